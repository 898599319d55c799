"""Ports of robot and observer, sensor noise."""
