"""Readers of a real robot's data files."""
