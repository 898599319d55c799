"""The truth of an object of the simulated world: shape, mass, friction, contents.

Frame: B is the object's frame at the centre of its base.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike
from pydantic import (
    PlainSerializer,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from objectmodels import ObjectModel
from objectmodels.containers import lids
from objectmodels.files.yaml_documents import Deviation, Friction, Mass, length_of
from objectmodels.geometry.base_shapes import Polygon
from objectmodels.geometry.rotations import as_tuples
from objectmodels.models.object_parts import Container, Lid, Vessel
from objectmodels.models.shapes import SHAPES, AnyShape, ShapeKeys
from planner.types.world_state import Colour
from sim.robots.cell_description import AsItIs, Fraction, Part, Point2, Point3

GREY: Colour = (0.6, 0.6, 0.6)

_ALWAYS_WRITTEN = ("size_m", "radius_m", "base_radius_m", "corners_m", "height_m", "vertices_m")
"""Keys of shapes that every document has, in this order; null if they belong to another shape."""


def _shape_of(stated: Mapping[str, Any]) -> ShapeKeys:
    """The shape whose keys are stated.

    Raises:
        ValueError: the keys are not those of one shape.
    """
    found = [shape for shape in SHAPES if _first_key(shape) in stated]
    if len(found) != 1:
        *some, last = map(_first_key, SHAPES)
        raise ValueError(f"needs one shape: {', '.join(some)} or {last}")
    (shape,) = found
    known = shape.file_keys()
    for key in dict.fromkeys(key for each in SHAPES for key in each.file_keys()):
        if (key in stated and key not in known) or (key not in stated and known.get(key)):
            raise ValueError(_belonging(key))
    return shape.model_validate(dict(stated))


def _first_key(shape: type[ShapeKeys]) -> str:
    return next(iter(shape.file_keys()))


def _belonging(key: str) -> str:
    """The shapes to which a key belongs, in words."""
    owners = [shape for shape in SHAPES if key in shape.file_keys()]
    named = " or ".join(map(_first_key, owners))
    needed = all(shape.file_keys()[key] for shape in owners)
    return f"{key} belongs to a {named}{', and to nothing else' if needed else ''}"


def _keys_of(shape: ShapeKeys) -> dict[str, Any]:
    """Keys of a shape in a file."""
    return shape.model_dump(mode="json", by_alias=True)


class Truth(Part):
    """The truth of an object; only the simulated world and an observer of it may read this.

    In a file the keys of its shape stand among the others: those of a box (`size_m`, `inside`), an
    upright cylinder (`radius_m`, `height_m`, `base_radius_m`), a prism over a convex polygon
    (`corners_m`, `height_m`), a convex hull (`vertices_m`), or of another one of `SHAPES`.

    Attributes:
        shape: true shape.
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
        lid: what really covers it; `mass_kg` includes the lid.
        colour: red, green, blue in 0…1, for the camera and for pictures.
    """

    shape: Annotated[AnyShape, AsItIs(), PlainSerializer(_keys_of)]
    mass_kg: Mass
    friction_table: Friction
    friction_finger: Friction
    centre_of_mass_m: Point3 | None = None
    contents_shift_m: Deviation = 0.0
    support_m: Annotated[tuple[Point2, ...], length_of("support")] | None = None
    container: Container | None = None
    lid: Lid | None = None
    colour: tuple[Fraction, Fraction, Fraction] = (0.8, 0.7, 0.4)

    @model_validator(mode="before")
    @classmethod
    def _read_shape(cls, document: Any) -> Any:
        """Makes a shape of its keys in a file."""
        if not isinstance(document, dict) or "shape" in document:
            return document
        of_shapes = {key for shape in SHAPES for key in shape.file_keys()}
        stated = {key: document[key] for key in of_shapes if document.get(key) is not None}
        # Lists of JSON are no tuples by themselves once a document was looked into.
        others = {key: as_tuples(v) for key, v in document.items() if key not in of_shapes}
        # A key that is unknown is told first: it may be one of a shape, misspelt.
        if others.keys() <= cls.model_fields.keys():
            others["shape"] = _shape_of(stated)
        return others

    @model_serializer(mode="wrap")
    def _document(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The form that it has in a file."""
        document: dict[str, Any] = write(self)
        shape: dict[str, Any] = document.pop("shape")
        inside = {"inside": shape.pop("inside", None)}
        # A cavity stands between container and lid.
        after = {key: document.pop(key) for key in ("lid", "colour") if key in document}
        unstated: dict[str, Any] = dict.fromkeys(_ALWAYS_WRITTEN)
        return unstated | shape | document | inside | after

    @model_validator(mode="after")
    def _check_shape(self) -> Truth:
        shape, holds = self.shape, self.container is not None or self.lid is not None
        if holds and not shape.has_upright_walls:
            raise ValueError("a hull of vertices_m has neither container nor lid")
        if holds and shape.cavity is not None:
            raise ValueError("inside belongs to a size_m that has neither container nor lid")
        Polygon.convex(shape.silhouette)
        if shape.hull_corners[:, 2].min() != 0.0:
            raise ValueError("the lowest of vertices_m are at z = 0")
        if len(self.support) < 3 or not shape.crown:
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
        return Vessel.from_shape(self.shape.rim, self.shape.top, self.container)

    def _contains(self, p_B: Point3) -> bool:
        x, y, z = p_B
        outline = Polygon.convex(self.shape.silhouette)
        return bool((outline.normals @ [x, y] < outline.offsets).all() and 0 < z < self.shape.top)

    def scaled(self, *, mass: float, friction: float, finger_friction: float) -> Truth:
        """The same with so many times the mass, contents included, and the coefficients."""
        changed: dict[str, object] = {
            "mass_kg": self.mass_kg * mass,
            "friction_table": self.friction_table * friction,
            "friction_finger": self.friction_finger * finger_friction,
        }
        if self.container is not None:
            litres = self.container.contents_l * mass
            changed["container"] = self.container.model_copy(update={"contents_l": litres})
        return self.model_copy(update=changed)

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
    def centre_of_mass(self) -> Point3:
        """Centre of mass in B [m]."""
        return self.centre_of_mass_m or (0.0, 0.0, self.shape.top / 2)

    @property
    def without_lid(self) -> Truth:
        """The same without its lid, which is a body of its own."""
        if self.lid is None:
            return self
        left = self.mass_kg - self.lid.mass
        p_BL = lids.lid_centre(self.lid, self.shape.rim, self.shape.top)
        com = (self.mass_kg * np.array(self.centre_of_mass) - self.lid.mass * p_BL) / left
        return self.model_copy(
            update={"mass_kg": left, "centre_of_mass_m": tuple(com.tolist()), "lid": None}
        )

    @property
    def support(self) -> tuple[Point2, ...]:
        """Support points in B's x, y [m]."""
        return self.shape.feet if self.support_m is None else self.support_m


