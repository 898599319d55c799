"""The object on the table that a reference means: by name, by attributes, by place.

The words as they stand are tried as a name first ("red bull can"); only if they fit nothing, the
noun, and of those that it fits the ones that have the qualities: colours first, then the place
beside other objects, then sizes and positions from the noun outwards, each among those that are
left.

Two objects that fit are an ambiguity and never guessed: the error says what would tell them apart,
and whatever it offers was tried.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, get_args

from grammar.frames.command import ObjectRef, Quality, Relation
from grammar.words.plurals import singular
from nlcontrol.errors import ControlError, error, whole_span
from nlcontrol.references.object_names import (
    SHADES,
    Candidate,
    distinguishing_words,
    find_by_name,
    in_relation,
    likely_name,
    name_words,
    objects_at_rank,
    with_attribute,
)
from nlcontrol.text_format import join_words

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from planner.types.world_state import SeenObject, WorldState


# References in words: what was said, and what could be said to tell objects apart.


COLOURS: tuple[Quality, ...] = tuple(q for q in get_args(Quality) if q in SHADES)

GENERIC = frozenset({"", "one", "object", "thing", "item"})
"""Nouns that fit every object."""

RANKED: dict[Quality, tuple[str, int]] = {
    "heavy": ("mass", 1),
    "light": ("mass", 2),
    "tall": ("height", 1),
    "short": ("height", 2),
    "wide": ("width", 1),
    "narrow": ("width", 2),
    "big": ("size", 1),
    "small": ("size", 2),
    "rough": ("friction", 1),
    "slippery": ("friction", 2),
}
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
    fits = f"'{reference_text(ref)}' fits {len(names)} objects: {join_words(names)}"
    return error(
        "ambiguous_object",
        f"{fits}; say which: {join_words(told, 'or')}",
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
    return f"{ref.text} {place} {join_words(others)}"


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


# Objects by what they are, where none is called so: the carton, the cup, the one with the lid.
#
# A general word is looked up last, after names and synonyms. It fits every object of its kind, so
# that of two that fit none is guessed. All words that are said have to fit.
#
# Sides of several things ("everything on the left") are those of the table: what stands left of
# its middle.


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


_SIDES: tuple[Quality, ...] = ("left", "right", "near", "far")
"""Qualities of which all that stand on that side of the table have some."""

_SPOKEN: tuple[Quality, ...] = ("other", "same", "moved_first", "moved_last")


@dataclass(frozen=True)
class Context:
    """Objects that a command, or a reference in it, may refer back to.

    Attributes:
        last: names of the objects that were spoken of, the most recent first; what "it" may mean.
        held: name of the object in the hand; None if it holds nothing.
        latest: those of the last sentence, of which the rest is the rest.
        moved: names of the objects that were moved, in that order.
        group: those that were handled or compared together last, if nothing else was since; of
            these "the taller one" is one, else of the two that were ever spoken of.
        doubt: those of which a pronoun may mean any, since all were handled alike, or told as an
            answer, or fit a name that was refused, and "the left one" is one; None if it is clear.
        ranked: a property, and two objects of which an answer told that the first has more of it.
        other: what "the other one" may be the other of, within a command.
    """

    last: tuple[str, ...] = ()
    held: str | None = None
    latest: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    group: tuple[str, ...] = ()
    doubt: tuple[str, ...] | None = None
    ranked: tuple[str, ...] = ()
    other: tuple[str, ...] = ()


@dataclass(frozen=True)
class Surroundings:
    """Objects among which references are looked up.

    Attributes:
        on_table: objects of the scene.
        known: models of the registry.
        look: what the robot sees now; asked only if names do not decide.
    """

    on_table: Sequence[Candidate]
    known: Sequence[ObjectModel]
    look: Callable[[], WorldState]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects on the table."""
        return tuple(c.name for c in self.on_table)

    def model(self, name: str) -> ObjectModel:
        """The believed model of an object as it lies; off the table, the registry's."""
        if name in self.names:
            return self.look().objects[name].model
        return next(model for model in self.known if model.name == name)


