"""Which object on the table a sentence means.

A name is taken in three steps, the first that fits decides: the whole name, a synonym (of the
scene or of the registry's model), or some of the words of a name ("the box", "the coffee"). Two
objects that fit are an ambiguity and never guessed; neither is a misspelled name, which only
yields a suggestion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar, cast

from pydantic import BaseModel

from grammar.frames import Command, ObjectRef, Span
from nlcontrol.errors import ControlError, error
from objectmodels import suggest

Part = TypeVar("Part", bound=BaseModel)


@dataclass(frozen=True)
class Candidate:
    """A name that may be meant.

    Attributes:
        name: name of the object in the scene.
        names: everything that it is called: its name, synonyms, the model's name.
    """

    name: str
    names: tuple[str, ...]


def resolve(
    command: Command, on_table: Sequence[Candidate], known: Iterable[Sequence[str]] = ()
) -> Command:
    """The command with the `id` of every object filled in.

    Args:
        command: what was understood.
        on_table: objects of the scene.
        known: for each model of the registry, its name and synonyms.

    Raises:
        ControlError: `unknown_object`, `ambiguous_object` or `not_on_table`.
    """
    models = [tuple(names) for names in known]
    frames = tuple(_bind(frame, on_table, models) for frame in command.frames)
    return command.model_copy(update={"frames": frames})


def _bind(part: Part, on_table: Sequence[Candidate], known: list[tuple[str, ...]]) -> Part:
    """A copy of any part of a frame in which each object reference has its id."""
    if isinstance(part, ObjectRef):
        return cast("Part", part.model_copy(update={"id": find(part, on_table, known)}))
    changed: dict[str, object] = {}
    for key in type(part).model_fields:
        value = getattr(part, key)
        if isinstance(value, BaseModel):
            changed[key] = _bind(value, on_table, known)
        elif isinstance(value, tuple) and any(isinstance(v, BaseModel) for v in value):
            changed[key] = tuple(_bind(v, on_table, known) for v in value)
    return part.model_copy(update=changed) if changed else part


def find(ref: ObjectRef, on_table: Sequence[Candidate], known: Sequence[Sequence[str]]) -> str:
    """Name of the one object in the scene that a reference means.

    Raises:
        ControlError: `unknown_object`, `ambiguous_object` or `not_on_table`.
    """
    wanted = _words(ref.text)
    for fits in (_is, _is_part_of):
        found = [c for c in on_table if any(fits(wanted, _words(n)) for n in c.names)]
        if len(found) == 1:
            return found[0].name
        if found:
            raise _ambiguous(ref, found)
    raise _missing(ref, on_table, known)


def _words(text: str) -> tuple[str, ...]:
    words = tuple(text.casefold().replace("-", " ").replace("_", " ").split())
    return words[1:] if len(words) > 1 and words[0] in {"the", "a", "an", "my", "this"} else words


def _is(wanted: tuple[str, ...], name: tuple[str, ...]) -> bool:
    return wanted == name


def _is_part_of(wanted: tuple[str, ...], name: tuple[str, ...]) -> bool:
    """Whether the wanted words stand in the name, in this order, perhaps with others between."""
    rest = iter(name)
    return all(word in rest for word in wanted)


def _ambiguous(ref: ObjectRef, found: Sequence[Candidate]) -> ControlError:
    names = [c.name for c in found]
    common = set.intersection(*(set(_words(name)) for name in names))
    telling = [" ".join(w for w in _words(n) if w not in common) or n for n in names]
    return error(
        "ambiguous_object",
        f"'{ref.text}' fits {len(names)} objects: {_listed(names)}; "
        f"say which: {_listed(telling, 'or')}",
        span=_span(ref),
        suggestions=tuple(f"the {name}" for name in names),
    )


def _missing(
    ref: ObjectRef, on_table: Sequence[Candidate], known: Sequence[Sequence[str]]
) -> ControlError:
    wanted = _words(ref.text)
    there = _listed([c.name for c in on_table]) or "nothing"
    for names in known:
        if any(_is(wanted, _words(n)) for n in names):
            return error(
                "not_on_table",
                f"'{ref.text}' is known, but there is none on the table; there is: {there}",
                span=_span(ref),
                suggestions=tuple(c.name for c in on_table),
            )
    message = f"there is no '{ref.text}' on the table; there is: {there}"
    guess = likely(ref.text, [(n, c.name) for c in on_table for n in c.names])
    suggestions = (f"did you mean '{guess}'?",) if guess else tuple(c.name for c in on_table)
    return error("unknown_object", message, span=_span(ref), suggestions=suggestions)


def likely(text: str, names: Sequence[tuple[str, str]]) -> str | None:
    """The one object whose name is close to a misspelled text; None if two are about as close.

    Args:
        text: as written.
        names: every name, and the object that it belongs to.
    """
    near = suggest(" ".join(_words(text)), [name for name, _ in names])
    owners = {owner for name, owner in names if name in near}
    return owners.pop() if len(owners) == 1 else None


def _span(ref: ObjectRef) -> Span | None:
    if not ref.spans:
        return None
    return min(s for s, _ in ref.spans), max(e for _, e in ref.spans)


def _listed(names: Sequence[str], word: str = "and") -> str:
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {word} {names[-1]}"
