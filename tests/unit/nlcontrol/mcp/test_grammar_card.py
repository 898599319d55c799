"""The card has every kind of goal and clause, in words that are understood."""

from __future__ import annotations

import re

from grammar import parse
from grammar.frames.constraints import CONSTRAINTS
from grammar.frames.goals import GOALS
from nlcontrol.mcp.stdio_server import grammar_card


def test_every_example_is_read_as_its_kind() -> None:
    examples = dict(re.findall(r"^- (\w+): .*“(.+)”$", grammar_card(), re.M))
    assert set(examples) == set(GOALS) - {"none"}
    assert {kind: parse(said).frames[0].goal.kind for kind, said in examples.items()} == {
        kind: kind for kind in examples
    }


def test_every_clause_is_read_as_its_kind() -> None:
    line = next(each for each in grammar_card().splitlines() if each.startswith("Clauses"))
    clauses = line.partition(": ")[2].removesuffix(".").split("; ")
    # What is pushed away slides, but a fall need not begin with that.
    commands = {"without sliding it": "topple the box"}
    read = [
        parse(f"{commands.get(clause, 'push the box away')} {clause}").frames[0].constraints
        for clause in clauses
    ]
    assert [each.kind for (each,) in read] == list(CONSTRAINTS)


def test_every_question_and_direction_is_read() -> None:
    lines = grammar_card().splitlines()
    questions = next(each for each in lines if each.startswith("Questions"))
    found = [parse(said).frames[0].query for said in re.findall(r"“([^”]+)”", questions)]
    assert {"predict", "possible", "how_hard", "where", "value", "affordances", "why"} == set(found)
    directions = next(each for each in lines if each.startswith("Directions"))
    said = directions.partition(": ")[2].removesuffix(".").split(", ")
    assert len({parse(f"push the box {way}").frames[0].goal for way in said}) == len(said) >= 4


def test_it_fits_into_a_models_context() -> None:
    assert len(grammar_card()) < 3000
