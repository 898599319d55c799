"""What a sentence asks of several things, and whether it came about, by true poses alone.

It shares no code with planner and checks. Lengths and angles may be off by `SLACK` times what the
defaults allow. All that is read is where each thing was before the sentence and where it is after
it, so that a step may undo what an earlier one did, and is found out.

Frames: W is the world, z up, +x away from the robot, +y to its left; B is an object.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from benchmarks.goals.judge import FELL, SLACK, STIRRED, WAYS, Places, TruePlace
from objectmodels.geometry.base_shapes import Array, hull_polygon
from planner.problem.footprints import gap
from planner.types.defaults import DEFAULTS as D

Wished = Literal[
    "swap", "row", "together", "between", "clear", "room", "aside", "blocked", "facing",
    "straight", "stand", "on", "off", "into", "out of", "lay", "flat", "all", "back", "restore",
    "asked", "edge",
]  # fmt: skip
WISHED: tuple[Wished, ...] = get_args(Wished)

MIDDLE = np.array([0.5, 0.0])
"""Middle of the table [m]."""
TOUCHES = 0.005
"""What is lower over a surface lies on it [m]."""

_BROAD = 0.97  # share of the longest side from which a side counts as as long


@dataclass(frozen=True)
class Wish:
    """What is asked.

    Attributes:
        kind: of it.
        moved: names of what is to be moved.
        told: names of what tells where; it stays where it is. Of a question, the answer.
        way: direction, or side of the table.
        distance: to be moved, or to hang over an edge; 0 if nobody says how far [m].
        edge: where the table ends that way, from the origin of W [m].
    """

    kind: Wished
    moved: tuple[str, ...]
    told: tuple[str, ...] = ()
    way: str = ""
    distance: float = 0.0
    edge: float = 0.0

    @property
    def direction(self) -> Array:
        """Its way in W, shape (2,)."""
        return np.array(WAYS[self.way])


def is_told(wish: Wish, question: str, answer: str, names: Iterable[str]) -> bool:
    """Whether an answer names what the question asks for, and nothing else of `names`."""
    found = {name for name in names if name in answer and name not in question}
    return found == set(wish.told)


def harm(wish: Wish, before: Places, after: Places) -> Iterator[str]:
    """Names of what fell, and of what was stirred though it tells where, or is fragile."""
    for name, was in before.items():
        if name in wish.moved:
            continue
        now = after[name]
        stays = name in wish.told or was.fragile
        if now.tilt - was.tilt > FELL or (stays and _way(was, now) > STIRRED):
            yield name


def is_met(wish: Wish, before: Places, after: Places) -> bool:
    """Whether what was asked came about."""
    own = after[_first(wish, after)]
    lower = after[wish.told[0]] if wish.told else own
    upright = max(own.tilt, lower.tilt) <= SLACK * D.rest_tilt
    match wish.kind:
        case "stand":
            return own.tilt <= SLACK * D.rest_tilt and own.lowest <= TOUCHES
        case "lay":
            lies = abs(own.tilt - 0.5 * math.pi) <= SLACK * D.rest_tilt
            return lies and own.lowest <= TOUCHES
        case "on":
            x, y = own.middle[:2].tolist()
            dot = np.array([[x - 1e-3, y], [x, y + 1e-3], [x + 1e-3, y]])
            over = abs(own.lowest - lower.lowest - lower.model.top) <= TOUCHES
            return over and upright and gap(dot, lower.outline) <= 0.0
        case "into":
            return upright and _is_inside(own, lower)
    # The others leave what is moved tilted as it was, on the table.
    rests = all(
        after[name].leans_against(before[name]) <= SLACK * D.rest_tilt
        and after[name].lowest <= TOUCHES
        for name in wish.moved
    )
    return rests and _is_arranged(wish, before, after)


def _is_arranged(wish: Wish, before: Places, after: Places) -> bool:
    """Whether what is moved is where it should be."""
    name = _first(wish, after)
    own = after[name]
    told = [after[each] for each in wish.told]
    match wish.kind:
        case "swap":
            one, other = wish.moved
            off = max(_way(before[a], after[b]) for a, b in ((one, other), (other, one)))
            return off <= SLACK * D.place_tolerance
        case "row":
            at = np.array([after[each].middle[:2] for each in wish.moved])
            at = at - at.mean(axis=0)
            across = np.linalg.svd(at)[2][1]
            return float(np.abs(at @ across).max()) <= SLACK * D.place_tolerance
        case "together":
            room = gap(own.outline, after[wish.moved[1]].outline)
            return room <= D.place_gap + SLACK * D.place_gap_tolerance
        case "between":
            return _is_between(own, *told)
        case "clear":
            reach = max(_reach(each, wish.direction, MIDDLE) for each in after.values())
            return reach <= SLACK * D.edge_tolerance
        case "room":
            here = after[wish.told[0]].outline
            rooms = [gap(here, each.outline) for k, each in after.items() if k not in wish.told]
            return min(rooms) >= D.room - SLACK * D.place_tolerance
        case "aside":
            return _way(before[name], own) >= D.aside - SLACK * D.distance_tolerance
        case "blocked" | "flat" | "all":
            return all(_went(wish, before[each], after[each]) for each in wish.moved)
        case "back":
            far = own.farthest >= wish.distance - SLACK * D.distance_tolerance
            return far and _way(before[name], own) <= SLACK * D.place_tolerance
        case "restore":  # one went where it should, the other was out of its way and is back
            was, now = before[wish.moved[1]], after[wish.moved[1]]
            aside = now.farthest >= D.aside - SLACK * D.distance_tolerance
            back = _way(was, now) <= SLACK * D.place_tolerance
            return aside and back and _went(wish, before[name], own)
        case "edge":  # it hangs over as far as it should, level on the table
            over = _reach(own, wish.direction) - wish.edge
            near = abs(over - wish.distance) <= SLACK * D.overhang_tolerance
            far = near if wish.distance else over >= D.overhang_tolerance
            return far and own.lowest >= -TOUCHES
        case "off" | "out of":
            return gap(own.outline, told[0].outline) > 0.0
    # It is turned where it stands.
    in_place = _way(before[name], own) <= SLACK * 2.0 * D.turn_drift
    return in_place and _askew(wish, own, told) <= SLACK * D.turn_tolerance


def _first(wish: Wish, after: Places) -> str:
    """What is moved first; anything if a half is clear, or there is room, as it is."""
    return (*wish.moved, *after)[0]


def _way(was: TruePlace, now: TruePlace) -> float:
    """Distance over the table [m]."""
    return float(np.linalg.norm((now.middle - was.middle)[:2]))


def _reach(place: TruePlace, side: Array, origin: Array | float = 0.0) -> float:
    """How far it reaches to a side of a point [m]."""
    return float(((place.outline - origin) @ side).max())


def _went(wish: Wish, was: TruePlace, now: TruePlace) -> bool:
    """Whether a thing went as far and where it should."""
    u, went = wish.direction, (now.middle - was.middle)[:2]
    along, aside = float(went @ u), abs(float(went[0] * u[1] - went[1] * u[0]))
    off = abs(along - wish.distance) <= SLACK * D.distance_tolerance
    return off and aside <= max(SLACK * D.distance_tolerance, 0.2 * wish.distance)


def _is_between(own: TruePlace, one: TruePlace, other: TruePlace) -> bool:
    way, v = (other.middle - one.middle)[:2], (own.middle - one.middle)[:2]
    length = float(np.linalg.norm(way))
    u = way / length
    rooms = [gap(own.outline, each.outline) for each in (one, other)]
    aside, uneven = abs(float(v[0] * u[1] - v[1] * u[0])), 0.5 * abs(rooms[0] - rooms[1])
    near = math.hypot(aside, uneven) <= SLACK * D.between_tolerance
    return near and 0.0 < float(v @ u) < length


def _is_inside(own: TruePlace, box: TruePlace) -> bool:
    """Whether it stands on the floor of an open box, all of it between the walls."""
    inside = box.model.inside
    assert inside is not None, "it is put into an open box"
    in_B = (own.corners - box.p_WB) @ box.R_WB
    between = bool((np.abs(in_B[:, :2]) <= 0.5 * np.array(inside.size)).all())
    return between and abs(float(in_B[:, 2].min()) - inside.floor) <= TOUCHES


def _askew(wish: Wish, own: TruePlace, told: list[TruePlace]) -> float:
    """How far its long sides are from looking at a thing, or from running along it [rad]."""
    sides = _long_sides(own)
    if wish.kind == "facing":
        v = (told[0].middle - own.middle)[:2]
        off = np.arcsin(np.clip(np.abs(sides @ (v / np.linalg.norm(v))), 0.0, 1.0))
    else:
        along = _long_sides(told[0]) if told else np.eye(2)  # else the table's edges
        off = np.arccos(np.clip(np.abs(sides @ along.T), 0.0, 1.0))
    return float(off.min())


def _long_sides(place: TruePlace) -> Array:
    """Directions of its longest sides in W, shape (k, 2); none if it is round."""
    if place.is_round:
        return np.empty((0, 2))
    corners = hull_polygon(np.array(place.model.outline)).vertices
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(sides, axis=1)
    long = lengths >= _BROAD * lengths.max()
    return np.asarray((sides[long] / lengths[long, None]) @ place.R_WB[:2, :2].T)
