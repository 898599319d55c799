"""Public logs of pushes by a stiff robot: data for `nlcontrol fit`, and a test of the models."""
