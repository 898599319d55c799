"""The language on one card: an example of every kind, in the language's own words.

The kinds come from the frames and the words from the lexicon, so that a new kind or another word
stands on the card by itself; only the numbers of the examples are chosen here.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, get_args

from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, Limit, new_constraint
from grammar.frames.goals import GOALS
from grammar.paraphrasing.command_wording import paraphrase
from grammar.words.lexicon import default_lexicon

_BOX, _MUG = g.ObjectRef(text="box"), g.ObjectRef(text="mug")
_VALUES = {"rad": 0.17453292519943295, "N": 5.0, "m/s": 0.05, "s": 20.0, "m": 0.1}

_MOST_VERBS = 10  # of a kind; it knows more

_GOAL_FIELDS: dict[str, dict[str, Any]] = {
    "displace": {"direction": "away", "distance": 0.1},
    "place": {"relation": "left_of", "reference": (_MUG,), "distance": 0.05},
    "rotate": {"angle": 0.7853981633974483, "sense": "ccw"},
    "tilt": {"angle": 0.17453292519943295},
    "lift": {"height": 0.1},
    "open": {"part": "lid"},
    "close": {"part": "lid"},
    "pour": {"into": _MUG, "volume": 5e-5},
    "parameters": {"which": ("mass",)},
}
_CONSTRAINT_FIELDS: dict[str, dict[str, Any]] = {
    "no_touch": {"object": _MUG},
    "contact": {"face": "left"},
    "effector": {"tool": "finger", "count": 1},
    "until": {"event": "touching", "object": _MUG},
}
_PUSH: dict[str, Any] = {"action": "push", "object": _BOX}
_AWAY = g.Displace(direction="away")
_QUESTIONS: tuple[g.Frame, ...] = (
    g.Frame(query="predict", **_PUSH, goal=_AWAY, event="tips"),
    g.Frame(query="predict", **_PUSH, constraints=(new_constraint("force", value=3.0),)),
    g.Frame(query="possible", **_PUSH, goal=_AWAY),
    g.Frame(query="how_hard", **_PUSH, event="slides"),
    g.Frame(query="where", **_PUSH, event="tips"),
    g.Frame(query="value", object=_BOX, goal=g.Parameters(which=("mass",))),
    g.Frame(query="affordances", object=_BOX),
    g.Frame(query="why"),
)
_REMARKS: tuple[g.Frame, ...] = (
    g.Frame(dialogue="repeat"),
    g.Frame(dialogue="more"),
    g.Frame(dialogue="undo"),
    g.Frame(dialogue="correct", object=_MUG),
)


@cache
def grammar_card() -> str:
    """The card, as plain text."""
    return "\n".join(_lines())


def _lines() -> Iterator[str]:
    yield "What can be said, in English (the names of objects are those that `look` shows):"
    for kind in GOALS:
        if kind != "none":
            yield f"- {kind}: {_verbs(kind)}: “{_goal_example(kind)}”"
    yield f"Directions: {', '.join(map(_direction_words, get_args(g.Direction)))}."
    yield f"Clauses that may follow: {'; '.join(map(_clause_words, CONSTRAINTS))}."
    yield f"Questions, for `ask`: {' '.join(_said(frame) for frame in _QUESTIONS)}"
    yield f"Remarks on what was said before: {'; '.join(map(_said, _REMARKS))}."
    twice = g.Frame(action="turn", object=g.ObjectRef(text="it", pronoun=True), goal=g.Rotate())
    both = paraphrase((g.Frame(**_PUSH, goal=_AWAY), twice))
    yield f"Several at once: “{both}”. Names may stand in quotes: 'push the “box” away'."


def _verbs(kind: str) -> str:
    said = [word for word, verb in default_lexicon().verbs.items() if verb.goal == kind]
    return ", ".join(said[:_MOST_VERBS])


def _goal_example(kind: str) -> str:
    goal = GOALS[kind](**_GOAL_FIELDS.get(kind, {}))
    frame = {"action": next(iter(goal.words.verbs)), "object": _BOX, "goal": goal}
    return paraphrase(g.Frame.model_validate(frame))


def _clause_words(kind: str) -> str:
    """A clause, cut off a whole sentence that has it."""
    cls, fields = CONSTRAINTS[kind], _CONSTRAINT_FIELDS.get(kind, {})
    if issubclass(cls, Limit):
        fields = {"value": _VALUES[cls.words.unit]}
    frame = g.Frame(**_PUSH, goal=_AWAY, constraints=(new_constraint(kind, **fields),))
    return paraphrase(frame).replace(paraphrase(g.Frame(**_PUSH, goal=_AWAY)), "").strip()


def _direction_words(direction: g.Direction) -> str:
    said = paraphrase(g.Frame(**_PUSH, goal=g.Displace(direction=direction)))
    return said.removeprefix(paraphrase(g.Frame(**_PUSH, goal=g.Displace()))).strip()


def _said(frame: g.Frame) -> str:
    return f"“{paraphrase(frame)}”"
