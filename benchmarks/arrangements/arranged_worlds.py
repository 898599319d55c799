"""What stands on the table in worlds drawn for sentences about several things.

A world holds what a kind of sentence needs and up to two things more; what is spoken of comes
first.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from benchmarks.arrangements.wishes import WAYS, Kind
from nlcontrol.batches.drawn_scenes import (
    GAP,
    REACHED,
    STANDING,
    Generator,
    free_place,
    pushable_models,
)
from objectmodels import BoxModel, CylinderModel, ObjectModel, Registry
from objectmodels.geometry.rotations import rot_x, rot_y
from planner.problem.footprints import footprint, gap
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import PlanarPose, SeenObject
from sim.truth.scene_file import VaryingTable

CLOSE = (0.05, 0.08)
"""Gap at which something stands that is to make room, or is in the way [m]."""

SMALL_TABLE = VaryingTable(centre_m=(0.55, 0.0), size_m=(0.9, 1.0))
"""A table whose edges are as near as those that a person at it would speak of."""

_TRIES_INSIDE = 200  # places in a box that are tried for a thing


def draw_things(kind: Kind, rng: Generator) -> list[SeenObject]:
    """What stands there for a sentence of a kind."""
    return _DRAWN.get(kind, _stand_about)(kind, rng)


def table_of(kind: Kind) -> VaryingTable:
    """The table for a sentence of a kind."""
    return SMALL_TABLE if kind == "edge" else VaryingTable()


def apart(seen: SeenObject, other: SeenObject) -> float:
    """Gap between two things, seen from above [m]."""
    return gap(footprint(seen), footprint(other))


_NEEDED: dict[Kind, int] = {
    "swap": 2, "row": 3, "together": 2, "between": 3, "clear": 2, "room": 1, "aside": 1,
    "blocked": 1, "facing": 2, "straight": 1, "stand": 1, "lay": 1, "flat": 1, "all": 2, "back": 1,
    "edge": 1,
}  # fmt: skip


def _models(kind: Kind, rng: Generator) -> list[ObjectModel]:
    """Different models, the first of which fits the kind."""
    found = list(pushable_models())
    models = [found[k] for k in rng.permutation(len(found)).tolist()]
    if kind in ("flat", "edge"):
        return [Registry.built_in().get("book"), *models]
    fits = _FITS.get(kind)
    first = next(model for model in models if fits is None or fits(model))
    return [first, *(model for model in models if model is not first)]


_FITS: dict[Kind, Callable[[ObjectModel], bool]] = {
    "facing": lambda model: not isinstance(model, CylinderModel),
    "straight": lambda model: not isinstance(model, CylinderModel),
    "stand": lambda model: isinstance(model, BoxModel),
    "lay": lambda model: isinstance(model, BoxModel),
    "asked": lambda model: model.top <= 0.2,
    "on": lambda model: model.grasp is not None or model.top <= 0.2,
    "off": lambda model: model.grasp is not None or model.top <= 0.2,
}


def _stand_about(kind: Kind, rng: Generator, *, more: int | None = None) -> list[SeenObject]:
    """Things apart from each other, the one spoken of first."""
    count = _NEEDED[kind] + (int(rng.integers(3)) if more is None else more)
    things: list[SeenObject] = []
    for model in _models(kind, rng)[:count]:
        _add(things, model, rng)
    return things


def _add(
    things: list[SeenObject],
    model: ObjectModel,
    rng: Generator,
    spans: tuple[tuple[float, float], ...] | None = None,
    room: float = GAP,
) -> bool:
    spans = spans or (STANDING if things else REACHED)
    pose = free_place(model, spans, things, rng, apart=room)
    if pose is not None:
        things.append(SeenObject(model.name, pose, model))
    return pose is not None


def _close_by(kind: Kind, rng: Generator) -> list[SeenObject]:
    """One or two things near the first, and others farther off."""
    things = _stand_about(kind, rng, more=0)
    others = iter(_models(kind, rng))
    for _ in range(int(rng.integers(1, 3))):
        model = next(each for each in others if each.name != things[0].name)
        reach = 0.12 + 0.5 * float(np.ptp(np.array(model.outline)))
        at = things[0].pose
        spans = ((at.x - reach, at.x + reach), (at.y - reach, at.y + reach))
        _add(things, model, rng, spans, float(rng.uniform(*CLOSE)))
    return things


def _in_the_way(kind: Kind, rng: Generator) -> list[SeenObject]:
    """One thing in the way of another."""
    first, second = _models(kind, rng)[:2]
    things: list[SeenObject] = []
    _add(things, first, rng)
    at = things[0].pose
    u = np.array(list(WAYS.values())[int(rng.integers(4))])
    x, y = (np.array([at.x, at.y]) + float(rng.uniform(0.14, 0.22)) * u).tolist()
    spans = ((x - 0.02, x + 0.02), (y - 0.02, y + 0.02))
    _add(things, second, rng, spans, CLOSE[0])
    return things


def _fallen(kind: Kind, rng: Generator) -> list[SeenObject]:
    """The first lies on one of its sides."""
    first, *rest = _models(kind, rng)[: 1 + int(rng.integers(1, 3))]
    pose = free_place(first, REACHED, (), rng)
    assert pose is not None, "an empty table has room"
    about, way = (rot_x, rot_y)[int(rng.integers(2))], int(rng.choice([-1, 1]))
    attitude = tuple(about(way * math.pi / 2.0).ravel().tolist())
    lying = SeenObject(first.name, PlanarPose(pose.x, pose.y, pose.yaw, attitude), first)
    things = [lying]
    for model in rest:
        lain = [SeenObject.lying(seen.name, seen.pose, seen.model) for seen in things]
        place = free_place(model, STANDING, lain, rng)
        if place is not None:
            things.append(SeenObject(model.name, place, model))
    return things


def _stacked(kind: Kind, rng: Generator) -> list[SeenObject]:
    """The first stands on a book or a box."""
    first, *others = _models(kind, rng)
    lower = _lower(first, rng)
    things: list[SeenObject] = []
    _add(things, lower, rng, REACHED)
    at = things[0].pose
    yaw = float(rng.uniform(-math.pi, math.pi))
    on = SeenObject(first.name, PlanarPose(at.x, at.y, yaw), first, on=lower.name)
    for model in others[: int(rng.integers(2))]:
        if model.name != lower.name:
            _add(things, model, rng)
    return [on, *things]


def _stacked_or_boxed(kind: Kind, rng: Generator) -> list[SeenObject]:
    """The first stands on another thing, or in an open box."""
    return _stacked("off", rng) if rng.random() < 0.5 else _with_box("out of", rng)


def _lower(first: ObjectModel, rng: Generator) -> ObjectModel:
    """A book or a box on which something may stand."""
    boxes = [model for model in Registry.built_in() if isinstance(model, BoxModel)]
    fitting = [
        model
        for model in boxes
        if model.name != first.name and model.top < 0.2 and model.inside is None
    ]
    return fitting[int(rng.integers(len(fitting)))]


def _with_lower(kind: Kind, rng: Generator) -> list[SeenObject]:
    """Something to hold, something on which it fits, and others."""
    first, *others = _models(kind, rng)
    lower = _lower(first, rng)
    things: list[SeenObject] = []
    for model in (first, lower, *others[: int(rng.integers(2))]):
        if model.name not in [seen.name for seen in things]:
            _add(things, model, rng, room=GAP + 0.02)
    return things


def _with_box(kind: Kind, rng: Generator) -> list[SeenObject]:
    """Something beside an open box or in it, the box, and one thing more in or beside it."""
    box = next(model for model in Registry.built_in() if model.inside is not None)
    first, other = _models(kind, rng)[:2]
    boxes: list[SeenObject] = []
    _add(boxes, box, rng, ((0.45, 0.60), (-0.15, 0.15)))
    inside = [first] if kind == "out of" else []
    if rng.random() < 0.3:
        inside.append(other)
    in_box: list[SeenObject] = []
    for model in inside:
        _add_inside(in_box, boxes[0], model, rng)
    beside = list(boxes)
    for model in (first, other):
        if model not in inside and (model is first or rng.random() < 0.5):
            _add(beside, model, rng, STANDING, GAP + 0.02)
    found = [*in_box, *beside[1:]]
    return [*(s for s in found if s.name == first.name), boxes[0],
            *(s for s in found if s.name != first.name)]  # fmt: skip


def _add_inside(
    things: list[SeenObject], box: SeenObject, model: ObjectModel, rng: Generator
) -> None:
    """Adds something that stands somewhere between the walls, if there is room for it."""
    inside = box.model.inside
    assert inside is not None, "the box is open"
    R_WB, half = box.pose.R_WB[:2, :2], 0.5 * np.array(inside.size) - D.clearance
    for _ in range(_TRIES_INSIDE):
        x, y = (R_WB @ rng.uniform(-half, half) + box.pose.p_WB[:2]).tolist()
        pose = PlanarPose(x, y, float(rng.uniform(-math.pi, math.pi)))
        seen = SeenObject(model.name, pose, model, on=box.name)
        off = np.abs((footprint(seen) - box.pose.p_WB[:2]) @ R_WB)
        if (off <= half).all() and all(apart(seen, other) >= 2.0 * D.clearance for other in things):
            things.append(seen)
            return


_DRAWN: dict[Kind, Callable[[Kind, Generator], list[SeenObject]]] = {
    "room": _close_by,
    "blocked": _in_the_way,
    "restore": _in_the_way,
    "stand": _fallen,
    "on": _with_lower,
    "off": _stacked,
    "asked": _stacked_or_boxed,
    "into": _with_box,
    "out of": _with_box,
}
