"""Worlds that show nothing that could happen: they end with an error, not with a verdict."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sim.errors import SimError
from sim.truth.scene_file import parse_scene
from sim.worlds.drake.drake_world import DrakeWorld

SCENE = """
version: 1
name: lone
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: crate
    model: coffee box
    pose: {x_m: 0.5, y_m: Y}
    truth: {size_m: [0.12, 0.12, HIGH], mass_kg: 2.0, friction_table: 0.35, friction_finger: 0.6}
"""


def world(high: float, y: float = 0.0) -> DrakeWorld:
    return DrakeWorld(parse_scene(SCENE.replace("HIGH", str(high)).replace("Y", str(y))))


def test_what_stands_in_the_waiting_robot_is_refused() -> None:
    """The arm pressed it through the table."""
    with pytest.raises(SimError, match=r"the crate stands .* mm in the robot") as raised:
        world(1.0)
    assert raised.value.code == "simulation_broke"
    assert world(1.0, y=-0.4).time == 0.0
    assert world(0.3).time == 0.0


@pytest.mark.parametrize(("z", "broken"), [(-0.02, True), (-0.001, False)])
def test_what_is_in_the_table_ends_the_run(z: float, broken: bool) -> None:
    from pydrake.math import RigidTransform

    lone = world(0.2)
    body, context = lone._model.bodies["crate"], lone._context
    lone._plant.SetFreeBodyPose(context, body, RigidTransform(np.array([0.5, 0.0, z])))
    still = lone.robot.commanded
    if not broken:
        lone.robot.step(*still)
        return
    with pytest.raises(SimError, match=r"the crate is .* mm deep in the table") as raised:
        lone.robot.step(*still)
    assert raised.value.code == "simulation_broke"


def test_what_the_engine_cannot_solve_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    lone = world(0.2)

    class Failing:
        def AdvanceTo(self, *_: Any, **__: Any) -> None:
            raise RuntimeError("did not converge")

    monkeypatch.setattr(lone, "simulator", Failing())
    with pytest.raises(SimError) as raised:
        lone.robot.step(*lone.robot.commanded)
    assert raised.value.code == "simulation_broke"
