"""Rows of an explanation: words to parameters."""
