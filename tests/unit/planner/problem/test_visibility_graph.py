"""Ways around things: free all along, no longer than they must be, and found if there are any."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.problem.directions import unit
from planner.problem.footprints import footprint, gap, shortest_detour
from planner.pushing.push_paths import ANOTHER_PUSH
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import world

QUARTERS = tuple(k * math.pi / 2 for k in range(4))
CLEARANCE = 0.01
CLOSE = 1e-6  # a way along the very edge of what is free [m]


def found(state: WorldState, aim: tuple[float, float]) -> list[tuple[float, float]] | None:
    target = state.objects["ice tea box"]
    others = {name: CLEARANCE for name in state.objects if name != target.name}
    turned = tuple(h + target.pose.yaw for h in QUARTERS)
    return shortest_detour(target, aim, turned, state, others, CLEARANCE, ANOTHER_PUSH)


def walked(target: SeenObject, way: list[tuple[float, float]]) -> list[SeenObject]:
    """Where the object is on its way, every 5 mm."""
    places, p = [target], target.pose.p_WB
    for heading, length in way:
        for share in np.linspace(0.0, 1.0, 2 + int(length / 0.005))[1:]:
            x, y, _ = (p + share * length * unit(heading)).tolist()
            places.append(replace(target, pose=replace(target.pose, x=x, y=y)))
        p = p + length * unit(heading)
    return places


@settings(max_examples=30)
@given(
    x=st.floats(0.56, 0.72),
    y=st.floats(-0.12, 0.12),
    turned=st.floats(-0.7, 0.7),
    degrees=st.floats(-40.0, 40.0),
)
def test_every_place_on_the_way_is_free(x: float, y: float, turned: float, degrees: float) -> None:
    state = world(
        ice_tea_box=PlanarPose(0.42, 0.0, math.radians(degrees)),
        sugar_box=PlanarPose(x, y, turned),
    )
    aim = (0.86, 0.02)
    way = found(state, aim)
    if way is None:
        return
    places = walked(state.objects["ice tea box"], way)
    assert (places[-1].pose.x, places[-1].pose.y) == pytest.approx(aim, abs=1e-9)
    other = footprint(state.objects["sugar box"])
    assert min(gap(footprint(seen), other) for seen in places) > CLEARANCE - CLOSE


def test_a_free_way_is_two_legs() -> None:
    state = world(ice_tea_box=PlanarPose(0.45, 0.0))
    way = found(state, (0.60, 0.13))
    assert way is not None
    assert sorted(length for _, length in way) == pytest.approx([0.13, 0.15])


def test_around_a_wall_through_its_only_gap() -> None:
    # Boxes side by side leave a gap on the left only.
    wall = {f"cereal_box_{i}": PlanarPose(0.65, -0.30 + 0.2 * i) for i in range(4)}
    plain = world(ice_tea_box=PlanarPose(0.45, 0.0), cereal_box=PlanarPose(0.65, 0.0))
    model = plain.objects["cereal box"].model
    objects = {name: SeenObject(name, pose, model) for name, pose in wall.items()}
    state = replace(plain, objects={"ice tea box": plain.objects["ice tea box"], **objects})
    way = found(state, (0.85, 0.0))
    # To the left edge of the wall at 0.396, and half the box and the clearance beyond.
    assert (
        way is None
        or max(seen.pose.y for seen in walked(plain.objects["ice tea box"], way))
        > (0.396 + 0.045 + CLEARANCE - 0.02)
        or min(seen.pose.y for seen in walked(plain.objects["ice tea box"], way)) < -0.396
    )


def test_nothing_leads_out_of_a_ring() -> None:
    plain = world(ice_tea_box=PlanarPose(0.45, 0.0), cereal_box=PlanarPose(0.65, 0.0))
    model = plain.objects["cereal box"].model
    ring = {
        "a": PlanarPose(0.55, 0.0), "b": PlanarPose(0.35, 0.0),
        "c": PlanarPose(0.45, 0.12, math.pi / 2), "d": PlanarPose(0.45, -0.12, math.pi / 2),
    }  # fmt: skip
    objects = {name: SeenObject(name, pose, model) for name, pose in ring.items()}
    state = replace(plain, objects={"ice tea box": plain.objects["ice tea box"], **objects})
    assert found(state, (0.8, 0.0)) is None
