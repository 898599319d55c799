"""Mechanical models of pushed objects, and the registry that serves them."""
