"""Would a person at the table ask for it? By shapes, weights and plain geometry, without a planner.

What is pushed slides when it is touched low, and some place that would do is on the part of the
table where things are sent, and `ROOM` away from all that stays; on ways nothing is looked at, for
a hand has several. What is turned has the circle about it free. What is held is held by
`benchmarks.goals.hand_sense`. What is fragile stays where it is.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.arrangements.wishes import MIDDLE, WAYS, Kind, Wish
from benchmarks.goals.hand_sense import may_be_held, may_be_held_lying
from benchmarks.goals.sense import ROOM, SPARE, TABLE
from objectmodels import ObjectModel
from objectmodels.geometry.base_shapes import Array, hull_polygon
from planner.problem.footprints import footprint, gap
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import SeenObject, TableState, WorldState
from sim.motion.robot_reach import lowest_contact
from sim.robots.robots import HAND

Standing = dict[str, SeenObject]

HIGHEST = 0.30
"""Of two things on each other, the highest that is asked for [m]."""

_HEADINGS = np.radians(np.arange(0.0, 360.0, 15.0))
_HIGH = 0.85  # share of its height at which something is pushed to fall
_OVER = 0.02  # from the middle of what hangs over an edge to that edge, at least [m]
_STEP = 0.02  # between places that are looked at [m]


def is_sensible(wish: Wish, things: Standing) -> bool:
    """Return True if a person would ask for it."""
    return _LABELS[wish.kind](wish, things)


def slides(model: ObjectModel) -> bool:
    """Return True if an object clearly slides before it tips when it is touched low on any side."""
    low = lowest_contact(HAND)
    if model.top <= low:
        return False
    pushes = [(face.points_at(0.0, low)[0], -face.points_at(0.0, low)[1]) for face in model.faces()]
    points, ways = (np.array(each) for each in zip(*pushes, strict=True))
    found = model.thresholds(points, ways)
    return bool((np.asarray(found.slide) < SPARE * np.asarray(found.topple)).all())


def _may_go(wish: Wish, things: Standing) -> bool:
    return all(slides(things[name].model) and not things[name].fragile for name in wish.moved)


def _at(seen: SeenObject, xy: Array) -> SeenObject:
    x, y = xy.tolist()
    return replace(seen, pose=replace(seen.pose, x=x, y=y))


def _here(seen: SeenObject) -> Array:
    return np.array([seen.pose.x, seen.pose.y])


def _is_free(there: SeenObject, others: Iterable[SeenObject]) -> bool:
    (x0, x1), (y0, y1) = TABLE
    if not (x0 <= there.pose.x <= x1 and y0 <= there.pose.y <= y1):
        return False
    covered = footprint(there)
    return all(gap(covered, footprint(other)) >= ROOM for other in others)


def _others(things: Standing, *names: str) -> list[SeenObject]:
    return [seen for name, seen in things.items() if name not in names]


def _swap(wish: Wish, things: Standing) -> bool:
    a, b = (things[name] for name in wish.moved)
    there = [_at(a, _here(b)), _at(b, _here(a))]
    rest = _others(things, *wish.moved)
    apart = gap(footprint(there[0]), footprint(there[1])) >= ROOM
    return _may_go(wish, things) and apart and all(_is_free(each, rest) for each in there)


def _row(wish: Wish, things: Standing) -> bool:
    """Along x or y, through one of them, with all else where it is."""
    if not _may_go(wish, things):
        return False
    own, rest = [things[name] for name in wish.moved], _others(things, *wish.moved)
    for across, anchor in itertools.product((0, 1), own):
        spots = [_here(seen) for seen in own]
        for spot in spots:
            spot[across] = _here(anchor)[across]
        there = [_at(seen, spot) for seen, spot in zip(own, spots, strict=True)]
        if all(_is_free(seen, [*rest, *there[:k]]) for k, seen in enumerate(there)):
            return True
    return False


def _together(wish: Wish, things: Standing) -> bool:
    one, other = (things[name] for name in wish.moved)
    if not _may_go(wish, things):
        return False
    ways = ((one, other), (other, one))
    return any(_fits_beside(own, to, _others(things, *wish.moved)) for own, to in ways)


def _fits_beside(own: SeenObject, to: SeenObject, rest: list[SeenObject]) -> bool:
    for heading in _HEADINGS:
        u = np.array([np.cos(heading), np.sin(heading)])
        for way in np.arange(0.05, 0.3, 0.01):
            there = _at(own, _here(to) + way * u)
            if gap(footprint(there), footprint(to)) >= D.place_gap:
                if _is_free(there, rest):
                    return True
                break
    return False


def _between(wish: Wish, things: Standing) -> bool:
    own, (one, other) = things[wish.moved[0]], (things[name] for name in wish.told)
    a, b = _here(one), _here(other)
    rest = _others(things, wish.moved[0])
    spots = (a + share * (b - a) for share in np.linspace(0.35, 0.65, 13))
    return _may_go(wish, things) and any(_is_free(_at(own, spot), rest) for spot in spots)


def _clear(wish: Wish, things: Standing) -> bool:
    """Each of them has a place in the other half, with the others in theirs."""
    assert wish.way is not None, "a half has a side"
    side = np.array(WAYS[wish.way])
    return _find_places(wish, things, lambda there: _reach(there, side) <= 0.0)


def _reach(seen: SeenObject, side: Array) -> float:
    return float(((footprint(seen) - MIDDLE) @ side).max())


def _room(wish: Wish, things: Standing) -> bool:
    here = footprint(things[wish.told[0]])
    return _find_places(wish, things, lambda there: gap(footprint(there), here) >= D.room)


def _away(wish: Wish, things: Standing) -> bool:
    here = _here(things[wish.moved[0]])
    return _find_places(
        wish, things, lambda there: float(np.linalg.norm(_here(there) - here)) >= D.aside
    )


def _find_places(wish: Wish, things: Standing, fits: Callable[[SeenObject], bool]) -> bool:
    """Return True if what is moved finds a place one after the other, the nearest first."""
    if not _may_go(wish, things) or not wish.moved:
        return False
    (x0, x1), (y0, y1) = TABLE
    grid = np.stack(np.meshgrid(np.arange(x0, x1, _STEP), np.arange(y0, y1, _STEP)), -1)
    spots, rest = grid.reshape(-1, 2), _others(things, *wish.moved)
    for name in wish.moved:
        seen = things[name]
        order = np.argsort(np.linalg.norm(spots - _here(seen), axis=1), kind="stable")
        places = (_at(seen, spot) for spot in spots[order])
        there = next((each for each in places if fits(each) and _is_free(each, rest)), None)
        if there is None:
            return False
        rest.append(there)
    return True


def _blocked(wish: Wish, things: Standing) -> bool:
    """What stands in its way may be moved, and the end is on the table and free of what may not."""
    own = things[wish.moved[0]]
    return _may_go(wish, things) and _way_is_free(wish, own, _staying(things, own.name))


def _staying(things: Standing, name: str) -> list[SeenObject]:
    """All others that are not moved aside."""
    others = _others(things, name)
    return [seen for seen in others if seen.fragile or not slides(seen.model)]


def _way_is_free(wish: Wish, own: SeenObject, others: Sequence[SeenObject]) -> bool:
    assert wish.way is not None, "it goes somewhere"
    u, steps = np.array(WAYS[wish.way]), np.arange(_STEP, wish.distance + 1e-9, _STEP)
    return all(_is_free(_at(own, _here(own) + step * u), others) for step in steps)


def _restored(wish: Wish, things: Standing) -> bool:
    """What is moved aside finds a place, and the push ends clear of where it is put back."""
    own, other = wish.moved
    rest = {name: seen for name, seen in things.items() if name != other}
    aside = replace(wish, moved=(other,))
    end = _at(things[own], _here(things[own]) + wish.distance * np.array(WAYS[wish.way or "left"]))
    apart = gap(footprint(end), footprint(things[other])) >= ROOM
    return apart and _away(aside, things) and _blocked(replace(wish, moved=(own,)), rest)


def _all(wish: Wish, things: Standing) -> bool:
    """The ends of all ways are free, and so are the ways past what stays."""
    rest = _others(things, *wish.moved)
    return _may_go(wish, things) and all(
        _way_is_free(wish, things[name], rest) for name in wish.moved
    )


def _flat(wish: Wish, things: Standing) -> bool:
    """It is drawn along from above, and its way is free; what slides may be moved aside."""
    own = things[wish.moved[0]]
    return not own.fragile and _way_is_free(wish, own, _staying(things, own.name))


def _over(wish: Wish, things: Standing) -> bool:
    """Its way straight to the edge is free, and its middle stays over the table by `_OVER`."""
    assert wish.way is not None, "an edge has a side"
    own, u = things[wish.moved[0]], np.array(WAYS[wish.way])
    beyond = float((footprint(own) @ u).max()) - wish.edge
    way = max(wish.distance, _STEP) - beyond
    com = (own.pose.R_WB @ np.array(own.model.com) + own.pose.p_WB)[:2]
    rest = _staying(things, own.name)
    there = (footprint(_at(own, _here(own) + step * u)) for step in np.arange(0.0, way, _STEP))
    free = all(gap(covered, footprint(other)) >= ROOM for covered in there for other in rest)
    return not own.fragile and free and float(com @ u) + way <= wish.edge - _OVER


def _lay(wish: Wish, things: Standing) -> bool:
    """Pushed high up on some side it tips before it slides, and there is room where it falls."""
    own = things[wish.moved[0]]
    model, rest = own.model, _others(things, own.name)
    high = _HIGH * model.top
    for face in model.faces():
        points, inward = face.points_at(0.0, high)[0], -np.array(face.normal)
        found = model.thresholds(points[None], inward[None])
        tips = bool((np.asarray(found.topple) < SPARE * np.asarray(found.slide)).all())
        along = model.top * (own.pose.R_WB[:2, :2] @ inward[:2])
        fallen = np.vstack([footprint(own), footprint(own) + along])
        if tips and all(gap(hull_polygon(fallen).vertices, footprint(o)) >= ROOM for o in rest):
            return True
    return False


def _turned(wish: Wish, things: Standing) -> bool:
    own = things[wish.moved[0]]
    reach = float(np.linalg.norm(footprint(own) - _here(own), axis=1).max())
    circle = _here(own) + reach * np.column_stack([np.cos(_HEADINGS), np.sin(_HEADINGS)])
    others = _others(things, own.name)
    return _may_go(wish, things) and all(gap(circle, footprint(o)) >= ROOM for o in others)


def _stand(wish: Wish, things: Standing) -> bool:
    """A hand takes it as it lies, and nothing stands close by."""
    own = things[wish.moved[0]]
    covered = footprint(own)
    room = all(gap(covered, footprint(o)) >= 2.0 * ROOM for o in _others(things, own.name))
    return room and may_be_held_lying(own, WorldState(things, _TABLE))


def _on(wish: Wish, things: Standing) -> bool:
    own, lower = things[wish.moved[0]], things[wish.told[0]]
    narrow = float(np.ptp(np.array(lower.model.outline), axis=0).min())
    low = own.model.top + lower.model.top <= HIGHEST
    state = WorldState(things, _TABLE)
    beside = all(gap(footprint(lower), footprint(o)) >= 2.0 * ROOM
                 for o in _others(things, lower.name, own.name))  # fmt: skip
    return low and narrow >= 0.06 and beside and may_be_held(own, state)


def _off(wish: Wish, things: Standing) -> bool:
    own, lower = things[wish.moved[0]], things[wish.told[0]]
    rest = _others(things, own.name, lower.name)
    state = WorldState({seen.name: seen for seen in (own, *rest)}, _TABLE)
    return may_be_held(own, state) and _fits_beside(own, lower, rest)


def _into(wish: Wish, things: Standing) -> bool:
    """With some heading there is a free place for it between the walls."""
    own, box = (things[name] for name in (*wish.moved, *wish.told))
    inside = box.model.inside
    assert inside is not None, "it is put into an open box"
    contents = [seen for seen in things.values() if seen.on == box.name]
    half, R_WB = 0.5 * np.array(inside.size), box.pose.R_WB[:2, :2]
    grid = np.stack(np.meshgrid(*(np.arange(-h, h, _STEP) for h in half)), -1).reshape(-1, 2)
    rest = _others(things, own.name, box.name, *(seen.name for seen in contents))
    held = may_be_held(own, WorldState({seen.name: seen for seen in (own, *rest)}, _TABLE))
    return held and any(
        _is_within(there, box, half) and all(gap(footprint(there), footprint(o)) >= D.clearance
                                             for o in contents)
        for there in (
            _turned_at(own, heading, R_WB @ spot + _here(box))
            for heading in _HEADINGS
            for spot in grid
        )
    )  # fmt: skip


def _turned_at(seen: SeenObject, heading: float, xy: Array) -> SeenObject:
    there = _at(seen, xy)
    return replace(there, pose=replace(there.pose, yaw=heading))


def _is_within(seen: SeenObject, box: SeenObject, half: Array) -> bool:
    in_B = (footprint(seen) - _here(box)) @ box.pose.R_WB[:2, :2]
    return bool((np.abs(in_B) <= half - D.clearance).all())


_TABLE = TableState(-0.2, 1.2, -0.8, 0.8)

_LABELS: dict[Kind, Callable[[Wish, Standing], bool]] = {
    "swap": _swap,
    "row": _row,
    "together": _together,
    "between": _between,
    "clear": _clear,
    "room": _room,
    "aside": _away,
    "blocked": _blocked,
    "facing": _turned,
    "straight": _turned,
    "stand": _stand,
    "on": _on,
    "off": _off,
    "into": _into,
    "out of": _off,
    "lay": _lay,
    "flat": _flat,
    "all": _all,
    "back": _blocked,
    "restore": _restored,
    "edge": _over,
    "asked": lambda wish, things: True,
}
