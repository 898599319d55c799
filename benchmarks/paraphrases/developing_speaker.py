"""Says commands in the words of `developing_words.yaml`, by which the language was made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import yaml

from grammar.frames import command as g

WORDS: dict[str, Any] = yaml.safe_load(
    Path(__file__).with_name("developing_words.yaml").read_text(encoding="utf-8")
)
NAMES = ("coffee box", "mug", "cereal box", "soup can", "jar", "ice tea box")
OTHERS = ("tea tin", "bottle", "sugar box")


class Verb(NamedTuple):
    """A verb and its forms; `noun` is what is given by it ("a push")."""

    base: str
    action: g.Action
    ed: str
    ing: str
    noun: str = ""


MOVING = (
    Verb("push", "push", "pushed", "pushing", "a push"),
    Verb("slide", "slide", "slid", "sliding"),
    Verb("move", "move", "moved", "moving"),
    Verb("pull", "pull", "pulled", "pulling", "a pull"),
)
TURN = Verb("turn", "turn", "turned", "turning", "a turn")
TOPPLE = Verb("topple", "topple", "toppled", "toppling")
LIFT = Verb("lift", "lift", "lifted", "lifting")


class Phrase(NamedTuple):
    """A phrase by the key of its words, with what it names behind it."""

    key: str
    name: str = ""


@dataclass(frozen=True)
class Case:
    """A command, and the phrases that say it.

    Attributes:
        verb: what is done.
        name: of the object.
        goal: phrases of the goal.
        how: phrases of the constraints.
        frame: what it means.
    """

    verb: Verb
    name: str
    goal: tuple[Phrase, ...]
    how: tuple[Phrase, ...]
    frame: g.Frame


HOW: Mapping[str, g.Constraint] = {
    "gentle": g.Gentle(),
    "slow": g.Slow(),
    "no_topple": g.NoTopple(),
    "finger": g.Effector(tool="finger", count=1),
    "force": g.MaxForce(value=5.0),
}


def drawn_case(rng: Random) -> Case:
    """A command of one of the kinds of goals, with up to two constraints."""
    name, kind = rng.choice(NAMES), rng.randrange(8)
    phrases: tuple[Phrase, ...]
    goal: g.Goal
    verb = rng.choice(MOVING)
    other = rng.choice(OTHERS)
    direction: Any = rng.choice(("away", "toward", "left", "right"))
    match kind:
        case 0 | 1:
            phrases, goal = (Phrase(direction),), g.Displace(direction=direction)
        case 2 | 3:
            far, distance = rng.choice((("cm10", 0.1), ("cm5", 0.05)))
            phrases = (Phrase(far), Phrase(direction))
            goal = g.Displace(direction=direction, distance=distance)
        case 4:
            phrases = (Phrase("little"), Phrase(direction))
            goal = g.Displace(direction=direction, amount="little")
        case 5:
            relation: Any = rng.choice(("next_to", "behind"))
            phrases = (Phrase(relation, other),)
            goal = g.Place(relation=relation, reference=(g.ObjectRef(text=other),))
        case 6:
            side, sense = rng.choice((("left", "ccw"), ("right", "cw")))
            verb, phrases = TURN, (Phrase("deg30"), Phrase(side))
            goal = g.Rotate(angle=0.5235987755982988, sense=sense)
        case _:
            verb = rng.choice((TOPPLE, LIFT))
            phrases = (Phrase(direction),) if verb is TOPPLE else (Phrase("cm10"),)
            goal = g.Topple(direction=direction) if verb is TOPPLE else g.Lift(height=0.1)
    fitting = [key for key in HOW if not (key == "no_topple" and verb in (TOPPLE, LIFT))]
    fitting = [key for key in fitting if not (key == "finger" and verb is LIFT)]
    how = tuple(rng.sample(fitting, rng.choice((0, 0, 1, 1, 2))))
    frame = g.Frame(
        action=verb.action,
        object=g.ObjectRef(text=name),
        goal=goal,
        constraints=tuple(HOW[key] for key in how),
    )
    return Case(verb, name, phrases, tuple(map(Phrase, how)), frame)


class DevelopingSpeaker:
    """Says a case in other words."""

    def __init__(self, rng: Random, known: frozenset[str]) -> None:
        self._rng, self._known = rng, known

    def paraphrase_of(self, case: Case, kind: str) -> str:
        """The case said in the way of a kind."""
        said: str = getattr(self, f"_{kind}")(case)
        return " ".join(said.split()).replace(" ,", ",").replace(" .", ".")

    def _pick(self, key: str) -> str:
        picked: str = self._rng.choice(WORDS[key])
        return picked

    def _first(self, phrase: Phrase, other: bool = False) -> str:
        """A phrase in plain words, or in any of those of the list."""
        words = self._pick(phrase.key) if other else plain_words(phrase.key)
        return f"{words} the {phrase.name}" if phrase.name else words

    def _rest(self, case: Case, other: bool = False) -> str:
        return " ".join(self._first(phrase, other) for phrase in (*case.goal, *case.how))

    def plain(self, case: Case) -> str:
        """The command in plain words."""
        return f"{case.verb.base} the {case.name} {self._rest(case)}"

    def _lexical(self, case: Case) -> str:
        verb = case.verb.base
        if self._rng.randrange(3) == 0:
            verb = self._rng.choice(WORDS["synonyms"][verb])
        return f"{verb} the {case.name} {self._rest(case, other=True)}"

    def _structural(self, case: Case) -> str:
        templates = [t for ts in WORDS["structures"].values() for t in ts]
        if case.verb.noun and not isinstance(case.frame.goal, g.Place):
            templates += WORDS["nouns"] * 2
        verb = case.verb
        return str(self._rng.choice(templates)).format(
            v=verb.base, ed=verb.ed, ing=verb.ing, a=verb.noun, o=f"the {case.name}",
            n=case.name, rest=self._rest(case),
        )  # fmt: skip

    def _politeness(self, case: Case) -> str:
        bare, way = self.plain(case), self._rng.randrange(4)
        before = f"{self._pick('before')} " if way in (0, 2) else ""
        after = self._pick("after") if way in (1, 2) else ""
        reason = f"{self._rng.choice(('', '', ','))} {self._pick('reasons')}" if way == 3 else ""
        return f"{before}{bare}{after}{reason}"

    def _disfluency(self, case: Case) -> str:
        phrases = [case.verb.base, f"the {case.name}"]
        phrases += [self._first(phrase) for phrase in (*case.goal, *case.how)]
        match self._rng.randrange(5):
            case 0:
                words = " ".join(phrases).split()
                i = self._rng.randrange(len(words))
                again = words[i : i + self._rng.choice((1, 2))]
                return " ".join([*words[:i], *again, *words[i:]])
            case 1:
                phrases.insert(self._rng.randrange(len(phrases)), self._pick("fillers"))
            case 2:
                words = " ".join(phrases).split()
                words.insert(self._rng.randrange(len(words)), self._pick("fillers"))
                return " ".join(words)
            case _:
                i = self._rng.randrange(1, len(phrases))
                instead = self._mistaken(case, i)
                phrases.insert(i, f"{instead}{self._pick('corrections')}")
        return " ".join(phrases)

    def _mistaken(self, case: Case, i: int) -> str:
        """What one said first in place of the phrase at a place, where 1 is the object."""
        if i == 1:
            return f"the {self._rng.choice([n for n in NAMES if n != case.name])}"
        phrase = (*case.goal, *case.how)[i - 2]
        return f"{plain_words(phrase.key)} the mug" if phrase.name else MISTAKEN[phrase.key]

    def _order(self, case: Case) -> str:
        how = [self._first(phrase) for phrase in case.how]
        goal = [self._first(phrase) for phrase in case.goal]
        self._rng.shuffle(goal)
        self._rng.shuffle(how)
        verb = f"{case.verb.base} the {case.name}"
        front = [words for words in how if words in ("gently", "slowly", "without toppling it")]
        match self._rng.randrange(6):
            case 3:
                return f"{' '.join(goal)}, {verb} {' '.join(how)}"
            case 4:
                return f"{verb}, {', '.join((*goal, *how))}"
            case 5:
                second = f". Do it {' '.join(how)}" if how else ""
                return f"{verb} {' '.join(goal)}{second}"
            case 0 if front and front[0] != "without toppling it":
                how.remove(front[0])
                return f"{front[0]} {verb} {' '.join((*goal, *how))}"
            case 1 if not case.goal[-1].name:
                return f"{verb} {' '.join((*how, *goal))}"
            case _:
                return f"{verb} {' '.join((*goal, *how))}"

    def _typing(self, case: Case) -> str:
        match self._rng.randrange(8):
            case 0:
                return self.plain(case).upper()
            case 1:
                return f"{self.plain(case).capitalize()}{self._rng.choice(('.', '!', '...', ' .'))}"
        words = self.plain(case).split()
        own = set(case.name.split()) | {w for p in case.goal for w in p.name.split()}
        places = [i for i, w in enumerate(words) if len(w) > 3 and w.isalpha() and w not in own]
        while True:
            i = self._rng.choice(places)
            wrong = self._mistyped(words[i])
            if wrong not in self._known and wrong != words[i]:
                return " ".join([*words[:i], wrong, *words[i + 1 :]])

    def _mistyped(self, word: str) -> str:
        i = self._rng.randrange(len(word) - 1)
        match self._rng.randrange(3):
            case 0:
                return f"{word[:i]}{word[i + 1]}{word[i]}{word[i + 2 :]}"
            case 1:
                return f"{word[:i]}{word[i + 1 :]}"
            case _:
                return f"{word[: i + 1]}{word[i:]}"


MISTAKEN = {
    "away": "to the left", "toward": "to the right", "left": "to the right",
    "right": "to the left", "cm10": "20 cm", "cm5": "7 cm", "little": "a lot",
    "deg30": "45 degrees", "gentle": "hard", "slow": "fast", "no_topple": "without tilting it",
    "finger": "with two fingers", "force": "with at most 9 N",
}  # fmt: skip


def plain_words(key: str) -> str:
    """The first words of a key, those that the language had before."""
    words: str = WORDS[key][0]
    return words
