"""The truth of an object of the simulated world: shape, mass, friction, contents.

Frame: B is the object's frame at the centre of its base.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from objectmodels import BoxModel, CylinderModel, HullModel, ObjectModel, PrismModel
from objectmodels.containers import lids
from objectmodels.files.yaml_documents import Deviation, Friction, Length, Mass, length_of
from objectmodels.geometry.base_shapes import Array, Base, Disc, Polygon, hull_polygon
from objectmodels.models.object_parts import (
    Cavity,
    Container,
    Lid,
    Vessel,
    open_box_parts,
    require_open_box,
)
from planner.types.world_state import Colour
from sim.robots.cell_description import Fraction, Part, Point2, Point3

GREY: Colour = (0.6, 0.6, 0.6)

_RIM_POINTS = 16
_FLAT = 1e-4  # heights of a hull that differ by less are one [m]


class Truth(Part):
    """The truth of an object; only the simulated world and an observer of it may read this.

    Its shape is one of four: a box (`size_m`), an upright cylinder (`radius_m`, `height_m`), a
    prism over a convex polygon (`corners_m`, `height_m`) or a convex hull (`vertices_m`).

    Attributes:
        size_m: of a box along B's axes.
        radius_m: of a cylinder.
        base_radius_m: of the circle on which a cylinder stands, if that is smaller.
        corners_m: of a prism's base in B's x, y, in order.
        height_m: of a cylinder or prism.
        vertices_m: of a convex hull in B; it stands on those at z = 0.
        mass_kg: true mass.
        friction_table: the one coefficient of the contact between base and table. A discrete
            simulation has no separate static coefficient; this is the sliding one.
        friction_finger: the same between object and fingertip.
        centre_of_mass_m: in B; above the origin at half the height if not given.
        contents_shift_m: standard deviation of a shift of the centre of mass along each axis of B,
            drawn anew whenever the robot begins to touch the object; 0 for contents that lie still.
            Not for containers, whose contents lie as gravity has it.
        support_m: points of the base on which the object stands, in B's x, y; its corners (of a
            cylinder: points of its rim) if not given.
        container: what it really holds; `mass_kg` includes the contents.
        inside: of a box that is open above, where other objects may stand.
        lid: what really covers it; `mass_kg` includes the lid.
        colour: red, green, blue in 0…1, for the camera and for pictures.
    """

    size_m: tuple[Length, Length, Length] | None = None
    radius_m: Length | None = None
    base_radius_m: Length | None = None
    corners_m: Annotated[tuple[Point2, ...], length_of("corners")] | None = None
    height_m: Length | None = None
    vertices_m: Annotated[tuple[Point3, ...], length_of("vertices")] | None = None
    mass_kg: Mass
    friction_table: Friction
    friction_finger: Friction
    centre_of_mass_m: Point3 | None = None
    contents_shift_m: Deviation = 0.0
    support_m: Annotated[tuple[Point2, ...], length_of("support")] | None = None
    container: Container | None = None
    inside: Cavity | None = None
    lid: Lid | None = None
    colour: tuple[Fraction, Fraction, Fraction] = (0.8, 0.7, 0.4)

    @model_validator(mode="after")
    def _one_shape(self) -> Truth:
        upright = (self.radius_m, self.corners_m)
        shapes = (self.size_m, *upright, self.vertices_m)
        if sum(shape is not None for shape in shapes) != 1:
            raise ValueError("needs one shape: size_m, radius_m, corners_m or vertices_m")
        if any(shape is not None for shape in upright) == (self.height_m is None):
            raise ValueError("height_m belongs to a radius_m or corners_m, and to nothing else")
        if self.vertices_m is not None and (self.container is not None or self.lid is not None):
            raise ValueError("a hull of vertices_m has neither container nor lid")
        if self.inside is not None and (
            self.size_m is None or self.container is not None or self.lid is not None
        ):
            raise ValueError("inside belongs to a size_m that has neither container nor lid")
        if self.inside is not None and self.size_m is not None:
            require_open_box(self.size_m, self.inside)
        if self.base_radius_m is not None and self.radius_m is None:
            raise ValueError("base_radius_m belongs to a radius_m")
        if self.corners_m is not None:
            Polygon.convex(self.corners_m)
        if self.vertices_m is not None:
            if min(z for _, _, z in self.vertices_m) != 0.0:
                raise ValueError("the lowest of vertices_m are at z = 0")
            if len(self.support) < 3 or not self.upper_points:
                raise ValueError("vertices_m has a base of three or more at z = 0")
        return self

    @model_validator(mode="after")
    def _inside(self) -> Truth:
        if not self._contains(self.centre_of_mass):
            raise ValueError(f"centre_of_mass_m {self.centre_of_mass} lies outside the object")
        if self.lid is not None and not (
            self.lid.mass < self.mass_kg and self._contains(self.without_lid.centre_of_mass)
        ):
            raise ValueError("mass_kg and centre_of_mass_m include those of the lid")
        return self

    @model_validator(mode="after")
    def _holds_its_contents(self) -> Truth:
        if self.container is None:
            return self
        _ = self.vessel  # which refuses what does not fit
        if self.container.mass >= self.mass_kg:
            raise ValueError(f"the contents weigh {self.container.mass:.3f} kg, more than mass_kg")
        if self.contents_shift_m > 0.0:
            raise ValueError("contents_shift_m is not for containers")
        return self

    @cached_property
    def vessel(self) -> Vessel | None:
        """Its cavity, as a function of how it leans; None if it is not hollow."""
        if self.container is None:
            return None
        return Vessel.from_shape(self.rim, self.height, self.container)

    def _contains(self, p_B: Point3) -> bool:
        x, y, z = p_B
        outline = Polygon.convex(self.outline)
        return bool((outline.normals @ [x, y] < outline.offsets).all() and 0 < z < self.height)

    def with_shift(self, shift: ArrayLike) -> Truth:
        """The same with its centre of mass shifted in B, shape (3,) [m].

        The shift is a half or less where it would fall over.
        """
        for share in (1.0, 0.5, 0.25):
            x, y, z = (np.array(self.centre_of_mass) + share * np.asarray(shift)).tolist()
            if self._contains((x, y, z)) and _is_surrounded((x, y), self.support):
                return self.model_copy(update={"centre_of_mass_m": (x, y, z)})
        return self

    @property
    def cuboids(self) -> tuple[tuple[Array, Array], ...]:
        """Opposite corners in B of the cuboids of which a box consists, shape (3,) each [m]."""
        assert self.size_m is not None, "only a box consists of cuboids"
        if self.inside is not None:
            return open_box_parts(self.size_m, self.inside)
        x, y, z = self.size_m
        return ((np.array([-x / 2, -y / 2, 0.0]), np.array([x / 2, y / 2, z])),)

    @property
    def height(self) -> float:
        """Of its top above the table [m]."""
        if self.size_m is not None:
            return self.size_m[2]
        if self.vertices_m is not None:
            return max(z for _, _, z in self.vertices_m)
        assert self.height_m is not None
        return self.height_m

    @property
    def outline(self) -> tuple[Point2, ...]:
        """Corners of its sides in B's x, y [m]; points around a round one."""
        if self.size_m is not None:
            a, b = self.size_m[0] / 2, self.size_m[1] / 2
            return ((a, b), (-a, b), (-a, -b), (a, -b))
        if self.vertices_m is not None:
            return _outline(self.vertices_m)
        return self.corners_m or _circle(self.radius_m or 0.0)

    @property
    def corners(self) -> Array:
        """Corners of its hull in B, points around those of round ends, shape (k, 3) [m]."""
        if self.vertices_m is not None:
            return np.array(self.vertices_m)
        return np.array([(x, y, z) for z in (0.0, self.height) for x, y in self.outline])

    @property
    def centre_of_mass(self) -> Point3:
        """Centre of mass in B [m]."""
        return self.centre_of_mass_m or (0.0, 0.0, self.height / 2)

    @property
    def rim(self) -> Base:
        """Outline of its top in B."""
        return Polygon.convex(self.outline) if self.radius_m is None else Disc(self.radius_m)

    @property
    def without_lid(self) -> Truth:
        """The same without its lid, which is a body of its own."""
        if self.lid is None:
            return self
        left = self.mass_kg - self.lid.mass
        p_BL = lids.lid_centre(self.lid, self.rim, self.height)
        com = (self.mass_kg * np.array(self.centre_of_mass) - self.lid.mass * p_BL) / left
        return self.model_copy(
            update={"mass_kg": left, "centre_of_mass_m": tuple(com.tolist()), "lid": None}
        )

    @property
    def support(self) -> tuple[Point2, ...]:
        """Support points in B's x, y [m]."""
        if self.support_m is not None:
            return self.support_m
        if self.vertices_m is not None:
            return _thinned(_outline([point for point in self.vertices_m if point[2] <= _FLAT]))
        return self.outline if self.base_radius_m is None else _circle(self.base_radius_m)

    @property
    def upper_points(self) -> tuple[Point2, ...]:
        """Points of its top in B's x, y [m], on which it lies if it has fallen over."""
        if self.vertices_m is None:
            return self.outline
        return _thinned(_outline([p for p in self.vertices_m if p[2] >= self.height - _FLAT]))


