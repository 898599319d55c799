"""Object that stands on a table and is pushed: the base of all kinds of model.

Model: a rigid object with a flat convex base on a horizontal table, Coulomb friction at the table
and at the finger; see `objectmodels.mechanics.push_thresholds` for the formulae. Frame B has its
origin at the centre of the base, z up. Forces are slow: classes are those at the onset of motion,
without inertia, unless a method says otherwise.

A kind of model is a subclass that says what shape it has, by a class of
`objectmodels.models.shapes` or by `footprint`, `top` and `faces` of its own (see docs/models.md).
Everything else follows from those and from the parameters.

It may lie on another face than the one its model stands on. Frame N belongs to the face below, as B
does to the base: origin at its centre on the table, z up. A pose of B picks the face.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import TYPE_CHECKING, Any, Literal, Self, TypeGuard, overload

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Base, carrying_base, friction_radius
from objectmodels.geometry.pushed_body import Friction, contact_room
from objectmodels.geometry.rotations import (
    UNIT,
    checked_pairs,
    checked_rotation,
    require_amount,
    require_normals,
    require_units,
)
from objectmodels.lazy import cached_property
from objectmodels.mechanics import push_thresholds
from objectmodels.mechanics.friction_cone import ConeThresholds, cone_thresholds
from objectmodels.mechanics.push_outcomes import (
    Prediction,
    Thresholds,
    closed_form_thresholds,
    size_and_direction,
)
from objectmodels.models.object_parts import Vessel, cavity_error
from objectmodels.models.parameters import RADIUS_SHARE_SD, Parameters
from objectmodels.models.shapes import Shape

if TYPE_CHECKING:
    from objectmodels.exact.exact_thresholds import ExactThresholds
    from objectmodels.geometry.pushed_body import PushedBody
    from objectmodels.mechanics.outcome_probability import Likelihood
    from objectmodels.mechanics.push_motion import Stroke
    from objectmodels.mechanics.push_outcomes import SuddenPush
    from objectmodels.models.predictor import SeenPushes


# Contact points that callers hand in: on the object, in metres.
#
# Checked where a caller comes in, never inside the mechanics.


def checked_contacts(
    model: ObjectModel, points: ArrayLike, vectors: ArrayLike
) -> tuple[Array, Array]:
    """Contact points on an object in B, and a vector for each; both finite, shape (n, 3).

    Raises:
        ModelError: `bad_array`; `off_object` if a point is far outside of the box around it.
    """
    p, v = checked_pairs(points, vectors)
    low, high = model.contact_room
    if p.size and ((p.min(axis=0) < low) | (p.max(axis=0) > high)).any():
        off = ((p < low) | (p > high)).any(axis=1)
        raise _off_object(model, p[off.argmax()], low, high)
    return p, v


def _off_object(model: ObjectModel, p: Array, low: Array, high: Array) -> ModelError:
    x, y, z = (f"{side:.4g}" for side in model.extents)
    hint = "points are in B: the origin is the centre of the base, z goes up, in metres"
    if (
        np.abs(p).max() > 10.0 * max(model.extents)
        and ((low <= 1e-3 * p) & (1e-3 * p <= high)).all()
    ):
        hint = "millimetres? points are in metres"
    return ModelError(
        "off_object",
        f"the point [{', '.join(f'{c:.4g}' for c in p)}] m is not on the {model.name}, which is "
        f"{x} × {y} × {z} m large",
        suggestions=(hint,),
    )


LEVEL = np.radians(10.0)
"""An object lies on a face that is tilted by at most so much."""


@dataclass(frozen=True)
class Resting:
    """A way in which an object lies.

    Attributes:
        face: name of the face that is below; `bottom` is the one that its model stands on.
        model: what is believed of it as it lies there, in N.
        R_BN: orientation of N in B, shape (3, 3).
        p_BN: origin of N in B, shape (3,) [m].
        standing: what is believed of it on its bottom, in B.
    """

    face: str
    model: ObjectModel
    R_BN: Array
    p_BN: Array
    standing: ObjectModel

    @property
    def down(self) -> Array:
        """Outward normal of the face below in B, shape (3,)."""
        return -self.R_BN[:, 2]

    @property
    def foot(self) -> Array:
        """Outward normal of the bottom in N, shape (3,)."""
        return np.asarray(-self.R_BN[2])

    def lying_pose(self, R_WB: Array, p_WB: Array) -> tuple[Array, Array]:
        """R_WN, shape (3, 3), and p_WN, shape (3,) [m], of the same object."""
        return R_WB @ self.R_BN, p_WB + R_WB @ self.p_BN

    def body_pose(self, R_WN: Array, p_WN: Array) -> tuple[Array, Array]:
        """R_WB, shape (3, 3), and p_WB, shape (3,) [m], of the same object."""
        R_WB = R_WN @ self.R_BN.T
        return R_WB, p_WN - R_WB @ self.p_BN


# A single push as plain numbers: calls of numpy to check and turn it take longer than they do.
#
# What is not plain, such as what is to be refused, is left to those who look at arrays.

_TINY = float(np.finfo(float).tiny)


def single_thresholds(
    model: PushedBody, points: ArrayLike, directions: ArrayLike, friction: Friction
) -> Thresholds | None:
    """Thresholds of one push by the closed form; None if arrays are to be looked at.

    Args:
        model: what is believed.
        points: contact p_BC, shape (1, 3) [m].
        directions: unit direction of the force in B, shape (1, 3).
        friction: which coefficient at the table decides.
    """
    if not (_is_on(points, model) and _is_single(directions)):
        return None
    is_unit = abs(_size(directions) - 1.0) <= UNIT
    return closed_form_thresholds(model, points, directions, friction) if is_unit else None


def single_prediction(
    model: PushedBody, points: ArrayLike, forces: ArrayLike, friction: Friction
) -> Prediction | None:
    """Outcome of one push with a force, shape (1, 3) [N]; None as for `single_thresholds`."""
    if not (_is_on(points, model) and _is_single(forces)):
        return None
    size = _size(forces)
    if not size < inf:
        return None
    u = forces / max(size, _TINY)
    return Prediction(np.array([size]), closed_form_thresholds(model, points, u, friction))


def _is_single(vectors: ArrayLike) -> TypeGuard[Array]:
    """Return True for an array of one vector."""
    return isinstance(vectors, np.ndarray) and vectors.shape == (1, 3) and vectors.dtype == float


def _is_on(points: ArrayLike, model: PushedBody) -> TypeGuard[Array]:
    """Return True for one contact on a model."""
    if not _is_single(points):
        return False
    ((x, y, z),) = points.tolist()
    low, high = (corner.tolist() for corner in model.contact_room)
    return bool(low[0] <= x <= high[0] and low[1] <= y <= high[1] and low[2] <= z <= high[2])


def _size(vectors: Array) -> float:
    ((x, y, z),) = vectors.tolist()
    return sqrt(x * x + y * y + z * z)


_OF_ITS_BASE = (
    "friction_radius",
    "friction_radius_sd",
    "correlations",
    "container",
    "inside",
    "lid",
)


class ObjectModel(Parameters, Shape):
    """Belief about an object of some shape, and its predictions for pushes.

    Attributes: see `objectmodels.models.parameters.Parameters`.
    """

    @cached_property
    def rests(self) -> tuple[Resting, ...]:
        """The ways in which it may lie on the table, the one it stands in first."""
        return (Resting("bottom", self, np.eye(3), np.zeros(3), self),)

    def model_on_face(self, face: str) -> ObjectModel:
        """The object lying on another of its faces: a model in the frame of that one.

        What was fitted for the base (points to stand on, friction radius) does not go along; the
        centre of mass, all coefficients and the squeeze that it bears do.

        Raises:
            ModelError: `unknown_face` if it cannot rest on a face of that name.
        """
        models = {rest.face: rest.model for rest in self.rests}
        if face in models:
            return models[face]
        wrong = f"the {self.name} cannot rest on {face!r}"
        hint = f"it rests on: {', '.join(models)}"
        raise ModelError("unknown_face", wrong, suggestions=(hint,))

    def resting_face(self, R_WB: ArrayLike) -> Resting:
        """Face on which it rests in an orientation: the pose picks the base.

        Args:
            R_WB: orientation of B in W, shape (3, 3).

        Raises:
            ModelError: `bad_array`; `not_resting` if no face of it is below.
        """
        down = -checked_rotation(R_WB)[2]  # W's downward direction in B
        nearest = max(self.rests, key=lambda rest: float(rest.down @ down))
        off = float(np.arccos(np.clip(nearest.down @ down, -1.0, 1.0)))
        if off > LEVEL:
            raise ModelError(
                "not_resting",
                f"the {self.name} does not lie on a face: it leans {np.degrees(off):.0f}° off "
                f"{nearest.face!r}",
                suggestions=(f"it rests on: {', '.join(rest.face for rest in self.rests)}",),
            )
        return nearest

    def _fields_on_face(self, top: float, **changes: object) -> dict[str, Any]:
        """Fields of a model that lies, so high [m], on another face: those not of its base."""
        kept = {name: getattr(self, name) for name in type(self).model_fields if name != "kind"}
        for name in _OF_ITS_BASE:
            del kept[name]
        if not isinstance(self.support, str):
            del kept["support"]
        if self.grasp is not None:
            kept["grasp"] = self.grasp.model_copy(update={"lowest": 0.0, "highest": top})
        return kept | changes

    @model_validator(mode="after")
    def _open_above(self) -> Self:
        if self.inside is None:
            return self
        if self.container is not None or self.lid is not None:
            raise cavity_error("", "goes with neither `container` nor `lid`", "leave those out")
        if self.cavity is None:
            raise cavity_error("", "only a box has one", "begin the file with `format: box/1`")
        return self

    @model_validator(mode="after")
    def _fill_derived(self) -> Self:
        """Fills in what depends on the shape, and checks what must fit it."""
        base = self.base
        known = self.__dict__
        if np.isnan(known["com"]).any():
            known["com"] = self.centre
        if np.isnan(known["friction_radius"]):
            known["friction_radius"] = friction_radius(self.support, self.footprint)
        if np.isnan(known["friction_radius_sd"]):
            known["friction_radius_sd"] = RADIUS_SHARE_SD * known["friction_radius"]
        c = np.array(self.com)
        needed = None
        if not base.contains(c[None, :2], -1e-9 * base.size):
            needed = "over the base: it topples by itself"
        elif not 0.0 < c[2] < self.top:
            needed = f"inside the object, {self.top} m high"
        if needed:
            found = f"found {list(self.com)}, expected a place {needed}"
            hint = "give [x, y, z] in metres, from the middle of the base on the table"
            raise ModelError("bad_value", found, path="com", suggestions=(hint,))
        if self.container is not None and self.container.mass >= self.mass:
            found = f"the contents weigh {self.container.mass:.3f} kg, all of it {self.mass} kg"
            hint = "give the mass of the object with what is in it"
            raise ModelError("bad_value", found, path="container", suggestions=(hint,))
        _ = self.vessel  # which refuses what does not fit
        return self

    @cached_property
    def base(self) -> Base:
        """Base that it would topple over: its footprint, or the hull of its support points."""
        return carrying_base(self.support, self.footprint)

    @cached_property
    def contact_room(self) -> tuple[Array, Array]:
        """Corners of the box in which contacts may lie, each (3,) [m]."""
        return contact_room(self)

    @cached_property
    def vessel(self) -> Vessel | None:
        """Its cavity, as a function of how it leans; None if it is not hollow."""
        inside = self.container
        return None if inside is None else Vessel.from_shape(self.section, self.top, inside)

    @property
    def seen_pushes(self) -> SeenPushes | None:
        """Pushes by which a kind with predictions of its own is judged."""
        return None

    @overload
    def thresholds(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        exact: Literal[True],
        friction: Friction = "static",
    ) -> ExactThresholds: ...

    @overload
    def thresholds(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        exact: bool | Literal["border"] = False,
        friction: Friction = "static",
    ) -> Thresholds: ...

    def thresholds(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        exact: bool | Literal["border"] = False,
        friction: Friction = "static",
    ) -> Thresholds:
        """Forces at which slow pushes start to slide or to topple the object.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            directions: unit directions of the force in B, shape (n, 3).
            exact: take the loads of the support points as they follow the push, instead of the
                ellipsoidal limit surface; slower. The answer is then an `ExactThresholds`.
                `border`: only where the closed form's two thresholds lie within `BORDER`.
            friction: which coefficient at the table decides.

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong; `off_object`.
        """
        if not exact and (single := single_thresholds(self, points, directions, friction)):
            return single
        p, u = checked_contacts(self, points, directions)
        require_units(u)
        return self._thresholds_by_tier(p, u, exact, friction)

    def _thresholds_by_tier(
        self, p: Array, u: Array, exact: bool | Literal["border"], friction: Friction
    ) -> Thresholds:
        if not exact:
            return closed_form_thresholds(self, p, u, friction)
        from objectmodels.exact import exact_thresholds as tier

        compute = tier.exact_near_the_border if exact == "border" else tier.exact_thresholds
        return compute(self, p, u, friction)

    def predict(
        self,
        points: ArrayLike,
        forces: ArrayLike,
        *,
        exact: bool = False,
        friction: Friction = "static",
    ) -> Prediction:
        """Outcomes of slow pushes with the given forces.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            forces: forces f_BC_B, shape (n, 3) [N].
            exact: as in `thresholds`.
            friction: as in `thresholds`.

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong; `off_object`.
        """
        if not exact and (single := single_prediction(self, points, forces, friction)):
            return single
        p, f = checked_contacts(self, points, forces)
        force, u = size_and_direction(f)
        return Prediction(force, self._thresholds_by_tier(p, u, exact, friction))

    def cone_thresholds(
        self, points: ArrayLike, normals: ArrayLike, *, sigmas: float = 0.0, yaw: bool = True
    ) -> ConeThresholds:
        """Extremes over all forces that a fingertip's friction cone can transmit.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            normals: outward unit normals of the faces in B, not vertical, shape (n, 3).
            sigmas: standard deviations that the worst case of the parameters takes.
            yaw: whether the object may turn as it slides; False if two fingers hold it straight,
                with `points` midway between them.

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong; `off_object`.
        """
        p, n = checked_contacts(self, points, normals)
        require_normals(n)
        require_amount(sigmas, "sigmas", "2 is a usual margin, 0 takes none")
        return cone_thresholds(self, p, n, sigmas, yaw)

    def likelihood(
        self,
        points: ArrayLike,
        directions: ArrayLike,
        *,
        force: float | None = None,
        exact: bool = True,
    ) -> Likelihood:
        """Probability of each outcome under the parameters' uncertainty.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            directions: unit directions of the force in B, shape (n, 3).
            force: size of the push [N]; if not given, the class at the onset is meant.
            exact: take the exact tier; the closed form, for searches, overstates toppling.

        Raises:
            ModelError: `bad_array`, `bad_value`, `off_object`.
        """
        p, u = checked_contacts(self, points, directions)
        if exact:
            from objectmodels.exact.exact_probability import exact_likelihood

            return exact_likelihood(self, p, u, force)
        from objectmodels.mechanics.outcome_probability import outcome_likelihood

        return outcome_likelihood(self, p, u, force)

    def is_slipping(
        self, normals: ArrayLike, forces: ArrayLike, *, friction: Friction = "static"
    ) -> Any:
        """Return True where a finger that presses so slips along the face, shape (n,).

        Args:
            normals: outward unit normals of the faces in B, shape (n, 3).
            forces: forces f_BC_B on the object, shape (n, 3) [N]; one that pulls slips.
            friction: which coefficient at the finger decides.

        Raises:
            ModelError: `bad_array`; `unknown_parameter`.
        """
        n, f = checked_pairs(normals, forces)
        mu = self.finger_friction if friction == "static" else self.finger_friction_kinetic
        if mu is None:
            raise ModelError(
                "unknown_parameter",
                "the finger's kinetic friction is not known",
                suggestions=("give the model one, or ask with `friction='static'`",),
            )
        pressing = -np.sum(n * f, axis=1)
        return np.linalg.norm(f + pressing[:, None] * n, axis=1) > mu * pressing

    def sudden(self, points: ArrayLike, forces: ArrayLike) -> SuddenPush:
        """Motion at the instant at which forces are applied suddenly, inertia included.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            forces: forces f_BC_B, shape (n, 3) [N].

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong; `off_object`.
        """
        from objectmodels.mechanics.push_outcomes import sudden_push

        return sudden_push(self, *checked_contacts(self, points, forces))

    def stroke(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        direction: ArrayLike,
        travel: ArrayLike,
        *,
        exact: bool = False,
        tip_radius: float = 0.0,
    ) -> Stroke:
        """Motion by slow strokes of one finger each, or of two; see `push_motion`.

        Args:
            points: contacts p_BC at the start, (n, 3) [m]; (n, 2, 3) for two that keep apart.
            normals: outward unit normals of the touched faces in B, shape (n, 3).
            direction: horizontal unit direction of travel in B at the start, (3,) or (n, 3).
            travel: how far, of all or of each, shape () or (n,) [m].
            exact: take the loaded support points instead of the ellipsoidal limit surface.
            tip_radius: of the round fingertips [m].

        Raises:
            ModelError: `bad_array`, `bad_value`, `off_object`.
        """
        from objectmodels.exact.top_drag import LoadedPoints
        from objectmodels.mechanics.friction_limit import Ellipsoid
        from objectmodels.mechanics.push_motion import LawOf, integrate_stroke

        law: LawOf = LoadedPoints.of_model if exact else Ellipsoid.of_model
        return integrate_stroke(self, points, normals, direction, travel, tip_radius, law)

    def angle_of_no_return(self, direction: ArrayLike, *, sigmas: float = 0.0) -> float:
        """Tilt past which it falls by itself; see `push_thresholds.angle_of_no_return` [rad]."""
        return push_thresholds.angle_of_no_return(self, direction, sigmas)

    def topple_stroke(self, direction: ArrayLike, height: float, angle: float) -> float:
        """Travel of a finger that tilts it by an angle; see `push_thresholds.topple_stroke` [m]."""
        return push_thresholds.topple_stroke(self, direction, height, angle)

    def stroke_tilt(
        self, direction: ArrayLike, height: float, travel: float
    ) -> tuple[float, float]:
        """Tilts to which a finger's travel may bring it; see `push_thresholds` [rad]."""
        return push_thresholds.stroke_tilt(self, direction, height, travel)
