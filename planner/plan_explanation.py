"""Which words became which parameters of the controller: the way of a sentence as a table.

The rows go from the words over the field of the frame to the parameter and its value, as in
Figures 2 and 3 of the paper "Prediction of action outcomes using an object model": the verb picks
the controller, the noun the object model, "away" is the wanted outcome, "without toppling it" a
constraint. What the sentence did not say has no words, and what the table of defaults gave says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from pydantic import ConfigDict

from grammar.frames import command as g
from objectmodels.short_repr import ShortRepr
from planner.problem.directions import phrase
from planner.refusals.blocked import dead_end
from planner.types.actions import Carry, FlipOver, LiftUp, PourOut, TurnCap, TurnOver
from planner.types.plan import Plan
from planner.types.refusal import probability_text

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.defaults import Defaults
    from planner.types.plan import DefaultUsed
    from planner.types.refusal import Refusal
    from planner.types.world_state import SeenObject, WorldState


# The parts of a frame and the rows that explain them: words, field, parameter, value.
#
# A row goes from the words over the field of the frame to the parameter of the controller and its
# value. The parts bear the names of Figure 2 of the paper "Prediction of action outcomes using an
# object model". Values are SI inside; people read millimetres, degrees and newtons.

PartName = Literal[
    "push controller",
    "hand controller",
    "controller",
    "question",
    "remark",
    "object model",
    "wanted outcome",
    "constraint",
    "left open",
    "filler",
]


class Row(ShortRepr):
    """The way of some words into the controller.

    Attributes:
        words: as they stand in the sentence; empty if it did not say so.
        field: of the frame that they set.
        parameter: of the controller that follows; empty if nothing does.
        value: with its unit.
        spans: where the words stand.
        frame: which frame of the sentence, from 0.
        part: of the way from words to a push, as the paper calls it.
        default: whether the value comes from what stands for words that were not said.
        problem: whether these words are why there is no plan.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid")

    words: str
    field: str
    parameter: str
    value: str
    spans: g.Spans = ()
    frame: int = 0
    part: PartName = "left open"
    default: bool = False
    problem: bool = False


class Clause(NamedTuple):
    """A part of a frame: what the paper calls it, how it reads, where it stands, and itself."""

    part: PartName
    field: str
    spans: g.Spans
    said: Any


class Value(NamedTuple):
    """A parameter with its value.

    Attributes:
        parameter: of the controller, of the object model or of an answer.
        value: with its unit.
        default: whether the number comes from the table of defaults, or was chosen.
        said: whether words led to it; words may say "a little", and the table how much that is.
    """

    parameter: str
    value: str
    default: bool = False
    said: bool = True


def frame_clauses(frame: g.Frame, controller: PartName = "controller") -> Iterator[Clause]:
    """The parts of a frame: its head, its object, its goal, its constraints."""
    named_so = {key: getattr(frame, key) for key in ("query", "dialogue", "action", "event")}
    head = [f"{key}: {said}" for key, said in named_so.items() if said is not None]
    yield Clause(controller, ", ".join(head), frame.spans, None)
    if frame.object is not None:
        yield Clause(
            "object model", f"object: {object_name(frame.object)}", frame.object.spans, None
        )
    if frame.goal.kind != "none" or frame.goal.spans:
        yield Clause(
            "wanted outcome", f"goal: {clause_text(frame.goal)}", frame.goal.spans, frame.goal
        )
    for said in frame.constraints:
        yield Clause("constraint", f"constraint: {clause_text(said)}", said.spans, said)


def row(clause: Clause, text: str, value: Value, **more: Any) -> Row:
    """The row of a clause of the sentence `text` and a value of it, with `more` fields."""
    spans = clause.spans if value.said else ()
    return Row(
        words=quotation(text, spans),
        field=clause.field,
        spans=spans,
        part=clause.part,
        parameter=value.parameter,
        value=value.value,
        default=value.default,
        **more,
    )


