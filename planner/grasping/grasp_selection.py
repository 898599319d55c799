"""Grasps that hold, the best first.

Model: the hand squeezes harder than what just holds by a reserve, and as hard as the worst case of
what is believed takes, if it can; that must be likely enough to hold, and the object to hang
upright in it. Of several grasps the one with most squeeze to spare comes first.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import axis_rotation, spatial_cross
from objectmodels.mechanics.grasp_stability import Contacts, Lifted, least_squeezes
from objectmodels.mechanics.outcome_probability import normal_cdf
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel
from objectmodels.safety_figure import SafetyFigure
from planner.grasping.grasp_candidates import Candidate
from planner.problem.planning_problem import GraspProblem
from planner.refusals.blocked import Blocked, dead_end
from planner.types.actions import Grasp
from planner.types.world_state import plain_vector

# How far something leans that a hand holds.
#
# Model: the fingertips stick, and their springs give way. About the closing direction they resist
# a turn with a stiffness K; the others they hardly allow. The weight m g acts at the centre of
# mass, e beside the line across, to its left, and h above it, so that it leans by −φ: K φ = m g
# (e + h φ). What is not known of mass and centre of mass counts to first order; all else is
# `HAND_LEAN`.

HAND_LEAN: SafetyFigure = math.radians(1.2)
"""Standard deviation of a lean by what is not in the model, as simulated lifts have it [rad]."""


@dataclass(frozen=True)
class Lean:
    """Lean about the closing direction, and its standard deviation [rad]; infinite if it tips."""

    angle: float
    sd: float

    @classmethod
    def of_grasp(cls, model: ObjectModel, candidate: Candidate) -> Lean:
        """The lean of an object that hangs in a hand."""
        off = np.array(model.com) - candidate.middle
        closing = candidate.closing
        beside = np.array([-closing[1], closing[0], 0.0])
        weight = model.weight
        holds = candidate.grip.stiffness - weight * float(off[2])
        if holds <= 0.0:
            return cls(math.inf, math.inf)
        angle = 0.0 - weight * float(off @ beside) / holds
        by_place = weight * math.hypot(*(beside * model.com_sd)) / holds
        by_mass = angle * model.mass_sd / model.mass
        return cls(angle, math.hypot(by_place, by_mass, HAND_LEAN))

    def probability_within(self, most: float) -> float:
        """Probability that it leans by no more than an angle [rad]."""
        if math.isinf(self.sd):
            return 0.0
        ends = (np.array([most, -most]) - self.angle) / self.sd
        within, below = normal_cdf(ends).tolist()
        return float(within - below)


_PATCH = np.array([[0.0, 0.0], [0.0, 0.004], [0.0, -0.004]])  # contacts at a knob [m]
_TILTS = 8  # at which a motion is looked at

ACCELERATION: SafetyFigure = 1.0
"""Of what is lifted and carried slowly, with what makes it tremble [m/s²]."""


@dataclass(frozen=True)
class Load:
    """Load of a hand that is not the object's weight.

    Attributes:
        force: downwards [N].
        force_sd: its standard deviation [N].
    """

    force: float
    force_sd: float = 0.0


@dataclass(frozen=True, eq=False)
class GraspLoad:
    """A grasp, and what it has to bear.

    Attributes:
        candidate: the grasp.
        load: that hangs on it; the object's weight if None.
        lean: direction in B in which it is tilted [rad].
        angle: how far [rad].
        turned: rotation vector, in B, of a turn about whatever axis, (3,) [rad]; None of a tilt.
    """

    candidate: Candidate
    load: Load | None = None
    lean: float = 0.0
    angle: float = 0.0
    turned: Array | None = None

    @property
    def down(self) -> Array:
        """Directions of its weight in B on its way, shape (k, 3)."""
        if self.turned is not None:
            angle = float(np.linalg.norm(self.turned))
            R = axis_rotation(self.turned / angle, np.linspace(0.0, angle, _TILTS))
            return -R[:, 2]
        tilts = np.linspace(0.0, self.angle, _TILTS) if self.angle else np.zeros(1)
        ahead, ones = np.sin(tilts), np.ones(len(tilts))
        return np.stack(
            [ahead * math.cos(self.lean), ahead * math.sin(self.lean), -np.cos(tilts) * ones], -1
        )

    def lifted_object(self, model: ObjectModel) -> Lifted:
        """It in the hand, through its motion."""
        each = self.candidate
        closing, approach, contacts = each.closing, each.approach, each.grip.contacts
        shares = each.grip.shares
        # The fingers have slipped, as far as that is known: what creeps must still hold.
        borne = model.model_copy(update={"finger_friction": friction(model)})
        if self.load is not None:
            force = {"mass": self.load.force / GRAVITY, "mass_sd": self.load.force_sd / GRAVITY}
            borne = borne.model_copy(update=force)
        if each.part == "lid":
            # The fingers around a knob do not keep it from swinging until its weight is below.
            borne = borne.model_copy(update={"com": tuple(each.middle), "com_sd": (0.0, 0.0, 0.0)})
            contacts, shares = _PATCH, np.array([1.0, 0.5, 0.5])
        R_BG = np.column_stack([closing, spatial_cross(approach, closing), approach])
        grasp = Contacts(contacts, shares, each.press)
        return Lifted(borne, grasp, each.middle, R_BG, self.down, ACCELERATION)


@dataclass(frozen=True, eq=False)
class StableGrasp:
    """A grasp that holds.

    Attributes:
        grasp: as a plan states it.
        probability: that it holds, and hangs upright.
        lean: direction in B in which it holds while it is tilted [rad]; None if any will do.
        hangs: how the object leans in it; None if it is held already, or is a lid.
        turned: as of `GraspLoad`, for which it holds.
    """

    grasp: Grasp
    probability: float
    lean: float | None = None
    hangs: Lean | None = None
    turned: Array | None = None


def held_already(problem: GraspProblem) -> list[StableGrasp]:
    """The grasp in which the hand holds it; none if it holds nothing."""
    held = problem.state.held
    return [] if held is None else [StableGrasp(held.grasp, 1.0)]


def stable_grasps(
    problem: GraspProblem, bearings: Sequence[GraspLoad]
) -> list[StableGrasp] | Blocked:
    """The grasps that hold, those with most squeeze to spare first."""
    d, known = problem.defaults, _GraspBeliefs(problem.target.model)
    just, worst = known.squeezes_needed(bearings)
    wanted = problem.force.reserve * just
    limit = np.array([strongest(problem, each.candidate) for each in bearings])
    spare = limit / wanted
    if not (spare >= 1.0).any():
        best = int(spare.argmax())
        needed = float(wanted[best])
        if math.isinf(needed):
            numbers = {
                "needed_friction": known.friction_needed(bearings),
                "friction": friction(problem.target.model),
            }
            doing, name = problem.goal.doing, problem.target.name
            return dead_end("no_squeeze_holds", numbers, doing=doing, object=name)
        if known.probability(bearings[best], needed) < d.probability:
            needed = _free_squeeze(problem, bearings) or needed
        return _too_heavy(problem, bearings[best].candidate, needed)
    squeeze = np.minimum(np.maximum(wanted, worst), limit)
    probability = np.array(
        [known.probability(*each) for each in zip(bearings, squeeze, strict=True)]
    )
    unsure = probability < d.probability
    # Where the belief is uncertain, more squeeze may do.
    squeeze[unsure] = limit[unsure]
    for i in np.flatnonzero(unsure & (spare >= 1.0)).tolist():
        probability[i] = known.probability(bearings[i], squeeze[i])
    model, candidates = problem.target.model, [each.candidate for each in bearings]
    # Lids do not lean.
    leans = [Lean.of_grasp(model, each) if each.part == "body" else None for each in candidates]
    upright = np.array([1.0 if u is None else u.probability_within(d.upright) for u in leans])
    holds = (spare >= 1.0) & (probability >= d.probability)
    probability = np.maximum(probability + upright - 1.0, 0.0)
    good = holds & (probability >= d.probability)
    if holds.any() and not good.any():
        return _hangs_askew(problem, [leans[i] for i in np.flatnonzero(holds)])
    if not good.any():
        best = int(np.where(spare >= 1.0, probability, -1.0).argmax())
        return _may_slip(problem, bearings, best, float(squeeze[best]), float(probability[best]))
    order = _order(problem, bearings, upright, spare)
    return [
        StableGrasp(
            _grasp_value(problem, bearings[i].candidate, float(squeeze[i]), float(just[i])),
            float(probability[i]),
            bearings[i].lean if bearings[i].angle else None,
            leans[i],
            bearings[i].turned,
        )
        for i in order
        if good[i]
    ]


def _order(
    problem: GraspProblem, bearings: Sequence[GraspLoad], upright: Array, spare: Array
) -> list[int]:
    """Indices of the grasps: with room, upright and with squeeze to spare first."""
    candidates = [each.candidate for each in bearings]
    crowded = [each.is_crowded(problem.target, problem.state) for each in candidates]
    # Height does not matter to a hold; in the middle there is most room for the hand.
    heights = np.array([each.middle[2] for each in candidates])
    off = np.abs(heights - 0.5 * (heights.min() + heights.max()))
    # Except for a hand that comes down askew: its palm is low, which counts before any squeeze.
    steep = np.array([-each.approach[2] for each in candidates])
    askew = (steep > 0.0) & (steep < 1.0)
    low = np.where(askew, heights.max() - heights, 0.0)
    keys = np.array([off, -spare.round(2), -upright.round(3), low, crowded])
    return [int(i) for i in np.lexsort(keys)]


def _may_slip(
    problem: GraspProblem,
    bearings: Sequence[GraspLoad],
    best: int,
    squeeze: float,
    probability: float,
) -> Blocked:
    """Dead end since even the best of the grasps is not sure enough."""
    if free := _free_squeeze(problem, bearings):
        return _too_heavy(problem, bearings[best].candidate, free)
    found_to = problem.defaults.found_to
    learn, then = _best_experiment(problem.target.model, bearings[best], squeeze, found_to)
    numbers = {
        "squeeze": squeeze,
        "probability": probability,
        "probability_then": then,
        "asked_probability": problem.effort.probability,
    }
    name, model = problem.target.name, problem.target.model
    return dead_end(f"may_slip.{learn}", numbers, object=name, model=model.name)


def _hangs_askew(problem: GraspProblem, leans: Sequence[Lean | None]) -> Blocked:
    """Dead end since the object would lean in every grasp that holds it."""
    most = problem.defaults.upright
    known = [lean for lean in leans if lean is not None]
    best = max(known, key=lambda lean: lean.probability_within(most))
    numbers = {
        "lean": abs(best.angle),
        "lean_sd": best.sd,
        "upright": most,
        "probability": best.probability_within(most),
    }
    return dead_end("hangs_askew", numbers, doing=problem.goal.doing, object=problem.target.name)


def _free_squeeze(problem: GraspProblem, bearings: Sequence[GraspLoad]) -> float | None:
    """Squeeze with which it would be held if the sentence allowed any [N]; None if it would not."""
    if math.isinf(problem.force.max):
        return None
    free = replace(problem, force=replace(problem.force, max=math.inf))
    found = stable_grasps(free, bearings)
    return None if isinstance(found, Blocked) else found[0].grasp.squeeze


def _too_heavy(problem: GraspProblem, candidate: Candidate, wanted: float) -> Blocked:
    """Dead end since it takes more squeeze than there is."""
    model, has, force = problem.target.model, candidate.grip.strongest, problem.force
    numbers = {"needed_force": wanted, "strongest": has, "friction": friction(model)}
    words: dict[str, Any] = {
        "doing": problem.goal.doing,
        "object": problem.target.name,
        "width": candidate.width,
    }
    crush = _crush_force(model, candidate)
    if force.max <= min(has, crush) and wanted <= min(has, crush):
        numbers = {"allowed_force": force.max, **numbers}
        return dead_end("squeeze_not_allowed", numbers, spans=force.spans, **words)
    if crush < has:
        return dead_end("bears_no_squeeze", {"crush": crush, **numbers}, **words)
    return dead_end("squeeze_not_there", numbers, **words)


def strongest(problem: GraspProblem, candidate: Candidate) -> float:
    """Largest squeeze that hand, object and sentence allow [N]."""
    crush = _crush_force(problem.target.model, candidate)
    return min(candidate.grip.strongest, problem.force.max, crush)


def _crush_force(model: ObjectModel, candidate: Candidate) -> float:
    """Squeeze that an object bears [N]; a lid bears any."""
    return math.inf if model.grasp is None or candidate.part == "lid" else model.grasp.crush


class _GraspBeliefs:
    """Beliefs about grasps; those that differ by a turn only are computed once."""

    def __init__(self, model: ObjectModel) -> None:
        self._model = model
        self._keyed: dict[GraspLoad, tuple[bytes, Lifted]] = {}
        self._likely: dict[bytes, float] = {}

    def squeezes_needed(self, bearings: Sequence[GraspLoad]) -> tuple[Array, Array]:
        """Squeezes with everything as believed, and in the worst case, each shape (n,) [N]."""
        distinct: dict[bytes, Lifted] = {}
        for key, each in map(self._key_and_object, bearings):
            distinct.setdefault(key, each)
        where = {key: i for i, key in enumerate(distinct)}
        needed, worst = least_squeezes(tuple(distinct.values()))
        at = [where[self._key_and_object(bearing)[0]] for bearing in bearings]
        return needed[at], worst[at]

    def friction_needed(self, bearings: Sequence[GraspLoad]) -> float:
        """Least coefficient at the fingers with which any squeeze holds in one of the grasps."""
        needed = (self._key_and_object(each)[1].friction_needed() for each in bearings)
        return min(needed)

    def probability(self, bearing: GraspLoad, squeeze: float) -> float:
        """Probability that a squeeze holds."""
        key, lifted = self._key_and_object(bearing)
        key += f"{squeeze:.6g}".encode()
        if key not in self._likely:
            self._likely[key] = lifted.hold_probability(squeeze)
        return self._likely[key]

    def _key_and_object(self, bearing: GraspLoad) -> tuple[bytes, Lifted]:
        """All that a hold depends on, and the object in the hand."""
        if bearing not in self._keyed:
            lifted = bearing.lifted_object(self._model)
            # All of it in the frame of the grasp.
            R, model = lifted.R_BG, lifted.model
            parts = (
                lifted.contacts.places,
                (np.array(model.com) - lifted.p_BG) @ R,
                R.T @ np.diag(np.square(model.com_sd)) @ R,
                lifted.down_B @ R,
                np.array([model.mass, model.mass_sd, *vars(lifted.contacts.press).values()]),
            )
            key = b"".join((np.round(part, 7) + 0.0).tobytes() for part in parts)
            self._keyed[bearing] = key, lifted
        return self._keyed[bearing]


def friction(model: ObjectModel) -> float:
    """The coefficient at the fingers that a hold relies on."""
    kinetic = model.finger_friction_kinetic
    return model.finger_friction if kinetic is None else kinetic


def _grasp_value(
    problem: GraspProblem, candidate: Candidate, squeeze: float, needed: float
) -> Grasp:
    R_WB = problem.target.pose.R_WB
    return Grasp(
        part=candidate.part,
        p_BG=plain_vector(np.round(candidate.middle, 12)),
        closing_W=plain_vector(np.round(R_WB @ candidate.closing, 12)),
        approach_W=plain_vector(np.round(R_WB @ candidate.approach, 12)),
        width=candidate.width,
        squeeze=squeeze,
        needed=needed,
        strongest=candidate.grip.strongest,
        depth=candidate.depth,
    )


def _best_experiment(
    model: ObjectModel, bearing: GraspLoad, squeeze: float, found_to: float
) -> tuple[str, float]:
    """The parameter most useful to be known, and the probability of the hold then."""
    then = {}
    for name in ("finger_friction", "mass"):
        least = min(getattr(model, f"{name}_sd"), found_to * getattr(model, name))
        known = model.model_copy(update={f"{name}_sd": least})
        then[name] = bearing.lifted_object(known).hold_probability(squeeze)
    best = max(then, key=lambda name: then[name])
    return best, then[best]
