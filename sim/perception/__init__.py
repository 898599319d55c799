"""Camera frames to world state, fingertip forces."""
