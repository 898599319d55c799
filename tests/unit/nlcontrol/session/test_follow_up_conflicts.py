"""What a remark says takes the place of the constraints that it cannot stand beside."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import pytest

from grammar.frames import command as g
from grammar.frames import constraints as conflicts
from grammar.frames.constraints import CONSTRAINTS, new_constraint
from nlcontrol.session.remarks import follow_up_targets
from nlcontrol.session.remarks.follow_up_targets import merge_frames

GOALS: dict[str, g.Goal] = {
    "topple": g.Topple(),
    "tilt": g.Tilt(),
    "rotate": g.Rotate(),
    "lift": g.Lift(),
    "upright": g.Upright(),
    "pour": g.Pour(),
    "displace": g.Displace(direction="away"),
    "place": g.Place(relation="at", reference="center"),
}
MUG = g.ObjectRef(text="mug")


def constraint(kind: str) -> g.Constraint:
    fields: dict[str, Any] = {"value": 1.0} if CONSTRAINTS[kind].words.unit else {}
    fields |= {"event": "moves"} if kind == "until" else {}
    return new_constraint(kind, **fields)


def kept(before: g.Frame, said: g.Frame) -> set[str]:
    return {clause.kind for clause in merge_frames(before, said).constraints}


def frame(kind: str, goal: g.Goal) -> g.Frame:
    return g.Frame(action="move", object=MUG, goal=goal, constraints=(constraint(kind),))


def matters() -> Iterator[tuple[int, str, str]]:
    for i, matter in enumerate(conflicts.SAME_MATTER):
        for known, new in combinations(sorted(matter), 2):
            yield i, known, new
            yield i, new, known


@pytest.mark.parametrize(("row", "known", "new"), list(matters()))
def test_new_constraint_takes_the_place_of_its_matter(
    row: int, known: str, new: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = g.Frame(dialogue="correct", constraints=(constraint(new),))
    assert kept(frame(known, g.Displace()), said) == {new}
    rest = conflicts.SAME_MATTER[:row] + conflicts.SAME_MATTER[row + 1 :]
    monkeypatch.setattr(follow_up_targets, "SAME_MATTER", rest)
    assert kept(frame(known, g.Displace()), said) == {known, new}


@pytest.mark.parametrize("kind", sorted(conflicts.HOW_FAR))
def test_new_distance_takes_the_place_of_what_says_how_far(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = frame(kind, g.Displace(direction="left"))
    farther = g.Frame(dialogue="correct", goal=g.Displace(distance=0.1))
    assert kept(before, farther) == set()
    assert kept(before, g.Frame(dialogue="correct", goal=g.Displace(direction="away"))) == {kind}
    monkeypatch.setattr(follow_up_targets, "HOW_FAR", conflicts.HOW_FAR - {kind})
    assert kept(before, farther) == {kind}


@pytest.mark.parametrize(
    ("goal", "kind"),
    [(goal, kind) for goal, kinds in conflicts.FORBIDS.items() for kind in sorted(kinds)],
)
def test_new_goal_drops_what_forbids_it(
    goal: str, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, said = frame(kind, g.HandOver()), g.Frame(action="push", goal=GOALS[goal])
    assert kept(before, said) == set()
    rest = conflicts.FORBIDS | {goal: conflicts.FORBIDS[goal] - {kind}}
    monkeypatch.setattr(follow_up_targets, "FORBIDS", rest)
    assert kept(before, said) == {kind}


@pytest.mark.parametrize(("goal", "kind"), [("tilt", "max_tilt"), ("rotate", "max_turn")])
def test_new_goal_drops_the_limit_of_its_measure(goal: str, kind: str) -> None:
    said = g.Frame(action="move", goal=GOALS[goal])
    assert kept(frame(kind, g.HandOver()), said) == set()


def test_new_goal_keeps_how_far_it_may_go() -> None:
    said = g.Frame(action="move", goal=GOALS["displace"])
    assert kept(frame("max_distance", g.HandOver()), said) == {"max_distance"}
