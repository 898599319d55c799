"""Says commands in words that judged the language before it was developed with them.

A command is drawn as phrases and said plainly; what that is read as is what a paraphrase of it has
to be read as. Its kinds are those of `developing_speaker.py`, drawn otherwise: a sixth of the
paraphrases have politeness on top, a mistake may be any phrase, and typing errors are those of
keyboards and voice (letters beside each other, capitals, no punctuation).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, cast

import yaml

NAMES = ("tea box", "milk carton", "blue mug", "vase", "pepper mill", "cookie jar", "stapler")
OTHERS = ("bowl", "lamp", "teapot", "juice bottle")
DIRECTIONS = ("away", "toward", "left", "right")
PLACES = ("left_of", "right_of", "in_front_of", "behind", "next_to", "edge", "middle")
HOW = ("gentle", "slow", "fast", "no_topple", "no_tilt", "no_touch", "finger1", "finger2", "n3",
       "cms5")  # fmt: skip
CLASHES = ({"gentle", "fast"}, {"slow", "fast"}, {"finger1", "finger2"}, {"slow", "cms5"},
           {"fast", "cms5"}, {"no_topple", "no_tilt"}, {"until", "no_touch"})  # fmt: skip
NEIGHBOURS = dict(zip("qwertyuiopasdfghjklzxcvbnm", "wqreytuipoasfdhgkjlzcxbvmn", strict=True))


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


def drawn_phrases(rng: Random) -> Phrases:
    """A command of a kind of goal, with up to two constraints that do not contradict."""
    direction, verb = rng.choice(DIRECTIONS), rng.choice(("push", "slide", "move", "pull"))
    goals = (
        (verb, (direction,)), (verb, (direction, "until")),
        (verb, (rng.choice(("cm3", "cm12", "in2")), direction)), (verb, ("little", direction)),
        (verb, (rng.choice(PLACES),)), (verb, (rng.choice(PLACES),)),
        ("turn", (rng.choice(("deg45", "deg90")), rng.choice(("cw", "ccw")))),
        rng.choice((("topple", (direction,)), ("lift", ("high8",)))),
    )  # fmt: skip
    verb, goal = rng.choice(goals)
    kept = {"topple": ("gentle", "slow", "finger1", "n3"), "lift": ("gentle", "slow", "fast")}
    how = tuple(rng.sample(kept.get(verb, HOW), rng.choice((0, 0, 1, 1, 2))))
    if any(clash <= {*goal, *how} for clash in CLASHES):
        how = how[:1] if "until" not in goal else ()
    return Phrases(verb, rng.choice(NAMES), goal, how, rng.choice(OTHERS))


@cache
def words_of(name: str) -> dict[str, Any]:
    """The words of a file: those of verbs, slots, openings and so on."""
    path = Path(__file__).with_name(f"{name}_words.yaml")
    return cast("dict[str, Any]", yaml.safe_load(path.read_text(encoding="utf-8")))


class JudgingSpeaker:
    """Says phrases in other words, those of a file."""

    def __init__(self, rng: Random, known: frozenset[str], words: str) -> None:
        self._rng, self._known, self._words = rng, known, words_of(words)

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
            wrong = rng.choice((
                word[:k] + word[k + 1] + word[k] + word[k + 2 :], word[:k] + word[k + 1 :],
                word[: k + 1] + word[k:], word[:k] + NEIGHBOURS[word[k]] + word[k + 1 :],
            ))  # fmt: skip
            if wrong not in self._known and wrong != word:
                return " ".join([*words[:i], wrong, *words[i + 1 :]])
