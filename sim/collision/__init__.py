"""Obstacles and distances."""
