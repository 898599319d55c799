"""Hostile calls to the service and to the tools of agents."""
