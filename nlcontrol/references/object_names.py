"""Names of objects and of their side faces.

An object's name is taken in three steps, the first that fits decides: the whole name, a synonym (of
the scene or of the registry's model), or some of the words of a name ("the box", "the coffee"). A
misspelled name is never guessed; it only yields a suggestion. Faces are named as they look at the
robot; where nothing says how the object is turned, as if B's axes were the robot's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nlcontrol.errors import error
from objectmodels import Face, ObjectModel, suggest
from planner.problem.directions import face_name
from planner.problem.footprints import footprint, gap

if TYPE_CHECKING:
    from grammar.frames.command import Quality, Relation
    from planner.types.world_state import SeenObject
    from sim.robots.cell_description import CellObject


@dataclass(frozen=True)
class Candidate:
    """A name that may be meant.

    Attributes:
        name: name of the object in the scene.
        names: everything that it is called: its name, synonyms, the model's name.
    """

    name: str
    names: tuple[str, ...]


def names_on_table(
    objects: Iterable[CellObject], models: Mapping[str, ObjectModel]
) -> list[Candidate]:
    """The names of a cell's objects: its own, their synonyms, and those of their models."""
    return [
        Candidate(item.name, (item.name, *item.synonyms, item.model, *models[item.name].synonyms))
        for item in objects
    ]


