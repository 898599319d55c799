"""What the robot sees on the table, and which of two objects has more of something."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import ControlError, error, whole_span
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.push_questions import target_of
from nlcontrol.references.object_names import gap_between, name_words, stands_in_relation
from nlcontrol.references.reference_search import relation_text
from nlcontrol.text_format import join_words, place_text, quantity, with_sd_text
from planner import plan
from planner.problem.footprints import footprint
from planner.types.plan import Plan
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import SeenObject, WorldState


# Believed values of an object: weight, friction, size, place, with where the figures come from.
#
# The width of an object is what it measures from left to right as it stands, its length what it
# measures away from the robot.


Told = tuple[str, dict[str, float]]

EVERYTHING = ("mass", "friction", "size")
"""What is told if a question names no property."""

_SEEN = {"position", "load", "support"}


def property_answer(frame: g.Frame, state: WorldState, position_sd: float) -> Answer:
    """The believed values that a question asks for, given how well positions are seen [m].

    Raises:
        ControlError: `unsupported` if a property is none that is known of objects.
    """
    target, goal = target_of(frame, state), frame.goal
    which = goal.which if isinstance(goal, g.Parameters) else ()
    parts: list[str] = []
    numbers: dict[str, float] = {}
    for name in which or EVERYTHING:
        if name == "position":
            text, figures = _position(target, position_sd)
        elif name == "load" or (name == "fill" and target.model.inside is not None):
            text, figures = _load(target, state)
        elif name == "support":
            text, figures = f"stands {standing_text(target, state)}", {"height": target.pose.z}
        elif name == "fill" and target.model.vessel is not None:
            text, figures = _fill(target)
        elif name in _TOLD:
            text, figures = _TOLD[name](target)
        else:
            raise _unknown(name, target, goal.spans or frame.spans)
        parts.append(text)
        numbers |= figures
    seen = _SEEN if target.model.inside is None else _SEEN | {"fill"}
    source = "" if which and set(which) <= seen else f" ({_source(target, which or EVERYTHING)})"
    text = f"The {target.name} {join_words(parts)}{source}."
    return Answer(query="value", text=text, numbers=numbers)


def _unknown(name: str, target: SeenObject, spans: g.Spans) -> ControlError:
    known = ", ".join(word.replace("_", " ") for word in (*_TOLD, "position"))
    words = f"the {name.replace('_', ' ')} of objects"
    if name == "fill":
        words = f"what is in the {target.name}"
    return error(
        "unsupported",
        f"the model of the {target.name} does not say {words}",
        span=whole_span(spans),
        capability=f"knowing {words}",
        suggestions=(f"ask for one of: {known}",),
    )


def _source(target: SeenObject, which: tuple[str, ...]) -> str:
    """Source of the figures, in a few words; only weight and friction are found by trials."""
    found = target.model.provenance
    tried = found.trials is not None and not {"mass", "friction"}.isdisjoint(which)
    return f"source: {found.source}{f', {found.trials} trials' if tried else ''}"


def _mass(target: SeenObject) -> Told:
    m = target.model
    return f"weighs {with_sd_text(m.mass, m.mass_sd, ' kg')}", {
        "mass": m.mass,
        "mass_sd": m.mass_sd,
    }


def _friction(target: SeenObject) -> Told:
    m = target.model
    text = f"has a friction coefficient of {with_sd_text(m.friction, m.friction_sd)} on the table"
    return text, {"friction": m.friction, "friction_sd": m.friction_sd}


def _fill(target: SeenObject) -> Told:
    container, vessel = target.model.container, target.model.vessel
    assert container is not None
    assert vessel is not None, "what is full or not is hollow"
    has, sd = container.contents, container.contents_sd
    spread = f" ± {quantity(sd, 'm³')}" if sd else ""
    share = has / vessel.capacity
    text = f"holds {quantity(has, 'm³')}{spread}, {100 * share:.0f} % of what fits into it"
    figures = {"contents": has, "contents_sd": sd, "fill": share, "capacity": vessel.capacity}
    return text, figures


def _extents(target: SeenObject) -> dict[str, float]:
    x, y, z = target.model.extents
    if abs(math.sin(target.pose.yaw)) > abs(math.cos(target.pose.yaw)):
        x, y = y, x
    return {"length": x, "width": y, "height": z}


def _side(name: str, words: str) -> Callable[[SeenObject], Told]:
    def describe(target: SeenObject) -> Told:
        length = _extents(target)[name]
        return f"is {quantity(length, 'm')} {words}", {name: length}

    return describe


def _size(target: SeenObject) -> Told:
    sides = _extents(target)
    x, y, z = (quantity(sides[name], "m") for name in ("length", "width", "height"))
    return f"is {z} high, {y} wide and {x} deep as it stands", sides


def _centre_of_mass(target: SeenObject) -> Told:
    names = ("com_x", "com_y", "com_z")
    model = target.model
    figures = dict(zip(names, model.com, strict=True))
    figures |= {f"{name}_sd": sd for name, sd in zip(names, model.com_sd, strict=True)}
    height = f"{quantity(model.com[2], 'm')} ± {quantity(model.com_sd[2], 'm')}"
    aside = quantity(math.hypot(*model.com[:2]), "m")
    spread = quantity(max(model.com_sd[:2]), "m")
    text = f"has its centre of mass {height} above the table, {aside} ± {spread} off its middle"
    return text, figures


def _load(target: SeenObject, state: WorldState) -> Told:
    carried = state.carried_by(target.name)
    names = join_words([f"the {each.name}" for each in carried]) or "nothing"
    does = "carries" if target.model.inside is None else "contains"
    return f"{does} {names}", {"objects": float(len(carried))}


def standing_text(seen: SeenObject, state: WorldState) -> str:
    """On or in what an object stands, in words."""
    where = "in" if state.stands_inside(seen) else "on"
    return f"{where} the {seen.on or 'table'}"


def _position(target: SeenObject, sd: float) -> Told:
    pose = target.pose
    figures = {"x": pose.x, "y": pose.y, "yaw": pose.yaw, "position_sd": sd}
    text = (
        f"is at {place_text(pose.x, pose.y)}, seen to ± {1e3 * sd:.1f} mm, and turned by "
        f"{quantity(pose.yaw, 'rad')}"
    )
    return text, figures


_TOLD: dict[str, Callable[[SeenObject], Told]] = {
    "mass": _mass,
    "friction": _friction,
    "height": _side("height", "high"),
    "width": _side("width", "wide"),
    "length": _side("length", "deep"),
    "size": _size,
    "centre_of_mass": _centre_of_mass,
}


_MORE = {
    "mass": ("heavier", "kg"),
    "height": ("taller", "m"),
    "width": ("wider", "m"),
    "size": ("bigger", "m³"),
    "friction": ("rougher", ""),
    "position": ("farther away", "m"),
}
"""Property → who has more of it, and its unit."""


def answer_about_scene(
    frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults
) -> Answer:
    """The answer to a question about several objects."""
    if frame.query == "capable":
        return capable_answer(frame, state, robot, defaults)
    if frame.query == "seen" and isinstance(frame.goal, g.Place):
        return neighbours_answer(frame.goal, state)
    return scene_answer(state) if frame.query == "seen" else comparison_answer(frame, state)


def scene_answer(state: WorldState) -> Answer:
    """The objects on the table, and where each of them stands."""
    seen = sorted(state.objects.values(), key=lambda each: each.pose.x)
    lines = tuple(
        f"the {s.name} at {place_text(s.pose.x, s.pose.y)}"
        + (f", {standing_text(s, state)}" if s.on else "")
        + ("" if s.lies_on == "bottom" else f", lying on {s.side_below}")
        + ("" if s.model.lid is None else f", its lid {'closed' if s.is_covered else 'open'}")
        for s in seen
    )
    names = join_words([f"the {each.name}" for each in seen]) or "nothing"
    held = "" if state.held is None else f" I hold the {state.held.name}."
    numbers = {"objects": float(len(seen))}
    return Answer(query="seen", text=f"I see {names}.{held}", lines=lines, numbers=numbers)


def neighbours_answer(place: g.Place, state: WorldState) -> Answer:
    """The objects that are seen in a relation to others: behind one, between two."""
    assert isinstance(place.reference, tuple)
    others = [state.objects[ref.id] for ref in place.reference if ref.id is not None]
    there = [
        seen.name
        for seen in state.objects.values()
        if seen not in others and stands_in_relation(place.relation, seen, others)
    ]
    where = f"{relation_text(place.relation)} {join_words([f'the {o.name}' for o in others])}"
    names = join_words([f"the {name}" for name in there]) or "nothing"
    numbers = {"objects": float(len(there))}
    text = f"I see {names} {where}."
    return Answer(query="seen", text=text, objects=tuple(there), numbers=numbers, yes=bool(there))


def comparison_answer(frame: g.Frame, state: WorldState) -> Answer:
    """Which of two objects is believed to have more of something; of one, how much it has."""
    one, goal = target_of(frame, state), frame.goal
    if not isinstance(goal, g.Parameters) or not goal.than:
        most = {"query": "compare", "objects": (one.name,)}
        return property_answer(frame, state, 0.0).model_copy(update=most)
    (which,), than = goal.which, goal.than[0]
    assert than.id is not None, "the objects of a question are resolved"
    other, (word, unit) = state.objects[than.id], _MORE[which]
    more, less = sorted((one, other), key=lambda each: -_amount(each, which))
    a, b = _amount(more, which), _amount(less, which)
    own = {"mass": "mass_sd", "friction": "friction_sd"}.get(which, "")
    sd = math.hypot(*(getattr(each.model, own, 0.0) for each in (more, less)))
    sure = "" if a - b > 2.0 * sd else ", as far as I know"
    figures = f"{quantity(a, unit)} to {quantity(b, unit)}"
    text = f"The {more.name} is {word} than the {less.name}{sure}: {figures}."
    return Answer(query="compare", text=text, objects=(more.name,), numbers={"more": a, "less": b})


def _amount(seen: SeenObject, which: str) -> float:
    """The believed value of a property [SI]; of the size, the volume around it."""
    x, y, z = seen.model.extents
    sizes = {"height": z, "width": min(x, y), "size": x * y * z, "position": seen.pose.x}
    return {"mass": seen.model.mass, "friction": seen.model.friction, **sizes}[which]


def capable_answer(frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults) -> Answer:
    """The objects on the table with which the planner finds a way to do what is asked."""
    asked = name_words(frame.object.text) if frame.object else ()
    wanted = {word.removesuffix("es") for word in asked} | {w.removesuffix("s") for w in asked}
    names = [n for n in state.objects if not wanted or wanted & set(name_words(n))]
    can = []
    for name in names:
        about = {"query": None, "object": g.ObjectRef(text=name, id=name)}
        made = plan(frame.model_copy(update=about), state, robot, defaults=defaults)
        can += [] if isinstance(made, Refusal) else [name]
    cannot = [f"the {name}" for name in names if name not in can]
    text = f"I can do that with {join_words([f'the {name}' for name in can]) or 'none of them'}"
    text += f", not with {join_words(cannot, 'or')}." if cannot and can else "."
    numbers = {"can": float(len(can)), "asked": float(len(names))}
    return Answer(query="capable", text=text, objects=tuple(can), numbers=numbers, yes=bool(can))


def destination_answer(
    frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults
) -> Answer:
    """Where the object would stand after what is asked about, by the plan for it."""
    target = target_of(frame, state)
    command = frame.model_copy(update={"query": None, "event": None})
    made = plan(command, state, robot, defaults=defaults)
    if isinstance(made, Refusal):
        text = f"The {target.name} would stay where it is: {made.message}."
        return Answer(query="predict", text=text, reason=made.reason, suggestions=made.suggestions)
    aim = made.aim if isinstance(made, Plan) else None
    if aim is None:
        return Answer(query="predict", text=f"The {target.name} would stand where it does now.")
    x, y = aim.x, aim.y
    text = f"The {target.name} would be at {place_text(x, y)}."
    return Answer(query="predict", text=text, numbers={"x": x, "y": y})


# Where objects are seen to stand to each other: how far apart, beside what, upright or not.


def distance_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from another one: the gap, and from middle to middle."""
    assert isinstance(frame.goal, g.Parameters)
    one, (other,) = target_of(frame, state), _seen(frame.goal.than, state)
    gap = gap_between(one, other)
    apart = math.dist(one.pose.p_WB[:2], other.pose.p_WB[:2])
    text = (
        f"Between the {one.name} and the {other.name} there are {quantity(gap, 'm')}; "
        f"their middles are {quantity(apart, 'm')} apart."
    )
    return Answer(query="value", text=text, numbers={"gap": gap, "middles": apart})