def plan_rows(
    frame: g.Frame, text: str, controller: PartName, values: Callable[[Clause], Iterable[Value]]
) -> tuple[Row, ...]:
    """The rows of a planned frame: the values of each of its parts, and of what it left open."""
    left_open = Clause("left open", "controller", (), None)
    clauses = (*frame_clauses(frame, controller), left_open)
    return tuple(row(clause, text, value) for clause in clauses for value in values(clause))


def amount_value(name: str, told: str, used: DefaultUsed | None) -> Value:
    """A number, and whether it comes from the table of defaults."""
    if used is None:
        return Value(name, told)
    # Words may name an amount, but what number that is stands in the table.
    in_words = used.reason.startswith("“")
    why = f"{used.reason}, from the table of defaults" if in_words else "not said: by default"
    return Value(name, f"{told} ({why})", default=True, said=in_words)


def outcome_value(does: str, plan: Plan) -> Value:
    """The outcome of a plan, and how likely it is."""
    return Value("outcome", f"{does}, probability {probability_text(plan.probability)}")


def place_text(x: float, y: float) -> str:
    """A point of the table in words, from its coordinates in W [m]."""
    return f"x {si_text(x, 'm')}, y {si_text(y, 'm')}"


def quotation(text: str, spans: g.Spans) -> str:
    """The words that spans cover, in their order; a dash stands for other words between them."""
    told, last = "", 0
    for start, end in sorted(spans):
        if told and start > last:
            told += " … " if text[last:start].strip(" ,") else " "
        told += text[max(start, last) : max(end, last)]
        last = max(end, last)
    return told


_UNITS = {
    "distance": "m",
    "clearance": "m",
    "height": "m",
    "x": "m",
    "y": "m",
    "angle": "rad",
    "heading": "rad",
    "volume": "m³",
}
"""Units of fields; the class of a constraint knows that of its `value`."""


def clause_text(part: Any) -> str:
    """A goal or a constraint in words: its kind, and each field that was said."""
    told = part.kind
    for key, info in type(part).model_fields.items():
        value = getattr(part, key)
        if key in ("kind", "spans") or value == info.get_default():
            continue
        if key == "value":
            told += f", {si_text(value, part.words.unit)}"
        else:
            told += f", {key} {_field(value, key)}"
    return str(told)


def _field(value: Any, name: str) -> str:
    match value:
        case None:
            return "anything"
        case g.ObjectRef():
            return object_name(value)
        case g.RelativeLength():
            whose = value.of.text if value.of.pronoun else f"{object_name(value.of)}'s"
            return f"{value.value:g} × {whose} {value.side or 'width'}"
        case g.ContactHeight():
            bound = "" if value.bound == "exact" else f"{value.bound.replace('_', ' ')} "
            where = "above the table" if value.origin == "table" else "below the top"
            return f"{bound}{_field(value.value, 'height')} {where}"
        case g.Point():
            return place_text(value.x, value.y)
        case tuple():
            return " and ".join(_field(each, name) for each in value)
        case float():
            return si_text(value, _UNITS.get(name, ""))
    return str(value).replace("_", " ")


def object_name(ref: g.ObjectRef) -> str:
    """An object by its name in the scene; as it was said, if that is not known."""
    return ref.id or ref.text


def si_text(value: float, unit: str) -> str:
    """An SI value as people read it, in whole millimetres, millilitres and degrees."""
    if unit in ("m", "m/s"):
        return f"{round(1e3 * value) + 0.0:.0f} m{unit}"  # never −0
    if unit == "m³":
        return f"{1e6 * value:.0f} ml"
    if unit == "rad/s":
        return f"{math.degrees(value):.0f}°/s"
    return f"{math.degrees(value):.0f}°" if unit == "rad" else f"{value:g} {unit}".rstrip()


