"""What is said in a world that was drawn, and what is meant by it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.arrangements.arranged_worlds import SMALL_TABLE, apart
from benchmarks.arrangements.wishes import MIDDLE, WAYS, Kind, Way, Wish
from nlcontrol.batches.drawn_scenes import Generator
from objectmodels import CylinderModel
from planner.problem.footprints import footprint
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import SeenObject


def say(kind: Kind, things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Words, and what they mean by true poses."""
    if kind in _MEASURED:
        return _MEASURED[kind](things, rng)
    names = [seen.name for seen in things]
    a, b, c = (f"the {name}" for name in (names * 3)[:3])
    words = _SAID[kind][int(rng.integers(len(_SAID[kind])))].format(a=a, b=b, c=c)
    if kind == "room":
        near = [seen.name for seen in things[1:] if apart(seen, things[0]) < D.room]
        return words, Wish(kind, tuple(near), told=(names[0],))
    count = _MOVED.get(kind, 1)
    told = names[count : count + _TOLD.get(kind, 0)]
    return words, Wish(kind, tuple(names[:count]), tuple(told))


_HALVES: dict[str, Way] = {"left": "left", "right": "right", "front": "toward", "back": "away"}
_PUSHED: dict[Way, str] = {
    "left": "to the left", "right": "to the right", "away": "away", "toward": "toward me",
}  # fmt: skip

_SAID: dict[Kind, tuple[str, ...]] = {
    "swap": ("swap {a} and {b}", "exchange {a} and {b}"),
    "row": ("put {a}, {b} and {c} in a row", "line up {a}, {b} and {c}"),
    "together": ("put {a} and {b} together", "push {a} and {b} together"),
    "between": ("put {a} between {b} and {c}", "push {a} between {b} and {c}"),
    "room": ("make room for {a}", "make some room around {a}"),
    "aside": ("get {a} out of the way", "move {a} aside"),
    "facing": ("turn {a} to face {b}", "turn {a} towards {b}"),
    "stand": ("stand {a} up", "set {a} upright", "put {a} upright"),
    "lay": ("lay {a} down", "put {a} on its side"),
    "on": ("put {a} on {b}",),
    "off": ("take {a} off {b}",),
    "into": ("put {a} into {b}", "put {a} in {b}"),
    "out of": ("take {a} out of {b}",),
}
_MOVED: dict[Kind, int] = {"swap": 2, "row": 3, "together": 2}
_TOLD: dict[Kind, int] = {"between": 2, "facing": 1, "on": 1, "off": 1, "into": 1, "out of": 1}


def _clearing(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """A half of the table."""
    half = list(_HALVES)[int(rng.integers(len(_HALVES)))]
    inside = [seen.name for seen in things if _reaches(seen, _HALVES[half])]
    return f"clear the {half} half of the table", Wish("clear", tuple(inside), way=_HALVES[half])


def _reaches(seen: SeenObject, side: Way) -> bool:
    return float(((footprint(seen) - MIDDLE) @ np.array(WAYS[side])).max()) > 0.0


def _blocked_push(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Past what stands in the way, or a bit of a way where nothing does."""
    own, distance = things[0], 20
    way: Way = "left"
    if len(things) > 1:
        at, there = (np.array([seen.pose.x, seen.pose.y]) for seen in things)
        way = max(WAYS, key=lambda each: float((there - at) @ np.array(WAYS[each])))
        distance = round(100.0 * float(np.linalg.norm(there - at))) + int(rng.integers(0, 10))
    text = _moving(own.name, distance, way)
    return text, Wish("blocked", (own.name,), way=way, distance=distance / 100.0)


def _straightening(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Along the table, or along a thing that has sides."""
    own = things[0].name
    with_sides = [s.name for s in things[1:] if not isinstance(s.model, CylinderModel)]
    if with_sides and rng.random() < 0.4:
        other = with_sides[0]
        return f"turn the {own} parallel to the {other}", Wish("straight", (own,), (other,))
    choices = (f"straighten the {own}", f"turn the {own} parallel to the edge of the table",
               f"align the {own} with the edge of the table")  # fmt: skip
    return choices[int(rng.integers(len(choices)))], Wish("straight", (own,))


def _moving(own: str, distance: int, way: Way) -> str:
    return f"push the {own} {distance} cm {_PUSHED[way]}"


def _any_way(rng: Generator) -> tuple[int, Way]:
    """A short distance [cm] and a direction."""
    return int(rng.integers(5, 13)), list(WAYS)[int(rng.integers(4))]


def _push_of_all(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """All that stands there, or two things."""
    names = [seen.name for seen in things]
    distance, way = _any_way(rng)
    a, b = names[:2]
    choices = (([a, b], f"both the {a} and the {b}"), ([a, b], f"the {a} and the {b}"),
               (names, "everything"), (names, "all of them"))  # fmt: skip
    moved, what = choices[int(rng.integers(len(choices)))]
    text = f"push {what} {distance} cm {_PUSHED[way]}"
    return text, Wish("all", tuple(moved), way=way, distance=distance / 100.0)


def _flat_push(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    own = things[0].name
    distance, way = _any_way(rng)
    wish = Wish("flat", (own,), way=way, distance=distance / 100.0)
    return _moving(own, distance, way), wish


def _over_edge(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Over one of the table's edges, by a length or until it hangs over."""
    own, extent = things[0].name, SMALL_TABLE.extent
    edges: dict[Way, tuple[str, float]] = {
        "left": ("left", extent.y_max), "right": ("right", -extent.y_min),
        "away": ("far", extent.x_max), "toward": ("front", -extent.x_min),
    }  # fmt: skip
    way = list(edges)[int(rng.integers(len(edges)))]
    verb, hangs = ("pull", "push", "slide")[int(rng.integers(3))], int(rng.integers(2, 6))
    words = f"{verb} the {own} over the {edges[way][0]} edge"
    if rng.random() < 0.25:
        return words, Wish("edge", (own,), way=way, edge=edges[way][1])
    wish = Wish("edge", (own,), way=way, distance=hangs / 100.0, edge=edges[way][1])
    return f"{words} by {hangs} cm", wish


def _push_and_back(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    own = things[0].name
    distance, way = _any_way(rng)
    then = (", then put it back", " and then put it back where it was")[int(rng.integers(2))]
    wish = Wish("back", (own,), way=way, distance=distance / 100.0)
    return _moving(own, distance, way) + then, wish


def _push_past(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """A push of one thing while another is out of its way, which is put back afterwards."""
    own, other = (seen.name for seen in things)
    distance, way = _any_way(rng)
    text = (f"get the {other} out of the way, {_moving(own, distance, way)}, "
            f"and then put the {other} back where it was")  # fmt: skip
    return text, Wish("restore", (own, other), way=way, distance=distance / 100.0)


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


_MEASURED: dict[Kind, Callable[[Sequence[SeenObject], Generator], tuple[str, Wish]]] = {
    "clear": _clearing,
    "blocked": _blocked_push,
    "straight": _straightening,
    "all": _push_of_all,
    "flat": _flat_push,
    "back": _push_and_back,
    "restore": _push_past,
    "asked": _question,
    "edge": _over_edge,
}
