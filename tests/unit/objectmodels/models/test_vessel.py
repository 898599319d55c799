"""What leaning vessels hold, against closed forms and against points thrown into the cavity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from pydantic import ValidationError

from objectmodels import BoxModel, CylinderModel, Disc, HullModel, Polygon, PrismModel
from objectmodels.models.object_parts import Container, Opening, Vessel

Array = NDArray[np.float64]

CARTON = Vessel(
    Polygon.rectangle(0.056, 0.076), 0.002, 0.16, Opening(centre=(0.0, 0.02), radius=0.014)
)
MUG = Vessel(Disc(0.037), 0.003, 0.082, Opening(radius=0.037))
JUG = Vessel(
    Polygon.convex([(0.05, -0.03), (0.0, 0.06), (-0.05, -0.02)]), 0.003, 0.1,
    Opening(centre=(0.01, 0.0), radius=0.01),
)  # fmt: skip
VESSELS = pytest.mark.parametrize("vessel", [CARTON, MUG, JUG], ids=["carton", "mug", "jug"])


def _points(vessel: Vessel, count: int) -> Array:
    """Points spread evenly over the cavity, shape (n, 3)."""
    rng, size = np.random.default_rng(1), vessel.section.size
    p = rng.uniform([-size, -size, vessel.floor], [size, size, vessel.top], (count, 3))
    if isinstance(vessel.section, Disc):
        return p[np.hypot(p[:, 0], p[:, 1]) < vessel.section.radius]
    assert isinstance(vessel.section, Polygon)
    return p[(p[:, :2] @ vessel.section.normals.T < vessel.section.offsets).all(axis=1)]


def _up(tilt: float, heading: float) -> Array:
    return np.array(
        [-np.sin(tilt) * np.cos(heading), -np.sin(tilt) * np.sin(heading), np.cos(tilt)]
    )


@VESSELS
@pytest.mark.parametrize("degrees", [0.0, 7.0, 45.0, 85.0, 90.0, 97.0, 130.0, 175.0])
def test_points_thrown_into_the_cavity(vessel: Vessel, degrees: float) -> None:
    tilt, points = np.radians(degrees), _points(vessel, 400_000)
    for heading in (0.0, 0.9, -2.3):
        heights = points @ _up(tilt, heading)
        rim = vessel.opening.radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 3600))
        x, y = vessel.opening.centre
        around = np.column_stack([x + rim.real, y + rim.imag, np.full(3600, vessel.top)])
        lip = (around @ _up(tilt, heading)).min()
        # Four standard deviations of a share of some 200 000 points.
        share = vessel.brim(tilt, heading) / vessel.capacity
        assert share == pytest.approx((heights < lip).mean(), abs=0.005)
        volume = 0.37 * vessel.capacity
        level = np.quantile(heights, 0.37)
        # Of the quantile, with the points' mean distance in a cavity of some 100 mm.
        assert vessel.surface_level(volume, tilt, heading) == pytest.approx(level, abs=5e-4)
        middle = points[heights < level].mean(axis=0)
        assert vessel.centroid(volume, tilt, heading) == pytest.approx(middle, abs=5e-4)


@pytest.mark.parametrize("degrees", [10.0, 30.0])
def test_a_box_that_leans_along_a_side(degrees: float) -> None:
    """While the surface meets both walls, its middle is as high as upright."""
    box = Vessel(Polygon.rectangle(0.06, 0.08), 0.0, 0.2, Opening(radius=0.03))
    tilt = np.radians(degrees)
    held = 0.06 * 0.08 * (0.2 - 0.03 * np.tan(tilt))
    wedge = 0.5 * 0.06 * 0.08 * 0.06 * np.tan(tilt)
    # Strips are exact there; what remains is rounding.
    assert box.brim(tilt, 0.0) == pytest.approx(held, rel=1e-9)
    assert box.spill_angle(held, 0.0) == pytest.approx(tilt, abs=1e-9)
    over = box.brim(np.arctan(0.2 / 0.06), 0.0)  # half the box is left: the floor's far edge
    assert over == pytest.approx(0.5 * 0.06 * 0.08 * 0.2, rel=1e-6)
    x, _, z = box.centroid(held, tilt, 0.0)
    middle = 0.2 - 0.06 * np.tan(tilt)
    expected = (middle * 0.06 * 0.08 * middle / 2 + wedge * (middle + 0.02 * np.tan(tilt))) / held
    assert x == pytest.approx(wedge * 0.01 / held, rel=2e-3)  # strips as places, not as areas
    assert z == pytest.approx(expected, rel=1e-4)


def test_a_cylinder_in_closed_form() -> None:
    """Until the floor falls dry half the cylinder's slice is lost, then an ungula is left."""
    radius, height = 0.04, 0.1
    cup = Vessel(Disc(radius), 0.0, height, Opening(radius=radius))
    tilt = np.arctan(0.5 * height / radius)
    slanted = np.pi * radius**2 * (height - radius * np.tan(tilt))
    # Strips of a disc: right to 0.1 %.
    assert cup.brim(tilt, 1.1) == pytest.approx(slanted, rel=1e-3)
    half_dry = np.arctan(height / radius)  # the surface passes through the middle of the floor
    assert cup.brim(half_dry, 1.1) == pytest.approx(2.0 / 3.0 * radius**2 * height, rel=1e-3)


