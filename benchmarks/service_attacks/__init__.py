"""Hostile sequences of calls to the planning service, over HTTP and over the tools of agents."""
