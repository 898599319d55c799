"""Which object is meant."""