@given(
    share=st.floats(0.01, 0.99),
    tilt=st.floats(0.0, np.pi),
    heading=st.floats(-np.pi, np.pi),
    vessel=st.sampled_from([CARTON, MUG, JUG]),
)
def test_the_level_of_the_brim_is_the_lip(
    share: float, tilt: float, heading: float, vessel: Vessel
) -> None:
    volume = share * vessel.capacity
    held = float(vessel.brim(tilt, heading))
    head = float(vessel.liquid_head(volume, tilt, heading))
    # The level is found to 0.1 nm; an area of 100 cm² makes 1e-12 m³ of that.
    if abs(held - volume) > 1e-11:
        assert (head > 0.0) == (volume > held)
    spills = float(vessel.spill_angle(volume, heading))
    if abs(tilt - spills) > 1e-6:
        assert (tilt > spills) == (held < volume)


@VESSELS
def test_arrays_are_what_their_elements_are(vessel: Vessel) -> None:
    rng = np.random.default_rng(0)
    volume, tilt = rng.uniform(0.0, vessel.capacity, (4, 3)), rng.uniform(0.0, np.pi, 3)
    heading = rng.uniform(-3.0, 3.0, (4, 1))
    level, middle = (
        vessel.surface_level(volume, tilt, heading),
        vessel.centroid(volume, tilt, heading),
    )
    assert level.shape == (4, 3)
    assert middle.shape == (4, 3, 3)
    i, j = 2, 1
    one: tuple[Any, ...] = (volume[i, j], tilt[j], heading[i, 0])
    assert vessel.surface_level(*one) == pytest.approx(level[i, j], abs=1e-9)
    assert vessel.centroid(*one) == pytest.approx(middle[i, j], abs=1e-8)


def test_the_ends_of_the_scale() -> None:
    assert MUG.brim(0.0, 0.3) == pytest.approx(MUG.capacity)
    assert MUG.brim(np.pi, 0.3) == pytest.approx(0.0, abs=1e-9)
    assert MUG.spill_angle(0.0, 0.0) == np.pi
    assert MUG.spill_angle(MUG.capacity, 0.0) == 0.0
    assert MUG.surface_level(0.0, 0.0, 0.0) == pytest.approx(MUG.floor, abs=1e-6)
    over = MUG.surface_level(MUG.capacity + 1e-6, 0.0, 0.0) - MUG.top
    assert over == pytest.approx(1e-6 / (np.pi * 0.037**2), rel=1e-6)
    # A hole in front leaves what lies behind it and above.
    behind = CARTON.brim(np.radians(100.0), -np.pi / 2.0)
    assert behind > CARTON.brim(np.radians(100.0), np.pi / 2.0)


CONTAINER = Container(wall=0.002, opening=Opening(radius=0.02), contents_l=0.2)


def test_models_have_the_cavity_of_their_shape() -> None:
    bare: dict[str, Any] = {"name": "x", "mass": 0.3, "friction": 0.4, "container": CONTAINER}
    box = BoxModel(size=(0.06, 0.08, 0.16), **bare).vessel
    assert box is not None
    assert box.capacity == pytest.approx(0.056 * 0.076 * 0.158)
    mug = CylinderModel(radius=0.04, height=0.1, base_radius=0.03, **bare).vessel
    assert mug is not None
    assert mug.capacity == pytest.approx(np.pi * 0.038**2 * 0.098)
    corners = ((0.05, -0.05), (0.05, 0.05), (-0.05, 0.05), (-0.05, -0.05))
    jar = PrismModel(corners=corners, height=0.1, **bare).vessel
    assert jar is not None
    assert jar.capacity == pytest.approx(0.096**2 * 0.098)
    assert BoxModel(name="x", size=(0.06, 0.08, 0.16), mass=0.3, friction=0.4).vessel is None


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"wall": 0.04}, "container.wall_m"),
        ({"opening": Opening(centre=(0.03, 0.0), radius=0.02)}, "container.opening"),
        ({"contents_l": 0.9, "density": 100.0}, "container.contents_l"),
        ({"contents_l": 0.35}, "container"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, object], where: str) -> None:
    container = CONTAINER.model_copy(update=changes)
    with pytest.raises(ValidationError) as caught:
        BoxModel(name="x", size=(0.06, 0.08, 0.16), mass=0.3, friction=0.4, container=container)
    assert f"{where}: " in str(caught.value)


def test_a_hull_is_no_container() -> None:
    corners = tuple((x, y, z) for x in (-0.04, 0.04) for y in (-0.04, 0.04) for z in (0.0, 0.1))
    with pytest.raises(ValidationError, match="upright walls"):
        HullModel(name="x", vertices=corners, mass=1.0, friction=0.4, container=CONTAINER)


def test_a_thick_wall_swallows_a_short_side() -> None:
    """A bevel of 1 mm is gone behind a wall of 5 mm; the square inside is left."""
    a = 0.05
    bevelled = Polygon.convex([(a, -a), (a, a - 1e-3), (a - 1e-3, a), (-a, a), (-a, -a)])
    vessel = Vessel.from_shape(bevelled, 0.1, Container(wall=0.005, opening=Opening(radius=0.02)))
    assert vessel.capacity == pytest.approx(0.09**2 * 0.095)
