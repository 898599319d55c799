"""A box on a table: its parameters, how well they are known, and what pushes do to it.

Model: a rigid cuboid that stands with its whole base on a horizontal table, Coulomb friction at the
table and at the finger; see `objectmodels.thresholds` for the formulae. Parameters carry standard
deviations, taken as independent. Frame B has its origin at the centre of the base, z up, x and y
along the sides. Forces are slow: classes are those at the onset of motion, without inertia.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    NonNegativeFloat,
    PositiveFloat,
    model_validator,
)

from objectmodels import tilting
from objectmodels.cone import ConeThresholds, cone_thresholds
from objectmodels.errors import ModelError
from objectmodels.prediction import Face, Prediction, Thresholds, outcome_at_onset
from objectmodels.support import Support, friction_radius
from objectmodels.thresholds import (
    EDGE_NORMALS,
    GRAVITY,
    Array,
    edge_offsets,
    slide_threshold,
    sliding_twist,
    topple_thresholds,
    toppling_twist,
    yaw_arm,
)

RADIUS_SHARE_SD = 0.45
"""Standard deviation of an unfitted friction radius as a share of it: real objects spread so."""


def _as_tuple(value: Any) -> Any:
    """Lists and arrays of numbers are as good as tuples."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(value) if isinstance(value, list) else value


Vector3 = Annotated[tuple[float, float, float], BeforeValidator(_as_tuple)]
Size = Annotated[tuple[PositiveFloat, PositiveFloat, PositiveFloat], BeforeValidator(_as_tuple)]
Deviation3 = Annotated[
    tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat], BeforeValidator(_as_tuple)
]
Word = Annotated[str, Field(min_length=1, max_length=100, pattern=r"^\S(.*\S)?$")]
Words = Annotated[tuple[Word, ...], BeforeValidator(_as_tuple)]


