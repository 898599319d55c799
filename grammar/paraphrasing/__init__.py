"""Frames to words, and the sampler of sentences."""
