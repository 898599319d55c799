"""Where everything is predicted to be after a plan."""

from __future__ import annotations

import numpy as np
import pytest

from planner import plan
from planner.problem.footprints import footprint
from planner.problem.predicted_states import state_after
from planner.types.plan import Plan, Reached
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import frame_of, world
from tests.unit.planner.grasping.conftest import RuledHand

ROUNDING = 1e-9


@pytest.fixture
def table() -> WorldState:
    return world(ice_tea_box=PlanarPose(0.5, 0.0), mug=PlanarPose(0.5, 0.3))


def after(text: str, state: WorldState) -> WorldState:
    made = plan(frame_of(text), state, RuledHand())
    assert isinstance(made, Plan), made
    found = state_after(made, state)
    assert found is not None
    return found


def test_what_is_pushed_is_where_it_was_to_go(table: WorldState) -> None:
    pose = after("push the ice tea box 10 cm away", table).objects["ice tea box"].pose
    assert [pose.x, pose.y] == pytest.approx([0.6, 0.0])


@pytest.mark.parametrize(("way", "axis", "sign"), [("away", 0, 1.0), ("to the right", 1, -1.0)])
def test_what_is_toppled_lies_beyond_its_edge(
    way: str, axis: int, sign: float, table: WorldState
) -> None:
    lying = after(f"topple the ice tea box {way}", table).objects["ice tea box"]
    assert lying.lies_on != "bottom"
    # It stood on 9 by 9 cm and is 23 cm high.
    along = sign * (footprint(lying)[:, axis] - [0.5, 0.0][axis])
    assert [along.min(), along.max()] == pytest.approx([0.045, 0.275], abs=ROUNDING)
    assert np.ptp(footprint(lying)[:, 1 - axis]) == pytest.approx(0.09, abs=ROUNDING)


def test_what_is_tilted_stands_as_before(table: WorldState) -> None:
    assert after("tilt the ice tea box by 8 degrees away", table).objects == table.objects


def test_what_is_lifted_is_held_so_high_and_put_down_elsewhere(table: WorldState) -> None:
    up = after("lift the mug 10 cm", table)
    assert up.held is not None
    assert up.held.name == "mug"
    assert up.held.height == pytest.approx(0.1)
    higher = after("lift the mug 5 cm", up).held
    assert higher is not None
    assert higher.height == pytest.approx(0.15)
    down = after("put the mug at x 0.6 y 0.25", up)
    assert down.held is None
    pose = down.objects["mug"].pose
    assert [pose.x, pose.y] == pytest.approx([0.6, 0.25])


def test_what_is_there_already_stays(table: WorldState) -> None:
    assert state_after(Reached(), table) is table
