"""Forces that open lids, and forces at which the object would move meanwhile.

Model: slow forces on an object that stands on a table by itself. A lid resists by Coulomb friction
τ_f, a flip lid's catch besides by a torque τ_s that fades linearly over its snap angle, and the
lid's weight m_l g acts at its middle, a(θ) from the hinge horizontally. A fingertip at the distance
ρ from the hinge pushes across the lid, so its force turns with it:

    F(θ) = [τ_f + τ_s max(0, 1 − θ/θ_s) + m_l g a(θ)] / ρ      opening
    F(θ) = [τ_f − τ_s max(0, 1 − θ/θ_s) − m_l g a(θ)] / ρ      closing, on its upper side

Along the lid the fingertip holds the tab where it is, by any share up to its friction of F; that
force goes through the hinge and opens nothing, but it keeps a cup from tipping back that F alone
would tip. Object and lid together are pushed by both at the tab; they slide or topple at the
thresholds of `objectmodels.mechanics.push_thresholds` for that point and direction, with the centre
of mass where the turned lid moves it, and stay if they do at any such share.

A lift-off lid comes off at retention plus its weight, unless what stays is tipped off the table
first: that is pulled up by the retention alone, at the middle of its top. A screw cap turns at its
friction torque, unless the standing object turns along: at μ N c̄, N its weight and what the hand
presses down (a squeeze alone does neither press nor lift).

Uncertain are the lid's torques or retention and the object's mass, friction coefficients, friction
radius and centre of mass; probabilities are shares of a fixed sample. Frame: everything in B.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.mechanics.outcome_probability import Sample, sample_parameters
from objectmodels.mechanics.push_thresholds import (
    GRAVITY,
    slide_threshold,
    topple_threshold,
    yaw_arm,
)
from objectmodels.models.kinds import CylinderModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import FlipLid, Lid, LiftOffLid, ScrewCap

# Places of lids on their objects, closed and open.
#
# A closed lid lies on the object's top: a flip lid is a disc of `THICKNESS` with a tab, a
# lift-off lid a disc with a knob, a screw cap a cylinder. The hinge of a flip lid lies on the rim
# at the height of the top, across B's z axis; the lid's lower side turns about it.
#
# Frame: B, at the centre of the base, z up.

THICKNESS = 0.003
"""Of a flip lid and its tab [m]."""

TAB_WIDTH = 0.02
"""Of a flip lid's tab, along the hinge [m]."""

GRIP = 0.7
"""Where a fingertip meets a tab, as a share of its length from the rim."""


@dataclass(frozen=True, eq=False)
class Hinge:
    """A flip lid on its object.

    Attributes:
        p_BH: middle of the hinge, shape (3,) [m].
        out: unit direction from it to the tab, shape (3,).
        reach: from the hinge to the rim under the tab [m].
    """

    p_BH: Array
    out: Array
    reach: float

    def lid_direction(self, angle: ArrayLike) -> Array:
        """Unit direction in which an open lid points, shape (..., 3)."""
        t = np.asarray(angle, dtype=np.float64)[..., None]
        return np.asarray(np.cos(t) * self.out + np.sin(t) * _UP)

    def opening_direction(self, angle: ArrayLike) -> Array:
        """Unit direction off its lower side, in which it opens, shape (..., 3)."""
        return self.lid_direction(np.asarray(angle, dtype=np.float64) + np.pi / 2.0)

    def lid_point(self, angle: ArrayLike, distance: float, above: float = 0.0) -> Array:
        """Point of the lid in B at an angle (...) [rad], shape (..., 3) [m].

        It lies at a distance from the hinge and so far above the lid's lower side [m].
        """
        return np.asarray(
            self.p_BH + distance * self.lid_direction(angle) + above * self.opening_direction(angle)
        )

    def centre_of_mass(self, angle: ArrayLike) -> Array:
        """Centre of mass of the lid in B, shape (..., 3) [m]."""
        return self.lid_point(angle, 0.5 * self.reach, 0.5 * THICKNESS)


_UP = np.array([0.0, 0.0, 1.0])


