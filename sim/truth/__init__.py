"""CLOSED to planning and control: scene file with truth, world sampling, observer."""
