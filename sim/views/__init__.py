"""Replay and picture, and the viewer of scenes in a browser."""
