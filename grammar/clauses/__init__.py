"""Phrase parts to frames, and their consistency."""
