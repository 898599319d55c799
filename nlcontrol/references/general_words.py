"""Objects by what they are, where none is called so: the carton, the cup, the one with the lid.

A general word is looked up last, after names and synonyms. It fits every object of its kind, so
that of two that fit none is guessed. All words that are said have to fit.

Sides of several things ("everything on the left") are those of the table: what stands left of its
middle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from nlcontrol.references.disambiguation_text import COLOURS
from nlcontrol.references.object_names import Candidate, find_by_name, name_words

if TYPE_CHECKING:
    from grammar.frames.command import ObjectRef, Quality
    from planner.types.world_state import SeenObject, WorldState

_KINDS: dict[str, frozenset[str]] = {
    "box": frozenset({"box", "carton", "packet", "pack", "package", "packaging"}),
    "carton": frozenset({"carton", "box", "packet", "pack", "package", "container"}),
    "mug": frozenset({"mug", "cup", "container", "vessel", "beaker"}),
    "cup": frozenset({"cup", "container", "vessel", "beaker"}),
    "can": frozenset({"can", "tin", "container"}),
    "tin": frozenset({"tin", "can", "container", "caddy"}),
    "jar": frozenset({"jar", "container", "vessel", "pot"}),
    "bottle": frozenset({"bottle", "container", "vessel"}),
    "bin": frozenset({"bin", "tub", "container"}),
    "book": frozenset({"book"}),
}
"""A word of a name → what the object may be called in general."""

_NOBODY = frozenset({"one", "ones", "thing", "object", "item"})
_LIDDED = frozenset({"lidded", "covered", "capped"})
_FIXED = frozenset({"fixed", "held", "clamped", "immovable", "fastened"})
_LOOSE = frozenset({"loose", "free", "movable", "unfixed"})

_COUNTS = {"two": 2, "three": 3, "four": 4, "five": 5, "six": 6}

GENERAL = frozenset(word for kind in _KINDS.values() for word in kind) | {"drink"}
"""Words for many objects."""


def objects_called(noun: str, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those whose whole name a general word is, and those of whose name it is a part.

    "The carton" is the one that is called so; "the big carton" may be a large ice tea carton.
    """
    words = name_words(noun)
    return [c for c in candidates if any(set(words) <= set(name_words(n)) for n in c.names)]


def objects_of_kind(
    noun: str, candidates: Sequence[Candidate], look: Callable[[], WorldState]
) -> list[Candidate]:
    """Those of which all words of a name say what they are; none if no word is a general one.

    Args:
        noun: what was said, without adjectives.
        candidates: what may be meant.
        look: at lids and holders; asked only if the words speak of them.
    """
    said = [word for word in name_words(noun) if word not in _NOBODY]
    words, states = set(said), set(said) & (_LIDDED | _FIXED | _LOOSE)
    if not said or said[-1] not in (GENERAL | states):
        return []
    found = [c for c in candidates if words - states <= _kinds_of(c)]
    if not states or not found:
        return found
    state = look()
    return [c for c in found if states <= _states_of(state.objects[c.name], state)]


def _kinds_of(candidate: Candidate) -> set[str]:
    """All general words for an object, and those of its names."""
    own = {word for name in candidate.names for word in name_words(name)}
    said = own.union(*(_KINDS.get(word, ()) for word in own))
    drink = find_by_name("ice tea", [candidate]) or "bottle" in own
    return said | {"drink", "drinks"} if drink else said


def _states_of(seen: SeenObject, state: WorldState) -> frozenset[str]:
    """Words for whether it has a lid and whether it is held; only twins of those are loose."""
    lidded = _LIDDED if seen.model.lid is not None else frozenset[str]()
    if seen.fixed:
        return lidded | _FIXED
    twins = (other for other in state.objects.values() if other.model == seen.model)
    return lidded | _LOOSE if any(other.fixed for other in twins) else lidded


def on_side(quality: Quality, seen: Sequence[SeenObject], state: WorldState) -> list[SeenObject]:
    """Those that stand on a side of the table's middle; all if the quality names no side."""
    table = state.table
    x, y = (table.x_min + table.x_max) / 2.0, (table.y_min + table.y_max) / 2.0
    match quality:
        case "left":
            return [s for s in seen if s.pose.y > y]
        case "right":
            return [s for s in seen if s.pose.y < y]
        case "near":
            return [s for s in seen if s.pose.x < x]
        case "far":
            return [s for s in seen if s.pose.x > x]
    return list(seen)


def count_in(ref: ObjectRef) -> int | None:
    """How many "all three" are; None if it is not said."""
    return next((_COUNTS[word] for word in ref.text.casefold().split() if word in _COUNTS), None)


def compares_two(ref: ObjectRef) -> bool:
    """Check for "the taller one", which is one of two, and not one beside something else."""
    compares = any(word.endswith("er") for word in ref.text.split() if word != "other")
    return compares and not ref.reference and not set(COLOURS) & set(ref.qualities)