def lid_hinge(lid: FlipLid, rim: Base, top: float) -> Hinge:
    """Hinge of a flip lid on an object of this rim, in B, and height of the top [m]."""
    out = np.array([np.cos(lid.tab_heading), np.sin(lid.tab_heading)])
    back, front = rim.extent(np.array([-out, out])).tolist()
    p_BH = np.array([*(-back * out), top])
    return Hinge(p_BH, np.array([*out, 0.0]), back + front)


def grip_distance(lid: FlipLid, hinge: Hinge) -> float:
    """From the hinge to where a fingertip meets the tab [m]."""
    return hinge.reach + GRIP * lid.tab


def lid_height(lid: Lid) -> float:
    """Height of a closed lid above the object's top [m]."""
    if isinstance(lid, FlipLid):
        return THICKNESS
    return lid.height + (lid.knob_height if isinstance(lid, LiftOffLid) else 0.0)


def lid_rise(model: ObjectModel, opened: float) -> float:
    """Height of the object's lid above its top, 0 without a lid [m].

    The angle by which it is opened [rad] matters for a flip lid only.
    """
    if model.lid is None:
        return 0.0
    up = 0.0
    if isinstance(model.lid, FlipLid):
        reach = lid_hinge(model.lid, model.rim, model.top).reach + model.lid.tab
        up = reach * float(np.sin(np.clip(opened, 0.0, 0.5 * np.pi)))
    return lid_height(model.lid) + up


def is_off(lid: LiftOffLid | ScrewCap, opened: float) -> bool:
    """Return True if a lid is off, by its opening [m] or turn [rad] as seen."""
    # A camera sees the whole turn of a cap a little wrongly.
    return opened > (lid.travel if isinstance(lid, LiftOffLid) else 0.97 * math.tau * lid.turns)


def lid_name(name: str) -> str:
    """Name of the lid of an object."""
    return f"{name} lid"


def detached_lid(model: ObjectModel, name: str) -> CylinderModel | None:
    """A lid that is off as an object of its own, as wide all the way up; None of one that stays on.

    Its B is at the middle of the lid's lower side. It is called after the object that has this name
    in the scene.
    """
    lid = model.lid
    if lid is None or isinstance(lid, FlipLid):
        return None
    return CylinderModel(
        name=lid_name(name),
        mass=lid.mass,
        radius=lid.radius,
        height=lid_height(lid),
        friction=model.friction,
        finger_friction=model.finger_friction,
    )


def lid_centre(lid: Lid, rim: Base, top: float) -> Array:
    """Centre of mass of a closed lid in B, shape (3,) [m]; a knob weighs nothing."""
    if isinstance(lid, FlipLid):
        return lid_hinge(lid, rim, top).centre_of_mass(0.0)
    return np.array([0.0, 0.0, top + 0.5 * lid.height])


STEPS = 41
"""Angles at which the arc of a flip lid is looked at."""

SAMPLES = 400
"""Samples behind a probability: one half is met to 0.025 (a standard deviation)."""

SHARES = np.linspace(-1.0, 1.0, 13)
"""Shares of the finger's friction that are tried along the lid."""

_SEED = 0


