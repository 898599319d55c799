"""Obstacles as the robot sees them, and distances of spheres from them; it knows no robot."""