def _is_surrounded(point: Point2, points: tuple[Point2, ...]) -> bool:
    """True if a point lies inside the hull of others: no half plane at it is free of them."""
    x, y = (np.array(points) - point).T
    angles = np.sort(np.arctan2(y, x))
    return bool(np.diff(angles, append=angles[0] + 2.0 * np.pi).max() < np.pi)


def truth_as_believed(model: ObjectModel, colour: Colour = GREY) -> Truth:
    """The truth of an object that is exactly as its model says, without contents and lid.

    Of a kind that a plug-in brings, with a shape of its own, it has the hull of its base and, at
    its top, of its outline.
    """
    return Truth(shape=model.bare_shape(), **_figures(model, colour))


def whole_truth(model: ObjectModel) -> Truth:
    """The same with its contents and its lid; a hull has neither."""
    shape = model.bare_shape()
    held = {"container": model.container, "lid": model.lid} if shape.has_upright_walls else {}
    return Truth(shape=shape, **(_figures(model, GREY) | held))


def _figures(model: ObjectModel, colour: Colour) -> dict[str, Any]:
    feet = None if isinstance(model.support, str) else tuple(p[:2] for p in model.support)
    return {
        "support_m": feet,
        "mass_kg": model.mass,
        "friction_table": model.friction,
        "friction_finger": model.finger_friction,
        "centre_of_mass_m": tuple(model.com),
        "colour": colour,
    }
