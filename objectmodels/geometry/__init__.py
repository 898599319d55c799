"""Base shapes, side faces, support points."""
