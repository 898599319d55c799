"""Paths of fingertips and held objects: geometry that knows no robot."""
