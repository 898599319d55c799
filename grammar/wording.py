"""A frame in plain words: what was understood.

The words are chosen so that reading them gives the same frame again, up to spans.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal

from grammar.frames import (
    Constraint,
    ContactRegion,
    Direction,
    Displace,
    Effector,
    Fast,
    Force,
    Frame,
    Gentle,
    Goal,
    Hard,
    Lift,
    MaxForce,
    MinForce,
    NoLift,
    NoSlide,
    NoSpill,
    NoTilt,
    NoTopple,
    NoTouch,
    NoTurn,
    ObjectRef,
    Pour,
    Rotate,
    Slow,
    Tilt,
    Topple,
)
from grammar.lexicon import Lexicon, default_lexicon

_VERBS = {
    ("push", "displace"): "push",
    ("pull", "displace"): "pull",
    ("move", "displace"): "move",
    ("slide", "displace"): "slide",
    ("topple", "topple"): "topple",
    ("turn", "rotate"): "turn",
    ("tilt", "tilt"): "tilt",
    ("lift", "lift"): "lift",
    ("open", "open"): "open",
    ("close", "close"): "close",
    ("pour", "pour"): "pour the contents of",
    ("explore", "parameters"): "explore",
}
_DIRECTIONS: dict[Direction, str] = {
    "away": "away",
    "toward": "toward the robot",
    "left": "to the left",
    "right": "to the right",
}
_AMOUNTS = {"little": "a little", "lot": "a lot"}
_BOUNDS = {"exact": "", "at_least": "at least ", "at_most": "at most "}
_FORCES: dict[type[Constraint], str] = {Force: "", MinForce: "at least ", MaxForce: "at most "}
_SENSES = {"cw": "clockwise", "ccw": "counterclockwise"}
_REGIONS = {"top": "at the top", "middle": "in the middle", "bottom": "at the bottom"}
_ON: dict[str, str] = {
    "front": "on the front side",
    "back": "on the back side",
    "left": "on the left side",
    "right": "on the right side",
    "top": "on the top face",
}
_FROM: dict[str, str] = {
    "front": "from the front",
    "back": "from behind",
    "left": "from the left",
    "right": "from the right",
}
_HEIGHTS = {"table": "above the table", "top": "below the top"}
_MANNERS: dict[type[Constraint], str] = {
    Gentle: "gently",
    Hard: "hard",
    Slow: "slowly",
    Fast: "quickly",
}
_AVOIDED: dict[type[Constraint], str] = {
    NoTopple: "toppling it",
    NoTilt: "tilting it",
    NoTurn: "turning it",
    NoSlide: "sliding it",
    NoLift: "lifting it",
    NoSpill: "spilling it",
}
_COUNTS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


def paraphrase(frame: Frame, lexicon: Lexicon | None = None) -> str:
    """Says in plain words what a frame asks.

    Args:
        frame: what was understood.
        lexicon: the words of the language; decides which names need quotation marks.

    Raises:
        ValueError: if the language has no words for it.
    """
    lexicon = default_lexicon() if lexicon is None else lexicon
    verb = _VERBS.get((frame.action or "", frame.goal.kind))
    if verb is None or frame.object is None or frame.query or frame.dialogue:
        raise ValueError(f"there are no words for action {frame.action}, goal {frame.goal.kind}")
    constraints = list(frame.constraints)
    words = []
    if constraints and type(constraints[0]) in _MANNERS:
        words.append(_MANNERS[type(constraints.pop(0))])
    words += [verb, _name(frame.object, lexicon), *_goal(frame.goal, lexicon)]
    directed = getattr(frame.goal, "direction", None) is not None
    words += _constraints(constraints, lexicon, directed=directed)
    return " ".join(words)


def _name(ref: ObjectRef, lexicon: Lexicon) -> str:
    """The object's name as the language reads it; with quotation marks unless it is plain."""
    if ref.text.casefold() == "it":
        return ref.text
    words = ref.text.replace("-", " ").casefold().split()
    plain = all(word.isascii() and word.isalnum() and not word[0].isdigit() for word in words)
    bare = not lexicon.reserved & set(words)
    return f"the {ref.text}" if plain and bare else f'"{ref.text}"'


