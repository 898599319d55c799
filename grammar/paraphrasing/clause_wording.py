"""Names, quantities, goals and constraints in words that are read back as the same.

The words are the lexicon's own: of the phrases that mean the same the first, or any other that a
caller chooses.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from typing import Any, cast

from grammar.frames import command as g
from grammar.words.lexicon import Lexicon

Choice = Callable[[Sequence[str]], str]
"""Picks one of several phrases that mean the same."""

_WAYS = {0.25: "0.25", 0.5: "0.5", 0.75: "0.75", 1 / 3: "1/3", 2 / 3: "2/3", 1.0: "1"}
_COUNTS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_I = re.compile(r"\bi\b")
_TIMES = {0.25: "a quarter of ", 1 / 3: "a third of ", 0.5: "half ", 2 / 3: "two thirds of ",
          0.75: "three quarters of ", 1.0: "", 2.0: "twice "}  # fmt: skip
_NO_NAMES = ("one", "ones", "the", "a", "an", "my", "your", "our", "its")
_TOUCHES = ("touching", "in_line", "next_to")


def no_words(what: str) -> ValueError:
    """The language has no words for something that a frame can say."""
    return ValueError(f"there are no words for {what}")


class Phrasing:
    """Says the parts of frames.

    Args:
        lexicon: the words of the language.
        choose: picks one of the phrases that mean the same; the first by default.
    """

    def __init__(self, lexicon: Lexicon, choose: Choice | None = None) -> None:
        self.lexicon = lexicon
        self._choose = choose or (lambda phrases: phrases[0])

    def say(self, terminal: str, value: str = "", *, ending: str = "") -> str:
        """A phrase of the lexicon, with that at its end."""
        phrases = [p for p in self.lexicon.says(terminal, value) if p.endswith(ending)]
        if not phrases:
            raise no_words(f"{value} as {terminal}")
        return _I.sub("I", self._choose(phrases))

    # --- names --------------------------------------------------------------------------------

    def name(self, ref: g.ObjectRef) -> str:
        """An object, with its article and what tells it apart."""
        words = _words(ref.text)
        said = tuple(self.lexicon.adjectives[w] for w in words if w in self.lexicon.adjectives)
        plain = self.is_plain(ref.text) and said == ref.qualities[: len(said)]
        text = ref.text if ref.pronoun else f"the {ref.text}" if plain else f'"{ref.text}"'
        told = [text]
        for quality in ref.qualities[len(said) :]:
            if quality == "near" and ref.reference and ref.relation is None:
                told.append(f"{self.say('RELATION', 'nearest')} {self._names(ref.reference)}")
            else:
                told.append(self.say("SIDE_QUALITY", quality))
        if ref.relation is not None:
            told += [self.say("THAT_IS"), self._related(ref.relation, ref.reference)]
        return " ".join(told)

    def _names(self, refs: Sequence[g.ObjectRef]) -> str:
        return " and ".join(self.name(ref) for ref in refs)

    def _related(self, relation: str, reference: Sequence[g.ObjectRef]) -> str:
        said = self.say("BETWEEN") if relation == "between" else self.say("RELATION", relation)
        return f"{said} {self._names(reference)}"

    def needs_no_article(self, name: str) -> bool:
        """Whether a name is read whole wherever it stands, also behind adjectives."""
        lexicon = self.lexicon
        ends = lexicon.reserved | lexicon.first_words
        ends -= lexicon.openers | lexicon.verb_words["VERB"].keys() | lexicon.adjectives.keys()
        words = _words(name)
        return not any(w in ends and not _joins(words, i) for i, w in enumerate(words))

    def is_plain(self, name: str) -> bool:
        """Whether a name is read whole without quotation marks."""
        words = _words(name)
        if " ".join(words) in self.lexicon.names:
            return True
        if (
            not words
            or not all(w.isascii() and w.isalnum() for w in words)
            or words[0] in _NO_NAMES
            or f"the {words[0]}" in self.lexicon.terminals["YOU"]
            or self._ends_a_phrase(words)
        ):
            return False
        return all(self._stays_a_name(words, i) for i in range(len(words)))

    def _ends_a_phrase(self, words: Sequence[str]) -> bool:
        """Whether a name would be read as the end of a phrase ("the front", after "against")."""
        ends = (i for i in range(1, len(words) + 1)
                if " ".join(words[:i]) in self.lexicon.definite)  # fmt: skip
        return any(i == len(words) or words[i - 1] not in self.lexicon.adjectives for i in ends)

    def _stays_a_name(self, words: Sequence[str], i: int) -> bool:
        word, lexicon = words[i], self.lexicon
        if i == 0:
            return not word[0].isdigit()
        after_adjectives = all(before in lexicon.adjectives for before in words[:i])
        if after_adjectives and word in lexicon.nobodies:
            return True
        if after_adjectives and word in lexicon.adjectives and i + 1 < len(words):
            return words[i + 1] not in lexicon.ends_names
        if word in lexicon.openers or word in lexicon.verb_words["VERB"] or _joins(words, i):
            return True
        return not (word[0].isdigit() or word in lexicon.reserved | lexicon.first_words)

    # --- quantities ---------------------------------------------------------------------------

    def length(self, length: float | g.RelativeLength) -> str:
        """A length in centimetres, or in millimetres below one; exact, so that it is read back."""
        if isinstance(length, g.RelativeLength):
            return self._relative(length)
        metres = Decimal(repr(length))
        if metres < Decimal("0.01"):
            return f"{_plain(metres * 1000)} {self.say('LENGTH_UNIT', '0.001')}"
        return f"{_plain(metres * 100)} {self.say('LENGTH_UNIT', '0.01')}"

    def _relative(self, length: g.RelativeLength) -> str:
        times = _TIMES.get(length.value, f"{_plain(length.value)} times ")
        if length.side is None:
            raise no_words("lengths measured in objects without a side")
        if length.of.text == "its":
            return f"{times}its {length.side}"
        return f"{times}the {length.side} of {self.name(length.of)}"

    def angle(self, radians: float) -> str:
        """An angle in degrees, or in radians if only they are exact."""
        degrees = round(math.degrees(radians), 9)
        if math.radians(degrees) == radians:
            return f"{_plain(degrees)} {self.say('ANGLE_UNIT', 'degree')}"
        return f"{_plain(radians)} {self.say('ANGLE_UNIT', 'radian')}"

    def bound(self, bound: g.Bound) -> str:
        """A bound, with a space behind it."""
        return "" if bound == "exact" else f"{self.say('BOUND', bound)} "

    # --- goals --------------------------------------------------------------------------------

    def goal(self, goal: g.Goal) -> list[str]:
        """What should become of the object."""
        match goal:
            case g.Displace():
                return self._displace(goal)
            case g.Place():
                return self._place(goal)
            case g.Topple(direction=str(direction)):
                return [self.say("DIRECTION", direction)]
            case g.Tilt() | g.Rotate():
                return self._turned(goal)
            case g.Lift():
                return self._lift(goal)
            case g.Pour():
                into = [f"into {self.name(goal.into)}"] if goal.into else []
                return into if goal.fill is None else [*into, self._filled(goal.fill)]
            case g.Parameters(method=str(method)):
                return [self.say("METHOD", method)]
            case _:
                return []

    def portion(self, goal: g.Pour) -> str:
        """How much is poured, with a space behind it."""
        if goal.volume is not None:
            millilitres = _plain(Decimal(repr(goal.volume)) * 1_000_000)
            return f"{millilitres} {self.say('VOLUME_UNIT', '0.000001')} of "
        if goal.amount is not None:
            return f"a {goal.amount if goal.amount == 'little' else 'lot'} of "
        if goal.fraction is None:
            return ""
        if goal.fraction not in _WAYS:
            raise no_words(f"a share of {goal.fraction}")
        return f"{self.say('PORTION', _WAYS[goal.fraction], ending='of')} "

    def _filled(self, share: float) -> str:
        until = f"{self.say('UNTIL')} it"
        if share in _WAYS:
            return f"{until} {self.say('IS_FULL', _WAYS[share])}"
        percent = _plain(Decimal(repr(share)) * 100)
        return f"{until} {self.say('IS_AT')} {percent} {self.say('PERCENT')}"

    def _amount(self, amount: g.Amount | None) -> list[str]:
        return [self.say("AMOUNT", amount)] if amount else []

    def _lift(self, goal: g.Lift) -> list[str]:
        if goal.height is None:
            return self._amount(goal.amount)
        return [f"by {self.bound(goal.bound)}{self.length(goal.height)}"]

    def _turned(self, goal: g.Tilt | g.Rotate) -> list[str]:
        words = []
        if isinstance(goal, g.Rotate) and goal.sense:
            words.append(self.say("SENSE", goal.sense))
        if isinstance(goal, g.Tilt) and goal.direction:
            words.append(self.say("DIRECTION", goal.direction))
        if goal.angle is not None:
            words.append(f"by {self.bound(goal.bound)}{self.angle(goal.angle)}")
        return words + self._amount(goal.amount)

    def _displace(self, goal: g.Displace) -> list[str]:
        words = []
        if goal.fraction is not None:
            if goal.fraction not in _WAYS:
                raise no_words(f"a share of {goal.fraction} of the way")
            words.append(self.say("WAY", _WAYS[goal.fraction]))
        if goal.direction is not None:
            pair = (goal.direction,) if isinstance(goal.direction, str) else goal.direction
            words.append(" and ".join(self.say("DIRECTION", part) for part in pair))
        if goal.heading is not None:
            words.append(f"{self.say('HEADING')} {self.angle(goal.heading)}")
        if isinstance(goal.toward, str):
            words.append(self.say("TOWARD_REGION", goal.toward))
        elif goal.toward is not None:
            words.append(f"{self.say('TOWARD')} {self.name(goal.toward)}")
        if isinstance(goal.away_from, str):
            words.append(self.say("AWAY_FROM_REGION", goal.away_from))
        elif goal.away_from is not None:
            words.append(f"{self.say('RELATION', 'away_from')} {self.name(goal.away_from)}")
        if goal.distance is not None:
            words.append(f"by {self.bound(goal.bound)}{self.length(goal.distance)}")
        return words + self._amount(goal.amount)

    def _place(self, goal: g.Place) -> list[str]:
        words = []
        if goal.fraction is not None:
            if goal.fraction not in _WAYS:
                raise no_words(f"a share of {goal.fraction} of the way")
            words.append(self.say("WAY", _WAYS[goal.fraction]))
        match goal.reference:
            case g.Point(x=x, y=y):
                words.append(f"to x {_plain(x)} y {_plain(y)}")
            case str():
                words.append(self.say("REGION_OF_TABLE", goal.reference))
            case _:
                if goal.distance is not None:
                    words.append(self.length(goal.distance))
                words.append(self._related(goal.relation, goal.reference))
        return words

    # --- constraints --------------------------------------------------------------------------

    def manner(self, constraint: g.Constraint) -> str | None:
        """Gently, hard, slowly, quickly; None for anything else."""
        said = constraint.words.terminal == "MANNER"
        return self.say("MANNER", constraint.kind) if said else None

    def constraints(self, constraints: Sequence[g.Constraint], *, directed: bool) -> list[str]:
        """Everything that must hold on the way."""
        words: list[str] = []
        listed = False
        for constraint in constraints:
            avoided = constraint.words.terminal == "AVOIDING"
            if isinstance(constraint, g.ContactRegion):
                words.append(self._contact(constraint, directed=directed))
            elif avoided:
                doing = self.say("AVOIDING", constraint.kind)
                words.append(f"or {doing} it" if listed else f"{self.say('WITHOUT')} {doing} it")
            else:
                words.append(self._constraint(constraint))
            listed = avoided
        return words

    def _constraint(self, constraint: g.Constraint) -> str:
        if manner := self.manner(constraint):
            return manner
        match constraint:
            case g.NoTouch():
                return self._no_touch(constraint)
            case g.Effector():
                return _effector(constraint)
            case g.Until():
                return self._until(constraint)
            case _:
                words, value = constraint.words, cast(Any, constraint).value
                return words.phrase.format(self._value(value, words.unit))

    def _value(self, value: float, unit: str) -> str:
        if unit == "m":
            return self.length(value)
        return self.angle(value) if unit == "rad" else f"{_plain(value)} {unit}"

    def _no_touch(self, clause: g.NoTouch) -> str:
        if clause.clearance is not None and clause.object is not None:
            if clause.clearance == 0.0:
                raise no_words("a clearance of nothing")
            return f"keeping {self.length(clause.clearance)} away from {self.name(clause.object)}"
        touching = f"{self.say('WITHOUT')} {self.say('TOUCHING')}"
        if clause.object is None:
            return f"{touching} {self.say('ANYTHING')}"
        return f"{touching} {self.name(clause.object)}"

    def _until(self, clause: g.Until) -> str:
        until = f"{self.say('UNTIL')} it"
        if clause.event in _TOUCHES:
            if clause.object is None:
                raise no_words(f"an event {clause.event} without an object")
            return f"{until} {self.say('TOUCHES', clause.event)} {self.name(clause.object)}"
        if clause.event == "edge":
            return f"{until} {self.say('REACHES_EDGE', 'edge')}"
        return f"{until} {self.say('EVENT', clause.event)}"

    def _contact(self, contact: g.ContactRegion, *, directed: bool) -> str:
        # "From the left" also means "to the right" unless a direction is said; keep it for then.
        words = []
        if contact.region:
            words.append(self.say("REGION", contact.region))
        if contact.height:
            words.append(self._height(contact.height))
        if contact.face:
            from_side = directed and contact.face != "top"
            words.append(self.say("FROM_SIDE" if from_side else "FACE", contact.face))
        return " ".join(words)

    def _height(self, height: g.ContactHeight) -> str:
        value = f"{self.bound(height.bound)}{self.length(height.value)}"
        if not isinstance(height.value, g.RelativeLength):
            reference = self.say("HEIGHT_REFERENCE", height.origin)
            if height.bound == "exact":
                return f"at {value} {reference}"
            if height.origin == "top":
                return f"{value} {reference}"
            return (
                f"{self.say('HEIGHT_BOUND', height.bound)} {self.length(height.value)} {reference}"
            )
        if height.origin == "top":
            raise no_words("a height below the top measured in objects")
        return f"at {value}"


def _joins(words: Sequence[str], i: int) -> bool:
    """Whether this word is the "of" of "can of soup"."""
    return words[i] == "of" and 0 < i < len(words) - 1 and words[i + 1] not in _NO_NAMES


def _words(name: str) -> list[str]:
    return name.replace("-", " ").casefold().split()


def _effector(effector: g.Effector) -> str:
    if (effector.count or 1) > len(_COUNTS):
        raise no_words(f"{effector.count} {effector.tool}s")
    count = "your" if effector.count is None else _COUNTS[effector.count - 1]
    plural = "s" if (effector.count or 1) > 1 else ""
    words = ("with", count, effector.side or "", effector.tool + plural)
    return " ".join(word for word in words if word)


def _plain(value: float | Decimal) -> str:
    text = f"{Decimal(repr(value)) if isinstance(value, float) else value:f}"
    return re.sub(r"\.?0+$", "", text) if "." in text else text
