"""Answers without motion."""
