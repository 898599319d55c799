"""Beliefs of the robot about the scene while it plans.

Frames: W is the world, z up, the table plane is z = 0; B is an object's frame with its origin
at the centre of the base the object stands on. Nothing in here may come from the simulated
world's truth: poses come through the camera port, geometry and physics from the registry.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from objectmodels.containers.lids import lid_rise
from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import hull_polygon
from objectmodels.geometry.rotations import circle_around
from objectmodels.models.object_model import ObjectModel, Resting
from planner.types.actions import Grasp, Value, Vector3

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class PlanarPose:
    """Pose X_WB of an object on the table, or on another object.

    Attributes:
        x, y: position of B's origin in W [m].
        yaw: angle of B's x axis, counter-clockwise from W's x axis [rad].
        attitude: rotation of B against an upright frame of that yaw, row by row; None if the object
            stands upright.
        z: height over the table of what it stands on [m].
    """

    x: float
    y: float
    yaw: float = 0.0
    attitude: tuple[float, ...] | None = None
    z: float = 0.0

    @property
    def R_WB(self) -> NDArray[np.float64]:
        """Rotation of B in W, shape (3, 3)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        upright = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        if self.attitude is None:
            return upright
        return np.asarray(upright @ np.reshape(self.attitude, (3, 3)))

    @property
    def p_WB(self) -> NDArray[np.float64]:
        """Position of B's origin in W, shape (3,) [m]."""
        return np.array([self.x, self.y, self.z])


