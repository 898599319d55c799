"""Closed forms: thresholds, cone, friction limit, probability, motion, turning, grasps."""
