"""Remarks on what was said and done: the frames that they make of those before them."""
