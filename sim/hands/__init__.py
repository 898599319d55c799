"""Hands, a folder for each hand."""
