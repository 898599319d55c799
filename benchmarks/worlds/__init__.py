"""Simulated worlds in which the benchmarks and the tests try what is predicted."""
