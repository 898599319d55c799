"""Arm and hand along a path: inverse kinematics search, roadmap, the robot's reach."""
