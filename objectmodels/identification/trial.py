"""Trial: one touch of an object, with its contact, its force and what moved.

Frame: B is the object's, origin at the centre of its base, z up. Forces are given in the axes that
B has while the object stands upright with its heading of that moment: a tilt does not turn them.

Wrong units are wrong by a factor of 1000 as a rule, and a belief is hardly ever; so what lies
beside the object, or is off by a factor of `FAR` from what is believed, is refused, with a guess at
the unit. A force that pulls the object towards the finger is that on the finger, not on the object.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.models.object_model import ObjectModel

Moved = Literal["slide", "topple", "slip", "none"]
"""What gave way: the object slid, it tilted about an edge of its base, the finger slipped on it; or
nothing did, so that the force is less than what moves the object."""

Vector = tuple[float, float, float]

SLACK = 0.010
"""A contact may lie so far beside the object [m]: fingertips are round and tables uneven."""

FAR = 50.0
"""A force is off by more than this from what is believed only if its unit is wrong."""


@dataclass(frozen=True)
class Trial:
    """A balance of forces at which something moved.

    Attributes:
        moved: what gave way.
        point: contact point p_BC, a point of the object [m].
        force: whole force f_BC on the object then, in the level axes of B [N]. Of a slide the mean
            on the way, with the axes and the contact half-way; of a tilt, what holds it at `tilt`.
        force_sd: standard deviation of the force along its direction [N].
        tilt: angle about the edge at which the force was felt [rad]; 0 at the onset.
        tilt_sd: its standard deviation [rad].
        turn_rate: of a slide, by how much the object turned for each metre that the contact went
            along the force, counter-clockwise [rad/m]; None if that was not measured.
        turn_rate_sd: its standard deviation [rad/m].
        drift: of a slide, how far the contact went to the left of the force for each metre along
            it; None if that was not measured.
        normal: of a slip, the outward unit normal of the touched face in B.
        repetition: number of the repetition of the experiments that it belongs to.
        source: what to call it in messages, such as `row 3` or `tilt at the front, 8°`.
    """

    moved: Moved
    point: Vector
    force: Vector
    force_sd: float
    tilt: float = 0.0
    tilt_sd: float = 0.0
    turn_rate: float | None = None
    turn_rate_sd: float | None = None
    drift: float | None = None
    normal: Vector | None = None
    repetition: int = 0
    source: str = "a trial"


@dataclass(frozen=True)
class ContactPath:
    """Way of a contact, a point of the object, while the object slid from one pose to another.

    Attributes:
        travel: along the force [m].
        turn: of the object, counter-clockwise [rad].
        drift: to the left of the force for each metre along it.
    """

    travel: float
    turn: float
    drift: float

    @classmethod
    def between_poses(cls, point: Vector, force: Vector, pose: Vector) -> ContactPath:
        """Way between the pose at the start and that at the end.

        Args:
            point: the contact in B [m].
            force: on the object, in the axes of B half-way [N].
            pose: x, y [m], θ [rad] of B at the end, in B at the start.
        """
        turn = pose[2]
        c, s = np.cos(turn / 2.0), np.sin(turn / 2.0)
        x, y = c * pose[0] + s * pose[1], c * pose[1] - s * pose[0]
        x, y = x - 2.0 * s * point[1], y + 2.0 * s * point[0]
        u_x, u_y = np.array(force[:2]) / np.hypot(*force[:2])
        travel = float(u_x * x + u_y * y)
        aside = float(u_x * y - u_y * x)
        return cls(travel, turn, aside / travel if travel else np.inf)


@dataclass(frozen=True)
class Statistics:
    """A line of the paper's Table I.

    Attributes:
        mean: over the repetitions.
        sd: standard deviation of one repetition; None of a single one.
        percent: the same in per cent of the mean.
        least: smallest value.
        most: largest value.
        n: number of repetitions with a value.
    """

    mean: float
    sd: float | None
    percent: float | None
    least: float
    most: float
    n: int


@dataclass(frozen=True)
class Touches:
    """Trials as arrays.

    Attributes:
        kind: what gave way, shape (n,).
        p: contact points in B, shape (n, 3) [m].
        u: directions of the forces in B, shape (n, 3).
        size: sizes of the forces, shape (n,) [N].
        size_sd: their standard deviations [N].
        tilt: tilts, shape (n,) [rad].
        tilt_sd: their standard deviations [rad].
        turn: turn rates of slides, nan if not measured, shape (n,) [rad/m].
        turn_sd: their standard deviations [rad/m].
        ratio: tangential over normal force of slips, nan of others, shape (n,).
        ratio_sd: their standard deviations.
        sources: what the trials are called.
    """

    kind: NDArray[np.str_]
    p: Array
    u: Array
    size: Array
    size_sd: Array
    tilt: Array
    tilt_sd: Array
    turn: Array
    turn_sd: Array
    ratio: Array
    ratio_sd: Array
    sources: tuple[str, ...]

    @classmethod
    def from_trials(cls, trials: Sequence[Trial]) -> Touches:
        """Arrays of some trials.

        Raises:
            ModelError: `no_trials`; `bad_trial` if one makes no sense.
        """
        if not trials:
            raise ModelError(
                "no_trials",
                "there is no trial to learn from",
                suggestions=("give one or more touches: docs/fitting.md says which teach what",),
            )
        for trial in trials:
            _require_sense(trial)
        force = np.array([trial.force for trial in trials])
        size = np.linalg.norm(force, axis=1)
        ratios = np.array([_slip_ratio(trial) for trial in trials])
        rates = [(trial.turn_rate, trial.turn_rate_sd) for trial in trials]
        return cls(
            kind=np.array([trial.moved for trial in trials]),
            p=np.array([trial.point for trial in trials]),
            u=force / size[:, None],
            size=size,
            size_sd=np.array([trial.force_sd for trial in trials]),
            tilt=np.array([trial.tilt for trial in trials]),
            tilt_sd=np.array([trial.tilt_sd for trial in trials]),
            turn=np.array([np.nan if rate is None else rate for rate, _ in rates]),
            # A turn rate that comes without a standard deviation has this one [rad/m].
            turn_sd=np.array([0.5 if sd is None else sd for _, sd in rates]),
            ratio=ratios[:, 0],
            ratio_sd=ratios[:, 1],
            sources=tuple(trial.source for trial in trials),
        )


def _require_sense(trial: Trial) -> None:
    figures = (
        *trial.point,
        *trial.force,
        trial.force_sd,
        trial.tilt,
        trial.tilt_sd,
        trial.turn_rate or 0.0,
        trial.turn_rate_sd or 0.0,
        trial.drift or 0.0,
    )
    wrong = None
    if not np.isfinite(figures).all():
        wrong = "has a figure that is no number"
    elif not any(trial.force):
        wrong = "has no force"
    elif trial.force_sd <= 0.0 or trial.tilt_sd < 0.0 or trial.turn_rate_sd == 0.0:
        wrong = "needs positive standard deviations"
    elif trial.moved == "slip" and (trial.normal is None or _slip_ratio(trial)[0] <= 0.0):
        wrong = "is a slip, which needs the face's normal and a force that presses on it aslant"
    elif trial.moved != "slip" and not any(trial.force[:2]):
        wrong = "has a vertical force, which neither slides nor tilts anything"
    if wrong:
        hint = "leave it out, or correct it: docs/fitting.md says what a touch consists of"
        raise ModelError("bad_trial", f"{trial.source} {wrong}", suggestions=(hint,))


def _slip_ratio(trial: Trial) -> tuple[float, float]:
    """Tangential over normal force of a slip, and its standard deviation."""
    if trial.moved != "slip" or trial.normal is None:
        return np.nan, np.nan
    force, normal = np.array(trial.force), np.array(trial.normal)
    pressing = float(-force @ normal)
    if pressing <= 0.0:
        return 0.0, np.nan
    ratio = float(np.linalg.norm(force + pressing * normal)) / pressing
    return ratio, trial.force_sd / pressing * float(np.hypot(1.0, ratio))


@dataclass(frozen=True)
class Objection:
    """Reason why a measurement cannot be right.

    Attributes:
        quantity: the one that is wrong: `x`, `y` or `z` of the contact, `force` or `force_sd`.
        message: in words, with the number found.
        hints: at what may have been meant.
    """

    quantity: str
    message: str
    hints: tuple[str, ...] = ()


def contact_objection(model: ObjectModel, point: Vector) -> Objection | None:
    """Objection to a contact in B [m] farther than `SLACK` beside the object; None if it fits."""
    x, y, z = point
    low, high = model.outline.min(axis=0), model.outline.max(axis=0)
    if z > model.top + SLACK:
        what = f"{z:g} lies above the object, {model.top:g} m high"
        return Objection("z", what, _length_hint(z, model.top))
    if z < -SLACK:
        return Objection("z", f"{z:g} lies below the table", ("z is 0 at the base, and up",))
    for quantity, value, least, most in zip("xy", (x, y), low, high, strict=True):
        if not least - SLACK <= value <= most + SLACK:
            what = f"{value:g} lies beside the object, which reaches from {least:g} to {most:g} m"
            return Objection(quantity, what, _length_hint(abs(value), max(-least, most)))
    if _distances_beyond(model, point).max() > SLACK:
        return Objection("x", f"({x:g}, {y:g}) lies beside the object")
    # Contacts nearer to the origin than this share of the object are none.
    if np.linalg.norm(point) < 0.01 * max(model.extents):
        what = "the contact lies in the middle of the base, inside the object"
        return Objection("x", what, ("the coordinates are in metres, from the base's middle",))
    return None


def force_objection(model: ObjectModel, trial: Trial) -> Objection | None:
    """Objection to a force that pulls, or is far from what is believed; None if it is plausible."""
    f = np.array(trial.force)
    size = float(np.linalg.norm(f))
    if size == 0.0:
        return Objection("force", "a force of 0 N moves nothing")
    u = f / size
    if trial.moved != "slip" and not u[:2].any():
        return Objection("force", "a vertical force neither slides nor tilts anything")
    if trial.force_sd > size:
        what = f"{trial.force_sd:g} is larger than the force itself, {size:.3g} N"
        return Objection("force_sd", what, ("is it in millinewtons?",))
    beyond = _distances_beyond(model, trial.point)
    normals = Polygon.convex(model.outline).normals[beyond > -SLACK]
    # Least part of a unit force along the outward normal that surely pulls.
    if len(normals) and (normals @ u[:2]).min() > 0.05:
        what = "the force pulls the object towards the finger"
        hint = "is it the force on the finger? That on the object has the other sign"
        return Objection("force", what, (hint,))
    if trial.moved == "slip":
        return None  # only the ratio of its parts counts
    # Force at which the object is believed to do what it did; its weight if never [N].
    t = model.thresholds([trial.point], [u])
    force = float((t.slide if trial.moved == "slide" else t.topple)[0])
    believed = force if np.isfinite(force) else model.weight
    # A force that holds a tilted object is less than that at the onset, down to nothing.
    least = believed / (1e3 if trial.tilt else FAR)
    if least <= size <= FAR * believed:
        return None
    unit = "millinewtons" if size > believed else "kilonewtons"
    what = (
        f"a force of {size:.3g} N is far from what the {model.name} is believed to need to "
        f"{trial.moved} there, {believed:.3g} N"
    )
    return Objection("force", what, (f"is it in {unit}?", "or mend the model's guess"))


def _distances_beyond(model: ObjectModel, point: Vector) -> Array:
    """Distances of a point beyond each side of the outline seen from above [m]."""
    outline = Polygon.convex(model.outline)
    return np.asarray(outline.normals @ np.array(point[:2]) - outline.offsets)


def _length_hint(value: float, most: float) -> tuple[str, ...]:
    for factor, unit in ((100.0, "centimetres"), (1000.0, "millimetres")):
        if value / factor <= most + SLACK / 10.0:
            return (f"is it in {unit}? the column is in metres",)
    return ()
