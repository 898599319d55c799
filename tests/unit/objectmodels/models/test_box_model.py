"""The box model: what it takes, what it refuses, its faces and its tilting."""

from __future__ import annotations

from math import atan, degrees, hypot, radians
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from objectmodels import BoxModel, ModelError, Registry
from objectmodels.mechanics.push_thresholds import (
    stroke_level,
    stroke_stuck,
    tilt_level,
    tilt_stuck,
)

CRATE = {"name": "crate", "size": (0.10, 0.20, 0.30), "mass": 1.0, "friction": 0.4}


@pytest.fixture(scope="module")
def crate() -> BoxModel:
    return BoxModel.model_validate(CRATE)


def test_what_is_not_given_follows_from_the_size(crate: BoxModel) -> None:
    assert crate.com == (0.0, 0.0, 0.15)
    corners = BoxModel.model_validate(CRATE | {"support": "corners"})
    assert corners.friction_radius == pytest.approx(hypot(0.10, 0.20) / 2, rel=1e-12)
    assert corners.friction_radius_sd == pytest.approx(0.45 * corners.friction_radius, rel=1e-12)
    assert crate.friction_radius < corners.friction_radius


def test_lists_and_arrays_serve_as_vectors() -> None:
    box = BoxModel.model_validate(CRATE | {"size": np.array([0.1, 0.2, 0.3]), "com": [0, 0, 0.1]})
    assert box.size == (0.1, 0.2, 0.3)
    assert box.com == (0.0, 0.0, 0.1)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("mass", 0.0),
        ("mass", -1.0),
        ("mass", float("nan")),
        ("mass", float("inf")),
        ("mass", "1.0"),
        ("mass", True),
        ("friction", 0.0),
        ("size", (0.1, 0.2)),
        ("size", (0.1, 0.2, -0.3)),
        ("size", (0.1, 0.2, float("nan"))),
        ("com", (0.06, 0.0, 0.1)),
        ("com", (0.0, 0.0, 0.3)),
        ("com_sd", (-0.001, 0.0, 0.0)),
        ("support", "springs"),
        ("name", ""),
        ("name", " crate"),
        ("name", "two\nlines"),
        ("colour", "red"),
    ],
)
def test_nonsense_is_refused(key: str, value: Any) -> None:
    with pytest.raises(ValidationError) as error:
        BoxModel.model_validate(CRATE | {key: value})
    assert key in str(error.value)


def test_models_do_not_change(crate: BoxModel) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        crate.mass = 2.0  # type: ignore[misc]
    assert hash(crate) == hash(BoxModel.model_validate(CRATE))


@pytest.mark.parametrize(
    ("points", "directions", "found"),
    [
        ([0.0, 0.0, 0.1], [1.0, 0.0, 0.0], r"\(3,\)"),
        ([[0.0, 0.0, 0.1]], [[1.0, 0.0]], r"\(1, 2\)"),
        ([[0.0, 0.0, 0.1]], [[1.0, 0.0, 0.0]] * 2, r"\(2, 3\)"),
        ([[0.0, 0.0, float("nan")]], [[1.0, 0.0, 0.0]], "finite"),
        ([[0.0, 0.0, 0.1]], [[2.0, 0.0, 0.0]], "unit"),
    ],
)
def test_arrays_are_checked(crate: BoxModel, points: Any, directions: Any, found: str) -> None:
    with pytest.raises(ModelError, match=found) as error:
        crate.thresholds(points, directions)
    assert error.value.code == "bad_array"


def test_normals_and_sigmas_are_checked(crate: BoxModel) -> None:
    with pytest.raises(ModelError, match="side faces"):
        crate.cone_thresholds([[0.0, 0.0, 0.3]], [[0.0, 0.0, 1.0]])
    with pytest.raises(ModelError, match="sigmas"):
        crate.cone_thresholds([[0.05, 0.0, 0.1]], [[1.0, 0.0, 0.0]], sigmas=-1.0)