def find_object(
    ref: ObjectRef, around: Surroundings, spoken: Context, *, alone: bool = False
) -> str:
    """Name of the one object that a reference means.

    Args:
        ref: what was said, or the id of what is meant; the objects that it is beside have theirs.
        around: objects that may be meant.
        spoken: what was spoken of before.
        alone: whether a model of the registry will do if there is none on the table.

    Raises:
        ControlError: `unknown_object`, `ambiguous_object`, `not_on_table` or `no_antecedent`.
    """
    if ref.id is not None:
        known = tuple(model.name for model in around.known) if alone else ()
        if ref.id in (*around.names, *known):
            return ref.id
        return _model_elsewhere(ObjectRef(text=ref.id, spans=ref.spans), around, alone)
    if ref.pronoun and not set(_SPOKEN) & set(ref.qualities):
        return _pronoun_object(ref, around, spoken, alone)
    if not _objects_named(ref, around):
        return _model_elsewhere(ref, around, alone)
    found = matching_objects(ref, around, spoken)
    if not found:
        there = [c.name for c in _objects_named(ref, around)]
        raise error(
            "unknown_object",
            f"there is no '{reference_text(ref)}' on the table; there is: {join_words(there)}",
            span=whole_span(ref.spans),
            suggestions=tuple(f"the {name}" for name in there),
        )
    if ref.quantifier == "any" and found:
        nearest = with_attribute("near", [around.look().objects[c.name] for c in found])
        return nearest[0].name
    found = _with_doubtful(ref, found, around, spoken)
    if len(found) > 1:
        raise ambiguity_error(ref, found, lambda other: matching_objects(other, around, spoken))
    return found[0].name


def _with_doubtful(
    ref: ObjectRef, found: Sequence[Candidate], around: Surroundings, spoken: Context
) -> list[Candidate]:
    """What a name fits, and the one among those to be told apart of whose name it is a part.

    After "the box", of which there are three, "the ice tea one" may be the ice tea box.
    """
    doubtful = [c for c in around.on_table if c.name in (spoken.doubt or ())]
    parts = find_by_name(ref.text, doubtful)
    return [*found, *parts] if len(parts) == 1 and parts[0] not in found else list(found)


def with_number(ref: ObjectRef, around: Surroundings) -> ObjectRef:
    """A reference to "the boxes" as one to all of them, where nothing is called so."""
    noun = singular(reference_noun(ref))
    plural = noun != reference_noun(ref) and ref.quantifier is None and not ref.pronoun
    ranked = ref.ordinal or not set(ref.qualities) <= set(COLOURS)
    if not plural or ranked or _objects_named(ref, around):
        return ref
    several = ref.model_copy(update={"quantifier": "all", "noun": noun})
    return several if _objects_named(several, around) else ref


def find_several(ref: ObjectRef, around: Surroundings, spoken: Context) -> list[str]:
    """Names of all objects that a reference to several means, without its exceptions.

    Raises:
        ControlError: `unknown_object` if there is none, or two are meant and there are not two.
    """
    # Last words of "each of them", which are those that were spoken of together, if any were.
    of_them = ref.quantifier == "all" and ref.text.split()[-1] in ("them", "these", "those")
    if ref.pronoun or (of_them and len(spoken.group) > 1):
        names = list(spoken.doubt or spoken.group)
        if len(names) > 1:
            return names
        raise no_group_error(ref, spoken)
    excepted = {other.id for other in ref.exceptions}
    excepted |= set(spoken.latest) if ref.quantifier == "rest" else set()
    found = [c.name for c in matching_objects(ref, around, spoken) if c.name not in excepted]
    counted = 2 if ref.quantifier == "both" else count_in(ref)
    if found and counted in (None, len(found)):
        return found
    there = [c.name for c in _objects_named(ref, around)] or around.names
    count = f"{counted}" if counted else "one or more"
    raise error(
        "unknown_object",
        f"'{ref.text}' should be {count}, and are {join_words(found) or 'none'}; there is:"
        f" {join_words(there)}",
        span=whole_span(ref.spans),
        suggestions=tuple(f"the {name}" for name in there),
    )