@dataclass(frozen=True)
class Basis:
    """Knowledge with which a frame was planned or answered.

    Attributes:
        target: the object as it was believed to be.
        defaults: what a clause means when the sentence does not say more.
    """

    target: SeenObject
    defaults: Defaults

    @classmethod
    def of(cls, frame: g.Frame, state: WorldState, defaults: Defaults) -> Basis | None:
        """The basis of a frame about an object; None if it has none that is seen."""
        seen = state.objects.get(frame.object.id or "") if frame.object else None
        return cls(seen, defaults) if seen else None

    def fall(self, frame: g.Frame, state: WorldState) -> Refusal | None:
        """The refusal to go on with what fell meanwhile, if it is not to be stood up; else None."""
        here = state.objects[self.target.name]
        if here.lies_on == self.target.lies_on or isinstance(frame.goal, g.Upright):
            return None
        return dead_end("fell", object=here.name, side=here.side_below).refusal


def explain_push(frame: g.Frame, plan: Plan, text: str, basis: Basis) -> tuple[Row, ...]:
    """The rows of a frame of a sentence that pushes carry out, from its plan."""

    def values(clause: Clause) -> Iterable[Value]:
        match clause.part:
            case "push controller":
                return _push_controller(plan)
            case "object model":
                return (*belief_values(basis.target), *_prediction_values(plan))
            case "wanted outcome":
                return _goal(frame.goal, plan, basis)
            case "left open":
                return _push_open_values(frame, plan)
        return _constraint_values(clause.said, plan, basis)

    return plan_rows(frame, text, "push controller", values)


