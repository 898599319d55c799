"""Worlds and sentences about several things, drawn by seed and number alone.

Kinds take turns. A world holds what its sentence needs and up to two things more, with true masses,
frictions and centres of mass as in `nlcontrol.batches.drawn_scenes`. It is drawn again until the
sentence makes sense (`arranged_labels`), `TRIES` times at most; one in ten is drawn blindly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, get_args

import numpy as np

from benchmarks.arrangements.arranged_labels import is_sensible
from benchmarks.arrangements.wishes import MIDDLE, WAYS, Kind, Way, Wish
from benchmarks.goals.worlds import standing
from nlcontrol.batches.drawn_scenes import (
    FRAGILE,
    GAP,
    REACHED,
    STANDING,
    Generator,
    draw_truth,
    free_place,
    pushable_models,
    scene_of,
)
from objectmodels import BoxModel, CylinderModel, ObjectModel, Registry
from objectmodels.models.top_face import standing_height
from planner.geometry.footprints import footprint, gap
from planner.types.defaults import DEFAULTS as D
from planner.types.world_state import PlanarPose, SeenObject
from sim.cell.cell_description import Vision
from sim.rotations import rot_x, rot_y
from sim.truth.scene_file import Pose, Scene, SceneObject

BOX_KINDS: tuple[Kind, ...] = ("into", "out of")
"""Kinds about an open box; their cases are numbered by themselves."""
KINDS: tuple[Kind, ...] = tuple(kind for kind in get_args(Kind) if kind not in BOX_KINDS)
TRIES = 30
"""Worlds that are drawn until one makes sense."""
BLIND = 0.1
"""Share of the sentences that need not make sense."""
_TRIES_INSIDE = 200  # places in a box that are tried for a thing
CLOSE = (0.05, 0.08)
"""Gap at which something stands that is to make room, or is in the way [m]."""

_HALVES: dict[str, Way] = {"left": "left", "right": "right", "front": "toward", "back": "away"}
_PUSHED: dict[Way, str] = {
    "left": "to the left", "right": "to the right", "away": "away", "toward": "toward me",
}  # fmt: skip


class Job(NamedTuple):
    """One case: which world and sentence, and whether it is one of those about open boxes."""

    seed: int
    number: int
    boxes: bool = False

    @property
    def kind(self) -> Kind:
        """Of its sentence."""
        kinds = BOX_KINDS if self.boxes else KINDS
        return kinds[self.number % len(kinds)]


class Asked(NamedTuple):
    """A world, what is said in it and meant by it, and whether a person would say it."""

    scene: Scene
    text: str
    wish: Wish
    sensible: bool


def draw_case(job: Job) -> Asked:
    """The case of a job."""
    rng = np.random.default_rng((job.seed, job.number, *[1] * job.boxes))
    blind = bool(rng.random() < BLIND)
    for _ in range(1 if blind else TRIES):
        things = _DRAWN.get(job.kind, _stand_about)(job.kind, rng)
        text, wish = _said(job.kind, things, rng)
        truths = [draw_truth(Registry.built_in().get(_model_of(seen)), rng) for seen in things]
        objects = [_scene_object(seen, truth, things)
                   for seen, truth in zip(things, truths, strict=True)]  # fmt: skip
        objects = [item if item.name in (*wish.moved, *wish.told) else _maybe_fragile(item, rng)
                   for item in objects]  # fmt: skip
        scene = scene_of(f"{job.seed}-{job.number}", objects, Vision())
        if sensible := is_sensible(wish, standing(scene)):
            break
    return Asked(scene, text, wish, sensible)


def _model_of(seen: SeenObject) -> str:
    return seen.standing_model.name


def _scene_object(seen: SeenObject, truth: object, things: Sequence[SeenObject]) -> SceneObject:
    roll, pitch = 0.0, 0.0
    if seen.pose.attitude is not None:
        R = np.reshape(seen.pose.attitude, (3, 3))
        roll, pitch = (90.0 * round(float(sine)) for sine in (R[2, 1], R[0, 2]))
    z = next((standing_height(other.model) for other in things if other.name == seen.on), 0.0)
    yaw = math.degrees(seen.pose.yaw)
    pose = Pose(x_m=seen.pose.x, y_m=seen.pose.y, z_m=z, yaw_deg=yaw, roll_deg=roll,
                pitch_deg=pitch)  # fmt: skip
    values: dict[str, object] = {
        "name": seen.name,
        "model": _model_of(seen),
        "pose": pose,
        "truth": truth,
    }
    return SceneObject.model_validate(values)


def _maybe_fragile(item: SceneObject, rng: Generator) -> SceneObject:
    return item.model_copy(update={"fragile": bool(rng.random() < FRAGILE)})


# --- what stands there ---------------------------------------------------------------------------

_NEEDED: dict[Kind, int] = {
    "swap": 2, "row": 3, "together": 2, "between": 3, "clear": 2, "room": 1, "aside": 1,
    "blocked": 1, "facing": 2, "straight": 1, "stand": 1, "on": 2, "off": 1, "into": 1, "out of": 1,
}  # fmt: skip


def _models(kind: Kind, rng: Generator) -> list[ObjectModel]:
    """Different models, the first of which fits the kind."""
    found = list(pushable_models())
    models = [found[k] for k in rng.permutation(len(found)).tolist()]
    fits = _FITS.get(kind)
    first = next(model for model in models if fits is None or fits(model))
    return [first, *(model for model in models if model is not first)]


_FITS: dict[Kind, Callable[[ObjectModel], bool]] = {
    "facing": lambda model: not isinstance(model, CylinderModel),
    "straight": lambda model: not isinstance(model, CylinderModel),
    "stand": lambda model: isinstance(model, BoxModel),
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
    apart: float = GAP,
) -> bool:
    spans = spans or (STANDING if things else REACHED)
    pose = free_place(model, spans, things, rng, apart=apart)
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
            _add(things, model, rng, apart=GAP + 0.02)
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
        if (off <= half).all() and all(
            _apart(seen, other) >= 2.0 * D.clearance for other in things
        ):
            things.append(seen)
            return


_DRAWN: dict[Kind, Callable[[Kind, Generator], list[SeenObject]]] = {
    "room": _close_by,
    "blocked": _in_the_way,
    "stand": _fallen,
    "on": _with_lower,
    "off": _stacked,
    "into": _with_box,
    "out of": _with_box,
}


# --- what is said --------------------------------------------------------------------------------

_SAID: dict[Kind, tuple[str, ...]] = {
    "swap": ("swap {a} and {b}", "exchange {a} and {b}"),
    "row": ("put {a}, {b} and {c} in a row", "line up {a}, {b} and {c}"),
    "together": ("put {a} and {b} together", "push {a} and {b} together"),
    "between": ("put {a} between {b} and {c}", "push {a} between {b} and {c}"),
    "room": ("make room for {a}", "make some room around {a}"),
    "aside": ("get {a} out of the way", "move {a} aside"),
    "facing": ("turn {a} to face {b}", "turn {a} towards {b}"),
    "stand": ("stand {a} up", "set {a} upright", "put {a} upright"),
    "on": ("put {a} on {b}",),
    "off": ("take {a} off {b}",),
    "into": ("put {a} into {b}", "put {a} in {b}"),
    "out of": ("take {a} out of {b}",),
}
_MOVED: dict[Kind, int] = {"swap": 2, "row": 3, "together": 2}
_TOLD: dict[Kind, int] = {"between": 2, "facing": 1, "on": 1, "off": 1, "into": 1, "out of": 1}


def _said(kind: Kind, things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Words, and what they mean by true poses."""
    match kind:
        case "clear":
            return _clearing(things, rng)
        case "blocked":
            return _blocked_push(things, rng)
        case "straight":
            return _straightening(things, rng)
    names = [seen.name for seen in things]
    a, b, c = (f"the {name}" for name in (names * 3)[:3])
    words = _SAID[kind][int(rng.integers(len(_SAID[kind])))].format(a=a, b=b, c=c)
    if kind == "room":
        near = [seen.name for seen in things[1:] if _apart(seen, things[0]) < D.room]
        return words, Wish(kind, tuple(near), told=(names[0],))
    count = _MOVED.get(kind, 1)
    told = names[count : count + _TOLD.get(kind, 0)]
    return words, Wish(kind, tuple(names[:count]), tuple(told))


def _clearing(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """A half of the table."""
    half = list(_HALVES)[int(rng.integers(len(_HALVES)))]
    inside = [seen.name for seen in things if _reaches(seen, _HALVES[half])]
    return f"clear the {half} half of the table", Wish("clear", tuple(inside), way=_HALVES[half])


def _reaches(seen: SeenObject, side: Way) -> bool:
    return float(((footprint(seen) - MIDDLE) @ np.array(WAYS[side])).max()) > 0.0


def _apart(seen: SeenObject, other: SeenObject) -> float:
    return gap(footprint(seen), footprint(other))


def _blocked_push(things: Sequence[SeenObject], rng: Generator) -> tuple[str, Wish]:
    """Past what stands in the way, or a bit of a way where nothing does."""
    own, distance = things[0], 20
    way: Way = "left"
    if len(things) > 1:
        at, there = (np.array([seen.pose.x, seen.pose.y]) for seen in things)
        way = max(WAYS, key=lambda each: float((there - at) @ np.array(WAYS[each])))
        distance = round(100.0 * float(np.linalg.norm(there - at))) + int(rng.integers(0, 10))
    text = f"push the {own.name} {distance} cm {_PUSHED[way]}"
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