def no_group_error(ref: ObjectRef, spoken: Context) -> ControlError:
    """The error of "them" where no objects were spoken of together."""
    return error(
        "no_antecedent",
        f"'{ref.text}' — no objects were spoken of together",
        span=whole_span(ref.spans),
        suggestions=tuple(f"the {name}" for name in spoken.last) or ("all of them",),
    )


def matching_objects(ref: ObjectRef, around: Surroundings, spoken: Context) -> list[Candidate]:
    """All objects on the table that a reference with a name may mean.

    Raises:
        ControlError: `no_antecedent` if it needs one.
    """
    qualities = _looked_for(ref, around)
    found = _objects_named(ref, around)
    noun = reference_noun(ref)
    if noun in GENERAL and not find_by_name(ref.text, around.on_table):
        found = objects_called(noun, around.on_table) or found
    fitting = _fitting_objects(ref, found, qualities, around, spoken)
    if not fitting and set(COLOURS) & set(qualities):  # "the red one" beside two of other colours
        alone = replace(spoken, group=(), last=spoken.last[:1], doubt=None)
        fitting = _fitting_objects(ref, found, qualities, around, alone)
    if fitting or noun in GENERIC or not (qualities or ref.qualities):
        return fitting
    kind = objects_of_kind(noun, around.on_table, around.look)
    return _fitting_objects(ref, kind, qualities, around, spoken)


def _fitting_objects(
    ref: ObjectRef,
    found: list[Candidate],
    qualities: tuple[Quality, ...],
    around: Surroundings,
    spoken: Context,
) -> list[Candidate]:
    """Those of some objects that are told apart as a reference tells them."""
    doubtful = [c for c in found if c.name in (spoken.doubt or ())]
    several = ref.quantifier == "all"
    if len(doubtful) > 1 and ref.qualities and reference_noun(ref) in GENERIC and not several:
        found = doubtful
    elif _is_one_of_group(ref):
        together = [c for c in found if c.name in spoken.group]
        counted = 2 if ref.quantifier == "both" else count_in(ref)
        if len(together) != (counted or len(together)):
            together = []
        if len(together) < 2 and len(spoken.last) == (counted or 2):
            together = [c for c in found if c.name in spoken.last]
        found = together if len(together) > 1 else found
        if len(found) > 2 and compares_two(ref):
            return found
    if "other" in ref.qualities:
        last = _first_spoken_of(spoken.other, ref, around)
        found = [c for c in found if c.name != last]
    if "same" in ref.qualities:
        last = _first_spoken_of(spoken.last, ref, around)
        found = [c for c in found if c.name == last]
    if {"moved_first", "moved_last"} & set(ref.qualities):
        moved = [name for name in spoken.moved if name in [c.name for c in found]]
        last = _first_spoken_of(
            moved if "moved_first" in ref.qualities else moved[::-1], ref, around
        )
        found = [c for c in found if c.name == last]
    if (told := _told_apart(qualities, spoken)) and {c.name for c in found} == set(
        spoken.ranked[1:]
    ):
        return [c for c in found if c.name == told]
    if qualities or ref.reference:
        seen = _names_by_sight(ref, qualities, found, around.look())
        found = [c for c in found if c.name in seen]
    return found


def _told_apart(qualities: Sequence[Quality], spoken: Context) -> str | None:
    """Which of two "the lighter one" is after an answer has told it; None if none has."""
    which, place = RANKED.get(qualities[0], ("", 0)) if len(qualities) == 1 else ("", 0)
    return spoken.ranked[place] if spoken.ranked[:1] == (which,) else None


def _is_one_of_group(ref: ObjectRef) -> bool:
    """Check for "the taller one", "the other one" or both; "the tallest one" is one of all."""
    superlative = any(word.endswith("est") for word in ref.text.split())
    told = bool(ref.qualities) or ref.quantifier == "both" or count_in(ref) is not None
    return told and reference_noun(ref) in GENERIC and not superlative


