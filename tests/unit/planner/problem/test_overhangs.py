"""Overhangs: over which edge, how far it may be, and when a drag over one is planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels.mechanics.standing_balance import TopLoad
from planner.problem.overhangs import most_overhang, overhangs, table_with_room
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, WorldState
from tests.unit.planner.conftest import planned, refused, world
from tests.unit.planner.pushing.test_drag_planner import hand

TABLE = WorldState().table
SIGMAS = 1.645  # of a probability of 0.95


def book(x: float = 0.9, yaw: float = 0.0, **beliefs: object) -> WorldState:
    state = world(book=PlanarPose(x, 0.0, yaw))
    seen = state.objects["book"]
    return replace(
        state, objects={"book": replace(seen, model=seen.model.model_copy(update=beliefs))}
    )


def test_an_overhang_has_its_edge_and_its_normal_in_the_object() -> None:
    seen = book(TABLE.x_max, np.pi / 2.0).objects["book"]
    (over,) = overhangs(seen, TABLE)
    assert over.edge == "back"
    assert over.length == pytest.approx(0.11)
    np.testing.assert_allclose(over.normal, (0.0, -1.0), atol=1e-12)
    assert not [*overhangs(book().objects["book"], TABLE)]
    wider = table_with_room(TABLE, [over], 0.02)
    assert wider.x_max == pytest.approx(TABLE.x_max + 0.13)
    assert replace(wider, x_max=TABLE.x_max) == TABLE


def test_the_mass_stays_over_the_table_by_what_is_not_known() -> None:
    seen = book(TABLE.x_max, com=(0.02, 0.0, 0.015), com_sd=(0.003, 0.9, 0.0)).objects["book"]
    (over,) = overhangs(seen, TABLE)
    spare = SIGMAS * np.hypot(0.003, DEFAULTS.overhang_sd)
    assert most_overhang(seen, over, DEFAULTS) == pytest.approx(0.075 - 0.02 - spare, abs=1e-5)
    # A force towards the edge along the top moves the pressure there, one away from it does not.
    drawn = [TopLoad(np.array([0.02, 0.0]), 20.0, force * over.normal) for force in (8.0, -8.0)]
    shifts = [most_overhang(seen, over, DEFAULTS, [load]) for load in drawn]
    weight = seen.model.weight + 20.0
    assert shifts[0] == pytest.approx(
        0.055 - 0.03 * 8.0 / weight
        - SIGMAS * np.hypot(0.003 * seen.model.weight / weight, DEFAULTS.overhang_sd), abs=1e-5,
    )  # fmt: skip
    assert shifts[1] == most_overhang(seen, over, DEFAULTS)


def test_it_is_drawn_over_the_edge_so_far() -> None:
    made = planned("pull the book 4 cm over the far edge", book(), hand())
    assert made.aim is not None
    assert made.push.press > 0.0
    assert made.aim.x + 0.075 - TABLE.x_max == pytest.approx(0.04)
    assert "40 mm over the table's back edge" in made.notes[0]
    nearest = planned("pull the book over the edge", book(), hand())
    assert nearest.aim is not None
    assert nearest.aim.x + 0.075 - TABLE.x_max == pytest.approx(DEFAULTS.overhang)


def test_what_would_not_lie_there_is_refused() -> None:
    found = refused("pull the book 7 cm over the far edge", book(), hand())
    assert found.code == "hangs_too_far"
    assert found.numbers["overhang"] == pytest.approx(0.07)
    # As far as that says, it is planned.
    most = 1e3 * found.numbers["most"]
    assert 40.0 < most < 70.0
    assert planned(f"pull the book {most - 0.1:.1f} mm over the far edge", book(), hand())
    mug = refused("push the mug over the edge", world(mug=PlanarPose(0.9, 0.0)), hand())
    assert mug.code == "no_top_to_press"
    side = refused("push the book over the far edge on its left side", book(), hand())
    assert side.code == "pushed_over_edge"


def test_a_drag_to_the_edge_alone_keeps_off_it() -> None:
    made = planned("draw the book to the far edge", book(), hand())
    assert made.aim is not None
    assert TABLE.x_max - made.aim.x - 0.075 == pytest.approx(DEFAULTS.edge_gap)
    found = refused("push the book 30 cm away on its top face", book(), hand())
    assert found.code == "off_the_table"
