"""Plans of a whole hand in words: how something is held, each step, what will come of it, why."""

from __future__ import annotations

from collections.abc import Iterator

from nlcontrol.references.object_names import listed
from nlcontrol.text_format import quantity
from planner.geometry.directions import phrase
from planner.types.actions import (
    Action,
    Carry,
    FlipOver,
    FlipPrediction,
    Grasp,
    GraspAction,
    LiftUp,
    PourOut,
    PullPrediction,
    PutOn,
    SetDown,
    TurnCap,
)
from planner.types.plan import Plan


def likely(probability: float) -> str:
    """A probability as people read it."""
    return "over 0.99" if probability > 0.99 else f"{probability:.2f}"


def plan_lines(plan: Plan) -> Iterator[str]:
    """How it is held, what is done with it, what will come of that, and why."""
    held = _held(plan)
    yield f"Plan: {held}, then {doing(plan)}." if held else f"Plan: {doing(plan)}."
    yield f"  Predicted: {'; '.join(predicted(plan))}."
    if why := reasons(plan):
        yield f"  Why that works: {'; '.join(why)}."
    if plan.aim is not None:
        yield f"  It should end at x {quantity(plan.aim.x, 'm')}, y {quantity(plan.aim.y, 'm')}."
    yield from (f"  {note}" for note in plan.notes)


def _held(plan: Plan) -> str:
    if plan.grasp is None:
        return ""
    if plan.grasp.held:
        return f"the {plan.object} is in the hand already"
    part = f"the {plan.object}"
    if plan.grasp.part == "lid":
        return f"hold the lid of {part} from above, with {quantity(plan.grasp.squeeze, 'N')}"
    return f"hold {part} {grasp_words(plan.grasp)}"


def grasp_words(grasp: Grasp) -> str:
    """Where and how hard it is held: "from its side, 60 mm above its base, with 4.5 N"."""
    where = f"{quantity(grasp.p_BG[2], 'm')} above its base"
    return f"{grasp.way}, {where}, with {quantity(grasp.squeeze, 'N')}"


def doing(plan: Plan) -> str:
    """All steps of a plan, one after another."""
    return ", then ".join(_step(step, plan) for step in plan.steps)


def _step(step: Action, plan: Plan) -> str:
    what = f"the {plan.object}"
    match step:
        case LiftUp():
            up = f"lift it by {quantity(step.height, 'm')}"
            return f"{up} and hold it" if step.hold else up
        case Carry():
            return f"carry it to x {quantity(step.to.x, 'm')}, y {quantity(step.to.y, 'm')}"
        case PourOut():
            volume = "" if step.volume is None else f"{quantity(step.volume, 'm³')} "
            return (
                f"pour {volume}into the {step.into}, tilting it by up to "
                f"{quantity(step.angle, 'rad')} at {quantity(step.rate, 'rad/s')}"
            )
        case SetDown():
            return "set it down"
        case FlipOver():
            return (
                f"move the lid of {what} with a fingertip from {quantity(step.start, 'rad')} to "
                f"{quantity(step.end, 'rad')}, {phrase(step.heading)} lies its tab, with at most "
                f"{quantity(step.force_limit, 'N')}"
            )
        case TurnCap():
            way = "to the left" if step.angle > 0.0 else "to the right"
            return (
                f"turn it by {quantity(abs(step.angle), 'rad')} {way}, with at most "
                f"{quantity(step.torque_limit, 'N·m')}"
            )
        case PutOn():
            return f"put it onto the {step.onto} and press with {quantity(step.press, 'N')}"
    raise AssertionError(f"{step.kind} is no step of a hand")


def predicted(plan: Plan) -> list[str]:
    """What the models say will happen."""
    told = [f"it succeeds with probability {likely(plan.probability)}"]
    for action in plan.actions:
        match action:
            case GraspAction():
                told.append(f"the grasp holds with probability {likely(action.prediction.holds)}")
            case PourOut():
                p = action.prediction
                told += (
                    f"{quantity(p.poured, 'm³')} run out of the {plan.object}",
                    f"{quantity(p.received, 'm³')} arrive in the {action.into}",
                    f"{quantity(p.spilled, 'm³')} are spilled",
                    f"{quantity(p.left, 'm³')} stay in it",
                    f"the {action.into} is then {100 * p.level_after:.0f} % full",
                )
            case FlipOver():
                told.append(f"the lid ends at {quantity(action.prediction.lid_angle, 'rad')}")
    return told


def reasons(plan: Plan) -> list[str]:
    """The numbers by which it works."""
    return [reason for action in plan.actions for reason in _reasons(action, plan.object)]


def _reasons(action: Action, name: str) -> Iterator[str]:
    match action:
        case GraspAction() if action.needed > 0.0:
            yield (
                f"{quantity(action.needed, 'N')} would just hold it, the fingers have "
                f"{quantity(action.strongest, 'N')} at {quantity(action.width, 'm')}"
            )
        case LiftUp(prediction=PullPrediction() as p):
            yield f"the lid takes up to {quantity(p.lid_force, 'N')}"
            if p.lifting_force is not None:
                yield f"the {name} is lifted from {quantity(p.lifting_force, 'N')} on"
        case FlipOver():
            yield f"the lid takes up to {quantity(action.prediction.lid_force, 'N')}"
            yield from _stands(action.prediction, name)
        case TurnCap():
            cap, turns = action.prediction, ""
            if cap.turning_torque is not None:
                turns = f", the {name} turns along from {quantity(cap.turning_torque, 'N·m')} on"
            yield f"the cap takes {quantity(cap.lid_torque, 'N·m')}{turns}"


def _stands(p: FlipPrediction, name: str) -> Iterator[str]:
    """What the standing object bears while its lid is opened."""
    gives = [
        f"{verb} from {quantity(force, 'N')} on"
        for verb, force in (("slides", p.slide_force), ("topples", p.topple_force))
        if force is not None
    ]
    if gives:
        yield (
            f"at {quantity(p.nearest_angle, 'rad')}, where the {name} comes nearest to "
            f"giving way, it takes {quantity(p.nearest_force, 'N')}, and the {name} "
            f"{listed(gives)}"
        )


def predicted_figures(plan: Plan) -> dict[str, float]:
    """Numbers that the actions of a hand predict, by their names."""
    predictions = (
        action.prediction
        for action in plan.actions
        if not isinstance(action, Carry | SetDown | PutOn)
    )
    return {name: x for each in predictions if each for name, x in each if x is not None}


def deciding(plan: Plan) -> dict[str, float]:
    """The numbers of a plan by their names."""
    numbers = predicted_figures(plan)
    if plan.grasp is not None:
        numbers |= {
            "squeeze": plan.grasp.squeeze,
            "needed_squeeze": plan.grasp.needed,
            "strongest_squeeze": plan.grasp.strongest,
        }
    for step in plan.steps:
        if isinstance(step, LiftUp) and "height" not in numbers:
            numbers["height"] = step.height
    return numbers
