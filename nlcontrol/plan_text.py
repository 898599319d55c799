"""Plans in words: where and how hard it is pushed, how something is held, each step, and why.

Values are SI inside; people read millimetres, degrees and newtons.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from nlcontrol.text_format import join_words, place_text, quantity
from planner.problem.directions import phrase
from planner.types.actions import (
    Action,
    Aim,
    Carry,
    FlipOver,
    FlipPrediction,
    Grasp,
    GraspAction,
    LiftUp,
    Limits,
    PourOut,
    PullPrediction,
    Push,
    PushAction,
    PutOn,
    SetDown,
    SetOn,
    TurnCap,
    TurnOver,
)
from planner.types.plan import Plan
from planner.types.refusal import probability_text


def plan_lines(plan: Plan) -> Iterator[str]:
    """Lines on what will be done, what that will do, why it works, and where it ends."""
    yield from _push_lines(plan) if plan.pushes else _hand_lines(plan)
    yield from (f"  {note}" for note in plan.notes)


def plan_reason(plan: Plan) -> str:
    """One or two sentences on why it is done in this way and no other."""
    reason = _push_reason(plan) if plan.pushes else _hand_reason(plan)
    return reason + (f" Besides: {'; '.join(plan.notes)}." if plan.notes else "")


def deciding_figures(plan: Plan) -> dict[str, float]:
    """The numbers that decide about a plan, by their names [SI]."""
    if plan.pushes:
        return _push_figures(plan.push)
    predictions = (
        action.prediction
        for action in plan.actions
        if not isinstance(action, Carry | TurnOver | SetDown | PutOn)
    )
    numbers = {name: x for each in predictions if each for name, x in each if x is not None}
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


def _push_lines(plan: Plan) -> Iterator[str]:
    yield f"Plan: {push_text(plan.push)}."
    yield f"  Predicted: {_prediction(plan.push)}"
    yield f"  Why that is safe: {_safety(plan.push)}"
    if guards := _guards(plan.push.limits):
        yield f"  It is stopped before it {guards}."
    for number, push in enumerate(plan.pushes[1:], start=2):
        yield f"  {number}. Then, as foreseen: {push_text(push)}."
    if plan.aim is not None:
        yield f"  {_end(plan, plan.aim)}"


def push_text(push: Push) -> str:
    """One push in words: with what, where, which way, how hard, and until when."""
    fingers = "one finger" if push.fingers == 1 else "two fingers"
    apart = f" {quantity(push.spread, 'm')} apart" if push.fingers == 2 else ""
    x, y, _ = push.direction_W
    if push.press:
        return (
            f"draw the {push.object} {phrase(math.atan2(y, x))}, pressed from above with "
            f"{quantity(push.press, 'N')} by one finger, at {quantity(push.speed, 'm/s')} "
            f"{_extent(push)}"
        )
    return (
        f"push the {push.object} with {fingers}{apart} on its {push.face} face, "
        f"{quantity(push.p_BC[2], 'm')} above the table, {phrase(math.atan2(y, x))}, "
        f"with at most {quantity(push.force_limit, 'N')} at {quantity(push.speed, 'm/s')} "
        f"{_extent(push)}"
    )


def _extent(push: Push) -> str:
    """Extent of a push: how far, or until when."""
    way = quantity(push.stroke, "m")
    event = {
        "moves": "until it moves",
        "touching": f"until it touches the {push.meets}",
        "tips": "until it begins to tip",
    }.get(push.until or "")
    angle = quantity(abs(push.turn), "rad")
    turned = f"{angle} to the {'left' if push.turn > 0.0 else 'right'}"
    if push.ends_on == "tilted":
        return f"{event or 'until it is tilted by ' + quantity(push.tilt, 'rad')}, then let it back"
    if event:
        return f"{event}, at most over {way}"
    if push.ends_on == "turned":
        return f"until it has turned by {turned}"
    if push.ends_on == "toppled":
        return f"until it falls, at most over {way}"
    return f"over {way}" + (f", turning it by {turned}" if round(push.turn, 3) else "")


def _guards(limits: Limits) -> str:
    """Guards that stop a push, in words."""
    told = []
    for clear in dict.fromkeys(clear for _, clear in limits.clear_of):
        names = [f"the {name}" for name, kept in limits.clear_of if kept == clear]
        told.append(f"comes closer than {quantity(clear, 'm')} to {join_words(names, 'or')}")
    if limits.tilt is not None:
        told.append(f"tilts by more than {quantity(limits.tilt, 'rad')}")
    if limits.turn is not None:
        told.append(f"turns by more than {quantity(limits.turn, 'rad')}")
    if limits.duration is not None:
        told.append(f"has been pushed for {quantity(limits.duration, 's')}")
    return join_words(told, "or")


def _end(plan: Plan, aim: Aim) -> str:
    """Place where everything leads, and how sure that is."""
    heading = "" if aim.yaw is None else f", heading {quantity(aim.yaw, 'rad')}"
    pushes = len(plan.pushes)
    sure = f" (probability of all {pushes} pushes {probability_text(plan.probability)})"
    return f"It should end at {place_text(aim.x, aim.y)}{heading}{sure if pushes > 1 else ''}."


_VERBS = {"slide": "slides", "topple": "topples", "none": "stays"}


def _prediction(push: PushAction) -> str:
    p = push.prediction
    if push.press:
        return (
            f"it goes along (probability {probability_text(p.probability)}), which takes "
            f"{quantity(p.onset, 'N')} along its top."
        )
    starts = [
        f"{verb} would start at {quantity(force, 'N')}"
        for verb, force in (("sliding", p.slide_force), ("toppling", p.topple_force))
        if force is not None
    ]
    verb = {
        "turned": "turns",
        "tilted": "tilts and stands again",
        "toppled": "topples",
    }.get(push.ends_on) or _VERBS.get(p.outcome, p.outcome)
    text = f"it {verb} (probability {probability_text(p.probability)}); {', '.join(starts)}."
    if p.critical_height is not None and p.critical_height_worst is not None:
        text += (
            f" Pushed above {quantity(p.critical_height, 'm')} it would topple instead of slide "
            f"({quantity(p.critical_height_worst, 'm')} in the worst case)."
        )
    elif p.topple_force is None:
        text += " It cannot topple this way."
    return text


def _safety(push: PushAction) -> str:
    """Margins between the push and the outcome that it must not have."""
    if push.press:
        return (
            f"the fingertip would slip over it with {quantity(push.margins.force, 'N')} more, as "
            "it is believed to be; that is seen, and ends it."
        )
    margins = push.margins
    plural = "" if margins.sigmas == 1 else "s"
    case = f"in the worst case of {margins.sigmas:g} standard deviation{plural}"
    case = f"{case if margins.sigmas else 'as it is believed to be'}, whichever way it is pressed"
    # A margin that would be told as 0.0 N is told otherwise.
    spare = quantity(margins.force, "N") if margins.force >= 0.05 else "less than 0.1 N"
    if push.prediction.critical_height is None:
        return f"anywhere on this face it slides before it topples; {spare} to spare, {case}."
    slides = push.prediction.outcome == "slide"
    where, other = ("below", "topple") if slides else ("above", "slide")
    return (
        f"the contact is {quantity(margins.height, 'm')} {where} where it could {other} instead, "
        f"and that would take {spare} more, {case}."
    )


def _push_reason(plan: Plan) -> str:
    push = plan.push
    x, y, _ = push.direction_W
    way = {
        "stroke": f"moves {phrase(math.atan2(y, x))}",
        "turned": "turns",
        "tilted": "tilts and stands again",
        "toppled": "falls over",
    }[push.ends_on]
    later = len(plan.pushes) - 1
    if push.press:
        return (
            f"Pressed from above with {quantity(push.press, 'N')}, the {push.object} {way} with "
            f"the fingertip: that takes {quantity(push.prediction.onset, 'N')} along its top, and "
            f"the fingertip slips only with {quantity(push.margins.force, 'N')} more."
        )
    more = f" It is the first of {later + 1} pushes, as foreseen." if later else ""
    return (
        f"Pushed on its {push.face} face, {quantity(push.p_BC[2], 'm')} above the table, the "
        f"{push.object} {way}, since {_other_outcome(push)}. "
        f"It starts to move at {quantity(push.prediction.onset, 'N')}, "
        f"so at most {quantity(push.force_limit, 'N')} are used.{more}"
    )


def _other_outcome(push: PushAction) -> str:
    """Height from which it would do something else."""
    p = push.prediction
    if p.critical_height is None or p.critical_height_worst is None:
        return "anywhere on that face it slides before it topples"
    verb, side = ("topple", "above") if p.outcome == "slide" else ("slide", "below")
    return (
        f"it would {verb} only when pushed {side} {quantity(p.critical_height, 'm')}, and "
        f"{side} {quantity(p.critical_height_worst, 'm')} in the worst case"
    )


def _push_figures(push: PushAction) -> dict[str, float]:
    p = push.prediction
    numbers = {
        "contact_height": push.p_BC[2],
        "critical_height": p.critical_height,
        "critical_height_worst": p.critical_height_worst,
        "margin_height": push.margins.height,
        "margin_force": push.margins.force,
        "onset_force": p.onset,
        "force_limit": push.force_limit,
        "press": push.press or None,
    }
    return {name: value for name, value in numbers.items() if value is not None}


def _hand_lines(plan: Plan) -> Iterator[str]:
    held = _holding(plan)
    yield f"Plan: {held}, then {steps_text(plan)}." if held else f"Plan: {steps_text(plan)}."
    yield f"  Predicted: {'; '.join(predicted_outcomes(plan))}."
    if why := plan_reasons(plan):
        yield f"  Why that works: {'; '.join(why)}."
    if plan.aim is not None:
        yield f"  It should end at {place_text(plan.aim.x, plan.aim.y)}."


def _hand_reason(plan: Plan) -> str:
    why = plan_reasons(plan) or predicted_outcomes(plan)
    return f"To {plan.task} the {plan.object}: {steps_text(plan)}; {'; '.join(why)}."


def _holding(plan: Plan) -> str:
    if plan.grasp is None:
        return ""
    if plan.grasp.held:
        return f"the {plan.object} is in the hand already"
    part = f"the {plan.object}"
    if plan.grasp.part == "lid":
        return f"hold the lid of {part} from above, with {quantity(plan.grasp.squeeze, 'N')}"
    return f"hold {part} {grasp_text(plan.grasp)}"


def grasp_text(grasp: Grasp) -> str:
    """Place and force of a grasp: "from its side, 60 mm above its base, with 4.5 N"."""
    where = f"{quantity(grasp.p_BG[2], 'm')} above its base"
    return f"{grasp.approach_text}, {where}, with {quantity(grasp.squeeze, 'N')}"


def steps_text(plan: Plan) -> str:
    """All that a hand does, one step after another."""
    return ", then ".join(_step(step, plan) for step in plan.steps)


def _step(step: Action, plan: Plan) -> str:
    what = f"the {plan.object}"
    match step:
        case LiftUp():
            verb = "lift" if step.height > 0.0 else "lower"
            up = f"{verb} it by {quantity(abs(step.height), 'm')}"
            return f"{up} and hold it" if step.hold else up
        case Carry():
            return f"carry it to {place_text(step.to.x, step.to.y)}"
        case TurnOver():
            return "turn it over onto its bottom"
        case PourOut():
            volume = "" if step.volume is None else f"{quantity(step.volume, 'm³')} "
            return (
                f"pour {volume}into the {step.into}, tilting it by up to "
                f"{quantity(step.angle, 'rad')} at {quantity(step.rate, 'rad/s')}"
            )
        case SetDown():
            return "set it down"
        case SetOn():
            return f"set it down {_where(step)} the {step.onto}"
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


def _where(step: SetOn) -> str:
    return "in" if step.inside else "on"


def predicted_outcomes(plan: Plan) -> list[str]:
    """Predictions of the models, in words."""
    told = [f"it succeeds with probability {probability_text(plan.probability)}"]
    for action in plan.actions:
        match action:
            case GraspAction():
                told.append(
                    f"the grasp holds with probability {probability_text(action.prediction.holds)}"
                )
            case PourOut():
                p = action.prediction
                told += (
                    f"{quantity(p.poured, 'm³')} run out of the {plan.object}",
                    f"{quantity(p.received, 'm³')} arrive in the {action.into}",
                    f"{quantity(p.spilled, 'm³')} are spilled",
                    f"{quantity(p.left, 'm³')} stay in it",
                    f"the {action.into} is then {100 * p.level_after:.0f} % full",
                )
            case SetOn():
                stands = probability_text(action.prediction.stands)
                told.append(
                    f"it stands {_where(action)} the {action.onto} with probability {stands}"
                )
            case FlipOver():
                told.append(f"the lid ends at {quantity(action.prediction.lid_angle, 'rad')}")
    return told


def plan_reasons(plan: Plan) -> list[str]:
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
            yield from _bearing_texts(action.prediction, name)
        case SetOn():
            margin = quantity(action.prediction.margin, "m")
            yield f"standing {_where(action)} the {action.onto}, it is {margin} from falling"
        case TurnCap():
            cap, turns = action.prediction, ""
            if cap.turning_torque is not None:
                turns = f", the {name} turns along from {quantity(cap.turning_torque, 'N·m')} on"
            yield f"the cap takes {quantity(cap.lid_torque, 'N·m')}{turns}"


def _bearing_texts(p: FlipPrediction, name: str) -> Iterator[str]:
    """Forces that the standing object bears while its lid is opened."""
    gives = [
        f"{verb} from {quantity(force, 'N')} on"
        for verb, force in (("slides", p.slide_force), ("topples", p.topple_force))
        if force is not None
    ]
    if gives:
        yield (
            f"at {quantity(p.nearest_angle, 'rad')}, where the {name} comes nearest to "
            f"giving way, it takes {quantity(p.nearest_force, 'N')}, and the {name} "
            f"{join_words(gives)}"
        )
