"""Plan and actions, refusal, world state, robot, defaults."""
