"""Names of objects: whole names, synonyms, words of a name, and misspellings.

A name is taken in three steps, the first that fits decides: the whole name, a synonym (of the
scene or of the registry's model), or some of the words of a name ("the box", "the coffee"). A
misspelled name is never guessed; it only yields a suggestion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from objectmodels import suggest


@dataclass(frozen=True)
class Candidate:
    """A name that may be meant.

    Attributes:
        name: name of the object in the scene.
        names: everything that it is called: its name, synonyms, the model's name.
    """

    name: str
    names: tuple[str, ...]


def find_by_name(text: str, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Those whose name it is; if there is none, those of whose name it is a part."""
    wanted = name_words(text)
    for fits in (_is_whole_name, _is_part_of):
        found = [c for c in candidates if any(fits(wanted, name_words(n)) for n in c.names)]
        if found:
            return found
    return []


def name_words(text: str) -> tuple[str, ...]:
    """The words of a name, without its article."""
    split = tuple(text.casefold().replace("-", " ").replace("_", " ").split())
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
