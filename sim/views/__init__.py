"""Replay and picture."""
