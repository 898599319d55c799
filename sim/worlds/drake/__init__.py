"""The Drake engine."""
