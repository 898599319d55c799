"""Figures that protect somebody or keep a promise."""

from typing import Annotated

SafetyFigure = Annotated[float, "guarded by a test"]
"""A number on which a promise hangs: with 1.3 or 0.7 times as much, a test of its room fails.

`python -m benchmarks.changed_figures` changes each of them, both ways, and runs these tests.
"""
