"""The simulated robot and its world: scene, sensing, execution, trace and replay."""
