"""The robot: arm, hand, how they reach an object, and the cell around them."""