@dataclass(frozen=True)
class FlipArc:
    """A fingertip that moves a flip lid; arrays over n angles on its way.

    Attributes:
        angles: of the lid, in order, shape (n,) [rad].
        points: where the fingertip touches, p_BC, shape (n, 3) [m].
        directions: unit directions of its force, shape (n, 3).
        force: that moves the lid, shape (n,) [N]; zero where it moves by itself.
        slide, topple: at which the object would slide or topple, shape (n,) [N].
        probability: that the lid moves all the way and the object stays.
    """

    angles: Array
    points: Array
    directions: Array
    force: Array
    slide: Array
    topple: Array
    probability: float

    @cached_property
    def margin(self) -> Array:
        """The force at which the object gives way over the force needed, shape (n,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.minimum(self.slide, self.topple) / self.force
        return np.where(self.force > 0.0, ratio, np.inf)

    @cached_property
    def weakest_index(self) -> int:
        """Index of the angle at which the object comes nearest to giving way."""
        return int(np.argmin(self.margin))

    @property
    def least_margin(self) -> float:
        """The margin there; below one the object gives way."""
        return float(self.margin[self.weakest_index])

    @property
    def largest_force(self) -> float:
        """Over the whole way [N]."""
        return float(self.force.max())

    @property
    def outcome(self) -> Literal["moves", "slides", "topples"]:
        """First event on the way."""
        given_way = np.flatnonzero(self.margin < 1.0)
        if given_way.size == 0:
            return "moves"
        first = given_way[0]
        return "slides" if self.slide[first] < self.topple[first] else "topples"


@dataclass(frozen=True)
class Loosening:
    """Force or torque that takes a lid off, and the one that the standing object bears.

    Attributes:
        needed: that moves the lid: force [N] or torque [N·m].
        held: at which the object would come along; infinite if a holder keeps it.
        probability: that the lid moves and the object stays.
    """

    needed: float
    held: float
    probability: float

    @property
    def margin(self) -> float:
        """`held` over `needed`; below one the object comes along."""
        return self.held / self.needed if self.needed > 0.0 else np.inf


def flip(
    model: ObjectModel,
    lid: FlipLid,
    *,
    start: float = 0.0,
    end: float | None = None,
    fixed: bool = False,
) -> FlipArc:
    """Arc of a fingertip that moves a flip lid from one angle to another.

    Args:
        model: the object with its lid.
        lid: its lid.
        start: of the way [rad].
        end: of the way [rad]; all the way open if not given.
        fixed: whether a holder keeps the object where it is.
    """
    angles = np.linspace(start, lid.opens_to if end is None else end, STEPS)
    opens = bool(angles[-1] >= angles[0])
    hinge = lid_hinge(lid, model.rim, model.top)
    lever = grip_distance(lid, hinge)
    points = hinge.lid_point(angles, lever, 0.0 if opens else THICKNESS)
    directions = (1.0 if opens else -1.0) * hinge.opening_direction(angles)

    catch, weight = _torques_against(lid, hinge, angles)

    def force(friction: Array, snap: Array) -> Array:
        back = snap[:, None] * catch + weight
        return np.maximum(0.0, friction[:, None] + (back if opens else -back)) / lever

    def thresholds(of: Sample) -> tuple[Array, Array]:
        if fixed:
            never = np.full((len(of.weight), len(angles)), np.inf)
            return never, never
        return _flip_thresholds(model, lid, hinge, angles, (points, directions), of)

    slide, topple = thresholds(_believed_sample(model))
    needed = force(np.array([lid.friction_torque]), np.array([lid.snap_torque]))
    friction = _sample_positive(lid.friction_torque, lid.friction_torque_sd, 0)
    snap = _sample_positive(lid.snap_torque, lid.snap_torque_sd, 1)
    sample = sample_parameters(model, SAMPLES, _SEED)
    moves = force(friction, snap) <= np.minimum(*thresholds(sample))
    share = float(moves.all(axis=1).mean())
    return FlipArc(angles, points, directions, needed[0], slide[0], topple[0], share)


def _flip_thresholds(
    model: ObjectModel,
    lid: FlipLid,
    hinge: Hinge,
    angles: Array,
    push: tuple[Array, Array],
    of: Sample,
) -> tuple[Array, Array]:
    """Forces at which k bodies slide and topple under a lid's n angles, (k, n) each [N].

    The fingertip's points and directions are (n, 3); of what its friction bears along the lid it
    takes the share at which the object stands longest.
    """
    points, directions = push
    moved = hinge.centre_of_mass(angles) - hinge.centre_of_mass(0.0)
    c = of.com[:, None, :] + (lid.mass * GRAVITY / of.weight)[:, None, None] * moved
    held = of.finger_friction[:, None, None] * hinge.lid_direction(angles)
    tried = (directions + share * held for share in SHARES)
    pairs = zip(*(_yield_forces(model, of, points, u, c) for u in tried), strict=True)
    slides, topples = (np.array(each) for each in pairs)
    best = np.minimum(slides, topples).argmax(axis=0)[None]
    slide, topple = (np.take_along_axis(each, best, axis=0)[0] for each in (slides, topples))
    return slide, topple


def flip_torques(model: ObjectModel, lid: FlipLid, angle: float) -> tuple[float, float, float]:
    """A fingertip's distance from the hinge [m], the share of the catch, the weight's torque [N·m].

    All at an angle of the lid [rad].
    """
    hinge = lid_hinge(lid, model.rim, model.top)
    catch, weight = _torques_against(lid, hinge, np.array([angle]))
    return grip_distance(lid, hinge), float(catch[0]), float(weight[0])


def _torques_against(lid: FlipLid, hinge: Hinge, angles: Array) -> tuple[Array, Array]:
    """Share of the catch's torque, and torque of the lid's weight [N·m], shape (n,) each."""
    over = (hinge.centre_of_mass(angles) - hinge.p_BH) @ hinge.out
    return np.maximum(0.0, 1.0 - angles / lid.snap_angle), lid.mass * GRAVITY * over


def lift_off(model: ObjectModel, lid: LiftOffLid, *, fixed: bool = False) -> Loosening:
    """Force that pulls a lid straight up by its knob, off an object that stands.

    A holder keeps the object where it is if `fixed`.
    """
    weight = lid.mass * GRAVITY
    top = np.array([[0.0, 0.0, model.top]])
    p_BL = lid_centre(lid, model.rim, model.top)

    def held(of: Sample) -> Array:
        if fixed:
            return np.full(len(of.weight), np.inf)
        stays = of.weight - weight
        c = (of.weight[:, None] * of.com - weight * p_BL) / stays[:, None]
        bears = topple_threshold(model.base, top, _UP[None], c, 1.0)
        return np.asarray(weight + stays * bears)

    pulled = weight + _sample_positive(lid.retention, lid.retention_sd, 0)
    return _loosening(model, lid.retention + weight, pulled, held)


def unscrew(
    model: ObjectModel, cap: ScrewCap, *, down: float = 0.0, fixed: bool = False
) -> Loosening:
    """Torque that turns a screw cap on an object that stands.

    The hand presses `down` on the cap [N]; a holder keeps the object from turning if `fixed`.
    """

    def held(of: Sample) -> Array:
        if fixed:
            return np.full(len(of.weight), np.inf)
        return np.maximum(0.0, of.weight + down) * of.friction * of.friction_radius

    torque = _sample_positive(cap.friction_torque, cap.friction_torque_sd, 0)
    return _loosening(model, cap.friction_torque, torque, held)


def _loosening(
    model: ObjectModel, needed: float, sampled: Array, held: Callable[[Sample], Array]
) -> Loosening:
    """Force or torque needed, with samples of it, beside the one that the standing object bears."""
    share = float((sampled <= held(sample_parameters(model, SAMPLES, _SEED))).mean())
    return Loosening(needed, float(held(_believed_sample(model))[0]), share)


def _yield_forces(
    model: ObjectModel, of: Sample, p: Array, u: Array, c: Array
) -> tuple[Array, Array]:
    """Forces, in lengths of u, at which k samples slide and topple at n points, (k, n) [N]."""
    weight = of.weight[:, None]
    friction, radius = of.friction[:, None], of.friction_radius[:, None]
    slide = weight * slide_threshold(u, yaw_arm(p, u, c), friction, radius, 1.0)
    topple = weight * topple_threshold(model.base, p, u, c, 1.0)
    return slide, topple


def _believed_sample(model: ObjectModel) -> Sample:
    """Sample of one: the object's most likely parameters."""
    return Sample(
        weight=np.array([model.weight]),
        friction=np.array([model.friction]),
        finger_friction=np.array([model.finger_friction]),
        friction_radius=np.array([model.friction_radius]),
        com=np.array([model.com]),
    )


def _sample_positive(mean: float, sd: float, which: int) -> Array:
    """Samples of a quantity that is not negative, shape (SAMPLES,)."""
    rng = np.random.default_rng((_SEED, 1 + which))
    return np.maximum(0.0, mean + sd * rng.standard_normal(SAMPLES))
