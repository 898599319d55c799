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

from benchmarks.goals.drawn_worlds import apart
from benchmarks.goals.hand_sense import may_be_held, may_be_held_lying
from benchmarks.goals.sense import ROOM, TABLE, onset
from benchmarks.goals.wishes import MIDDLE, Wish
from objectmodels import ObjectModel
from objectmodels.geometry.base_shapes import Array, hull_polygon
from objectmodels.geometry.side_faces import Face
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
_TABLE = TableState(-0.2, 1.2, -0.8, 0.8)


def is_sensible(wish: Wish, things: Standing) -> bool:
    """Whether a person would ask for it."""
    if wish.kind == "asked":
        return True
    if wish.kind in ("stand", "on", "off", "out of", "into", "lay", "flat", "edge"):
        return _may_be_handled(wish, things)
    movable = all(slides(things[name].model) and not things[name].fragile for name in wish.moved)
    return movable and _may_be_pushed(wish, things)


def slides(model: ObjectModel) -> bool:
    """Whether an object clearly slides before it tips when it is touched low on any side."""
    low = lowest_contact(HAND)
    return model.top > low and all(onset(model, face, low).slides for face in model.faces())


def _at(seen: SeenObject, xy: Array, yaw: float | None = None) -> SeenObject:
    x, y = xy.tolist()
    pose = replace(seen.pose, x=x, y=y, yaw=seen.pose.yaw if yaw is None else yaw)
    return replace(seen, pose=pose)


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


def _may_be_pushed(wish: Wish, things: Standing) -> bool:
    """Whether what slides has free places to go to."""
    own, rest = [things[name] for name in wish.moved], _others(things, *wish.moved)
    match wish.kind:
        case "swap":
            there = [_at(own[0], _here(own[1])), _at(own[1], _here(own[0]))]
            return apart(*there) >= ROOM and all(_is_free(each, rest) for each in there)
        case "row":
            return _fits_in_row(own, rest)
        case "together":
            one, other = own
            return any(_fits_beside(a, b, rest) for a, b in ((one, other), (other, one)))
        case "between":
            a, b = (_here(things[name]) for name in wish.told)
            spots = (a + share * (b - a) for share in np.linspace(0.35, 0.65, 13))
            return any(_is_free(_at(own[0], spot), rest) for spot in spots)
        case "clear":  # each of them has a place in the other half, with the others in theirs
            side = wish.direction
            return _find_places(
                own, rest, lambda there: ((footprint(there) - MIDDLE) @ side).max() <= 0.0
            )
        case "room":
            return _find_places(
                own, rest, lambda there: apart(there, things[wish.told[0]]) >= D.room
            )
        case "aside":
            return _may_go_aside(own[0], rest)
        case "blocked" | "back":  # what stands in its way may be moved
            return _way_is_free(wish, own[0], _staying(rest))
        case "restore":
            # What is moved aside finds a place, and the push ends clear of where it is put back.
            pushed, other = own
            end = _at(pushed, _here(pushed) + wish.distance * wish.direction)
            aside = apart(end, other) >= ROOM and _may_go_aside(other, [*rest, pushed])
            return aside and _way_is_free(wish, pushed, _staying(rest))
        case "all":  # the ends of all ways are free, and so are the ways past what stays
            return all(_way_is_free(wish, each, rest) for each in own)
        case _:  # it is turned, with the circle about it free
            reach = float(np.linalg.norm(footprint(own[0]) - _here(own[0]), axis=1).max())
            rim = np.column_stack([np.cos(_HEADINGS), np.sin(_HEADINGS)])
            circle = _here(own[0]) + reach * rim
            return all(gap(circle, footprint(other)) >= ROOM for other in rest)


def _fits_in_row(own: Sequence[SeenObject], rest: list[SeenObject]) -> bool:
    """Along x or y, through one of them, with all else where it is."""
    for across, anchor in itertools.product((0, 1), own):
        spots = [_here(seen) for seen in own]
        for spot in spots:
            spot[across] = _here(anchor)[across]
        there = [_at(seen, spot) for seen, spot in zip(own, spots, strict=True)]
        if all(_is_free(seen, [*rest, *there[:k]]) for k, seen in enumerate(there)):
            return True
    return False


def _fits_beside(own: SeenObject, to: SeenObject, rest: list[SeenObject]) -> bool:
    for heading in _HEADINGS:
        u = np.array([np.cos(heading), np.sin(heading)])
        ways = (_at(own, _here(to) + way * u) for way in np.arange(0.05, 0.3, 0.01))
        there = next((each for each in ways if apart(each, to) >= D.place_gap), None)
        if there is not None and _is_free(there, rest):
            return True
    return False


