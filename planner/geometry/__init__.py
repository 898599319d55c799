"""Directions, footprints, visibility graph."""
