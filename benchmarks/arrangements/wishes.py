"""What a sentence asks of several things, and whether it came about, by true poses alone.

It shares no code with planner and checks. Lengths and angles may be off by `SLACK` times what the
defaults allow. All that is read is where each thing was before the sentence and where it is after
it, so that a step may undo what an earlier one did, and is found out.

Frames: W is the world, z up, +x away from the robot, +y to its left; B is an object.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from benchmarks.goals.true_judge import SLACK, STIRRED
from objectmodels import ObjectModel
from objectmodels.geometry.base_shapes import Array, Disc, hull_polygon
from planner.problem.footprints import gap
from planner.types.defaults import DEFAULTS as D

Kind = Literal[
    "swap", "row", "together", "between", "clear", "room", "aside", "blocked", "facing",
    "straight", "stand", "on", "off", "into", "out of", "lay", "flat", "all", "back", "restore",
    "asked", "edge",
]  # fmt: skip
Way = Literal["left", "right", "away", "toward"]

WAYS: dict[Way, tuple[float, float]] = {
    "left": (0.0, 1.0), "right": (0.0, -1.0), "away": (1.0, 0.0), "toward": (-1.0, 0.0),
}  # fmt: skip
MIDDLE = np.array([0.5, 0.0])
"""Middle of the table [m]."""
TOUCHES = 0.005
"""What is lower over a surface lies on it [m]."""

_FALLEN = math.radians(45.0)
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

    kind: Kind
    moved: tuple[str, ...]
    told: tuple[str, ...] = ()
    way: Way | None = None
    distance: float = 0.0
    edge: float = 0.0


@dataclass(frozen=True, eq=False)
class Placed:
    """An object where it truly is.

    Attributes:
        model: its shape.
        R_WB, p_WB: its pose, shapes (3, 3) and (3,) [m].
        fragile: whether it must not be stirred.
        farthest: how far it was from where it stood at first [m].
    """

    model: ObjectModel
    R_WB: Array
    p_WB: Array
    fragile: bool = False
    farthest: float = 0.0

    @cached_property
    def corners(self) -> Array:
        """Corners of a prism around it in W, shape (k, 3) [m]."""
        prism = [(x, y, z) for z in (0.0, self.model.top) for x, y in self.model.outline]
        return np.asarray(np.array(prism) @ self.R_WB.T + self.p_WB)

    @property
    def outline(self) -> Array:
        """What it covers, seen from above, shape (k, 2) [m]."""
        return hull_polygon(self.corners[:, :2]).vertices

    @property
    def middle(self) -> Array:
        """Its middle, seen from above, shape (2,) [m]."""
        return np.asarray(self.corners[:, :2].mean(axis=0))

    @property
    def lowest(self) -> float:
        """Height of its lowest corner [m]."""
        return float(self.corners[:, 2].min())

    @property
    def tilt(self) -> float:
        """Angle between its own axis and the vertical [rad]."""
        return math.acos(float(np.clip(self.R_WB[2, 2], -1.0, 1.0)))

    def long_sides(self) -> Array:
        """Directions of its longest sides in W, shape (k, 2); none if it is round."""
        if isinstance(self.model.base, Disc):
            return np.empty((0, 2))
        corners = hull_polygon(np.array(self.model.outline)).vertices
        sides = np.roll(corners, -1, axis=0) - corners
        lengths = np.linalg.norm(sides, axis=1)
        long = lengths >= _BROAD * lengths.max()
        return np.asarray((sides[long] / lengths[long, None]) @ self.R_WB[:2, :2].T)


Things = Mapping[str, Placed]


def is_met(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if what was asked came about."""
    return _CONDITIONS[wish.kind](wish, before, after)


def is_told(wish: Wish, question: str, answer: str, names: Iterable[str]) -> bool:
    """Return True if an answer names what the question asks for, and nothing else of `names`."""
    found = {name for name in names if name in answer and name not in question}
    return found == set(wish.told)


def harm(wish: Wish, before: Things, after: Things) -> Iterator[str]:
    """Names of what fell, and of what was stirred though it tells where, or is fragile."""
    for name, was in before.items():
        if name in wish.moved:
            continue
        now = after[name]
        stays = name in wish.told or was.fragile
        if now.tilt - was.tilt > _FALLEN or (stays and _way(was, now) > STIRRED):
            yield name