def _names_by_sight(
    ref: ObjectRef, qualities: Sequence[Quality], found: Sequence[Candidate], state: WorldState
) -> set[str]:
    """Names of those that look and stand as they should."""
    ids = [other.id for other in ref.reference if other.id is not None]
    beside = [state.objects[name] for name in ids]
    left = [state.objects[c.name] for c in found if c.name not in ids]
    for quality in qualities:
        if quality in COLOURS:
            left = with_attribute(quality, left)
    if ref.relation is not None and beside:
        left, beside = in_relation(ref.relation, left, beside), []
    ordinal = ref.ordinal or 1
    for quality in reversed(qualities):
        if ref.quantifier == "all" and quality in _SIDES:
            left = on_side(quality, left, state)
        elif ref.quantifier == "both" and quality in _SIDES:
            left = [s for rank in (1, 2) for s in objects_at_rank(quality, left, rank)]
        elif quality not in COLOURS:
            # Only "nearest to the mug" has an object beside it and no relation.
            near = with_attribute(quality, left, beside)
            left = objects_at_rank(quality, left, ordinal) if ordinal > 1 else near
            ordinal = 1
    return {s.name for s in left}


def _objects_named(ref: ObjectRef, around: Surroundings) -> list[Candidate]:
    """Those that the words of a reference name, whatever they are like."""
    whole = find_by_name(ref.text, around.on_table)
    if whole or reference_noun(ref) not in GENERIC:
        named = whole or find_by_name(reference_noun(ref), around.on_table)
        return named or objects_of_kind(reference_noun(ref), around.on_table, around.look)
    return list(around.on_table)


def _looked_for(ref: ObjectRef, around: Surroundings) -> tuple[Quality, ...]:
    """Qualities that are no part of a name, so that the camera must decide."""
    qualities = tuple(q for q in ref.qualities if q not in _SPOKEN)
    if name_words(ref.text) == name_words(ref.noun) or not find_by_name(ref.text, around.on_table):
        return qualities
    return tuple(q for q in qualities if ref.reference and q in {"near", "far"})


def _pronoun_object(ref: ObjectRef, around: Surroundings, spoken: Context, alone: bool) -> str:
    """Object of a pronoun; if nothing was spoken of, the only one that there is."""
    if spoken == Context() and len(around.on_table) == 1:
        return around.on_table[0].name
    if spoken.doubt is not None:
        may = [name for name in around.names if name in spoken.doubt] or around.names
        raise error(
            "ambiguous_object" if spoken.doubt else "no_antecedent",
            f"'{ref.text}' may mean {join_words(may, 'or')}; say which",
            span=whole_span(ref.spans),
            suggestions=tuple(f"the {name}" for name in may),
        )
    name = _first_spoken_of(spoken.last, ref, around)
    if name not in around.names and not alone:
        raise _not_on_table(f"'{ref.text}', the {name},", name, ref, around)
    return name


def _first_spoken_of(spoken: Sequence[str], ref: ObjectRef, around: Surroundings) -> str:
    if not spoken:
        raise error(
            "no_antecedent",
            f"'{ref.text}' — nothing was spoken of yet",
            span=whole_span(ref.spans),
            suggestions=around.names,
        )
    return spoken[0]


def _model_elsewhere(ref: ObjectRef, around: Surroundings, alone: bool) -> str:
    """The model of the registry that is meant, if one may stand alone."""
    meant = {name_words(ref.text), name_words(reference_noun(ref))}
    for model in around.known:
        if any(name_words(name) in meant for name in (model.name, *model.synonyms)):
            if alone:
                return model.name
            raise _not_on_table(f"'{ref.text}'", model.name, ref, around)
    guess = likely_name(ref.text, around.on_table) or likely_name(
        reference_noun(ref), around.on_table
    )
    require_no_more_than_a_name(ref, around.on_table, misspelt=guess is not None)
    raise error(
        "unknown_object",
        f"there is no '{ref.text}' on the table; there is: {_names_on_table(around)}",
        span=whole_span(ref.spans),
        suggestions=(f"did you mean '{guess}'?",) if guess else around.names,
    )


def _not_on_table(what: str, name: str, ref: ObjectRef, around: Surroundings) -> ControlError:
    return error(
        "not_on_table",
        f"{what} is known, but there is none on the table; there is: {_names_on_table(around)}",
        span=whole_span(ref.spans),
        suggestions=(*around.names, f'put it there: --put "{name}@0.45,0.18"'),
    )


def _names_on_table(around: Surroundings) -> str:
    return join_words(around.names) or "nothing"
