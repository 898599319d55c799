"""The exact tier: springs, load bounds, step force."""
