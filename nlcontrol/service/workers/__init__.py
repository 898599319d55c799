"""Processes in which the service plans and simulates, and the queue of runs."""
