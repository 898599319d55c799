"""What places mean, against what one sees on paper, and spots against their own regions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.frames import command as g
from planner.problem.footprints import footprint, gap
from planner.problem.places import (
    Between,
    Region,
    object_at,
    region,
    share_of_way,
    table_region,
)
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, WorldState
from tests.sizes import examples
from tests.unit.planner.conftest import world

TEA = g.ObjectRef(text="tea", id="ice tea box")
CEREAL = g.ObjectRef(text="cereal", id="cereal box")
COFFEE = g.ObjectRef(text="coffee", id="coffee box")
RELATIONS: tuple[g.Relation, ...] = (
    "next_to", "left_of", "right_of", "in_front_of", "behind", "touching",
)  # fmt: skip
angles = st.floats(-math.pi, math.pi)
polygons = st.lists(
    st.tuples(st.floats(0.02, 0.2), angles), min_size=3, max_size=8, unique_by=lambda p: p[1]
)


def _three(yaw: float = 0.0, other: float = 0.0) -> WorldState:
    return world(
        ice_tea_box=PlanarPose(0.40, 0.05, yaw),
        cereal_box=PlanarPose(0.60, 0.30, other),
        coffee_box=PlanarPose(0.60, -0.30),
    )


def _place(state: WorldState, goal: g.Place) -> Region:
    found = region(goal, state, DEFAULTS)
    assert found is not None
    return found


def _hull(corners: list[tuple[float, float]], x: float, y: float) -> np.ndarray:
    """Corners on an ellipse around a point: always convex."""
    angle = np.sort([a for _, a in corners])
    long = corners[0][0]
    return np.column_stack([x + long * np.cos(angle), y + 0.5 * long * np.sin(angle)])


def _dense(polygon: np.ndarray) -> np.ndarray:
    """Points along the edges of a polygon, 80 on each."""
    share = np.linspace(0.0, 1.0, 80)[:, None]
    ends = np.roll(polygon, -1, axis=0)
    return np.vstack([a + share * (b - a) for a, b in zip(polygon, ends, strict=True)])


@settings(max_examples=60, deadline=None)
@given(polygons, polygons, st.floats(-0.6, 0.6), st.floats(-0.6, 0.6))
def test_gap_is_the_least_distance_of_points(
    a: list[tuple[float, float]], b: list[tuple[float, float]], x: float, y: float
) -> None:
    for corners in (a, b):
        angles = np.sort([angle for _, angle in corners])
        # Corners closer than that make edges without a direction; −π and π are one corner.
        if np.diff(angles, append=angles[0] + 2.0 * np.pi).min() < 1e-2:
            return
    one, other = _hull(a, 0.0, 0.0), _hull(b, x, y)
    found = gap(one, other)
    apart = _dense(one)[:, None, :] - _dense(other)
    least = float(np.linalg.norm(apart, axis=2).min())
    if found <= 0.0:
        return
    # Samples lie up to 5 mm apart on edges of up to 0.4 m, each end of the gap within half of that
    # of one; so their distance is no less, and too great by no more than that.
    assert found - 1e-12 <= least <= found + 0.005
    assert gap(other, one) == pytest.approx(found, abs=1e-12)


def test_gap_between_squares_at_their_corners_and_sides() -> None:
    square = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]])
    assert gap(square, square + np.array([0.13, 0.05])) == pytest.approx(0.03)
    assert gap(square, square + np.array([0.13, 0.14])) == pytest.approx(0.05)
    # Where they overlap it is the way that would part them, less than nothing.
    assert gap(square, square + np.array([0.06, 0.05])) == pytest.approx(-0.04)
    assert gap(square, square) == pytest.approx(-0.1)
    inside = square * 0.2 + 0.04
    assert gap(square, inside) == pytest.approx(gap(inside, square)) == pytest.approx(-0.06)


@pytest.mark.parametrize("relation", RELATIONS)
@settings(max_examples=examples(30), deadline=None)
@given(yaw=angles, other=angles)
def test_an_object_on_any_spot_is_there(relation: g.Relation, yaw: float, other: float) -> None:
    state = _three(yaw, other)
    tea = state.objects["ice tea box"]
    place = _place(state, g.Place(relation=relation, reference=(CEREAL,)))
    spots = place.spots(tea)
    assert spots
    ways = [float(np.linalg.norm(spot - tea.pose.p_WB[:2])) for spot in spots]
    assert ways == sorted(ways)
    for spot in spots:
        assert place.holds(object_at(tea, spot))
    assert not place.holds(tea)


@pytest.mark.parametrize(
    ("relation", "x", "y"),
    [
        # The tea box is 90 mm square; the cereal box 195 mm along x, 66 mm along y; gap 30 mm.
        ("left_of", None, 1),
        ("right_of", None, -1),
        ("in_front_of", -1, None),
        ("behind", 1, None),
    ],
)
def test_sides_are_those_of_the_robot(relation: g.Relation, x: int | None, y: int | None) -> None:
    state = _three()
    cereal, tea = state.objects["cereal box"], state.objects["ice tea box"]
    half = np.ptp(footprint(cereal), axis=0) / 2
    spot = _place(state, g.Place(relation=relation, reference=(CEREAL,))).spots(tea)[0]
    way = spot - [0.60, 0.30]
    if x is not None:
        # The gap is found to a hundredth of a millimetre.
        assert way[0] == pytest.approx(x * (half[0] + 0.045 + DEFAULTS.place_gap), abs=2e-5)
    if y is not None:
        assert way[1] == pytest.approx(y * (half[1] + 0.045 + DEFAULTS.place_gap), abs=2e-5)


def test_a_side_does_not_move_it_across_more_than_needed() -> None:
    state = _three()
    goal = g.Place(relation="in_front_of", reference=(CEREAL,))
    there = object_at(state.objects["ice tea box"], np.array([0.3, 0.31]))
    nearest, middle = _place(state, goal).spots(there)
    assert (nearest[1], middle[1]) == pytest.approx((0.31, 0.30))


def test_the_wrong_side_is_no_left() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    left = _place(state, g.Place(relation="left_of", reference=(CEREAL,)))
    right = _place(state, g.Place(relation="right_of", reference=(CEREAL,)))
    at = object_at(tea, right.spots(tea)[0])
    assert right.holds(at)
    assert not left.holds(at)
    apart, aside = left.measures(at)
    assert apart.measured == pytest.approx(-DEFAULTS.place_gap, abs=2e-5)
    assert aside.ok


def test_a_place_too_far_aside_is_not_beside() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    behind = _place(state, g.Place(relation="behind", reference=(CEREAL,)))
    spot = behind.spots(tea)[-1]
    _, aside = behind.measures(object_at(tea, spot))
    assert behind.holds(object_at(tea, spot + np.array([0.0, 0.99 * aside.tolerance])))
    assert not behind.holds(object_at(tea, spot + np.array([0.0, 1.01 * aside.tolerance])))


def test_a_gap_that_is_said() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    place = _place(state, g.Place(relation="next_to", reference=(CEREAL,), distance=0.08))
    spot = place.spots(tea)[0]
    apart = gap(footprint(object_at(tea, spot)), footprint(state.objects["cereal box"]))
    assert apart == pytest.approx(0.08, abs=2e-5)  # it is found to 0.01 mm


def test_between_is_as_far_from_both() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    place = _place(state, g.Place(relation="between", reference=(CEREAL, COFFEE)))
    (spot,) = place.spots(tea)
    there = footprint(object_at(tea, spot))
    gaps = [gap(there, footprint(state.objects[name])) for name in ("cereal box", "coffee box")]
    assert gaps[0] == pytest.approx(gaps[1], abs=2e-5)  # found to 0.01 mm
    assert spot[0] == pytest.approx(0.60)
    near = DEFAULTS.between_tolerance
    assert place.holds(object_at(tea, spot + np.array([0.0, 0.99 * near])))
    assert not place.holds(object_at(tea, spot + np.array([0.0, 1.01 * near])))


def test_between_needs_room() -> None:
    state = _three()
    tea, cereal = state.objects["ice tea box"], state.objects["cereal box"]
    tight = Between(cereal, object_at(cereal, np.array([0.60, 0.40])), 0.03)
    assert tight.spots(tea) == []


def test_points_and_regions_of_the_table() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    point = _place(state, g.Place(relation="at", reference=g.Point(x=0.5, y=0.1)))
    assert point.holds(object_at(tea, np.array([0.509, 0.1])))
    assert not point.holds(object_at(tea, np.array([0.511, 0.1])))
    # The table reaches from (-0.2, -0.8) to (1.2, 0.8); 50 mm of gap and 45 mm of box are left.
    for name, spot in (
        ("center", (0.5, 0.0)),
        ("left_edge", (0.40, 0.705)),
        ("right_edge", (0.40, -0.705)),
        ("front_edge", (-0.105, 0.05)),
        ("back_edge", (1.105, 0.05)),
        ("edge", (-0.105, 0.05)),
        ("back_left_corner", (1.105, 0.705)),
        ("corner", (-0.105, 0.705)),
    ):
        place = table_region(name, state.table, DEFAULTS)
        assert place.spots(tea)[0] == pytest.approx(spot)
        assert place.holds(object_at(tea, np.array(spot)))
        assert not place.holds(tea)
        assert not place.holds(object_at(tea, np.array(spot) + 0.2))


def test_every_region_of_the_language_has_a_meaning() -> None:
    state = _three()
    for name in g.TableRegion.__args__:  # type: ignore[attr-defined]
        assert table_region(name, state.table, DEFAULTS).spots(state.objects["ice tea box"])


@pytest.mark.parametrize("half", ["left_half", "back_half"])
def test_a_half_has_places_beside_the_one_straight_across(half: str) -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    place = table_region(half, state.table, DEFAULTS)
    found = place.spots(object_at(tea, np.array([0.40, -0.05])))
    # Straight across first, then as far along the middle of the table to both sides.
    along, across = (0, 1) if half == "left_half" else (1, 0)
    assert found[0][along] == pytest.approx((0.40, -0.05)[along])
    off = np.array(found) - found[0]
    assert off[:, across] == pytest.approx(0.0)
    assert off[:, along].sum() == pytest.approx(0.0)
    assert np.ptp(off[:, along]) > 0.3  # room to go around what stands there
    assert all(place.holds(object_at(tea, spot)) for spot in found)
    inside = found[0] + 0.001 * (found[0] - np.array([0.40, -0.05]))
    assert place.spots(object_at(tea, inside)) == pytest.approx(np.array([inside]))


def test_in_something_is_no_place_yet() -> None:
    assert region(g.Place(relation="in", reference=(CEREAL,)), _three(), DEFAULTS) is None


def test_halfway_to_the_edge() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    half = share_of_way(table_region("left_edge", state.table, DEFAULTS), 0.5, tea, DEFAULTS)
    assert half.spots(tea)[0] == pytest.approx((0.40, (0.05 + 0.705) / 2))
    assert half.holds(object_at(tea, half.spots(tea)[0]))


def test_a_gap_of_the_defaults_is_used() -> None:
    state = _three()
    tea = state.objects["ice tea box"]
    wide = region(
        g.Place(relation="next_to", reference=(CEREAL,)), state, replace(DEFAULTS, place_gap=0.1)
    )
    assert wide is not None
    there = footprint(object_at(tea, wide.spots(tea)[0]))
    assert gap(there, footprint(state.objects["cereal box"])) == pytest.approx(0.1, abs=2e-5)