def _is_surrounded(point: Point2, points: tuple[Point2, ...]) -> bool:
    """True if a point lies inside the hull of others: no half plane at it is free of them."""
    x, y = (np.array(points) - point).T
    angles = np.sort(np.arctan2(y, x))
    return bool(np.diff(angles, append=angles[0] + 2.0 * np.pi).max() < np.pi)


def _outline(points: Sequence[Point3]) -> tuple[Point2, ...]:
    """Corners of points as seen from above; one or two are their own."""
    seen = np.array(points)[:, :2]
    if len(seen) < 3:
        return tuple(map(tuple, seen.tolist()))
    return tuple(map(tuple, hull_polygon(seen).vertices.tolist()))


def _thinned(corners: tuple[Point2, ...]) -> tuple[Point2, ...]:
    """Corners of which there are no more than of a rim."""
    return corners[:: math.ceil(len(corners) / _RIM_POINTS)]


def _circle(radius: float) -> tuple[Point2, ...]:
    """Points of a rim on which a round object stands."""
    turns = (2.0 * math.pi * k / _RIM_POINTS for k in range(_RIM_POINTS))
    return tuple((radius * math.cos(phi), radius * math.sin(phi)) for phi in turns)


def truth_as_believed(model: ObjectModel, colour: Colour = GREY) -> Truth:
    """The truth of an object that is exactly as its model says, without contents and lid.

    Of a kind that a plug-in brings it has the hull of its base and, at its top, of its outline.
    """
    return Truth.model_validate(_shape(model) | _figures(model, colour))


