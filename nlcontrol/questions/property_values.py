"""Believed values of an object: weight, friction, size, place, with where the figures come from.

The width of an object is what it measures from left to right as it stands, its length what it
measures away from the robot.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import ControlError, error, whole_span
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.asked_push import target_of
from nlcontrol.text_format import enumeration, place_text, quantity, with_sd_text

if TYPE_CHECKING:
    from planner.types.world_state import SeenObject, WorldState

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
    text = f"The {target.name} {enumeration(parts)}{source}."
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
    names = enumeration([f"the {each.name}" for each in carried]) or "nothing"
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