def _way(was: Placed, now: Placed) -> float:
    return float(np.linalg.norm(now.middle - was.middle))


def _stand(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if what is moved is tilted as it was, and lies on the table."""
    return all(
        _leant(before[name], after[name]) <= SLACK * D.rest_tilt and after[name].lowest <= TOUCHES
        for name in wish.moved
    )


def _leant(was: Placed, now: Placed) -> float:
    """Angle between the vertical and what of an object looked up [rad]."""
    up = now.R_WB @ was.R_WB[2]
    return math.acos(float(np.clip(up[2], -1.0, 1.0)))


def _swapped(wish: Wish, before: Things, after: Things) -> bool:
    one, other = wish.moved
    off = max(_way(before[a], after[b]) for a, b in ((one, other), (other, one)))
    return off <= SLACK * D.place_tolerance and _stand(wish, before, after)


def _in_row(wish: Wish, before: Things, after: Things) -> bool:
    at = np.array([after[name].middle for name in wish.moved])
    at = at - at.mean(axis=0)
    across = np.linalg.svd(at)[2][1]
    off = float(np.abs(at @ across).max())
    return off <= SLACK * D.place_tolerance and _stand(wish, before, after)


def _together(wish: Wish, before: Things, after: Things) -> bool:
    one, other = (after[name].outline for name in wish.moved)
    near = gap(one, other) <= D.place_gap + SLACK * D.place_gap_tolerance
    return near and _stand(wish, before, after)


def _between(wish: Wish, before: Things, after: Things) -> bool:
    own, (one, other) = after[wish.moved[0]], (after[name] for name in wish.told)
    way = other.middle - one.middle
    length = float(np.linalg.norm(way))
    u = way / length
    v = own.middle - one.middle
    aside = abs(float(v[0] * u[1] - v[1] * u[0]))
    rooms = [gap(own.outline, each.outline) for each in (one, other)]
    uneven = 0.5 * abs(rooms[0] - rooms[1])
    inside = 0.0 < float(v @ u) < length
    near = math.hypot(aside, uneven) <= SLACK * D.between_tolerance
    return inside and near and _stand(wish, before, after)


def _cleared(wish: Wish, before: Things, after: Things) -> bool:
    assert wish.way is not None, "a half has a side"
    side = np.array(WAYS[wish.way])
    reach = max(float(((each.outline - MIDDLE) @ side).max()) for each in after.values())
    return reach <= SLACK * D.edge_tolerance and _stand(wish, before, after)


def _has_room(wish: Wish, before: Things, after: Things) -> bool:
    (name,) = wish.told
    here = after[name].outline
    rooms = [gap(here, each.outline) for other, each in after.items() if other != name]
    return min(rooms) >= D.room - SLACK * D.place_tolerance and _stand(wish, before, after)


def _aside(wish: Wish, before: Things, after: Things) -> bool:
    way = _way(before[wish.moved[0]], after[wish.moved[0]])
    return way >= D.aside - SLACK * D.distance_tolerance and _stand(wish, before, after)


def _moved(wish: Wish, before: Things, after: Things) -> bool:
    return all(_went(name, wish, before, after) for name in wish.moved) and _stand(
        wish, before, after
    )


def _went(name: str, wish: Wish, before: Things, after: Things) -> bool:
    """Return True if a thing went as far and where it should."""
    assert wish.way is not None, "it goes somewhere"
    u = np.array(WAYS[wish.way])
    went = after[name].middle - before[name].middle
    along, aside = float(went @ u), abs(float(went[0] * u[1] - went[1] * u[0]))
    off = abs(along - wish.distance) <= SLACK * D.distance_tolerance
    straight = aside <= max(SLACK * D.distance_tolerance, 0.2 * wish.distance)
    return off and straight


def _returned(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if it went away, and stands where it stood."""
    (name,) = wish.moved
    far = after[name].farthest >= wish.distance - SLACK * D.distance_tolerance
    return far and _is_back(name, before, after) and _stand(wish, before, after)


def _is_back(name: str, before: Things, after: Things) -> bool:
    return _way(before[name], after[name]) <= SLACK * D.place_tolerance


def _restored(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if one went where it should, and the other was out of its way and is back."""
    own, other = wish.moved
    aside = after[other].farthest >= D.aside - SLACK * D.distance_tolerance
    moved = _went(own, wish, before, after) and _stand(wish, before, after)
    return aside and moved and _is_back(other, before, after)


def _hangs_over(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if it hangs over the edge as far as it should, and lies level on the table."""
    assert wish.way is not None, "an edge has a side"
    (name,) = wish.moved
    over = float((after[name].outline @ np.array(WAYS[wish.way])).max()) - wish.edge
    near = abs(over - wish.distance) <= SLACK * D.overhang_tolerance
    far_enough = near if wish.distance else over >= D.overhang_tolerance
    level = after[name].lowest >= -TOUCHES
    return far_enough and level and _stand(wish, before, after)


def _lies(wish: Wish, before: Things, after: Things) -> bool:
    own = after[wish.moved[0]]
    return abs(own.tilt - 0.5 * math.pi) <= SLACK * D.rest_tilt and own.lowest <= TOUCHES


def _faces(wish: Wish, before: Things, after: Things) -> bool:
    own, other = after[wish.moved[0]], after[wish.told[0]]
    v = other.middle - own.middle
    sides = own.long_sides()
    # A side looks at something to which it is square.
    off = np.arcsin(np.clip(np.abs(sides @ (v / np.linalg.norm(v))), 0.0, 1.0)).min()
    return bool(off <= SLACK * D.turn_tolerance) and _turned_in_place(wish, before, after)


def _straight(wish: Wish, before: Things, after: Things) -> bool:
    """Along the edges of the table, or along another thing."""
    own = after[wish.moved[0]].long_sides()
    along = after[wish.told[0]].long_sides() if wish.told else np.eye(2)
    off = np.arccos(np.clip(np.abs(own @ along.T), 0.0, 1.0)).min()
    return bool(off <= SLACK * D.turn_tolerance) and _turned_in_place(wish, before, after)


def _turned_in_place(wish: Wish, before: Things, after: Things) -> bool:
    (name,) = wish.moved
    near = _way(before[name], after[name]) <= SLACK * 2.0 * D.turn_drift
    return near and _stand(wish, before, after)


def _stands(wish: Wish, before: Things, after: Things) -> bool:
    own = after[wish.moved[0]]
    return own.tilt <= SLACK * D.rest_tilt and own.lowest <= TOUCHES


def _is_on(wish: Wish, before: Things, after: Things) -> bool:
    own, lower = after[wish.moved[0]], after[wish.told[0]]
    over = abs(own.lowest - lower.lowest - lower.model.top) <= TOUCHES
    x, y = own.middle.tolist()
    dot = np.array([[x - 1e-3, y], [x, y + 1e-3], [x + 1e-3, y]])
    inside = gap(dot, lower.outline) <= 0.0
    upright = max(own.tilt, lower.tilt) <= SLACK * D.rest_tilt
    return over and inside and upright


def _is_off(wish: Wish, before: Things, after: Things) -> bool:
    own, lower = after[wish.moved[0]], after[wish.told[0]]
    return gap(own.outline, lower.outline) > 0.0 and _stand(wish, before, after)


def _is_in(wish: Wish, before: Things, after: Things) -> bool:
    """Return True if it stands on the floor of an open box, all of it between the walls."""
    own, box = after[wish.moved[0]], after[wish.told[0]]
    inside = box.model.inside
    assert inside is not None, "it is put into an open box"
    in_B = (own.corners - box.p_WB) @ box.R_WB
    between = bool((np.abs(in_B[:, :2]) <= 0.5 * np.array(inside.size)).all())
    low = abs(float(in_B[:, 2].min()) - inside.floor) <= TOUCHES
    return between and low and max(own.tilt, box.tilt) <= SLACK * D.rest_tilt


_CONDITIONS: dict[Kind, Callable[[Wish, Things, Things], bool]] = {
    "swap": _swapped,
    "row": _in_row,
    "together": _together,
    "between": _between,
    "clear": _cleared,
    "room": _has_room,
    "aside": _aside,
    "blocked": _moved,
    "facing": _faces,
    "straight": _straight,
    "stand": _stands,
    "on": _is_on,
    "off": _is_off,
    "into": _is_in,
    "out of": _is_off,
    "lay": _lies,
    "flat": _moved,
    "all": _moved,
    "back": _returned,
    "restore": _restored,
    "edge": _hangs_over,
}
