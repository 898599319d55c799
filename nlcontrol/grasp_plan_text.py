"""Plans of a whole hand in words: how something is held, each step, what will come of it, why."""

from __future__ import annotations

from collections.abc import Iterator

from nlcontrol.references.object_names import listed
from nlcontrol.text_format import quantity
from planner.geometry.directions import phrase
from planner.types.actions import (
    Carry,
    FlipOver,
    Grasp,
    HandlingPlan,
    HandStep,
    LiftUp,
    PourOut,
    PutOn,
    SetDown,
    TurnCap,
)


def likely(probability: float) -> str:
    """A probability as people read it."""
    return "over 0.99" if probability > 0.99 else f"{probability:.2f}"


def plan_lines(plan: HandlingPlan) -> Iterator[str]:
    """How it is held, what is done with it, what will come of that, and why."""
    held = _held(plan)
    yield f"Plan: {held}, then {doing(plan)}." if held else f"Plan: {doing(plan)}."
    yield f"  Predicted: {'; '.join(predicted(plan))}."
    if why := reasons(plan):
        yield f"  Why that works: {'; '.join(why)}."
    if plan.aim is not None:
        yield f"  It should end at x {quantity(plan.aim.x, 'm')}, y {quantity(plan.aim.y, 'm')}."
    yield from (f"  {note}" for note in plan.notes)


def _held(plan: HandlingPlan) -> str:
    if plan.grasp is None:
        return ""
    if plan.held:
        return f"the {plan.object} is in the hand already"
    part = f"the {plan.object}"
    if plan.grasp.part == "lid":
        return f"hold the lid of {part} from above, with {quantity(plan.grasp.squeeze, 'N')}"
    return f"hold {part} {grasp_words(plan.grasp)}"


def grasp_words(grasp: Grasp) -> str:
    """Where and how hard it is held: "from its side, 60 mm above its base, with 4.5 N"."""
    where = f"{quantity(grasp.p_BG[2], 'm')} above its base"
    return f"{grasp.way}, {where}, with {quantity(grasp.squeeze, 'N')}"


def doing(plan: HandlingPlan) -> str:
    """All steps of a plan, one after another."""
    return ", then ".join(_step(step, plan) for step in plan.steps)


def _step(step: HandStep, plan: HandlingPlan) -> str:
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


def predicted(plan: HandlingPlan) -> list[str]:
    """What the models say will happen."""
    p = plan.prediction
    told = [f"it succeeds with probability {likely(plan.probability)}"]
    if p.holds is not None:
        told.append(f"the grasp holds with probability {likely(p.holds)}")
    if p.poured is not None:
        into = [step.into for step in plan.steps if isinstance(step, PourOut)]
        told.append(f"{quantity(p.poured, 'm³')} run out of the {plan.object}")
        if p.received is not None and into:
            told.append(f"{quantity(p.received, 'm³')} arrive in the {into[0]}")
        if p.spilled is not None:
            told.append(f"{quantity(p.spilled, 'm³')} are spilled")
        if p.left is not None:
            told.append(f"{quantity(p.left, 'm³')} stay in it")
        if p.level_after is not None and into:
            told.append(f"the {into[0]} is then {100 * p.level_after:.0f} % full")
    if p.lid_angle is not None:
        told.append(f"the lid ends at {quantity(p.lid_angle, 'rad')}")
    return told


def reasons(plan: HandlingPlan) -> list[str]:
    """The numbers by which it works."""
    p, grasp = plan.prediction, plan.grasp
    told = []
    if grasp is not None and grasp.needed > 0.0:
        told.append(
            f"{quantity(grasp.needed, 'N')} would just hold it, the fingers have "
            f"{quantity(grasp.strongest, 'N')} at {quantity(grasp.width, 'm')}"
        )
    if p.lid_force is not None:
        told.append(f"the lid takes up to {quantity(p.lid_force, 'N')}")
        told += _stands(plan)
    if p.lid_torque is not None:
        turns = ""
        if p.turning_torque is not None:
            turns = f", the {plan.object} turns along from {quantity(p.turning_torque, 'N·m')} on"
        told.append(f"the cap takes {quantity(p.lid_torque, 'N·m')}{turns}")
    return told


def _stands(plan: HandlingPlan) -> Iterator[str]:
    """What the standing object bears while its lid is opened."""
    p = plan.prediction
    if p.lifting_force is not None:
        yield f"the {plan.object} is lifted from {quantity(p.lifting_force, 'N')} on"
    gives = [
        f"{verb} from {quantity(force, 'N')} on"
        for verb, force in (("slides", p.slide_force), ("topples", p.topple_force))
        if force is not None
    ]
    if gives and p.nearest_angle is not None and p.nearest_force is not None:
        yield (
            f"at {quantity(p.nearest_angle, 'rad')}, where the {plan.object} comes nearest to "
            f"giving way, it takes {quantity(p.nearest_force, 'N')}, and the {plan.object} "
            f"{listed(gives)}"
        )


def deciding(plan: HandlingPlan) -> dict[str, float]:
    """The numbers of a plan by their names."""
    numbers = {k: v for k, v in plan.prediction.model_dump().items() if v is not None}
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
