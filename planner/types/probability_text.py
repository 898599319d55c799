"""Probabilities in words: in three digits, and never as if anything were certain."""

from __future__ import annotations


def probability_text(probability: float) -> str:
    """A probability as people read it; 1 and 0 are told of none."""
    if probability > 0.999:
        return "over 0.999"
    return "below 0.001" if probability < 0.001 else f"{probability:.3f}"