@dataclass(frozen=True)
class SeenObject:
    """An object on the table as the robot knows it: who it is, where it is seen, how it behaves.

    Attributes:
        name: the object's name in the scene; unique.
        pose: where the camera port sees it.
        model: the registry's model of it (the belief, never the truth), as it lies.
        rest: how it lies on another face than its model stands on; None if it does not. Pose and
            model are then those of the frame of that face.
        colour: what the camera sees, red, green, blue in 0…1; None if it was not looked at.
        fragile: whether hand and other objects are to keep well away from it.
        attitude: rotation of B in W, row by row, of one that lies on nothing flat.
        fixed: whether a holder on the table keeps it where it stands.
        lid: how far its lid is seen to be open, as in `sim.traces.trace.Trace.lids`; None without
            one.
        lid_at: where the middle of a lid that is off lies in W, its lower side [m]; None if it is
            on, or does not lie level.
        on: name of the object on which, or in which, it stands; None on the table.
    """

    name: str
    pose: PlanarPose
    model: ObjectModel
    rest: Resting | None = None
    colour: Colour | None = None
    fragile: bool = False
    attitude: tuple[float, ...] | None = None
    fixed: bool = False
    lid: float | None = None
    lid_at: tuple[float, float, float] | None = None
    on: str | None = None

    @property
    def lies_on(self) -> str:
        """Name of the face that is below; `bottom` if it stands as its model does."""
        if self.attitude is not None:
            return "nothing flat"
        return "bottom" if self.rest is None else self.rest.face

    @property
    def side_below(self) -> str:
        """The face that is below, in words."""
        face = self.lies_on
        return face if face.startswith(("face", "nothing")) else f"its {face} side"

    @property
    def standing_model(self) -> ObjectModel:
        """The model of it on its bottom."""
        return self.model if self.rest is None else self.rest.standing

    @property
    def body_pose(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """R_WB, shape (3, 3), and p_WB, shape (3,) [m], of the frame in which its model stands."""
        R_WN, p_WN = self.pose.R_WB, self.pose.p_WB
        return (R_WN, p_WN) if self.rest is None else self.rest.body_pose(R_WN, p_WN)

    @property
    def is_covered(self) -> bool:
        """Return True if a lid keeps its contents in, as far as is seen; one unseen is closed."""
        lid = self.model.lid
        return lid is not None and not lid.leaves_free(self.lid or 0.0)

    @classmethod
    def lying(
        cls,
        name: str,
        pose: PlanarPose,
        model: ObjectModel,
        colour: Colour | None = None,
        *,
        fragile: bool = False,
        fixed: bool = False,
        lid: float | None = None,
    ) -> SeenObject:
        """An object as it is seen: its pose picks the base that it lies on.

        One that leans on something keeps the model that stands upright.
        """
        if pose.attitude is None:
            return cls(name, pose, model, colour=colour, fragile=fragile, fixed=fixed, lid=lid)
        try:
            rest = model.resting_face(pose.R_WB)
        except ModelError:
            here = PlanarPose(pose.x, pose.y, pose.yaw)
            attitude = tuple(pose.R_WB.ravel().tolist())
            return cls(name, here, model, None, colour, fragile, attitude, fixed, lid)
        R_WN, p_WN = rest.lying_pose(pose.R_WB, pose.p_WB)
        yaw = float(np.arctan2(R_WN[1, 0], R_WN[0, 0]))
        here = PlanarPose(float(p_WN[0]), float(p_WN[1]), yaw)
        return cls(name, here, rest.model, rest, colour, fragile, None, fixed, lid)

    def bulk(self) -> tuple[NDArray[np.float64], float]:
        """An upright prism around it as it lies: corners in W, shape (k, 2), and height [m].

        A lid counts as far as it rises above it, not as far as it stands out.
        """
        return self._bulk

    def is_within(self, radius: float, x: float, y: float) -> bool:
        """Return True if it may be within a distance [m] of a place on the table in W."""
        (at_x, at_y), around = self._circle
        return math.hypot(at_x - x, at_y - y) < around + radius

    @functools.cached_property
    def _circle(self) -> tuple[tuple[float, float], float]:
        """Middle in W, and radius, of a circle around it as seen from above [m]."""
        middle, radius = circle_around(self._bulk[0])
        x, y = middle.tolist()
        return (x, y), radius

    @property
    def top_height(self) -> float:
        """Height of its highest point over the table [m]."""
        return self.pose.z + self._bulk[1]

    @functools.cached_property
    def _bulk(self) -> tuple[NDArray[np.float64], float]:
        outline, top = self.model.outline, self.model.top
        if self.lid is not None and self.lid_at is None:
            top += lid_rise(self.model, self.lid)
        if self.attitude is None:
            return outline @ self.pose.R_WB[:2, :2].T + self.pose.p_WB[:2], top
        corners = np.array([[x, y, z] for z in (0.0, top) for x, y in outline])
        turned = corners @ np.reshape(self.attitude, (3, 3)).T
        return hull_polygon(turned[:, :2] + self.pose.p_WB[:2]).vertices, float(
            np.ptp(turned[:, 2])
        )


@dataclass(frozen=True)
class TableState:
    """Extent of the table top in W [m]; its plane is z = 0."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    @property
    def middle(self) -> NDArray[np.float64]:
        """Its middle, shape (2,) [m]."""
        return np.array([self.x_min + self.x_max, self.y_min + self.y_max]) / 2.0

    def corners_within(self, margin: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest corner of what lies a margin within its edge, shape (2,) each [m]."""
        low = np.array([self.x_min, self.y_min]) + margin
        return low, np.array([self.x_max, self.y_max]) - margin


@dataclass(frozen=True)
class Held:
    """The object in the hand.

    Attributes:
        name: of the object in the scene.
        grasp: how it is held.
        height: of its base above the table [m].
        arm: angles of the arm, as it was left [rad]; empty if they are not known.
    """

    name: str
    grasp: Grasp
    height: float
    arm: tuple[float, ...] = ()


@dataclass(frozen=True)
class WorldState:
    """Everything that a plan may depend on.

    Attributes:
        objects: by name in the scene.
        table: where things may stand.
        held: what the hand holds; None if nothing.
    """

    objects: Mapping[str, SeenObject] = field(default_factory=dict)
    table: TableState = TableState(-0.2, 1.2, -0.8, 0.8)
    held: Held | None = None

    def stands_inside(self, seen: SeenObject) -> bool:
        """Return True if an object stands in an open box."""
        return seen.on is not None and self.objects[seen.on].model.inside is not None

    def carried_by(self, name: str) -> tuple[SeenObject, ...]:
        """Objects that stand on one, or in it."""
        return tuple(seen for seen in self.objects.values() if seen.on == name)


# Marks of a refusal: where its numbers are on the table, so that they can be drawn there.
#
# Points and directions are in W. Each mark has a text of a few words to stand beside it.


class HeightMark(Value):
    """A height above the table at which something changes on an object.

    Attributes:
        object: name of it.
        height: above the table [m].
        about: what changes there: from where it `topples`, up to where it `slides`, what is `asked`
            of the contact, or within the fingers' `reach`.
        text: the same in words.
    """

    kind: Literal["height"] = "height"
    object: str
    height: float
    about: Literal["topples", "slides", "asked", "reach"]
    text: str


class LengthMark(Value):
    """A length that is there, and the one that is asked from the same point on.

    Attributes:
        start_W, end_W: of the length that is there [m].
        asked: length along the same direction [m]; None if it is not about one.
        text: both, or what the length is.
    """

    kind: Literal["length"] = "length"
    start_W: Vector3
    end_W: Vector3
    asked: float | None = None
    text: str


class TiltMark(Value):
    """An object tipped about an edge of its base.

    Attributes:
        object: name of it.
        edge_W: a point of the edge [m].
        axis_W: unit direction of the edge, about which it turns counter-clockwise.
        angle: by which it is tipped [rad].
        text: what happens there.
    """

    kind: Literal["tilt"] = "tilt"
    object: str
    edge_W: Vector3
    axis_W: Vector3
    angle: float
    text: str


class ObstacleMark(Value):
    """An object that stands in the way.

    Attributes:
        object: name of it.
        text: of what it is in the way.
    """

    kind: Literal["obstacle"] = "obstacle"
    object: str
    text: str


def obstacle_mark(name: str) -> ObstacleMark:
    """The mark of an object that stands in the way."""
    return ObstacleMark(object=name, text=f"the {name} stands in the way")


Mark = Annotated[
    HeightMark | LengthMark | TiltMark | ObstacleMark,
    Field(discriminator="kind"),
]


def plain_vector(v: ArrayLike) -> Vector3:
    """Three numbers of an array, shape (3,), none of them −0.0 in what people read."""
    x, y, z = (np.asarray(v, dtype=np.float64) + 0.0).tolist()
    return x, y, z
