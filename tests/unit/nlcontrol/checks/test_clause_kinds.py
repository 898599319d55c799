"""Every kind of goal and constraint is known wherever a kind has to be known."""

from __future__ import annotations

import pytest

from grammar.frames.constraints import CONSTRAINTS
from grammar.frames.goals import GOALS
from grammar.words.lexicon import default_lexicon
from nlcontrol.checks import constraint_checks, goal_checks

NOT_CHECKED = {"hand_over", "upright", "parameters"}
"""Goals that are refused before anything moves, and one that ends in a report."""


@pytest.mark.parametrize("kind", sorted(CONSTRAINTS))
def test_constraint_has_its_words(kind: str) -> None:
    words, terminals = CONSTRAINTS[kind].words, default_lexicon().terminals
    assert words.terminal in terminals if words.terminal else words.phrase.count("{}") == 1
    if words.terminal in ("AVOIDING", "MANNER"):
        assert kind in terminals[words.terminal].values()
    assert bool(words.unit) == ("value" in CONSTRAINTS[kind].model_fields)


@pytest.mark.parametrize("kind", sorted(CONSTRAINTS))
def test_constraint_has_its_check(kind: str) -> None:
    assert kind in constraint_checks.CONSTRAINTS


@pytest.mark.parametrize("kind", sorted(GOALS))
def test_goal_has_its_words(kind: str) -> None:
    words, lexicon = GOALS[kind].words, default_lexicon()
    assert words.verbs
    assert set(words.verbs.values()) <= set(lexicon.verb_words["VERB"])
    assert set(words.outcomes) <= {*lexicon.terminals["EVENT"].values(), "ends_up"}


@pytest.mark.parametrize("kind", sorted(set(GOALS) - NOT_CHECKED))
def test_goal_has_its_check(kind: str) -> None:
    assert kind in goal_checks.GOALS
