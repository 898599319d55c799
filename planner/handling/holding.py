"""Which grasp holds, and which of those that hold the hand gets to.

Model: a grasp must hold in the worst case of what is believed (`Defaults.sigmas`), and exceed what
just holds by a reserve. Of several the one with most squeeze to spare is asked for first; the hand
squeezes no harder than that takes, unless the belief is too uncertain for it.

Frames: W is the world, B the object.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.base import Array
from objectmodels.grasping import Load, holding, squeeze_needed
from planner.handling import refusals
from planner.handling.plan import Grasp, HandlingPlan, HandlingPrediction, HandStep
from planner.plan import Aim, DefaultUsed, Vector3

if TYPE_CHECKING:
    from objectmodels.model import ObjectModel
    from planner.handling.grasps import Candidate
    from planner.handling.plan import Action
    from planner.handling.task import Task
    from planner.reach import ReachAnswer

_NOTHING = HandlingPrediction()
_Arrays = tuple[Array, Array, Array, Array, Array]


@dataclass(frozen=True)
class Hold:
    """A grasp that holds.

    Attributes:
        grasp: as a plan states it.
        probability: that it holds.
    """

    grasp: Grasp
    probability: float


@dataclass(frozen=True)
class Draft:
    """What a hand could do once it holds something.

    Attributes:
        steps: one after the other.
        prediction: what comes of it, but for the hold.
        probability: that it comes so if the hold holds.
        aim: where the object should stand at the end.
        defaults: values that the sentence left open.
        notes: how it was chosen.
    """

    steps: tuple[HandStep, ...]
    prediction: HandlingPrediction = _NOTHING
    probability: float = 1.0
    aim: Aim | None = None
    defaults: tuple[DefaultUsed, ...] = ()
    notes: tuple[str, ...] = ()


Way = tuple[Hold | None, Draft]


def held_already(task: Task) -> list[Hold]:
    """The grasp in which the hand holds it; none if it holds nothing."""
    held = task.state.held
    return [] if held is None else [Hold(held.grasp, 1.0)]


def holds(task: Task, candidates: Sequence[Candidate], load: Load | None = None) -> list[Hold]:
    """The candidates that hold, those with most squeeze to spare first.

    Args:
        task: what is planned for.
        candidates: ways to hold it.
        load: what is borne, if that is not the object's weight.

    Raises:
        RefusedError: none does.
    """
    model, how, d = task.target.model, task.how, task.defaults
    load = Load.of(model) if load is None else load
    worst = _needed(model, candidates, load, d.sigmas)
    wanted = np.maximum(how.reserve * _needed(model, candidates, load, 0.0), worst)
    limit = np.array([strongest(task, each) for each in candidates])
    spare = limit / wanted
    if spare.max() < 1.0:
        best = int(spare.argmax())
        raise refusals.too_heavy(task, candidates[best], float(wanted[best]))
    sure = _probability(model, candidates, load, wanted) >= d.probability
    squeeze = np.where(sure, np.minimum(wanted, limit), limit)
    probability = _probability(model, candidates, load, squeeze)
    good = (spare >= 1.0) & (probability >= d.probability)
    if not good.any():
        best = int(np.where(spare >= 1.0, probability, -1.0).argmax())
        learn = _experiment(model, candidates[best], load, squeeze[best], d.found_to)
        raise refusals.may_slip(task, float(squeeze[best]), float(probability[best]), *learn)
    crowded = [each.crowded(task.target, task.state) for each in candidates]
    # Height does not matter to a hold; where the weight is near, nothing swings.
    swing = [abs(float(each.middle[2]) - load.at[2]) for each in candidates]
    order = sorted(
        np.flatnonzero(good).tolist(),
        key=lambda i: (crowded[i], -round(float(spare[i]), 2), swing[i]),
    )
    return [
        Hold(_grasp(task, candidates[i], float(squeeze[i]), float(worst[i])), float(probability[i]))
        for i in order
    ]


def strongest(task: Task, candidate: Candidate) -> float:
    """Largest squeeze that hand, object and sentence allow [N]."""
    allowed = min(candidate.grip.strongest, task.how.most_force)
    graspable = task.target.model.grasp
    if candidate.part == "lid" or graspable is None:
        return allowed
    return min(allowed, graspable.crush)


def _grasp(task: Task, candidate: Candidate, squeeze: float, needed: float) -> Grasp:
    R_WB = task.target.pose.R_WB
    return Grasp(
        part=candidate.part,
        p_BG=_tuple(candidate.middle),
        closing_W=_tuple(R_WB @ candidate.closing),
        approach_W=_tuple(R_WB @ candidate.approach),
        width=candidate.width,
        squeeze=squeeze,
        needed=needed,
        strongest=candidate.grip.strongest,
    )


def _tuple(v: Array) -> Vector3:
    # Adding zero turns −0.0 into 0.0 in what people read.
    x, y, z = (np.round(v, 12) + 0.0).tolist()
    return x, y, z


def _needed(
    model: ObjectModel, candidates: Sequence[Candidate], load: Load, sigmas: float
) -> Array:
    found = np.empty(len(candidates))
    for some, arrays in _by_grip(candidates):
        found[some] = squeeze_needed(model, *arrays, load=load, sigmas=sigmas)
    return found


def _probability(
    model: ObjectModel, candidates: Sequence[Candidate], load: Load, squeeze: Array
) -> Array:
    found = np.empty(len(candidates))
    for some, arrays in _by_grip(candidates):
        found[some] = holding(model, *arrays, squeeze[some], load=load)
    return found


def _by_grip(candidates: Sequence[Candidate]) -> Iterator[tuple[list[int], _Arrays]]:
    """Candidates of one grip each, as the arrays that the physics takes."""
    for grip in {id(each.grip): each.grip for each in candidates}.values():
        some = [i for i, each in enumerate(candidates) if each.grip is grip]
        middles, closing, approach = (
            np.array([getattr(candidates[i], name) for i in some])
            for name in ("middle", "closing", "approach")
        )
        yield some, (middles, closing, approach, grip.contacts, grip.shares)


def _experiment(
    model: ObjectModel, candidate: Candidate, load: Load, squeeze: float, found_to: float
) -> tuple[str, float]:
    """What to find out first, and how likely the hold is then."""
    slippery = model.model_copy(
        update={
            "finger_friction_sd": min(model.finger_friction_sd, found_to * model.finger_friction)
        }
    )
    weighed = replace(load, force_sd=min(load.force_sd, found_to * load.force))
    then = {
        f"find out how slippery the {model.name} is to the fingers first": (slippery, load),
        f"find out the weight of the {model.name} first": (model, weighed),
    }
    likely = {
        words: float(_probability(known, [candidate], borne, np.array([squeeze]))[0])
        for words, (known, borne) in then.items()
    }
    best = max(likely, key=lambda words: likely[words])
    return best, likely[best]


# -- what the hand gets to ----------------------------------------------------------------------


def each_with_each(ways: Sequence[Hold], drafts: Sequence[Draft]) -> list[Way]:
    """All grasps with all that may be done, the best with the best first."""
    places = product(range(len(ways)), range(len(drafts)))
    return [(ways[i], drafts[j]) for i, j in sorted(places, key=sum)]


def first_way(task: Task, action: Action, ways: Sequence[Way], considered: int) -> HandlingPlan:
    """The first plan that hand and arm can carry out.

    Args:
        task: what is planned for.
        action: what it amounts to.
        ways: what may be done and with which grasp, the best first; not empty.
        considered: how many ways were looked at before.

    Raises:
        RefusedError: there is none.
    """
    answers: list[ReachAnswer] = []
    unlikely: HandlingPlan | None = None
    for hold, draft in ways:
        made = _plan(task, action, hold, draft)
        made = made.model_copy(update={"considered": considered, "satisfying": len(ways)})
        if made.probability < task.defaults.probability:
            unlikely = unlikely or made
            continue
        if len(answers) == task.defaults.most_grasps:
            break
        answers.append(task.hand.handles(made, task.state))
        if answers[-1].ok:
            return made
    if not answers and unlikely is not None:
        raise refusals.unlikely(task, unlikely)
    raise refusals.no_reach(task, answers)


def _plan(task: Task, action: Action, hold: Hold | None, draft: Draft) -> HandlingPlan:
    held = task.state.held is not None
    sure = 1.0 if hold is None else hold.probability
    prediction = draft.prediction.model_copy(update={"holds": None if hold is None else sure})
    return HandlingPlan(
        action=action,
        object=task.target.name,
        grasp=None if hold is None else hold.grasp,
        held=held,
        steps=draft.steps,
        prediction=prediction,
        # Whatever hangs together, it is at least so likely.
        probability=max(draft.probability + sure - 1.0, 0.0),
        aim=draft.aim,
        speed=task.how.speed,
        clear_of=task.how.clear_of,
        defaults=draft.defaults + task.how.defaults,
        notes=draft.notes,
    )
