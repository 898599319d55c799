"""What touches another thing, or seems to overlap it, gets away from it and along it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from grammar.frames import command as g
from nlcontrol import Registry
from planner import plan
from planner.problem.footprints import footprint, free_travel, gap, kept_gap
from planner.types.plan import Plan, PlanningResult
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, TableState, WorldState
from tests.unit.planner.conftest import RuledReach

TABLE = TableState(0.0, 1.0, -0.8, 0.8)
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 0.05


def pair(apart: float, yaw: float = 0.4) -> WorldState:
    """A box with another one on its left, at a distance; negative where they seem to overlap."""
    models = Registry.built_in()
    tea = SeenObject("tea", PlanarPose(0.5, 0.0, yaw), models.get("ice tea box"))
    lamp = SeenObject("lamp", PlanarPose(0.5, 0.4), models.get("cereal box"))
    come = free_travel(footprint(lamp), footprint(tea), np.array([0.0, -1.0]), 0.0)
    lamp = replace(lamp, pose=replace(lamp.pose, y=0.4 - come + apart))
    return WorldState({"tea": tea, "lamp": lamp}, TABLE)


def pushed(state: WorldState, direction: g.Direction, *clauses: g.Constraint) -> PlanningResult:
    frame = g.Frame(
        action="push",
        object=g.ObjectRef(text="tea", id="tea"),
        goal=g.Displace(direction=direction, distance=0.05),
        constraints=clauses,
    )
    return plan(frame, state, RuledReach(lambda _: True))


@pytest.mark.parametrize("apart", [-0.0002, 0.0, 0.0005])
def test_it_goes_away_and_along_but_not_into_it(apart: float) -> None:
    state = pair(apart)
    for direction in ("right", "toward"):
        assert isinstance(pushed(state, direction), Plan)
    into = pushed(state, "left")
    assert isinstance(into, Refusal)
    assert into.code == "in_the_way"


def test_what_it_is_not_to_touch_it_does_not_start_from() -> None:
    clear = g.NoTouch(object=g.ObjectRef(text="lamp", id="lamp"))
    assert isinstance(pushed(pair(-0.0002), "right", clear), Refusal)


@pytest.mark.parametrize(
    ("apart", "kept"),
    [(0.02, 0.01), (0.005, 0.0035), (0.0, -0.0005), (-0.001, -0.0015)],
)
def test_the_kept_gap_is_less_than_the_one_there_is(apart: float, kept: float) -> None:
    other = np.add(SQUARE, [0.1 + apart, 0.0])
    assert gap(SQUARE, other) == pytest.approx(apart, abs=1e-12)  # rounding
    assert kept_gap(SQUARE, other, 0.01) == pytest.approx(kept, abs=1e-12)
