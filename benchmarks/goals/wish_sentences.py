"""What is said about several things in a world that was drawn, and what is meant by it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.goals.drawn_worlds import SMALL_TABLE, apart
from benchmarks.goals.judge import WAYS
from benchmarks.goals.wishes import MIDDLE, Wish, Wished
from nlcontrol.batches.drawn_scenes import Generator
from objectmodels import CylinderModel
from planner.problem.footprints import footprint
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import SeenObject

_HALVES = {"left": "left", "right": "right", "front": "toward", "back": "away"}
_PUSHED = {"left": "to the left", "right": "to the right", "away": "away", "toward": "toward me"}
_EDGES = {"left": "left", "right": "right", "away": "far", "toward": "front"}

_SAID: dict[Wished, tuple[int, int, tuple[str, ...]]] = {
    "swap": (2, 0, ("swap {a} and {b}", "exchange {a} and {b}")),
    "row": (3, 0, ("put {a}, {b} and {c} in a row", "line up {a}, {b} and {c}")),
    "together": (2, 0, ("put {a} and {b} together", "push {a} and {b} together")),
    "between": (1, 2, ("put {a} between {b} and {c}", "push {a} between {b} and {c}")),
    "room": (0, 1, ("make room for {a}", "make some room around {a}")),
    "aside": (1, 0, ("get {a} out of the way", "move {a} aside")),
    "facing": (1, 1, ("turn {a} to face {b}", "turn {a} towards {b}")),
    "stand": (1, 0, ("stand {a} up", "set {a} upright", "put {a} upright")),
    "lay": (1, 0, ("lay {a} down", "put {a} on its side")),
    "on": (1, 1, ("put {a} on {b}",)),
    "off": (1, 1, ("take {a} off {b}",)),
    "into": (1, 1, ("put {a} into {b}", "put {a} in {b}")),
    "out of": (1, 1, ("take {a} out of {b}",)),
}
"""How many things a sentence moves, how many others tell where, and its words."""


def say(kind: Wished, things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Words, and what they mean by true poses."""
    names = [seen.name for seen in things]
    match kind:
        case "clear":
            return _clearing(things, rng)
        case "straight":
            return _straightening(things, rng)
        case "asked":
            return _question(things, rng)
        case "edge":
            return _over_edge(names[0], rng)
        case "blocked":
            return _blocked_push(things, rng)
        case "all" | "flat" | "back" | "restore":
            return _push(kind, names, rng)
    moved, told, texts = _SAID[kind]
    a, b, c = (f"the {name}" for name in (names * 3)[:3])
    words = texts[int(rng.integers(len(texts)))].format(a=a, b=b, c=c)
    if kind == "room":
        near = [seen.name for seen in things[1:] if apart(seen, things[0]) < D.room]
        return words, Wish(kind, tuple(near), told=(names[0],))
    return words, Wish(kind, tuple(names[:moved]), tuple(names[moved : moved + told]))


def _clearing(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """A half of the table."""
    half = list(_HALVES)[int(rng.integers(len(_HALVES)))]
    side = np.array(WAYS[_HALVES[half]])
    inside = [s.name for s in things if float(((footprint(s) - MIDDLE) @ side).max()) > 0.0]
    return f"clear the {half} half of the table", Wish("clear", tuple(inside), way=_HALVES[half])


def _blocked_push(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Past what stands in the way, or a bit of a way where nothing does."""
    own, distance, way = things[0].name, 20, "left"
    if len(things) > 1:
        at, there = (np.array([seen.pose.x, seen.pose.y]) for seen in things)
        way = max(WAYS, key=lambda each: float((there - at) @ np.array(WAYS[each])))
        distance = round(100.0 * float(np.linalg.norm(there - at))) + int(rng.integers(0, 10))
    text = f"push the {own} {distance} cm {_PUSHED[way]}"
    return text, Wish("blocked", (own,), way=way, distance=distance / 100.0)


def _push(kind: Wished, names: Sequence[str], rng: Generator) -> tuple[str, Wish]:
    """A short push of one thing or several, and what is said around it."""
    distance, way = int(rng.integers(5, 13)), list(WAYS)[int(rng.integers(4))]
    moved, own = list(names[:1]), f"the {names[0]}"
    if kind == "all":
        a, b = names[:2]
        own = (f"both the {a} and the {b}", f"the {a} and the {b}", "everything", "all of them")[
            int(rng.integers(4))
        ]
        moved = list(names if own in ("everything", "all of them") else names[:2])
    text = f"push {own} {distance} cm {_PUSHED[way]}"
    if kind == "back":
        back = (", then put it back", " and then put it back where it was")
        text += back[int(rng.integers(2))]
    elif kind == "restore":
        moved, other = list(names), names[1]
        text = f"get the {other} out of the way, {text}, and then put the {other} back where it was"
    return text, Wish(kind, tuple(moved), way=way, distance=distance / 100.0)


def _straightening(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Along the table, or along a thing that has sides."""
    own = things[0].name
    with_sides = [s.name for s in things[1:] if not isinstance(s.model, CylinderModel)]
    if with_sides and rng.random() < 0.4:
        other = with_sides[0]
        return f"turn the {own} parallel to the {other}", Wish("straight", (own,), (other,))
    choices = (
        f"straighten the {own}",
        f"turn the {own} parallel to the edge of the table",
        f"align the {own} with the edge of the table",
    )
    return choices[int(rng.integers(len(choices)))], Wish("straight", (own,))


def _over_edge(own: str, rng: Generator) -> tuple[str, Wish]:
    """Over one of the table's edges, by a length or until it hangs over."""
    extent = SMALL_TABLE.extent
    way = list(_EDGES)[int(rng.integers(len(_EDGES)))]
    end = {
        "left": extent.y_max,
        "right": -extent.y_min,
        "away": extent.x_max,
        "toward": -extent.x_min,
    }[way]
    verb, hangs = ("pull", "push", "slide")[int(rng.integers(3))], int(rng.integers(2, 6))
    words = f"{verb} the {own} over the {_EDGES[way]} edge"
    if rng.random() < 0.25:
        return words, Wish("edge", (own,), way=way, edge=end)
    wish = Wish("edge", (own,), way=way, distance=hangs / 100.0, edge=end)
    return f"{words} by {hangs} cm", wish


def _question(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """What is under, on or in something, with the names that are the answer."""
    upper, lower = things[:2]
    if upper.on is None:
        lower = things[0]  # there was no room in the box
    carried = tuple(seen.name for seen in things if seen.on == lower.name)
    what = "in" if lower.model.inside is not None else "on"
    choices = [(f"what is {what} the {lower.name}?", carried)]
    if upper.on is not None and what == "on":
        choices.append((f"what is under the {upper.name}?", (lower.name,)))
    text, names = choices[int(rng.integers(len(choices)))]
    return text, Wish("asked", (), names)
