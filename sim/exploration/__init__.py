"""Touches that find parameters."""