def find_by_name(text: str, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Those whose name it is; if there is none, those of whose name it is a part."""
    first, _, second = text.partition(" of ")  # "the carton of milk" is a milk carton
    for wanted in (name_words(text), name_words(f"{second} {first}")):
        for fits in (_is_whole_name, _is_part_of):
            found = [c for c in candidates if any(fits(wanted, name_words(n)) for n in c.names)]
            if found:
                return found
    return []


def name_words(text: str) -> tuple[str, ...]:
    """The words of a name, without its article."""
    plain = text.casefold().replace("-", " ").replace("_", " ").replace("iced tea", "ice tea")
    split = tuple(plain.split())
    return split[1:] if len(split) > 1 and split[0] in {"the", "a", "an", "my", "this"} else split


def _is_whole_name(wanted: tuple[str, ...], name: tuple[str, ...]) -> bool:
    return wanted == name


def _is_part_of(wanted: tuple[str, ...], name: tuple[str, ...]) -> bool:
    """True if the wanted words stand in the name in this order, perhaps with others between."""
    rest = iter(name)
    return all(word in rest for word in wanted)


def distinguishing_words(names: Sequence[str]) -> list[str]:
    """Of each name the words that the others lack, or all of it if there are none."""
    common = set.intersection(*(set(name_words(name)) for name in names))
    return [" ".join(w for w in name_words(n) if w not in common) or n for n in names]


def likely_name(text: str, candidates: Iterable[Candidate]) -> str | None:
    """The one object whose name is close to a misspelled text; None if two are about as close."""
    owners = [(name, c.name) for c in candidates for name in c.names]
    near = suggest(" ".join(name_words(text)), [name for name, _ in owners])
    found = {owner for name, owner in owners if name in near}
    return found.pop() if len(found) == 1 else None


_STRAIGHT = np.radians(5.0)


def face_names(model: ObjectModel, yaw: float = 0.0) -> dict[str, Face]:
    """The side faces by name, in the model's order, of an object that is turned by so much [rad].

    A face that looks aside is called after the nearest of `front`, `back`, `left` and `right` and
    its angle from that, counter-clockwise: `front+60`.
    """
    c, s = np.cos(yaw), np.sin(yaw)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    named: dict[str, Face] = {}
    for face in model.faces():
        nearest, off = face_name(rotation @ face.normal)
        name = f"{nearest}{np.degrees(off):+.0f}" if abs(off) > _STRAIGHT else str(nearest)
        while name in named:
            name += "'"
        named[name] = face
    return named


def face_of(model: ObjectModel, name: str, yaw: float = 0.0) -> Face:
    """The side face of that name, of an object that is turned by so much [rad].

    Raises:
        ControlError: `unknown_face`, with the names that there are.
    """
    named = face_names(model, yaw)
    if name in named:
        return named[name]
    if not named:
        raise error(
            "unknown_face",
            f"the {model.name} has no side that is wide enough for a fingertip",
            suggestions=("choose another object, or one that lies on another face",),
        )
    near = [known for known in named if known.startswith(name)]
    raise error(
        "unknown_face",
        f"the {model.name} has no face {name!r}",
        suggestions=(f"its faces: {', '.join(near or named)}",),
    )


# Attributes that tell seen objects apart: colour, size and place.
#
# Model of colours: each name stands for a few colours that many people called so, from light to
# dark and from dull to bright. A colour bears the name of the nearest of them in the CIE 1976
# L*a*b* space, where distances are about as large as people see them; where two names are about
# equally near (rust is red and brown), it bears both. Colours are sRGB, each part in 0…1, under
# daylight (D65) [xkcd-2010].
#
# Model of sizes and positions: an object has the quality that has most of it among those that are
# compared: "the tall box" is the tallest. Whatever comes close to the best has it as well, so
# that a near tie leaves several and is never decided by a millimetre.
#
# Sizes are those of the believed model as it lies; colours and poses come from the camera.
# Directions are the robot's, which stands at the −x end of W and looks along +x: left is +y,
# behind is farther (+x). Poses are planar: what stands on another object is seen over its middle.


Array = NDArray[np.float64]

TIE = 5.0
"""Colours about equally near differ by less in their distance; 2.3 is just seen."""

SHADES: dict[str, tuple[str, ...]] = {
    "red": ("e50000", "840000", "ff474c", "bb3f3f", "ff000d"),
    "orange": ("f97306", "c65102", "fdaa48", "d8863b", "ff5b00"),
    "yellow": ("ffff14", "d5b60a", "fffe7a", "eedc5b", "fffd01"),
    "green": ("15b01a", "033500", "96f97b", "74a662", "39ad48", "01ff07"),
    "blue": ("0343df", "00035b", "95d0fc", "49759c", "2c6fbb", "0165fc", "0804f9", "001146"),
    "purple": ("7e1e9c", "35063e", "bf77f6", "84597e", "9e43a2", "be03fd"),
    "pink": ("ff81c0", "cb416b", "ffd1df", "d5869d", "f36196", "fe01b1"),
    "brown": ("653700", "341c02", "ad8150", "876e4b", "7f5112"),
    "black": ("000000",),
    "white": ("ffffff",),
    "grey": ("929591", "363737", "d8dcd6", "7d7f7c"),
}
"""Of each name: the plain colour, then its dark, light, dull, medium and bright as far as named,
and for blue, on which the space is weakest, the primary colour and navy."""

_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""Linear sRGB to CIE XYZ (IEC 61966-2-1)."""

_WHITE = _TO_XYZ.sum(axis=1)


def colour_names(colour: ArrayLike) -> tuple[str, ...]:
    """Basic names of an sRGB colour, shape (3,); several, the nearest first, if about as near."""
    there = _lab(np.asarray(colour, dtype=float))
    distance = {
        name: float(np.linalg.norm(shades - there, axis=1).min())
        for name, shades in _shades_seen().items()
    }
    nearest = min(distance.values())
    near = [name for name in distance if distance[name] < nearest + TIE]
    return tuple(sorted(near, key=distance.__getitem__))


@cache
def _shades_seen() -> dict[str, Array]:
    """L*a*b* coordinates of the shades of each name, shape (n, 3) each."""
    return {
        name: _lab(np.array([list(bytes.fromhex(shade)) for shade in shades]) / 255.0)
        for name, shades in SHADES.items()
    }


def _lab(rgb: Array) -> Array:
    """Coordinates L*, a*, b* of colours, shape (…, 3)."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    t = linear @ _TO_XYZ.T / _WHITE
    x, y, z = np.moveaxis(np.where(t > 216 / 24389, np.cbrt(t), (24389 / 27 * t + 16) / 116), -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


SAME_SIZE = 0.1
"""Sizes and masses that differ by a smaller share are about equal."""

SAME_PLACE = 0.02
"""Positions and distances that differ by less are about equal [m]."""

TOUCHING = 0.01
"""Gap below which two objects are taken as touching [m]; five deviations of a single view."""

BESIDE = 0.30
"""Gap up to which an object is next to another one [m]."""


class _Scale(NamedTuple):
    """Figure that a quality compares; by its sign most or least of it is meant."""

    value: Callable[[SeenObject], float]
    sign: int
    tie: Callable[[SeenObject, SeenObject], float]


def with_attribute(
    quality: Quality, seen: Sequence[SeenObject], beside: Sequence[SeenObject] = ()
) -> list[SeenObject]:
    """Those of some objects that have a quality; several if they come close to each other.

    Args:
        quality: any but those that are a matter of what was said or done before.
        seen: what is compared.
        beside: for `near` and `far`, what the distance is measured from; the robot if not given.
    """
    if not seen:
        return []
    if quality in SHADES:
        return [s for s in seen if s.colour is not None and quality in colour_names(s.colour)]
    if quality == "middle":
        # The middle one of a row, or of a file if they are spread farther along x.
        places = np.array([s.pose.p_WB[:2] for s in seen])
        along = places[:, int(np.ptp(places, axis=0).argmax())]
        row = np.sort(along)
        low, high = row[(len(row) - 1) // 2] - SAME_PLACE, row[len(row) // 2] + SAME_PLACE
        return [s for s, place in zip(seen, along, strict=True) if low < place < high]
    if quality in {"near", "far"} and beside:
        sign = 1 if quality == "far" else -1
        return _extreme_ones(seen, _Scale(lambda s: _farthest_gap(s, beside), sign, _same_place))
    return _extreme_ones(seen, _SCALES[quality])


def in_relation(
    relation: Relation, seen: Sequence[SeenObject], to: Sequence[SeenObject]
) -> list[SeenObject]:
    """The nearest of those that stand in a relation to others; several if about as near.

    Sides and corners (`left_of`, `behind_left_of`) are a quarter of the directions each;
    `between` is inside the circle through the middles of the first and the last of `to`.
    """
    fitting = [s for s in seen if stands_in_relation(relation, s, to)]
    if relation == "between":
        away = _Scale(lambda s: _off_line(s, to[0], to[-1]), -1, _same_place)
    else:
        away = _Scale(lambda s: _farthest_gap(s, to), -1, _same_place)
    return _extreme_ones(fitting, away)


def _extreme_ones(seen: Sequence[SeenObject], scale: _Scale) -> list[SeenObject]:
    if not seen:
        return []
    best = max(seen, key=lambda s: scale.sign * scale.value(s))

    def is_close(s: SeenObject) -> bool:
        return abs(scale.value(s) - scale.value(best)) < scale.tie(s, best)

    return [s for s in seen if s is best or is_close(s)]


def stands_in_relation(relation: Relation, s: SeenObject, to: Sequence[SeenObject]) -> bool:
    """Check that an object is seen to stand in a relation to others; see `in_relation`."""
    if relation == "between":
        a, b = (other.pose.p_WB - s.pose.p_WB for other in (to[0], to[-1]))
        return bool(a @ b < 0.0)
    return all(_stands_by(relation, s, other) for other in to)


def _stands_by(relation: Relation, s: SeenObject, other: SeenObject) -> bool:
    x, y, _ = s.pose.p_WB - other.pose.p_WB
    if relation in _TOWARDS:
        u, v = _TOWARDS[relation]
        along, across = x * u + y * v, x * v - y * u
        return bool(along > 0.0 and along >= abs(across))
    if relation in ("out_of", "off"):
        return False  # everything else is
    if relation in ("on", "in"):
        inside = other.model.inside is not None
        return s.on == other.name and inside == (relation == "in")
    return gap_between(s, other) <= (TOUCHING if relation == "touching" else BESIDE)


def gap_between(s: SeenObject, other: SeenObject) -> float:
    """Gap between two objects as they stand, seen from above; 0 if they overlap [m]."""
    return max(gap(footprint(s), footprint(other)), 0.0)


def _farthest_gap(s: SeenObject, others: Sequence[SeenObject]) -> float:
    """Gap to the farther one of several objects [m]."""
    return max(gap_between(s, other) for other in others)


def _off_line(s: SeenObject, a: SeenObject, b: SeenObject) -> float:
    """Distance of an object's middle from the line through two others' [m]."""
    (x, y, _), (u, v, _) = s.pose.p_WB - a.pose.p_WB, b.pose.p_WB - a.pose.p_WB
    # Lengths below 1e-9 m are zero.
    return float(abs(x * v - y * u) / max(math.hypot(u, v), 1e-9))


def _prism_volume(s: SeenObject) -> float:
    """Of the upright prism around it [m³]."""
    x, y = s.model.outline.T
    area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    return area * s.model.top


def _seen_width(s: SeenObject) -> float:
    """From its left to its right end as the robot sees it, along y of W [m]."""
    return float(np.ptp(footprint(s)[:, 1]))


def _same_share(value: Callable[[SeenObject], float]) -> Callable[[SeenObject, SeenObject], float]:
    return lambda a, b: SAME_SIZE * max(value(a), value(b))


def _same_mass(a: SeenObject, b: SeenObject) -> float:
    """The share of masses that are well known, or as much as they are unknown [kg]."""
    unknown = math.hypot(a.model.mass_sd, b.model.mass_sd)
    return max(SAME_SIZE * max(a.model.mass, b.model.mass), unknown)


def _same_place(a: SeenObject, b: SeenObject) -> float:
    return SAME_PLACE


def objects_at_rank(quality: Quality, seen: Sequence[SeenObject], ordinal: int) -> list[SeenObject]:
    """The object in a place of a row, counted from 1; several if there is a tie before or at it."""
    left = list(seen)
    for _ in range(ordinal - 1):
        first = with_attribute(quality, left)
        if len(first) > 1:
            return first
        left = [s for s in left if s not in first]
    return with_attribute(quality, left)


def _friction(s: SeenObject) -> float:
    return s.model.friction_coefficient("static")


def _height(s: SeenObject) -> float:
    return s.model.top


def _mass(s: SeenObject) -> float:
    return s.model.mass


_TOWARDS: dict[Relation, tuple[float, float]] = {
    "left_of": (0.0, 1.0),
    "right_of": (0.0, -1.0),
    "behind": (1.0, 0.0),
    "in_front_of": (-1.0, 0.0),
    "behind_left_of": (1.0, 1.0),
    "behind_right_of": (1.0, -1.0),
    "front_left_of": (-1.0, 1.0),
    "front_right_of": (-1.0, -1.0),
}
"""Directions in W."""

_SCALES: dict[Quality, _Scale] = {
    "big": _Scale(_prism_volume, 1, _same_share(_prism_volume)),
    "small": _Scale(_prism_volume, -1, _same_share(_prism_volume)),
    "tall": _Scale(_height, 1, _same_share(_height)),
    "short": _Scale(_height, -1, _same_share(_height)),
    "wide": _Scale(_seen_width, 1, _same_share(_seen_width)),
    "narrow": _Scale(_seen_width, -1, _same_share(_seen_width)),
    "heavy": _Scale(_mass, 1, _same_mass),
    "light": _Scale(_mass, -1, _same_mass),
    "slippery": _Scale(_friction, -1, _same_share(_friction)),
    "rough": _Scale(_friction, 1, _same_share(_friction)),
    "left": _Scale(lambda s: s.pose.y, 1, _same_place),
    "right": _Scale(lambda s: s.pose.y, -1, _same_place),
    "near": _Scale(lambda s: s.pose.x, -1, _same_place),
    "far": _Scale(lambda s: s.pose.x, 1, _same_place),
}
