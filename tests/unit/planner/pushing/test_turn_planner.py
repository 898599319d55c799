"""Turns in parts on two opposite faces, which cancel their displacements."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_motion import best_turn
from planner.pushing.turn_planner import LARGEST_TURN, PAIRED_TURN, turn_parts
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import RuledReach, planned, world

BOX = BoxModel(
    name="b", size=(0.08, 0.12, 0.2), mass=1.0, friction=0.3, finger_friction=0.6, support="corners"
)


def rotated(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("degrees", [5.0, -14.0, 20.0, 45.0, -90.0, 120.0, -180.0])
@pytest.mark.parametrize("radius", [0.03, 0.07])
def test_pushes_on_opposite_faces_leave_it_where_it_was(degrees: float, radius: float) -> None:
    crate = BOX.model_copy(update={"friction_radius": radius, "com": (0.0, 0.0, 0.09)})
    parts = turn_parts(np.radians(degrees))
    assert sum(parts) == pytest.approx(np.radians(degrees))
    assert len(parts) % 2 == (abs(degrees) > np.degrees(PAIRED_TURN))
    place, heading = np.zeros(2), 0.0
    for number, part in enumerate(parts):
        best = best_turn(crate, crate.faces()[2 * (number % 2)], part, 0.03)
        assert best is not None
        place = place + rotated(heading) @ np.array(best.pose[:2])
        heading += part
    assert abs(parts[0]) <= 0.5 * LARGEST_TURN
    assert np.linalg.norm(place) < (1e-12 if len(parts) > 2 else 0.002)


@pytest.mark.parametrize(("degrees", "largest"), [(100, 50.0), (120, 31.0)])
def test_no_push_turns_an_object_by_more_than_52_degrees(
    degrees: int, largest: float, reach: RuledReach
) -> None:
    state = world(ice_tea_box=PlanarPose(0.5, 0.0))
    made = planned(f"turn the ice tea box by {degrees} degrees", state, reach)
    turns = np.degrees([push.turn for push in made.pushes])
    assert turns.sum() == pytest.approx(degrees)
    # Halves of 50° are allowed, halves of 60° are not.
    assert turns.max() == pytest.approx(largest, abs=0.05)