class Provenance(BaseModel):
    """Where a model's figures come from.

    Attributes:
        source: publication, person or program.
        method: how the figures were found, and what was estimated.
        trials: number of measurements behind each figure, if measured.
        date: ISO date of the measurement or entry.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    source: str = "not stated"
    method: str = "not stated"
    trials: Annotated[int, Field(ge=1)] | None = None
    date: Annotated[str, Field(pattern=r"^\d{4}(-\d{2}(-\d{2})?)?$")] | None = None


class BoxModel(BaseModel):
    """What is believed about a box; the *_sd are standard deviations of that belief.

    Attributes:
        name: what the box is called.
        size: extents along x, y, z of B [m].
        mass: m [kg].
        friction: static friction coefficient μ between box and table.
        finger_friction: static friction coefficient between box and fingertip.
        com: centre of mass in B [m]; the middle of the box if not given.
        support: how the base carries the box: `corners` or `uniform` pressure.
        friction_radius: c̄ = m_max / f_max [m]; from `support` if not given.
        friction_radius_sd: 45 % of c̄ if not given, which is the spread over real objects.
        friction_kinetic: coefficient at the table while sliding, if known.
        finger_friction_kinetic: coefficient at the fingertip while slipping, if known.
        synonyms: other names.
        provenance: where the figures come from.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    name: Word
    size: Size
    mass: PositiveFloat
    friction: PositiveFloat
    finger_friction: PositiveFloat = 0.6
    com: Vector3 = Field(default_factory=lambda data: (0.0, 0.0, data["size"][2] / 2.0))
    support: Support = "uniform"
    friction_radius: PositiveFloat = Field(
        default_factory=lambda data: friction_radius(data["support"], *data["size"][:2])
    )
    mass_sd: NonNegativeFloat = 0.0
    friction_sd: NonNegativeFloat = 0.0
    finger_friction_sd: NonNegativeFloat = 0.0
    com_sd: Deviation3 = (0.0, 0.0, 0.0)
    friction_radius_sd: NonNegativeFloat = Field(
        default_factory=lambda data: RADIUS_SHARE_SD * data["friction_radius"]
    )
    friction_kinetic: PositiveFloat | None = None
    finger_friction_kinetic: PositiveFloat | None = None
    synonyms: Words = ()
    provenance: Provenance = Provenance()
    kind: Literal["box"] = "box"

    @model_validator(mode="after")
    def _centre_of_mass_inside(self) -> BoxModel:
        x, y, z = self.size
        c = self.com
        if not (abs(c[0]) < x / 2 and abs(c[1]) < y / 2 and 0.0 < c[2] < z):
            raise ValueError(f"com {c} lies outside the box of size {self.size}")
        return self

    @property
    def weight(self) -> float:
        """G = m g [N]."""
        return self.mass * GRAVITY

    def thresholds(self, points: ArrayLike, directions: ArrayLike) -> Thresholds:
        """Forces at which slow pushes start to slide or to topple the box.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            directions: unit directions of the force in B, shape (n, 3).

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong.
        """
        p, u = pairs(points, directions)
        if np.any(np.abs(np.linalg.norm(u, axis=1) - 1.0) > 1e-6):
            raise ModelError("bad_array", "directions must be unit vectors")
        return self._thresholds(p, u)

    def _thresholds(self, p: Array, u: Array) -> Thresholds:
        """`thresholds` for checked arrays; a zero direction never moves anything."""
        c, d, weight = np.array(self.com), edge_offsets(self.size), self.weight
        by_edge = topple_thresholds(p, u, c, d, weight)
        topple = by_edge.min(axis=1)
        edge = np.where(np.isfinite(topple), by_edge.argmin(axis=1), -1)
        slide = slide_threshold(u, yaw_arm(p, u, c), self.friction, self.friction_radius, weight)
        outcome = outcome_at_onset(slide, topple)
        twist = np.full((len(p), 6), np.nan)
        i = outcome == "slide"
        twist[i] = sliding_twist(p[i], u[i], c, slide[i], self.friction_radius, weight)
        i = outcome == "topple"
        twist[i] = toppling_twist(p[i], u[i], edge[i], d)
        return Thresholds(slide, topple, np.minimum(slide, topple), outcome, edge, twist)

    def predict(self, points: ArrayLike, forces: ArrayLike) -> Prediction:
        """Outcomes of slow pushes with the given forces.

        Args:
            points: contact points p_BC, shape (n, 3) [m].
            forces: forces f_BC_B, shape (n, 3) [N].

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong.
        """
        p, f = pairs(points, forces)
        force = np.linalg.norm(f, axis=1)
        with np.errstate(invalid="ignore"):
            t = self._thresholds(p, np.where(force[:, None] > 0.0, f / force[:, None], 0.0))
            apart = np.where(np.isinf(t.onset), np.inf, np.abs(t.slide - t.topple))
        moves = force >= t.onset
        margin = np.abs(force - t.onset)
        return Prediction(
            outcome=np.where(moves, t.outcome, "none"),
            margin=np.where(moves, np.minimum(margin, apart), margin),
            thresholds=t,
        )

    def cone_thresholds(
        self, points: ArrayLike, normals: ArrayLike, *, sigmas: float = 0.0, yaw: bool = True
    ) -> ConeThresholds:
        """Extremes over all forces that a fingertip's friction cone can transmit.

        Args:
            points: contact points p_BC on side faces, shape (n, 3) [m].
            normals: outward unit normals of the faces in B, horizontal, shape (n, 3).
            sigmas: standard deviations that the worst case of the parameters takes.
            yaw: whether the box may turn as it slides; False if two fingers hold it straight, with
                `points` midway between them.

        Raises:
            ModelError: `bad_array` if a shape or a value is wrong.
        """
        p, n = pairs(points, normals)
        if np.any(np.abs(n[:, 2]) > 1e-9) or np.any(np.abs(np.hypot(*n.T[:2]) - 1.0) > 1e-6):
            raise ModelError("bad_array", "normals must be horizontal unit vectors")
        if not 0.0 <= sigmas < np.inf:
            raise ModelError("bad_value", f"sigmas must be a number from 0 on, not {sigmas}")
        return cone_thresholds(self, p, n, sigmas, yaw)

    def faces(self) -> tuple[Face, ...]:
        """The four side faces in B, in the order of `EDGE_NORMALS`: +x, +y, −x, −y."""
        z = self.size[2]
        widths = (self.size[1], self.size[0]) * 2
        return tuple(
            Face((nx, ny, 0.0), (d * nx, d * ny, z / 2.0), (-ny, nx, 0.0), width, z)
            for (nx, ny), d, width in zip(
                EDGE_NORMALS.tolist(), edge_offsets(self.size).tolist(), widths, strict=True
            )
        )

    def angle_of_no_return(self, direction: ArrayLike, *, sigmas: float = 0.0) -> float:
        """Tilt past which the box falls by itself, when tipped along a horizontal direction [rad].

        Args:
            direction: horizontal direction in B, shape (3,); the box tips over the base edge that
                looks most along it.
            sigmas: take the centre of mass at so many standard deviations towards an earlier
                fall (negative: towards a later one).
        """
        return tilting.angle_of_no_return(self, direction, sigmas)

    def topple_stroke(self, direction: ArrayLike, height: float, angle: float) -> float:
        """Travel of a finger that tilts the box to an angle, the larger of two cases [m].

        Args:
            direction: horizontal direction of the push in B, shape (3,).
            height: contact height on the face pushed [m].
            angle: tilt to be reached [rad].
        """
        return tilting.topple_stroke(self, direction, height, angle)


def pairs(points: ArrayLike, vectors: ArrayLike) -> tuple[Array, Array]:
    """Two finite arrays of equal shape (n, 3), or a `ModelError`."""
    p, v = np.asarray(points, dtype=np.float64), np.asarray(vectors, dtype=np.float64)
    if p.ndim != 2 or p.shape[1] != 3 or p.shape != v.shape:
        raise ModelError(
            "bad_array",
            f"expected two arrays of one shape (n, 3), found {p.shape} and {v.shape}",
            suggestions=("a single push is an array of shape (1, 3)",),
        )
    if not (np.isfinite(p).all() and np.isfinite(v).all()):
        raise ModelError("bad_array", "arrays must hold finite numbers only")
    return p, v
