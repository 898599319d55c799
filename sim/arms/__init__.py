"""Arm kinematics, a folder for each arm."""
