"""Batches: many rows of sentence, scene and seed, on all cores or on a cluster."""
