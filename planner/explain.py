"""Which words became which parameters of the controller: the way of a sentence as a table.

The rows go from the words over the field of the frame to the parameter and its value, as in
Figures 2 and 3 of the paper "Prediction of action outcomes using an object model": the verb picks
the controller, the noun the object model, "away" is the wanted outcome, "without toppling it" a
constraint. What the sentence did not say has no words, and what the table of defaults gave says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from grammar import frames as g
from planner.directions import phrase
from planner.rows import Clause, Row, Value, clauses, named, read, row, shown

if TYPE_CHECKING:
    from planner.defaults import Defaults
    from planner.plan import DefaultUsed, Plan
    from planner.state import SeenObject, WorldState


@dataclass(frozen=True)
class Basis:
    """What was known when a frame was planned or answered.

    Attributes:
        target: the object as it was believed to be.
        defaults: what a clause means when the sentence does not say more.
    """

    target: SeenObject
    defaults: Defaults

    @classmethod
    def of(cls, frame: g.Frame, state: WorldState, defaults: Defaults) -> Basis | None:
        """What is known about the object of a frame; None if it has none that is seen."""
        seen = state.objects.get(frame.object.id or "") if frame.object else None
        return cls(seen, defaults) if seen else None


def explain(frame: g.Frame, plan: Plan, text: str, basis: Basis) -> tuple[Row, ...]:
    """The rows of a planned frame: its head, its object, its goal, its constraints, and the rest.

    Args:
        frame: what was asked.
        plan: what came of it.
        text: the sentence.
        basis: what was known when it was planned.
    """
    rows: list[Row] = []
    for clause in clauses(frame, "push controller"):
        values: Iterable[Value]
        if clause.part == "push controller":
            values = _controller(plan)
        elif clause.part == "object model":
            values = (*believed(basis.target), *_predicted(plan))
        elif clause.part == "wanted outcome":
            values = _goal(frame.goal, plan)
        else:
            values = _constraint(clause.said, plan, basis)
        rows += [row(clause, text, value) for value in values]
    rest = Clause("left open", "controller", (), None)
    return (*rows, *(row(rest, text, value) for value in _rest(frame, plan)))


def believed(target: SeenObject) -> tuple[Value, ...]:
    """The numbers of an object model, with their standard deviations."""
    model = target.model
    sizes = " × ".join(f"{1e3 * side:.0f}" for side in model.extents)
    return (
        Value("weight", f"{_with_sd(model.mass, model.mass_sd)} kg"),
        Value("friction on the table", _with_sd(model.friction, model.friction_sd)),
        Value("friction at the finger", _with_sd(model.finger_friction, model.finger_friction_sd)),
        Value("size", f"{sizes} mm"),
        Value(
            "centre of mass",
            f"{_with_sd(1e3 * model.com[2], 1e3 * model.com_sd[2], digits=0)} mm high",
        ),
    )


def _with_sd(value: float, sd: float, *, digits: int = 3) -> str:
    # As decimals: 0.0375 lies half-way as it stands in a model file, but below that as a float.
    text, spread = (f"{Decimal(repr(float(x))):.{digits}f}" for x in (value, sd))
    return f"{text} ± {spread}" if sd else text


def _controller(plan: Plan) -> tuple[Value, ...]:
    until = {
        "tilted": f"it is tilted by {shown(plan.push.tilt, 'rad')}, then let it back",
        "toppled": "it falls by itself",
    }.get(plan.push.ends_on, "its stroke is done")
    return (Value("controller", f"push with {_fingers(plan)}, until {until}"),)


def _fingers(plan: Plan) -> str:
    push = plan.push
    return "one finger" if push.fingers == 1 else f"two fingers {shown(push.spread, 'm')} apart"


def _predicted(plan: Plan) -> Iterator[Value]:
    p = plan.prediction
    yield Value("moves from", f"{p.onset:.1f} N on")
    if p.critical_height is not None:
        yield Value("tips if pushed above", shown(p.critical_height, "m"))
    yield Value("falls by itself beyond", shown(p.stay_on_base_angle, "rad"))


def _goal(goal: g.Goal, plan: Plan) -> Iterator[Value]:
    used = {default.name: default for default in plan.defaults}
    push, p = plan.push, plan.prediction
    x, y, _ = push.direction_W
    likely = "over 0.999" if p.probability > 0.999 else f"{p.probability:.3f}"
    yield Value("outcome", f"{p.outcome}, probability {likely}")
    way = phrase(math.atan2(y, x))
    if "direction" in used:
        yield Value("direction", f"{way} (not said: by default)", default=True, said=False)
    elif isinstance(goal, g.Topple | g.Tilt) and goal.direction is None:
        yield Value("direction", f"{way} (not said: chosen)", default=True, said=False)
    else:
        yield Value("direction", way)
    if push.ends_on == "stroke":
        yield _distance(goal, push.stroke, used.get("distance"))
    if push.ends_on == "tilted":
        yield _tilt(push.tilt, used.get("tilt"))


def _tilt(angle: float, used: DefaultUsed | None) -> Value:
    told = shown(angle, "rad")
    if used is None:
        return Value("tilt", told)
    in_words = used.reason.startswith("“")
    why = f"{used.reason}, from the table of defaults" if in_words else "not said: by default"
    return Value("tilt", f"{told} ({why})", default=True, said=in_words)


def _distance(goal: g.Goal, stroke: float, used: DefaultUsed | None) -> Value:
    told = shown(stroke, "m")
    if used is not None and math.isclose(used.value, stroke):
        # Words may name an amount, but what number that is stands in the table.
        in_words = used.reason.startswith("“")
        why = f"{used.reason}, from the table of defaults" if in_words else "not said: by default"
        return Value("distance", f"{told} ({why})", default=True, said=in_words)
    asked = getattr(goal, "distance", None)
    if used is None and asked is not None and not math.isclose(asked, stroke):
        bound = getattr(goal, "bound", "exact").replace("_", " ").removeprefix("exact")
        return Value("distance", f"{told}, asked: {bound} {shown(asked, 'm')}".replace("  ", " "))
    return Value("distance", told)


def _constraint(clause: Any, plan: Plan, basis: Basis) -> Iterator[Value]:
    push, defaults = plan.push, basis.defaults
    match clause:
        case g.NoTopple() | g.NoTilt():
            yield Value("contact height", shown(push.p_BC[2], "m"))
            yield Value("margin", _margin(plan))
            most, share = defaults.no_tilt, ""
            if clause.kind == "no_topple":
                most = defaults.no_topple_share * plan.prediction.stay_on_base_angle
                share = f", {100 * defaults.no_topple_share:.0f} % of where it falls by itself"
            yield Value("largest tilt", f"{shown(most, 'rad')}{share}")
        case g.NoTurn():
            yield Value("contact", f"{_fingers(plan)}, around the middle of the {push.face} face")
            yield Value("largest turn", shown(defaults.no_turn, "rad"))
        case g.NoTouch():
            other = named(clause.object) if clause.object else "everything"
            yield Value(
                "free way", f"{shown(basis.defaults.clearance, 'm')} or more from the {other}"
            )
        case g.ContactRegion():
            yield Value("contact", _contact(plan))
            yield from _heights(clause, basis)
        case g.MaxForce():
            yield Value("force limit", f"{_force(plan)}, asked: at most {clause.value:g} N")
        case g.Gentle():
            yield _speed(plan, basis, "gentle")
            more = f"{100 * defaults.force_reserve_gentle:.0f} % above what is needed"
            yield Value("force limit", f"{_force(plan)}, {more}")
        case g.Slow():
            yield _speed(plan, basis, "slow")
        case g.MaxSpeed():
            told = f"{shown(push.speed, 'm/s')}, asked: at most {shown(clause.value, 'm/s')}"
            yield Value("largest speed", told)
        case g.MaxDistance():
            told = f"{shown(push.stroke, 'm')}, asked: at most {shown(clause.value, 'm')}"
            yield Value("distance", told)
        case g.Effector():
            yield Value("fingers", _fingers(plan))
        case _:
            yield Value("kept", read(clause))


def _margin(plan: Plan) -> str:
    if plan.prediction.critical_height is None:
        return "no push on this face tips it"
    return f"{shown(plan.margins.height, 'm')} below where it may tip"


def _heights(clause: g.ContactRegion, basis: Basis) -> Iterator[Value]:
    """The heights that a clause allows."""
    top, height = basis.target.model.top, clause.height
    if clause.region is not None:
        third = ("bottom", "middle", "top").index(clause.region)
        low, high = (f"{1e3 * top * k / 3:.0f}" for k in (third, third + 1))
        yield Value("heights allowed", f"{low} to {high} mm, a third of its side")
    if height is not None and isinstance(height.value, float):
        at = height.value if height.origin == "table" else top - height.value
        upwards = (height.bound == "at_least") == (height.origin == "table")
        bound = "" if height.bound == "exact" else f"at {'least' if upwards else 'most'} "
        yield Value("heights allowed", f"{bound}{shown(at, 'm')}")


def _speed(plan: Plan, basis: Basis, degree: str) -> Value:
    told = shown(plan.push.speed, "m/s")
    if not math.isclose(plan.push.speed, basis.defaults.speed_gentle):
        return Value("largest speed", told)
    return Value("largest speed", f"{told} ({degree}, from the table of defaults)", default=True)


def _rest(frame: g.Frame, plan: Plan) -> Iterator[Value]:
    """What no clause of the sentence decided."""
    said = {clause.kind for clause in frame.constraints}
    push = plan.push
    if any(default.name == "speed" for default in plan.defaults):
        speed = shown(push.speed, "m/s")
        yield Value("largest speed", f"{speed} (not said: by default)", default=True, said=False)
    if "contact" not in said:
        yield Value("contact", _contact(plan), default=True)
    if not said & {"max_force", "gentle"}:
        yield Value("force limit", _force(plan), default=True)
    if push.ends_on in {"toppled", "tilted"}:
        yield Value("longest stroke", shown(push.stroke, "m"), default=True)


def _contact(plan: Plan) -> str:
    return f"{plan.push.face} face, {shown(plan.push.p_BC[2], 'm')} above the table"


def _force(plan: Plan) -> str:
    return f"{plan.push.force_limit:.1f} N"
