"""Are the robot's own verdicts right? Cases by seed, with rows that are kept."""