def whole_truth(model: ObjectModel) -> Truth:
    """The same with its contents and its lid; a hull has neither."""
    shape = _shape(model)
    parts = {} if "vertices_m" in shape else {"container": model.container, "lid": model.lid}
    return Truth.model_validate(shape | _figures(model, GREY) | parts)


def _shape(model: ObjectModel) -> dict[str, object]:
    match model:
        case BoxModel():
            return {"size_m": model.size, "inside": model.inside}
        case CylinderModel():
            return {
                "radius_m": model.radius,
                "height_m": model.height,
                "base_radius_m": model.base_radius,
            }
        case PrismModel():
            return {"corners_m": model.corners, "height_m": model.height}
        case HullModel():
            return {"vertices_m": model.vertices}
        case _:
            ends = ((model.footprint.corners, 0.0), (model.outline, model.top))
            vertices = [(x, y, z) for corners, z in ends for x, y in corners.tolist()]
            return {"vertices_m": tuple(vertices)}


def _figures(model: ObjectModel, colour: Colour) -> dict[str, object]:
    feet = None if isinstance(model.support, str) else tuple(p[:2] for p in model.support)
    return {
        "support_m": feet,
        "mass_kg": model.mass,
        "friction_table": model.friction,
        "friction_finger": model.finger_friction,
        "centre_of_mass_m": tuple(model.com),
        "colour": colour,
    }
