"""Lessons, exploration sessions, log fitting, model store."""
