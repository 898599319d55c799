"""Says commands in other words, those of a list.

A command is drawn as phrases that the list has, and said plainly; what that is read as is what a
paraphrase of it has to be read as. A sixth of the paraphrases have politeness on top, a mistake may
be any phrase, and typing errors are those of keyboards and voice (letters beside each other,
capitals, no punctuation).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import yaml

NAMES = ("tea box", "milk carton", "blue mug", "vase", "pepper mill", "cookie jar", "stapler")
OTHERS = ("bowl", "lamp", "teapot", "juice bottle")
MOVING = ("push", "slide", "move", "pull")
DIRECTIONS = ("away", "toward", "left", "right")
DISTANCES = ("cm3", "cm12", "in2", "cm10", "cm5")
PLACES = ("left_of", "right_of", "in_front_of", "behind", "next_to", "edge", "middle")
ANGLES = ("deg45", "deg90", "deg30")
SENSES = ("cw", "ccw")
HEIGHTS = ("high8", "cm10")
HOW = (
    *("gentle", "slow", "fast", "no_topple", "no_tilt", "no_touch"),
    *("finger1", "finger2", "n3", "n5", "cms5"),
)
KEPT = {
    "topple": ("gentle", "slow", "finger1", "n3", "n5"),
    "lift": ("gentle", "slow", "fast", "n5"),
}
"""Constraints of what no other ones fit."""
CLASHES = (
    *({"gentle", "fast"}, {"slow", "fast"}, {"finger1", "finger2"}, {"slow", "cms5"}),
    *({"fast", "cms5"}, {"no_topple", "no_tilt"}, {"until", "no_touch"}),
)
NEIGHBOURS = dict(zip("qwertyuiopasdfghjklzxcvbnm", "wqreytuipoasfdhgkjlzcxbvmn", strict=True))
"""A key beside each."""


@dataclass(frozen=True)
class Phrases:
    """A command in phrases.

    Attributes:
        verb: what is done.
        name: of the object.
        goal: keys of the phrases of the goal.
        how: keys of the phrases of the constraints.
        other: name of the other object that a phrase may name.
    """

    verb: str
    name: str
    goal: tuple[str, ...]
    how: tuple[str, ...]
    other: str


class Speaker:
    """Draws commands and says them in the words of a list.

    Args:
        words: name of the list.
        rng: that draws.
        known: words of the language; no typing error makes one of them.
    """

    def __init__(self, words: str, rng: Random, known: frozenset[str]) -> None:
        path = Path(__file__).with_name(f"{words}_words.yaml")
        self._words: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
        self._rng, self._known = rng, known

    def command(self) -> Phrases:
        """A command of a kind of goal, with up to two constraints that do not contradict."""
        rng, said = self._rng, self._said
        direction, verb = rng.choice(DIRECTIONS), rng.choice(MOVING)
        goals = (
            (verb, (direction,)),
            (verb, (direction, *said("until"))),
            (verb, (rng.choice(said(*DISTANCES)), direction)),
            (verb, ("little", direction)),
            (verb, (rng.choice(said(*PLACES)),)),
            (verb, (rng.choice(said(*PLACES)),)),
            ("turn", (rng.choice(said(*ANGLES)), rng.choice(said(*SENSES) or DIRECTIONS[2:]))),
            rng.choice((("topple", (direction,)), ("lift", said(*HEIGHTS)[:1]))),
        )
        verb, goal = rng.choice(goals)
        how = tuple(rng.sample(said(*KEPT.get(verb, HOW)), rng.choice((0, 0, 1, 1, 2))))
        if any(clash <= {*goal, *how} for clash in CLASHES):
            how = how[:1] if "until" not in goal else ()
        return Phrases(verb, rng.choice(NAMES), goal, how, rng.choice(OTHERS))

    def _said(self, *keys: str) -> tuple[str, ...]:
        """Those keys of phrases that the list has."""
        return tuple(key for key in keys if key in self._words["slots"])

    def paraphrase_of(self, said: Phrases, kind: str) -> str:
        """The command said in the way of a kind."""
        words: str = getattr(self, f"_{kind}")(said)
        more = self._rng.randrange(6)
        if more == 0 and kind in ("lexical", "order"):
            words = f"{self._pick('openings')} {words}"
        elif more == 1 and kind in ("lexical", "order", "structural"):
            words += self._pick("closings")
        return " ".join(words.split()).replace(" ,", ",").replace(" .", ".").replace(" ?", "?")

    def _pick(self, key: str) -> str:
        return str(self._rng.choice(self._words[key]))

    def _slot(self, said: Phrases, key: str, other: bool = False) -> str:
        words = (
            self._rng.choice(self._words["slots"][key][1:])
            if other
            else self._words["slots"][key][0]
        )
        return str(words).format(n=said.other)

    def _rest(self, said: Phrases) -> str:
        return " ".join(self._slot(said, key) for key in (*said.goal, *said.how))

    def plain(self, said: Phrases) -> str:
        """The command in plain words."""
        return f"{said.verb} the {said.name} {self._rest(said)}"

    def _lexical(self, said: Phrases) -> str:
        keys = [*said.goal, *said.how]
        changed = set(self._rng.sample(range(-1, len(keys)), self._rng.choice((1, 1, 2))))
        verb = (
            self._rng.choice(self._words["verbs"][said.verb]["synonyms"])
            if -1 in changed
            else said.verb
        )
        rest = " ".join(self._slot(said, key, i in changed) for i, key in enumerate(keys))
        return f"{verb} the {said.name} {rest}"

    def _structural(self, said: Phrases) -> str:
        verb = self._words["verbs"][said.verb]
        templates = list(self._words["structures"])
        if "noun" in verb and not set(PLACES) & set(said.goal):
            templates += self._words["nouns"]
        return str(self._rng.choice(templates)).format(
            v=said.verb, ed=verb["ed"], ing=verb["ing"], a=verb.get("noun", ""),
            o=f"the {said.name}", o_bare=said.name, rest=self._rest(said),
        )  # fmt: skip

    def _politeness(self, said: Phrases) -> str:
        way, words = self._rng.randrange(5), self.plain(said)
        if way in (0, 1):
            words = f"{self._pick('openings')} {words}"
        if way in (1, 2):
            words += self._pick("closings")
        if way == 3:
            words += self._rng.choice((" ", ", ", ". ")) + self._pick("reasons")
        if way == 4:
            reason = self._pick("reasons")
            first = reason.startswith(("since", "because", "as ", "given", "now"))
            words = f"{reason}, {words}" if first else f"{words} {reason}"
        return words

    def _disfluency(self, said: Phrases) -> str:
        rng, phrases = self._rng, [said.verb, f"the {said.name}"]
        phrases += [self._slot(said, key) for key in (*said.goal, *said.how)]
        way = rng.randrange(4)
        if way == 0:  # words said twice
            words = " ".join(phrases).split()
            i, n = rng.randrange(len(words)), rng.choice((1, 1, 2))
            return " ".join([*words[: i + n], rng.choice(("", ",", "uh")), *words[i:]])
        if way == 1:  # one or two fillers between any two words
            words = " ".join(phrases).split()
            for _ in range(rng.choice((1, 1, 2))):
                words.insert(rng.randrange(len(words)), self._pick("fillers"))
            return " ".join(words)
        keys = (*said.goal, *said.how)
        places = [1, *(i + 2 for i, key in enumerate(keys) if key in self._words["mistaken"])]
        i = rng.choice(places)
        wrong = f"the {rng.choice([n for n in NAMES if n != said.name])}"
        if i > 1:
            wrong = self._words["mistaken"][keys[i - 2]]
        return " ".join([*phrases[:i], f"{wrong}{self._pick('corrections')}", *phrases[i:]])

    def _order(self, said: Phrases) -> str:
        rng, verb = self._rng, f"{said.verb} the {said.name}"
        goal = [self._slot(said, key) for key in said.goal]
        how = [self._slot(said, key) for key in said.how]
        rng.shuffle(goal)
        rng.shuffle(how)
        match rng.randrange(5):
            case 0:  # how it is done stands first
                return f"{' and '.join(how)}, {verb} {' '.join(goal)}".lstrip(" ,")
            case 1:  # the goal stands first
                return f"{' '.join(goal)}, {verb} {' '.join(how)}"
            case 2:  # manner between the object and the goal
                return f"{verb} {' '.join((*how, *goal))}"
            case 3:  # a second sentence says how
                second = f". Do it {' '.join(how)}" if how else ""
                return f"{verb} {' '.join(goal)}{second}"
            case _:
                return f"{verb}, {', '.join((*goal, *how))}"

    def _typing(self, said: Phrases) -> str:
        rng, words = self._rng, self.plain(said)
        match rng.randrange(6):
            case 0:
                return words.upper()
            case 1:
                return words.title() + rng.choice(("", "..", " !", " ."))
            case 2:
                return words.replace(" cm", "cm").replace("doesn't", "doesnt").replace(" ", "  ")
            case 3:
                return words.replace(" ", ", ", 1) if rng.random() < 0.2 else f"{words},"
            case _:
                return self._mistyped(said, words.split())

    def _mistyped(self, said: Phrases, words: list[str]) -> str:
        """The words with one that is none, outside of names."""
        rng, own = self._rng, {*said.name.split(), *said.other.split()}
        places = [i for i, w in enumerate(words) if len(w) > 3 and w.isalpha() and w not in own]
        while True:
            i = rng.choice(places)
            word, k = words[i], rng.randrange(len(words[i]) - 1)
            start, letter, after, end = word[:k], word[k], word[k + 1], word[k + 2 :]
            wrong = rng.choice(
                (
                    start + after + letter + end,
                    start + after + end,
                    start + letter + letter + after + end,
                    start + NEIGHBOURS[letter] + after + end,
                )
            )
            if wrong not in self._known and wrong != word:
                return " ".join([*words[:i], wrong, *words[i + 1 :]])
