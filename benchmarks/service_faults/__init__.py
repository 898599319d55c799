"""Proofs that the service and its page outlive their users: sessions, stops, restarts, faults."""