def _goal(goal: Goal, lexicon: Lexicon) -> list[str]:
    words: list[str] = []
    match goal:
        case Displace():
            words = _displace(goal, lexicon)
        case Topple(direction=str(direction)):
            words = [_DIRECTIONS[direction]]
        case Tilt():
            words = [_DIRECTIONS[goal.direction]] if goal.direction else []
        case Rotate(sense=str(sense)):
            words = [_SENSES[sense]]
        case Lift(height=float(height)):
            words = [f"by {_length(height)}"]
        case Pour():
            words = [f"into {_name(goal.into, lexicon)}"] if goal.into else []
            words += [_AMOUNTS[goal.amount]] if goal.amount else []
        case _:
            pass
    if isinstance(goal, Tilt | Rotate) and goal.angle is not None:
        words.append(f"by {_angle(goal.angle)}")
    return words


def _displace(goal: Displace, lexicon: Lexicon) -> list[str]:
    if goal.heading is not None or goal.fraction is not None:
        raise ValueError("there are no words for headings and shares of a way")
    words = []
    if goal.direction is not None:
        pair = (goal.direction,) if isinstance(goal.direction, str) else goal.direction
        words.append(" and ".join(_DIRECTIONS[direction] for direction in pair))
    if isinstance(goal.toward, ObjectRef):
        words.append(f"toward {_name(goal.toward, lexicon)}")
    if isinstance(goal.distance, float):
        words.append(f"by {_BOUNDS[goal.bound]}{_length(goal.distance)}")
    elif goal.distance is not None:
        raise ValueError("there are no words for lengths measured in objects")
    if goal.amount is not None:
        words.append(_AMOUNTS[goal.amount])
    return words


def _constraints(
    constraints: Sequence[Constraint], lexicon: Lexicon, *, directed: bool
) -> list[str]:
    words: list[str] = []
    previous: Constraint | None = None
    for constraint in constraints:
        avoided = _AVOIDED.get(type(constraint))
        if isinstance(constraint, ContactRegion):
            words.append(_contact(constraint, directed=directed))
        elif avoided is None:
            words.append(_constraint(constraint, lexicon))
        else:
            listed = previous is not None and type(previous) in _AVOIDED
            words.append(f"or {avoided}" if listed else f"without {avoided}")
        previous = constraint
    return words


def _constraint(constraint: Constraint, lexicon: Lexicon) -> str:
    if isinstance(constraint, Force | MinForce | MaxForce):
        return f"with {_FORCES[type(constraint)]}{_plain(constraint.value)} N"
    if isinstance(constraint, NoTouch) and constraint.object and constraint.clearance is None:
        return f"without touching {_name(constraint.object, lexicon)}"
    if isinstance(constraint, Effector):
        return _effector(constraint)
    if type(constraint) in _MANNERS:
        return _MANNERS[type(constraint)]
    raise ValueError(f"there are no words for {constraint.kind}")


def _contact(contact: ContactRegion, *, directed: bool) -> str:
    # "From the left" also means "to the right" unless a direction is said, so it is kept for then.
    sides = _FROM if directed else _ON
    words = []
    if contact.region:
        words.append(_REGIONS[contact.region])
    if contact.height and isinstance(contact.height.value, float):
        words.append(f"at {_length(contact.height.value)} {_HEIGHTS[contact.height.origin]}")
    if contact.face:
        words.append(sides.get(contact.face, _ON[contact.face]))
    return " ".join(words)


def _effector(effector: Effector) -> str:
    count = "your" if effector.count is None else _COUNTS[effector.count - 1]
    plural = "s" if (effector.count or 1) > 1 else ""
    words = ("with", count, effector.side or "", effector.tool + plural)
    return " ".join(word for word in words if word)


def _length(metres: float) -> str:
    """A length in centimetres, or in millimetres below one; exact, so that it is read back."""
    length = Decimal(repr(metres))
    if length < Decimal("0.01"):
        return f"{_plain(length * 1000)} mm"
    return f"{_plain(length * 100)} cm"


def _angle(radians: float) -> str:
    degrees = round(math.degrees(radians), 9)
    if math.radians(degrees) == radians:
        return f"{_plain(degrees)} degrees"
    return f"{_plain(radians)} radians"


def _plain(value: float | Decimal) -> str:
    text = f"{Decimal(repr(value)) if isinstance(value, float) else value:f}"
    return re.sub(r"\.?0+$", "", text) if "." in text else text