def _find_places(
    moved: Sequence[SeenObject], rest: Sequence[SeenObject], fits: Callable[[SeenObject], bool]
) -> bool:
    """Whether what is moved finds a place one after the other, the nearest first."""
    (x0, x1), (y0, y1) = TABLE
    grid = np.stack(np.meshgrid(np.arange(x0, x1, _STEP), np.arange(y0, y1, _STEP)), -1)
    spots, taken = grid.reshape(-1, 2), list(rest)
    for seen in moved:
        order = np.argsort(np.linalg.norm(spots - _here(seen), axis=1), kind="stable")
        places = (_at(seen, spot) for spot in spots[order])
        there = next((each for each in places if fits(each) and _is_free(each, taken)), None)
        if there is None:
            return False
        taken.append(there)
    return bool(moved)


def _may_go_aside(own: SeenObject, rest: Sequence[SeenObject]) -> bool:
    here = _here(own)
    return _find_places(
        [own], rest, lambda there: float(np.linalg.norm(_here(there) - here)) >= D.aside
    )


def _staying(others: Iterable[SeenObject]) -> list[SeenObject]:
    """What is not moved aside."""
    return [seen for seen in others if seen.fragile or not slides(seen.model)]


def _way_is_free(wish: Wish, own: SeenObject, others: Sequence[SeenObject]) -> bool:
    steps = np.arange(_STEP, wish.distance + 1e-9, _STEP)
    return all(_is_free(_at(own, _here(own) + step * wish.direction), others) for step in steps)


def _may_be_handled(wish: Wish, things: Standing) -> bool:
    """Whether a hand may take, topple or draw what is moved."""
    own = things[wish.moved[0]]
    lower = things[wish.told[0]] if wish.told else own
    rest = _others(things, own.name)
    match wish.kind:
        case "stand":  # a hand takes it as it lies, and nothing stands close by
            room = all(apart(own, other) >= 2.0 * ROOM for other in rest)
            return room and may_be_held_lying(own, WorldState(things, _TABLE))
        case "on":
            narrow = float(np.ptp(np.array(lower.model.outline), axis=0).min())
            low = own.model.top + lower.model.top <= HIGHEST
            beside = all(
                apart(lower, other) >= 2.0 * ROOM for other in rest if other.name != lower.name
            )
            held = low and narrow >= 0.06 and beside
            return held and may_be_held(own, WorldState(things, _TABLE))
        case "off" | "out of":
            rest = _others(things, own.name, lower.name)
            return _may_be_held_among(own, rest) and _fits_beside(own, lower, rest)
        case "into":
            return _may_be_put_into(own, lower, rest)
        case "lay":
            return any(_may_fall(own, face, rest) for face in own.model.faces())
        case "flat":  # it is drawn along from above, and its way is free
            return not own.fragile and _way_is_free(wish, own, _staying(rest))
    return not own.fragile and _may_hang_over(wish, own, _staying(rest))


def _may_be_held_among(own: SeenObject, others: Iterable[SeenObject]) -> bool:
    return may_be_held(own, WorldState({seen.name: seen for seen in (own, *others)}, _TABLE))


def _may_hang_over(wish: Wish, own: SeenObject, rest: Sequence[SeenObject]) -> bool:
    """Whether its way to the edge is free, and its middle stays over the table by `_OVER`."""
    u = wish.direction
    beyond = float((footprint(own) @ u).max()) - wish.edge
    way = max(wish.distance, _STEP) - beyond
    com = (own.pose.R_WB @ np.array(own.model.com) + own.pose.p_WB)[:2]
    there = (footprint(_at(own, _here(own) + step * u)) for step in np.arange(0.0, way, _STEP))
    free = all(gap(covered, footprint(other)) >= ROOM for covered in there for other in rest)
    return free and float(com @ u) + way <= wish.edge - _OVER


def _may_fall(own: SeenObject, face: Face, rest: Sequence[SeenObject]) -> bool:
    """Whether it tips before it slides, pushed high up on a side, and has room where it falls."""
    tips = onset(own.model, face, _HIGH * own.model.top).topples
    along = own.model.top * (own.pose.R_WB[:2, :2] @ -np.array(face.normal)[:2])
    fallen = np.vstack([footprint(own), footprint(own) + along])
    return tips and all(gap(hull_polygon(fallen).vertices, footprint(o)) >= ROOM for o in rest)


def _may_be_put_into(own: SeenObject, box: SeenObject, others: Sequence[SeenObject]) -> bool:
    """Whether with some heading there is a free place for it between the walls."""
    inside = box.model.inside
    assert inside is not None, "it is put into an open box"
    contents = [seen for seen in others if seen.on == box.name]
    rest = [seen for seen in others if seen is not box and seen not in contents]
    half, R_WB = 0.5 * np.array(inside.size), box.pose.R_WB[:2, :2]
    grid = np.stack(np.meshgrid(*(np.arange(-h, h, _STEP) for h in half)), -1).reshape(-1, 2)
    if not _may_be_held_among(own, rest):
        return False
    for heading, spot in itertools.product(_HEADINGS, grid):
        there = _at(own, R_WB @ spot + _here(box), heading)
        in_B = (footprint(there) - _here(box)) @ R_WB
        within = bool((np.abs(in_B) <= half - D.clearance).all())
        if within and all(apart(there, other) >= D.clearance for other in contents):
            return True
    return False
