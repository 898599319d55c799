"""Names of known objects as people say them without a verb or an article: "coffee box again".

What follows is tried only on a sentence that is not read as it stands: "the" before a bare name;
"the coffee one" as "the coffee"; a name and where it goes, "coffee behind the mug", with the verb
that this takes; and a name that is all there is, "the mug", as "no, the mug", or with a question
mark as "and the mug?". Words that are in no name never become one, so that prose stays refused.

A name may be short: a word that begins or ends the name of only one object, a colour, or a word
for many things with what tells it apart ("yellow carton"). Which object is meant, and whether
there are two, is seen where references are looked up.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain

from grammar.frames.command import Frame, references_in
from grammar.words.lexicon import Lexicon
from grammar.words.normalisation import Normalised
from grammar.words.phrase_places import WORD

_ONE = re.compile(r" ones?(?= |$)")
_GOES = "to|toward|towards|left|right|away|back|closer|behind|next|in front|a (?:bit|little)"
_PLACED = (
    "to(?! (?:be|have|see|do|get|go))|toward|towards|into|onto|left|right|away|back|"
    "(?:on|in|at) (?:its|their|top|a|one|each)|"
    "(?:on|in|at) the (?:other|edge|corner|far|near|very|left of|right of)|"
    "in front of|in between|backwards?|forwards?|closer|nearer|further|farther|behind|next|beside|"
    "between|near|by|over|out of|against|clear of|ahead of|up (?:to|against|next|again|right|on)|"
    "(?:back|straight) up|down (?:flat|on)|upright|standing up|flat|off to|alongside|"
    "around|round|along|here|together|side by side|one (?:row|line)|half ?way|all the way|"
    "clockwise|counter|anticlockwise|slightly|somewhat|aside|"
    "(?:just |only )?(?:a|one|the) (?:bit|little|touch|tad|smidge|wee|tiny|half|quarter|third|"
    "hand|finger|foot|inch|couple|few|full|whole)(?! (?:one|box|red|blue|green|brown|yellow|white))"
)
"""What may stand behind a name that goes somewhere: words of places, ways and amounts."""
_VERBS = tuple(
    (re.compile(rf"(?:{said})(?= |$)"), verb)
    for said, verb in (
        (r"(?:(?:straight |right |back )?up|upright|standing(?: up)?|on (?:its|their) feet) again|"
         r"(?:back )?upright|back up|back on (?:its|their) feet", "stand {} upright"),
        (r"(?:down |flat )?on (?:its|their) (?:side|back|face)|down flat|flat(?: down)?",
         "lay {} on its side"),
        (r"back(?= ?$| again$| please$)|back (?:to )?where .*|back (?:in|to|on) (?:its|their) .*",
         "put {} {0}"),
        (r"(?:all )?(?:in|into) (?:a|one) (?:straight |neat )?(?:row|line)|(?:one|a) (?:row|line)",
         "put {} in a row"),
        (r"(?:close )?together|side by side|(?:close|next) to each other", "put {} side by side"),
        (r"in each other's places?", "put {} in each other's place"),
        (r"(?:a|one) (?:quarter|half|third|full|whole)(?: of a)? (?:turn|rotation|way round)|"
         r"(?:half|quarter) (?:a )?(?:turn|rotation)|.* degrees(?: clockwise| counter ?clockwise| "
         r"anti ?clockwise)?|clockwise|counter ?clockwise|anti ?clockwise", "turn {} {0}"),
    )
)  # fmt: skip
"""What becomes of a thing, and the verb for it; with any other place it is moved there."""
_PLURALS = (
    "boxes|cartons|packets|packs|bottles|containers|things|tins|cans|cups|mugs|jars|objects|ones|"
    "others|rest"
)
_SEVERAL = (
    f"(?:the|those|these|all|all the|all of the|the other|the last) (?:two|three|four|five|six)"
    f"(?: (?:{_PLURALS}))?(?: of (?:them|these|those))?|(?:all )?(?:the|those|these) (?:other )?"
    f"(?:{_PLURALS})|all of (?:them|these|those)|everything(?: else)?|each (?:one|of them)|"
    f"both(?: of (?:them|these|those)|(?: of)? (?:the|those|these) (?:{_PLURALS})|"
    f" (?:{_PLURALS}))?|that one|this one"
)
"""Several things, by the words that count them or tell what they are."""
_BESIDES = (
    " (?:on|at|in) the (?:far |very )?(?:left|right|middle|centre|center|back|front)(?= (?!of ))"
)
_WAYS = "to the (?:left|right)|left|right|away|back|toward me|toward you"
_UNITS = "cm|mm|centimetres?|centimeters?|inch|inches"
_SIDE_OF = re.compile(r"(?:left|right|front|side) of$")
_FURTHER_BACK = re.compile(r"(?:further|farther) (back)(?= |$)(?! to)")
_OPENING = re.compile(
    r"(?:(?:and|but|first|next|now|please|so|then|right|ok|okay|well|no|yes|oh) (?:, )?)*"
)
_COLOURS = frozenset(
    {
        "red",
        "orange",
        "yellow",
        "green",
        "blue",
        "purple",
        "pink",
        "brown",
        "black",
        "white",
        "grey",
    }
)
_KINDS = frozenset({"box", "carton", "packet", "pack", "container", "cup", "mug", "can", "tin",
                    "jar", "bottle", "thing", "object", "one", *_PLURALS.split("|")})  # fmt: skip
"""Words for many things, which are names only with what tells a thing apart."""
_STATES = frozenset({"loose", "lidded", "clamped", "free", "fixed"})
_NO_TELLING = frozenset({"left", "right", "same", "back", "front", "further", "farther", "closer"})
"""Adjectives that are words of places too."""
_SIDE = re.compile(r" (?:on|at|in|to) the (?:far )?(?:left|right|middle|centre|center|back|front)$")
_GROUP = re.compile(r"(?:the )?both(?: of (?:them|these|those))?(?= |$)")
_AGAIN = frozenset({"again", "too", "also", "as", "well", "please"})


class KnownNames:
    """Finds the names of some objects in sentences in plain form.

    Attributes:
        words: the words of these names.
    """

    def __init__(self, names: Iterable[str], lexicon: Lexicon) -> None:
        plain = {" ".join(name.casefold().replace("-", " ").split()) for name in names}
        own = sorted(plain - lexicon.first_words - lexicon.verb_words["VERB"].keys(), key=len)
        told = lexicon.adjectives.keys() | lexicon.numbers.ordinals.keys() | _STATES
        self.words = {word for name in own for word in name.split()}
        unread = lexicon.first_words | lexicon.verb_words["VERB"].keys() | told
        short = _short_names(plain) | {name for name in plain if " " not in name}
        either = _any_of({*own, *(short - unread)})
        one = rf"(?:{_any_of(told)}) ones?"
        apart = rf"(?:(?:{_any_of(told - _NO_TELLING)}) )+(?:{_any_of(_KINDS | self.words)})"
        colours = [word for word, means in lexicon.adjectives.items() if means in _COLOURS]
        numbers = lexicon.numbers.pattern.pattern
        goes = rf"(?:{_PLACED})(?: |$)|\d|(?:{numbers})(?! ones?(?: |$))"
        ends = rf"(?= ?$| (?:and|or|,|{goes}))"
        coloured = rf"(?:(?:{_any_of(told - _NO_TELLING)}) )*(?:{_any_of(colours)}){ends}"
        ambiguous = rf"(?:{_any_of(short & unread - told)}){ends}(?! (?:i|you|we|the|it|that))"
        name = rf"{either}|{apart}|{one}|{coloured}|{ambiguous}"
        self._name = re.compile(rf"(?<![^ ])(?:{name})(?= |$)")
        self._told_where = re.compile(rf"(the (?:{either})) (?={_GOES}(?: |$)|\d|{numbers})")
        named = rf"{apart}|{name}|(?:{_any_of(_KINDS | self.words)})(?= )"
        thing = rf"(?>(?:the|that|this|my|your|our) (?:{named})|{_SEVERAL})(?>{_BESIDES})?"
        things = rf"{thing}(?>(?: ,)?(?: and)? {thing})*+"  # which are read in one way
        count = rf"(?:\d+(?:\.\d+)?|{numbers})"
        amount = rf"(?:a |just |only )*(?:bit|little|touch|tad|{count}|degrees)"
        self._same = re.compile(
            rf"(?:(?>{amount}|{_WAYS})(?: ,)? ?)++|{count} (?:{_UNITS})(?: please)?"
        )
        self._goes = re.compile(rf"({things})(?: ,)? (?={goes})")
        determining = (
            w for kind in ("THE", "A", "THAT", "QUANTIFIER") for w in lexicon.terminals[kind]
        )
        self._before_name = {*(w.split()[-1] for w in determining), *told, *self.words}
        self._told = {"the", "other", *told, *self.words, "one", "ones", "thing", "object"}
        several = (w.split() for w in lexicon.terminals["QUANTIFIER"])
        self._several = set(chain.from_iterable(several))
        self._borne = {*self._told, *lexicon.nobodies, *_KINDS}
        self._borne |= {"it", "them", "they", "that", "this", "loose", "lidded", "drink"}
        self._silent = lexicon.silent_words - {"the"}

    def are_borne(self, frames: Iterable[Frame]) -> bool:
        """Check for frames in whose names each word is of some object, or tells objects apart."""
        names = (
            set((ref.noun if ref.qualities else ref.text).split())
            - (self._several if ref.quantifier else set())
            for frame in frames
            for ref in references_in(frame)
            if not ref.pronoun
        )
        return all(self._borne.issuperset(words) for words in names)

    def readings(self, said: Normalised) -> Iterator[Normalised]:
        """Yield the sentence in the ways in which it may be meant, the likelier first."""
        named = self._with_articles(self._without_one(said))
        if named is not said:
            yield named
        command = self._as_command(named)
        where = self._told_where.match(named.text)
        if command and not (where and self._same.fullmatch(named.text, where.end())):
            yield command
        if where:
            yield _with_words(named, 0, 0, "now ")
        if command:
            yield command
        if remark := self._as_remark(named):
            yield remark

    def _without_one(self, said: Normalised) -> Normalised:
        """The sentence with "the coffee" in the place of "the coffee one"."""
        for one in _ONE.finditer(said.text):
            if said.text[: one.start()].rpartition(" ")[2] in self.words:
                return _with_words(said, one.start(), one.end(), "")
        return said

    def _with_articles(self, said: Normalised) -> Normalised:
        """The sentence with "the" before each name that has no article."""
        for name in reversed(list(self._name.finditer(said.text))):
            before = said.text[: name.start()].rstrip()
            if before.rpartition(" ")[2] not in self._before_name or _SIDE_OF.search(before):
                said = _with_words(said, name.start(), name.start(), "the ")
        return said

    def _as_command(self, said: Normalised) -> Normalised | None:
        """The sentence with a verb, if it is of things and where they go or what they become."""
        opening = _OPENING.match(said.text)
        start = opening.end() if opening else 0
        goes = self._goes.match(said.text, start)
        if goes is None or said.question:
            return None
        if back := _FURTHER_BACK.search(said.text, goes.end()):
            said = _with_words(said, *back.span(1), "away")
        for means, verb in _VERBS:
            if becomes := means.match(said.text, goes.end()):
                before, _, behind = verb.partition(" {}")
                if behind != " {0}":
                    said = _with_words(said, goes.end(1), becomes.end(), behind)
                return _with_words(said, start, start, f"{before} ")
        return _with_words(said, start, start, "move ")

    def _as_remark(self, said: Normalised) -> Normalised | None:
        """A name that is all there is, as a remark; None if there is more, or no name."""
        words = list(WORD.finditer(said.text))
        while words and words[0][0] in self._silent:
            words.pop(0)
        if words and words[-1][0] in ("next", "then"):
            said = _with_words(said, words.pop().start() - 1, len(said.text), "")
        again = bool(words) and words[-1][0] in _AGAIN
        while words and words[-1][0] in _AGAIN:
            words.pop()
        if not words:
            return None
        start, end = words[0].start(), words[-1].end()
        side = _SIDE.search(said.text, start, end)
        if side is not None:
            words = [word for word in words if word.end() <= side.start()]
        group = _GROUP.fullmatch(said.text, start, end)
        named = len(words) > 1 and self._told.issuperset(match[0] for match in words)
        if not (group or (named and words[0][0] == "the")):
            return None
        return _with_words(said, start, start, "and " if again or said.question else "no ")


def _short_names(names: Iterable[str]) -> set[str]:
    """The words that begin or end the name of only one thing, and are in no other name."""
    split = [set(name.split()) for name in names]
    ends = {word for name in names for word in (name.split()[0], name.split()[-1])}
    return {word for word in ends if sum(word in words for words in split) == 1}


def _any_of(words: Iterable[str]) -> str:
    """The pattern of any of some words, the longest first."""
    return "|".join(map(re.escape, sorted(words, key=lambda w: (-len(w), w)))) or "(?!)"


def _with_words(said: Normalised, start: int, end: int, words: str) -> Normalised:
    """The sentence with other words in the place of some of it."""
    at = said.columns[min(start, len(said.columns) - 1)]
    columns = (*said.columns[:start], *((at[0], at[0]),) * len(words), *said.columns[end:])
    put = replace(said, text=said.text[:start] + words + said.text[end:], columns=columns)
    return put.taken_back_from(said)