def belief_values(target: SeenObject) -> tuple[Value, ...]:
    """The numbers of an object model, with their standard deviations."""
    model = target.model
    sizes = " × ".join(f"{1e3 * side:.0f}" for side in model.extents)
    return (
        Value("mass", f"{_with_sd(model.mass, model.mass_sd)} kg"),
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


def _push_controller(plan: Plan) -> Iterator[Value]:
    does = "press from above and draw" if plan.push.press else "push"
    yield Value("controller", f"{does} with {_fingers(plan)}, until {_until(plan.push)}")
    then = [f"{push.face} face, until {_until(push)}" for push in plan.pushes[1:]]
    if then:
        yield Value("pushes", f"{1 + len(then)} foreseen; then {'; then '.join(then)}")


def _until(push: Push) -> str:
    """When a push ends."""
    if push.until is not None:
        return _EVENTS[push.until].format(push.meets)
    return {
        "stroke": f"it has gone {si_text(push.stroke, 'm')}",
        "turned": f"it has turned by {_turn(push.turn)}",
        "tilted": f"it is tilted by {si_text(push.tilt, 'rad')}, then let it back",
        "toppled": "it falls by itself",
    }[push.ends_on]


_EVENTS = {"moves": "it moves", "touching": "it touches the {}"}


def _turn(angle: float) -> str:
    return f"{si_text(abs(angle), 'rad')} to the {'left' if angle > 0.0 else 'right'}"


def _fingers(plan: Plan) -> str:
    push = plan.push
    return "one finger" if push.fingers == 1 else f"two fingers {si_text(push.spread, 'm')} apart"


def _prediction_values(plan: Plan) -> Iterator[Value]:
    p = plan.push.prediction
    yield Value("moves from", f"{p.onset:.1f} N on")
    if p.critical_height is not None:
        yield Value("tips if pushed above", si_text(p.critical_height, "m"))
    yield Value("falls by itself beyond", si_text(p.stay_on_base_angle, "rad"))


def _goal(goal: g.Goal, plan: Plan, basis: Basis) -> Iterator[Value]:
    used = {default.name: default for default in plan.defaults}
    last = plan.pushes[-1]
    does = {"turned": "turn", "tilted": "tilt"}.get(last.ends_on, last.prediction.outcome)
    yield outcome_value(does, plan)
    if plan.aim is None:
        yield _direction(goal, last.direction_W[:2], used)
        if last.ends_on == "tilted":
            yield amount_value("tilt", si_text(last.tilt, "rad"), used.get("tilt"))
        return
    aim, here = plan.aim, basis.target.pose
    if isinstance(goal, g.Rotate):
        assert aim.yaw is not None, "what is to turn has a heading"
        angle = aim.yaw - here.yaw
        told = _turn(angle)
        if goal.angle is not None and not math.isclose(goal.angle, abs(angle)):
            told += f", asked: {_bound_text(goal.bound)}{si_text(goal.angle, 'rad')}"
        yield amount_value("turn", told, used.get("turn"))
    else:
        way = aim.x - here.x, aim.y - here.y
        yield _direction(goal, way, used)
        yield _distance_value(goal, math.hypot(*way), used.get("distance"))
    heading = "" if aim.yaw is None else f", heading {si_text(aim.yaw, 'rad')}"
    yield Value("aim", place_text(aim.x, aim.y) + heading)


def _direction(goal: g.Goal, way: tuple[float, float], used: dict[str, DefaultUsed]) -> Value:
    told = phrase(math.atan2(way[1], way[0]))
    if "direction" in used:
        return Value("direction", f"{told} (not said: by default)", default=True, said=False)
    if isinstance(goal, g.Topple | g.Tilt) and goal.direction is None:
        return Value("direction", f"{told} (not said: chosen)", default=True, said=False)
    return Value("direction", told)


def _distance_value(goal: g.Goal, length: float, used: DefaultUsed | None) -> Value:
    told = si_text(length, "m")
    if used is not None and math.isclose(used.value, length):
        return amount_value("distance", told, used)
    asked = getattr(goal, "distance", None)
    # The distance of a place is a gap.
    if isinstance(goal, g.Displace) and asked is not None and not math.isclose(asked, length):
        return Value("distance", f"{told}, asked: {_bound_text(goal.bound)}{si_text(asked, 'm')}")
    return Value("distance", told)


def _bound_text(bound: g.Bound) -> str:
    return "" if bound == "exact" else f"{bound.replace('_', ' ')} "


def _constraint_values(clause: Any, plan: Plan, basis: Basis) -> Iterator[Value]:
    push, defaults = plan.push, basis.defaults
    match clause:
        case g.NoTopple() | g.NoTilt():
            yield Value("contact height", si_text(push.p_BC[2], "m"))
            yield Value("margin", _margin_text(plan))
            most, share = defaults.no_tilt, ""
            if clause.kind == "no_topple":
                most = defaults.no_topple_share * push.prediction.stay_on_base_angle
                share = f", {100 * defaults.no_topple_share:.0f} % of where it falls by itself"
            yield Value("largest tilt", f"{si_text(most, 'rad')}{share}")
        case g.NoTurn():
            yield Value("contact", f"{_fingers(plan)}, around the middle of the {push.face} face")
            yield Value("largest turn", si_text(defaults.no_turn, "rad"))
        case g.NoTouch():
            other = object_name(clause.object) if clause.object else "everything"
            yield Value("free way", f"{si_text(defaults.clearance, 'm')} or more from the {other}")
        case g.ContactRegion():
            yield Value("contact", _contact_text(plan))
            top, height = basis.target.model.top, clause.height
            if clause.region is not None:
                third = ("bottom", "middle", "top").index(clause.region)
                low, high = (f"{1e3 * top * k / 3:.0f}" for k in (third, third + 1))
                yield Value("heights allowed", f"{low} to {high} mm, a third of its side")
            if height is not None and isinstance(height.value, float):
                at = height.value if height.origin == "table" else top - height.value
                upwards = (height.bound == "at_least") == (height.origin == "table")
                bound = "" if height.bound == "exact" else f"at {'least' if upwards else 'most'} "
                yield Value("heights allowed", f"{bound}{si_text(at, 'm')}")
        case g.Effector():
            yield Value("fingers", _fingers(plan))
        case g.Gentle():
            yield _speed_value(plan, basis, "gentle")
            more = f"{100 * defaults.force_reserve_gentle:.0f} % above what is needed"
            yield Value("force limit", f"{_force_text(plan)}, {more}")
        case g.Slow():
            yield _speed_value(plan, basis, "slow")
        case _:
            yield Value(*(_force_value(clause, plan, defaults) or _limit_value(clause, plan)))
            if clause.kind in _TIMES and push.limits.duration is not None:
                yield Value("stopped after", si_text(push.limits.duration, "s"))


_SPEEDS = {"speed", "min_speed", "fast"}
_TIMES = {"duration", "max_duration"}


def _force_value(clause: Any, plan: Plan, defaults: Defaults) -> tuple[str, str] | None:
    """The parameter and value of a clause about the force; None of any other clause."""
    told = {
        "force": "",
        "max_force": ", asked: at most {:g} N",
        "min_force": ", ready to press with {:g} N",
        "hard": ", ready to press with {:g} N",
    }.get(clause.kind)
    if told is None:
        return None
    value = defaults.force_hard if clause.kind == "hard" else clause.value
    return "force limit", _force_text(plan) + told.format(value)


def _limit_value(clause: Any, plan: Plan) -> tuple[str, str]:
    """The parameter and value of a clause about speed, time, way or end."""
    push = plan.push
    match clause:
        case g.MaxSpeed():
            asked = si_text(clause.value, "m/s")
            return "largest speed", f"{si_text(push.speed, 'm/s')}, asked: at most {asked}"
        case _ if clause.kind in _SPEEDS | _TIMES:
            return "largest speed", si_text(push.speed, "m/s")
        case g.MaxDistance():
            asked = si_text(clause.value, "m")
            return "distance", f"{si_text(push.stroke, 'm')}, asked: at most {asked}"
        case g.MaxTilt():
            return "stopped at a tilt of", si_text(clause.value, "rad")
        case g.MaxTurn():
            return "stopped at a turn of", si_text(clause.value, "rad")
        case g.Until():
            return "ends", f"when {_until(plan.pushes[-1])}"
    return "kept", clause_text(clause)


def _margin_text(plan: Plan) -> str:
    if plan.push.press:
        return f"{plan.push.margins.force:.1f} N before the fingertip slips"
    if plan.push.prediction.critical_height is None:
        return "it slides before it tips, anywhere on this face"
    return f"{si_text(plan.push.margins.height, 'm')} below where it may tip"


def _speed_value(plan: Plan, basis: Basis, degree: str) -> Value:
    told = si_text(plan.push.speed, "m/s")
    if not math.isclose(plan.push.speed, basis.defaults.speed_gentle):
        return Value("largest speed", told)
    return Value("largest speed", f"{told} ({degree}, from the table of defaults)", default=True)


def _push_open_values(frame: g.Frame, plan: Plan) -> Iterator[Value]:
    """Values that no clause of the sentence decided."""
    said = {clause.kind for clause in frame.constraints}
    push = plan.push
    if any(default.name == "speed" for default in plan.defaults):
        speed = si_text(push.speed, "m/s")
        yield Value("largest speed", f"{speed} (not said: by default)", default=True, said=False)
    if "contact" not in said:
        yield Value("contact", _contact_text(plan), default=True)
    if not said & {"max_force", "gentle", "force", "min_force", "hard"}:
        yield Value("force limit", _force_text(plan), default=True)
    if push.ends_on in {"toppled", "tilted"}:
        yield Value("longest stroke", si_text(push.stroke, "m"), default=True)


def _contact_text(plan: Plan) -> str:
    if plan.push.press:
        return f"top face, pressed with {plan.push.press:.1f} N"
    return f"{plan.push.face} face, {si_text(plan.push.p_BC[2], 'm')} above the table"


def _force_text(plan: Plan) -> str:
    return f"{plan.push.force_limit:.1f} N"


def explain_hand(frame: g.Frame, plan: Plan, text: str, basis: Basis) -> tuple[Row, ...]:
    """The rows of a frame of a sentence that a whole hand carries out, from its plan."""

    def values(clause: Clause) -> Iterable[Value]:
        match clause.part:
            case "hand controller":
                return _grasp_controller(plan)
            case "object model":
                return belief_values(basis.target)
            case "wanted outcome":
                return _outcome(plan)
            case "left open":
                return _grasp_open_values(plan)
        return _constraint(clause.said, plan)

    return plan_rows(frame, text, "hand controller", values)


def _grasp_controller(plan: Plan) -> Iterator[Value]:
    steps = ", ".join(step.kind.replace("_", " ") for step in plan.steps)
    grasp = plan.grasp
    if grasp is None:
        yield Value("controller", f"with a fingertip: {steps}")
        return
    yield Value("controller", f"with the whole hand: {steps}")
    part = "its lid " if grasp.part == "lid" else ""
    yield Value(
        "grasp", f"{part}{grasp.approach_text}, {si_text(grasp.p_BG[2], 'm')} above its base"
    )
    least, most = f"{grasp.needed:.1f} N just hold", f"the fingers have {grasp.strongest:.1f} N"
    yield Value("squeeze", f"{grasp.squeeze:.1f} N; {least}, {most}")


def _outcome(plan: Plan) -> Iterator[Value]:
    yield outcome_value(plan.task, plan)

    def from_table(prefix: str) -> DefaultUsed | None:
        return next((each for each in plan.defaults if each.name.startswith(prefix)), None)

    for step in plan.steps:
        match step:
            case LiftUp() if plan.task == "lift":
                yield amount_value("height", si_text(step.height, "m"), from_table("lift_"))
            case TurnOver():
                yield Value("turned over", si_text(step.angle, "rad"))
            case PourOut():
                volume = "everything" if step.volume is None else si_text(step.volume, "m³")
                yield amount_value("volume", volume, from_table("pour_"))
                yield Value("tilt", f"up to {si_text(step.angle, 'rad')}")
            case FlipOver():
                yield Value("lid", f"{si_text(step.start, 'rad')} to {si_text(step.end, 'rad')}")
            case TurnCap():
                yield Value("turn", si_text(abs(step.angle), "rad"))
            case Carry():
                yield Value("aim", place_text(step.to.x, step.to.y))


def _constraint(clause: Any, plan: Plan) -> Iterator[Value]:
    match clause:
        case g.NoTouch():
            other = object_name(clause.object) if clause.object else "everything"
            kept = dict(plan.limits.clear_of)
            apart = max(kept.values(), default=0.0)
            yield Value("free way", f"{si_text(apart, 'm')} or more from the {other}")
        case g.NoSpill() if pours := [a for a in plan.actions if isinstance(a, PourOut)]:
            yield Value("spilled", f"{si_text(pours[0].prediction.spilled, 'm³')} foreseen")
        case g.Gentle() | g.Slow() | g.MaxSpeed() | g.Speed() | g.MinSpeed() if (
            plan.speed is not None
        ):
            yield Value("largest speed", si_text(plan.speed, "m/s"))
        case g.MaxForce() | g.Force() if plan.grasp is not None:
            yield Value("squeeze", f"{plan.grasp.squeeze:.1f} N")
        case g.ContactRegion() if plan.grasp is not None:
            yield Value("grasp", f"{si_text(plan.grasp.p_BG[2], 'm')} above its base")
        case _:
            yield Value("kept", clause_text(clause))


def _grasp_open_values(plan: Plan) -> Iterator[Value]:
    """Values that no clause of the sentence decided."""
    if plan.speed and any(used.name == "carry_speed" for used in plan.defaults):
        speed = si_text(plan.speed, "m/s")
        yield Value("largest speed", f"{speed} (not said: by default)", default=True, said=False)
