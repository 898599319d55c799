"""Directions, faces and free way, against what one sees on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from objectmodels import Registry
from planner.problem.directions import angle_between, bisector, face_name, heading_of, phrase, unit
from planner.problem.footprints import (
    ROLLED_ASIDE,
    ROLLED_ASKEW,
    footprint,
    free_travel,
    landing_area,
    landing_strip,
    overlaps,
    travel_to_edge,
)
from planner.types.world_state import PlanarPose, SeenObject, TableState
from tests.unit.planner.conftest import world

angles = st.floats(-math.pi, math.pi)


@given(angles)
def test_heading_and_unit_vector(heading: float) -> None:
    # Sine, cosine and arctangent, each exact to a rounding.
    assert angle_between(heading_of(unit(heading)), heading) == pytest.approx(0.0, abs=1e-12)


@given(angles)
def test_faces_of_a_box_bear_four_different_names(yaw: float) -> None:
    assume(abs(math.remainder(yaw - math.pi / 4, math.pi / 2)) > 1e-6)
    names = {face_name(unit(yaw + k * math.pi / 2))[0] for k in range(4)}
    assert names == {"front", "back", "left", "right"}


def test_words_for_headings() -> None:
    assert phrase(0.0) == "away"
    assert phrase(math.radians(3)) == "away"
    assert phrase(-math.pi / 2) == "to the right"
    assert phrase(math.radians(6)) == "at heading 6°"
    assert phrase(math.radians(30)) == "at heading 30°"
    assert bisector(["left", "right"]) is None
    assert bisector(["away", "left"]) == pytest.approx(math.pi / 4)


def _square(x: float, y: float, half: float = 0.05) -> np.ndarray:
    return np.array([x, y]) + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


@given(x=st.floats(0.2, 1.0), y=st.floats(-0.3, 0.3), clearance=st.floats(0.0, 0.03))
def test_free_travel_ends_where_they_are_as_close_as_allowed(
    x: float, y: float, clearance: float
) -> None:
    moving, standing, u = _square(0.0, 0.0), _square(x, y), np.array([1.0, 0.0])
    free = free_travel(moving, standing, u, clearance)
    if math.isinf(free):
        assert abs(y) >= 0.1 + clearance - 1e-12
        return
    assert free == pytest.approx(x - 0.1 - clearance)
    # Before it they are apart, past it they are not.
    assert not overlaps(moving + (free - 1e-6) * u, standing, clearance)
    assert overlaps(moving + (free + 1e-6) * u, standing, clearance)


def test_edge_of_the_table() -> None:
    table = TableState(0.0, 1.0, -0.5, 0.5)
    corners = _square(0.5, 0.0)
    assert travel_to_edge(corners, table, np.array([1.0, 0.0]), 0.01) == pytest.approx(0.44)
    assert travel_to_edge(corners, table, np.array([0.0, -1.0]), 0.01) == pytest.approx(0.44)
    diagonal = np.array([1.0, 1.0]) / math.sqrt(2)
    assert travel_to_edge(corners, table, diagonal, 0.0) == pytest.approx(0.45 * math.sqrt(2))


def test_where_a_box_falls() -> None:
    seen = world(ice_tea_box=PlanarPose(0.4, 0.1)).objects["ice tea box"]
    strip = landing_strip(seen, unit(0.0))
    # 90 mm of base and 230 mm of height in front of it.
    assert strip[:, 0].max() - strip[:, 0].min() == pytest.approx(0.32)
    assert strip[:, 1].max() - strip[:, 1].min() == pytest.approx(0.09)
    assert footprint(seen).mean(axis=0) == pytest.approx([0.4, 0.1])


def test_a_bottle_may_fall_askew_or_roll_aside() -> None:
    bottle = Registry.built_in().get("water bottle")
    strip = landing_area(SeenObject("bottle", PlanarPose(0.4, 0.1), bottle), unit(0.0))
    radius = footprint(SeenObject("bottle", PlanarPose(0.0, 0.0), bottle))[:, 0].max()
    askew = bottle.top * math.sin(ROLLED_ASKEW)
    beside = radius + max(askew, ROLLED_ASIDE)
    assert strip[:, 1].max() - 0.1 == pytest.approx(beside, abs=1e-3)
    assert 0.1 - strip[:, 1].min() == pytest.approx(beside, abs=1e-3)
    # It falls no farther than it is high.
    assert strip[:, 0].max() - 0.4 == pytest.approx(radius + bottle.top, abs=1e-3)


def attitude(axis: str, degrees: float) -> tuple[float, ...]:
    return tuple(Rotation.from_euler(axis, degrees, degrees=True).as_matrix().ravel().tolist())


def test_a_fallen_box_is_seen_as_it_lies() -> None:
    """Toppled away over its front edge at x = 0.545 it covers the table beyond that."""
    tea = Registry.built_in().get("ice tea box")
    # Rolled over the edge: B's origin is 45 mm up, its z axis looks away.
    seen = SeenObject.lying("tea", PlanarPose(0.545, 0.1, 0.0, attitude("y", 90.0)), tea)
    assert seen.lies_on == "back"
    assert seen.model.extents == pytest.approx((0.23, 0.09, 0.09), rel=1e-12)
    corners = footprint(seen)
    np.testing.assert_allclose(corners.min(axis=0), (0.545, 0.055), atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), (0.775, 0.145), atol=1e-9)


def test_what_leans_lies_on_nothing_flat() -> None:
    tea = Registry.built_in().get("ice tea box")
    seen = SeenObject.lying("tea", PlanarPose(0.5, 0.0, 0.3, attitude("y", 40.0)), tea)
    assert (seen.lies_on, seen.model) == ("nothing flat", tea)
