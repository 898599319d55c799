"""What the robot sees on the table, and which of two objects has more of something."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.asked_push import target_of
from nlcontrol.questions.property_values import property_answer, standing_text
from nlcontrol.references.disambiguation_text import relation_text
from nlcontrol.references.object_attributes import stands_in_relation
from nlcontrol.references.object_names import name_words
from nlcontrol.text_format import enumeration, place_text, quantity
from planner import plan
from planner.types.plan import Plan
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import SeenObject, WorldState

_MORE = {"mass": ("heavier", "kg"), "height": ("taller", "m"), "width": ("wider", "m"),
         "size": ("bigger", "m³"), "friction": ("rougher", ""),
         "position": ("farther away", "m")}  # fmt: skip
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
    names = enumeration([f"the {each.name}" for each in seen]) or "nothing"
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
    where = f"{relation_text(place.relation)} {enumeration([f'the {o.name}' for o in others])}"
    names = enumeration([f"the {name}" for name in there]) or "nothing"
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
    text = f"I can do that with {enumeration([f'the {name}' for name in can]) or 'none of them'}"
    text += f", not with {enumeration(cannot, 'or')}." if cannot and can else "."
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