def test_faces_enclose_the_box(crate: BoxModel) -> None:
    faces = crate.faces()
    assert [f.normal for f in faces] == [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    assert [f.width for f in faces] == [0.2, 0.1, 0.2, 0.1]
    for face in faces:
        np.testing.assert_allclose(np.cross([0, 0, 1], face.normal), face.tangent, atol=1e-15)
        corner = np.array(face.centre) + face.width / 2 * np.array(face.tangent)
        np.testing.assert_allclose(np.abs(corner), [0.05, 0.1, 0.15], atol=1e-15)


def test_angle_of_no_return_is_that_of_the_paper_s_box() -> None:
    box = Registry.default().get("ice tea box")
    assert degrees(box.angle_of_no_return([1, 0, 0])) == pytest.approx(21.4, abs=0.05)  # rounding
    early, late = (box.angle_of_no_return([0, -1, 0], sigmas=s) for s in (2, -2))
    assert early == pytest.approx(atan((0.045 - 0.006) / (0.115 + 0.06)), rel=1e-12)
    assert late == pytest.approx(atan((0.045 + 0.006) / (0.115 - 0.06)), rel=1e-12)


def test_angle_depends_on_the_side_of_the_centre_of_mass() -> None:
    box = BoxModel.model_validate(CRATE | {"com": (0.02, 0.0, 0.1)})
    assert box.angle_of_no_return([1, 0, 0]) == pytest.approx(atan(0.03 / 0.1), rel=1e-12)
    assert box.angle_of_no_return([-1, 0.1, 0]) == pytest.approx(atan(0.07 / 0.1), rel=1e-12)


def test_strokes_are_those_of_the_ice_tea_box() -> None:
    angle = radians(21.4)
    assert stroke_level(0.22, 0.09, angle) == pytest.approx(0.079, abs=0.0006)  # given to 1 mm
    assert stroke_stuck(0.22, 0.09, angle) == pytest.approx(0.086, abs=0.0006)
    box = Registry.default().get("ice tea box")
    assert box.topple_stroke([0, 1, 0], 0.22, angle) == stroke_stuck(0.22, 0.09, angle)


def test_stroke_of_a_stuck_finger_follows_its_point_of_the_box() -> None:
    """Oracle: rotate the contact point about the leading edge."""
    height, length, angle = 0.15, 0.1, 0.3
    p = np.array([-length, height])  # from the pivot, seen along the edge
    c, s = np.cos(angle), np.sin(angle)
    moved = np.array([c * p[0] + s * p[1], c * p[1] - s * p[0]])
    assert stroke_stuck(height, length, angle) == pytest.approx(moved[0] - p[0], rel=1e-12)


def test_stroke_of_a_level_finger_ends_on_the_face() -> None:
    """Oracle: where the tilted rear face crosses the finger's height."""
    height, length, angle = 0.15, 0.1, 0.3
    foot = np.array([-length * np.cos(angle), length * np.sin(angle)])  # rear base edge, lifted
    along = np.array([np.sin(angle), np.cos(angle)])
    crossing = foot + (height - foot[1]) / along[1] * along
    assert stroke_level(height, length, angle) == pytest.approx(crossing[0] + length, rel=1e-12)


@pytest.mark.parametrize(("height", "angle"), [(0.0, 0.1), (0.31, 0.1), (0.1, -0.1), (0.1, 1.6)])
def test_strokes_off_the_box_are_refused(crate: BoxModel, height: float, angle: float) -> None:
    with pytest.raises(ModelError):
        crate.topple_stroke([1, 0, 0], height, angle)


@pytest.mark.parametrize("direction", [[0, 0, 1], [1, 0, 0, 0], [float("nan"), 0, 0]])
def test_directions_must_be_horizontal(crate: BoxModel, direction: list[float]) -> None:
    with pytest.raises(ModelError, match="horizontal"):
        crate.angle_of_no_return(direction)


@pytest.mark.parametrize("height", [0.05, 0.12, 0.22])
@pytest.mark.parametrize("angle", [0.01, 0.2, 0.37, 0.6])
def test_the_tilt_of_a_stroke_is_the_inverse_of_the_stroke_to_a_tilt(
    height: float, angle: float
) -> None:
    tea = Registry.built_in().get("ice tea box")
    for stroke, tilt in ((stroke_level, tilt_level), (stroke_stuck, tilt_stuck)):
        travel = stroke(height, 0.09, angle)
        # A level finger passes over the edge of the box that it tilts too far.
        if stroke is stroke_stuck or travel < stroke(height, 0.09, angle + 0.01):
            assert tilt(height, 0.09, travel) == pytest.approx(angle, rel=1e-9)
    low, high = tea.stroke_tilt([1, 0, 0], height, 0.02)
    assert 0.0 < low <= high


def test_golden_strokes_tilt_to_the_angle_of_no_return() -> None:
    tea = Registry.built_in().get("ice tea box")
    assert degrees(tilt_level(0.22, 0.09, 0.079)) == pytest.approx(21.4, abs=0.2)  # 1 mm is 0.2°
    assert degrees(tilt_stuck(0.22, 0.09, 0.0866)) == pytest.approx(21.4, abs=0.2)
    for height, travel in ((0.3, 0.01), (0.1, -0.01), (0.1, float("nan"))):
        with pytest.raises(ModelError):
            tea.stroke_tilt([1, 0, 0], height, travel)


@pytest.mark.parametrize("method", ["predict", "sudden"])
@pytest.mark.parametrize("pushes", [1, 2])
def test_a_force_beyond_all_numbers_is_refused(method: str, pushes: int) -> None:
    """The square of 1e300 overflows; a force of nothing was told to be what moves nothing."""
    box = BoxModel(name="crate", size=(0.10, 0.10, 0.20), mass=1.0, friction=0.4)
    with pytest.raises(ModelError) as refused:
        getattr(box, method)([[-0.05, 0.0, 0.1]] * pushes, [[1e300, 0.0, 0.0]] * pushes)
    assert refused.value.code == "bad_array"
    assert box.predict([[-0.05, 0.0, 0.1]], [[1e150, 0.0, 0.0]]).outcome.item() == "slide"


@pytest.mark.parametrize("method", ["thresholds", "predict", "likelihood", "sudden"])
def test_a_point_in_millimetres_is_refused(method: str) -> None:
    box = BoxModel(name="crate", size=(0.10, 0.10, 0.20), mass=1.0, friction=0.4)
    ask = getattr(box, method)
    ask([[-0.05, 0.0, 0.1]], [[1.0, 0.0, 0.0]])
    with pytest.raises(ModelError) as refused:
        ask([[-0.05, 0.0, 0.1], [-50.0, 0.0, 100.0]], [[1.0, 0.0, 0.0]] * 2)
    assert refused.value.code == "off_object"
    assert "millimetres" in refused.value.suggestions[0]
    with pytest.raises(ModelError) as refused:
        ask([[-0.2, 0.0, 0.1]], [[1.0, 0.0, 0.0]])
    assert refused.value.code == "off_object"
    assert "millimetres" not in refused.value.suggestions[0]
