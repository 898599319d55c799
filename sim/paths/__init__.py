"""Where fingertip and held object go."""
