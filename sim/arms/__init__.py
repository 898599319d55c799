"""Kinematics of arms: the protocol that planning and control know, and a folder for each arm."""
