"""Places in an open box: with room to the walls and to what stands there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planner.problem.footprints import footprint, gap
from planner.problem.places import InBox
from planner.problem.stacks import put_on
from planner.types.world_state import PlanarPose, SeenObject
from tests.unit.planner.conftest import world

ROUNDING = 1e-9
OBJECTS = world(
    storage_bin=PlanarPose(0.5, 0.1, 0.4),
    mug=PlanarPose(0.2, 0.3),
    sugar_box=PlanarPose(0.2, -0.3, 0.4),
    ice_tea_box=PlanarPose(0.7, 0.5, 0.4),
    book=PlanarPose(0.7, -0.5, 0.4),
).objects
BOX = OBJECTS["storage bin"]


def place(*contents: SeenObject) -> InBox:
    return InBox(BOX, contents, 0.01, 0.005)


def there(name: str, at: np.ndarray) -> SeenObject:
    seen = OBJECTS[name]
    pose = replace(seen.pose, x=float(at[0]), y=float(at[1]))
    return put_on(replace(seen, pose=pose), BOX)


@pytest.mark.parametrize("name", ["mug", "sugar box", "book"])
def test_each_spot_leaves_room_to_the_walls(name: str) -> None:
    spots = place().spots(OBJECTS[name])
    assert spots
    c, s = np.cos(0.4), np.sin(0.4)
    half = 0.5 * np.array([0.212, 0.292]) - 0.008
    for at in spots:
        put = there(name, at)
        in_B = (footprint(put) - [0.5, 0.1]) @ np.array([[c, -s], [s, c]])
        assert (np.abs(in_B) < half + ROUNDING).all()
        assert place().holds(put)
    # The middle comes first where it is empty.
    np.testing.assert_allclose(footprint(there(name, spots[0])).mean(axis=0), [0.5, 0.1], atol=1e-6)


def test_it_keeps_off_what_stands_there() -> None:
    mug = there("mug", np.array([0.5, 0.1]))
    spots = place(mug).spots(OBJECTS["sugar box"])
    assert spots
    for at in spots:
        assert gap(footprint(there("sugar box", at)), footprint(mug)) >= 0.01 - ROUNDING
    assert not place(mug).spots(OBJECTS["book"])
    # What is itself there does not stand in its own way.
    assert place(mug).spots(OBJECTS["mug"])


def test_how_much_too_long_something_is() -> None:
    askew = replace(OBJECTS["book"], pose=PlanarPose(0.7, -0.5, 0.4 + np.pi / 2.0))
    # Its 220 mm lie across the 212 mm, less 8 mm of room on both sides.
    assert place().excess(askew) == pytest.approx(0.220 - 0.212 + 2.0 * 0.008, abs=ROUNDING)
    assert not place().spots(askew)
    assert place().excess(OBJECTS["book"]) < 0.0


@pytest.mark.parametrize(
    ("off", "height", "holds"),
    [(0.0, 0.004, True), (0.0, 0.062, False), (0.075, 0.004, False), (0.060, 0.004, True)],
)
def test_it_is_in_it_within_the_walls_and_on_the_floor(
    off: float, height: float, holds: bool
) -> None:
    # The mug's radius is 40 mm, half the inside 106 mm.
    at = np.array([0.5, 0.1]) + off * np.array([np.cos(0.4), np.sin(0.4)])
    pose = PlanarPose(float(at[0]), float(at[1]), z=height)
    assert place().holds(replace(OBJECTS["mug"], pose=pose)) == holds
