"""Names of objects and of their side faces.

An object's name is taken in three steps, the first that fits decides: the whole name, a synonym (of
the scene or of the registry's model), or some of the words of a name ("the box", "the coffee"). A
misspelled name is never guessed; it only yields a suggestion. Faces are named as they look at the
robot; where nothing says how the object is turned, as if B's axes were the robot's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.errors import error
from objectmodels import suggest
from planner.problem.directions import face_name

if TYPE_CHECKING:
    from objectmodels import Face, ObjectModel
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