def far_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from the robot, which is at the origin: away from it, and aside."""
    target = target_of(frame, state)
    away, left = float(target.pose.x), float(target.pose.y)
    side = "left" if left > 0 else "right"
    text = (
        f"The middle of the {target.name} is {quantity(away, 'm')} away from the robot, "
        f"{quantity(abs(left), 'm')} to the {side}."
    )
    return Answer(query="value", text=text, numbers={"away": away, "left": left})


def state_answer(frame: g.Frame, state: WorldState) -> Answer:
    """Whether an object stands upright, on the table itself, or in a relation to others."""
    target, goal = target_of(frame, state), frame.goal
    if isinstance(goal, g.Place):
        assert isinstance(goal.reference, tuple)
        return _relation_answer(target, goal.relation, _seen(goal.reference, state))
    if isinstance(goal, g.SetDown):
        text = (
            f"{_said(target.on is None)}, the {target.name} stands {standing_text(target, state)}."
        )
        return Answer(query="value", text=text, yes=target.on is None)
    if isinstance(goal, g.Open | g.Close):
        return _lid_answer(target, asks_open=isinstance(goal, g.Open))
    upright = target.lies_on == "bottom"
    yes = upright is isinstance(goal, g.Upright)
    how = "stands upright" if upright else f"lies on {target.side_below}"
    return Answer(query="value", text=f"{_said(yes)}, the {target.name} {how}.", yes=yes)


def edge_answer(frame: g.Frame, state: WorldState) -> Answer:
    """How far an object stands from an edge of the table; from the nearest, if any edge is meant.

    Raises:
        ControlError: `unsupported` for another part of the table.
    """
    target, goal = target_of(frame, state), frame.goal
    assert isinstance(goal, g.Displace)
    corners, table = footprint(target), state.table
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0), corners.max(axis=0)
    gaps = {
        "front_edge": float(x_min - table.x_min),
        "back_edge": float(table.x_max - x_max),
        "right_edge": float(y_min - table.y_min),
        "left_edge": float(table.y_max - y_max),
    }
    where = min(gaps, key=lambda edge: gaps[edge]) if goal.away_from == "edge" else goal.away_from
    if not isinstance(where, str) or where not in gaps:
        raise error(
            "unsupported",
            "only how far it is from an edge of the table is told",
            capability="telling the distance from a part of the table",
            suggestions=("how far is it from the left edge?",),
        )
    side, gap = where.removesuffix("_edge"), gaps[where]
    text = f"The {target.name} is {quantity(gap, 'm')} away from the {side} edge of the table."
    return Answer(query="value", text=text, numbers={"gap": gap})


def _lid_answer(target: SeenObject, *, asks_open: bool) -> Answer:
    if target.model.lid is None:
        text = f"The {target.name} has no lid that I know of."
        return Answer(query="value", text=text)
    closed = target.is_covered
    yes = closed is not asks_open
    is_so = "closed, its lid on" if closed else "open"
    return Answer(query="value", text=f"{_said(yes)}, the {target.name} is {is_so}.", yes=yes)


def _relation_answer(
    target: SeenObject, relation: g.Relation, others: tuple[SeenObject, ...]
) -> Answer:
    yes = stands_in_relation(relation, target, others)
    where = f"{relation_text(relation)} {join_words([f'the {each.name}' for each in others])}"
    gaps = [gap_between(target, each) for each in others]
    apart = join_words([quantity(gap, "m") for gap in gaps])
    text = f"{_said(yes)}, the {target.name} is {'' if yes else 'not '}{where}: {apart} apart."
    return Answer(query="value", text=text, numbers={"gap": max(gaps)}, yes=yes)


def _said(yes: bool) -> str:
    return "Yes" if yes else "No"


def _seen(references: tuple[g.ObjectRef, ...], state: WorldState) -> tuple[SeenObject, ...]:
    return tuple(state.objects[ref.id] for ref in references if ref.id is not None)
