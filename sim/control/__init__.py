"""Recorder and free motion."""
