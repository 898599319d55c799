"""Models as other simulators read them: MJCF, SDF and URDF."""
