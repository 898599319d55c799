"""Bundles of runs: one file that tells all of a run, and from which the run can be repeated."""
