"""Scenes in which little stands: six objects take the simulation half as long again as one."""

from __future__ import annotations

from sim.truth.scene_file import Scene


def with_only(scene: Scene, *names: str) -> Scene:
    """A scene in which these objects stand, and nothing else."""
    return scene.model_copy(update={"objects": tuple(map(scene.object, names))})
