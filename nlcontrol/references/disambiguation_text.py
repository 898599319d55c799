"""References in words: what was said, and what could be said to tell objects apart."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import get_args

from grammar.frames.command import ObjectRef, Quality, Relation
from nlcontrol.errors import ControlError, error, whole_span
from nlcontrol.references.object_attributes import SHADES
from nlcontrol.references.object_names import (
    Candidate,
    distinguishing_words,
    find_by_name,
    name_words,
)
from nlcontrol.text_format import enumeration

COLOURS: tuple[Quality, ...] = tuple(q for q in get_args(Quality) if q in SHADES)

GENERIC = frozenset({"", "one", "object", "thing", "item"})
"""Nouns that fit every object."""

RANKED: dict[Quality, tuple[str, int]] = {
    "heavy": ("mass", 1), "light": ("mass", 2), "tall": ("height", 1), "short": ("height", 2),
    "wide": ("width", 1), "narrow": ("width", 2), "big": ("size", 1), "small": ("size", 2),
    "rough": ("friction", 1), "slippery": ("friction", 2),
}  # fmt: skip
"""Quality → the property that it compares, and the place of who has it among two."""

_FAMILIES: tuple[tuple[Quality, ...], ...] = (
    COLOURS,
    ("left", "middle", "right"),
    ("near", "far"),
    ("tall", "short"),
    ("big", "small"),
    ("wide", "narrow"),
    ("heavy", "light"),
)
"""Qualities that tell objects apart, the plainest first."""

_PLACES: dict[Relation | None, str] = {
    "next_to": "next to",
    "left_of": "to the left of",
    "right_of": "to the right of",
    "in_front_of": "in front of",
    "front_left_of": "in front and to the left of",
    "front_right_of": "in front and to the right of",
    "behind_left_of": "behind and to the left of",
    "behind_right_of": "behind and to the right of",
    "at": "next to",
    None: "nearest to",
}


def ambiguity_error(
    ref: ObjectRef, found: Sequence[Candidate], fitting: Callable[[ObjectRef], list[Candidate]]
) -> ControlError:
    """The error for a reference that fits several objects.

    Only those other references are offered that, by `fitting`, fit one object alone.
    """
    names = [c.name for c in found]
    by_name = {c.name: [ObjectRef(text=c.name)] for c in found}
    by_looks = [
        {c.name: [_with_quality(ref, quality) for quality in family] for c in found}
        for family in _FAMILIES
        if not set(family) & set(ref.qualities)
    ]
    generic = reference_noun(ref) in GENERIC and "other" not in ref.qualities
    ways = [*by_looks, by_name] if generic else [by_name, *by_looks]
    offered = _distinct_descriptions(names, ways, fitting)
    told = distinguishing_words(names) if offered == [f"the {name}" for name in names] else offered
    fits = f"'{reference_text(ref)}' fits {len(names)} objects: {enumeration(names)}"
    return error(
        "ambiguous_object",
        f"{fits}; say which: {enumeration(told, 'or')}",
        span=whole_span(ref.spans),
        suggestions=tuple(offered),
    )


def _distinct_descriptions(
    names: Sequence[str],
    ways: Sequence[Mapping[str, Sequence[ObjectRef]]],
    fitting: Callable[[ObjectRef], list[Candidate]],
) -> list[str]:
    """A description of each object, all of one way if there is one that suits them all."""

    def first_description(name: str, refs: Sequence[ObjectRef]) -> str | None:
        fits = (ref for ref in refs if [c.name for c in fitting(ref)] == [name])
        return next((f"the {reference_text(ref)}" for ref in fits), None)

    mixed = dict.fromkeys(names, "")
    for way in ways:
        found = {name: first_description(name, way[name]) for name in names}
        if all(found.values()):
            return [text for text in found.values() if text]
        mixed |= {name: text for name, text in found.items() if text and not mixed[name]}
    return [text or f"the {name}" for name, text in mixed.items()]


def _with_quality(ref: ObjectRef, quality: Quality) -> ObjectRef:
    """The same reference with one more adjective."""
    qualities = (quality, *ref.qualities)
    text = f"{quality} {ref.text}"
    return ref.model_copy(
        update={"text": text, "qualities": qualities, "noun": reference_noun(ref)}
    )


def reference_noun(ref: ObjectRef) -> str:
    """The name in a reference, without adjectives and article."""
    described = ref.noun or ref.qualities or ref.quantifier
    return " ".join(name_words(ref.noun if described else ref.text))


def relation_text(relation: Relation | None) -> str:
    """A relation in words, before what it is to."""
    return _PLACES.get(relation, str(relation))


def reference_text(ref: ObjectRef) -> str:
    """A reference in words, with the place that tells it apart."""
    if not ref.reference:
        return ref.text
    place = relation_text(ref.relation)
    others = [
        other.text if other.pronoun else f"the {reference_text(other)}" for other in ref.reference
    ]
    return f"{ref.text} {place} {enumeration(others)}"


def require_no_more_than_a_name(
    ref: ObjectRef, on_table: Sequence[Candidate], *, misspelt: bool
) -> None:
    """Refuses words that a name has run on into: "ice tea box awya".

    A misspelt name is the better explanation, unless those words are like some of the language.

    Raises:
        ControlError: `unknown_object`, about those words.
    """
    from grammar.syntax_diagnosis import words_like
    from grammar.words.lexicon_plugins import installed_lexicon

    said_words = ref.text.split()
    of_names = {word.casefold() for name in [c.name for c in on_table] for word in name.split()}
    for i in range(len(said_words) - 1, 0, -1):
        name, more = " ".join(said_words[:i]), " ".join(said_words[i:])
        lexicon, _ = installed_lexicon()
        is_of_name = said_words[i].casefold() in of_names
        meant = () if is_of_name else words_like(said_words[i], lexicon)
        found = find_by_name(name, on_table)
        if not found or not (meant or (len(found) == 1 and not misspelt)):
            continue
        whole = whole_span(ref.spans)
        exact = whole is not None and whole[1] - whole[0] == len(ref.text)
        raise error(
            "unknown_object",
            f"'{more}' behind '{name}' is neither understood nor a part of a name on the table",
            span=(whole[1] - len(more), whole[1]) if whole and exact else whole,
            suggestions=(*meant, f"leave out '{more}'"),
        )
