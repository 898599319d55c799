"""Verdicts on refusals, and how surely what brute force found works."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.goals import refusal_judge
from benchmarks.goals.refusal_judge import (
    Confirmation,
    Doubt,
    Verdict,
    confirm,
    confirmations,
    likeliest,
    wrong_share,
)
from benchmarks.goals.search import Asked, Found
from benchmarks.goals.sentences import Job
from benchmarks.rollouts import OBJECT, world
from benchmarks.worlds.drake import DrakeBench
from benchmarks.worlds.strokes import at
from nlcontrol import Registry
from nlcontrol.session.controller import Controller
from sim import load_scene

DRAWS = 8  # objects; each takes a fifth of a second


def _asked(text: str) -> Asked:
    robot = Controller(world(), registry=Registry.built_in())
    (frame,) = robot.resolve(robot.parse(text)).frames
    return Asked(frame, OBJECT, robot.models, robot.look().table)


def _pushed(asked: Asked, height: float) -> Found:
    """10 cm straight on, so high above the table [m]."""
    before = DrakeBench(world(), OBJECT).poses()
    place = asked.model.faces()[0].points_at(0.0, height)
    stroke = at(OBJECT, place, before[OBJECT], slant=0.0, length=0.1)
    return Found((stroke,), (before,), 2)


@pytest.mark.slow
def test_what_works_for_some_of_what_is_believed_is_told_from_what_works_for_all() -> None:
    asked = _asked("push the ice tea box 10 cm")
    # Believed friction tips it above 119 mm; by what is doubted of it, anywhere above 33 mm.
    low, at_the_edge = _pushed(asked, 0.03), _pushed(asked, 0.14)
    rng = np.random.default_rng(0)
    some, _ = likeliest(world(), asked, [at_the_edge], rng, DRAWS)
    assert 0.0 < some < 1.0
    every, way = likeliest(world(), asked, [at_the_edge, low], rng, DRAWS)
    assert (every, way) == (1.0, low)


@pytest.mark.slow
def test_what_a_whole_hand_is_refused_is_planned_again_with_more_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case, kitchen = Job(7, 0, executed=False), load_scene("kitchen")
    found = {}
    for text in ("lift the mug 10 cm", "lift the mug 150 cm"):
        sentence = SimpleNamespace(text=text, target="mug")
        monkeypatch.setattr(refusal_judge, "said", lambda _, it=sentence: (kitchen, it))
        monkeypatch.setattr(refusal_judge, "beliefs_of", lambda _: Registry.built_in())
        found[text] = confirm(Doubt(case, "out_of_reach", 1)).verdict
    assert list(found.values()) == ["unconfirmed", "confirmed"]


def test_without_ways_nothing_works() -> None:
    asked = _asked("push the ice tea box 10 cm")
    assert likeliest(world(), asked, [], np.random.default_rng(0), 1) == (0.0, None)


def _verdict(number: int, reason: str, verdict: Verdict) -> Confirmation:
    return Confirmation(
        job=Doubt(Job(7, number), reason, 10),
        verdict=verdict,
        text="push it",
        refusal="no",
        found="a way",
    )


@pytest.mark.parametrize("verdict", ["unlikely", "unconfirmed", "not looked for"])
def test_whatever_is_not_confirmed_is_told_in_full(verdict: Verdict) -> None:
    lines = confirmations(
        [_verdict(1, "blocked", "confirmed"), _verdict(2, "blocked", verdict)]
    ).splitlines()
    _, counts, _, *told = lines
    assert counts.split()[0:2] == ["blocked", "1"]
    assert counts.endswith("7-1, 7-2")
    assert told == [f"7-2 {verdict}: “push it”: no", "  found: a way"]


def test_the_share_of_wrong_refusals_is_of_all_cases() -> None:
    verdicts: tuple[Verdict, ...] = ("confirmed", "unconfirmed", "unlikely", "not looked for")
    found = [_verdict(k, "blocked", verdict) for k, verdict in enumerate(verdicts)]
    # One of three that were looked into is wrong; so would be four of twelve, of a hundred cases.
    told = wrong_share(found, 12, 100)
    assert told.startswith("wrongly refused: 1 of 3 ")
    assert "4.0%" in told
