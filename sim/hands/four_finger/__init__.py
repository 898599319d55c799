"""Postures and kinematics of the four-finger hand."""
