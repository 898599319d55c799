"""Frame to planning problem: goal poses, regions, limits."""
