"""Which touches are made and in which order; the hand reports what it would feel."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.identification import Trial
from objectmodels.models.object_model import ObjectModel
from planner.touch_experiments import Experiment, Kind, expected_trials
from planner.types.actions import FaceName
from planner.types.end_reasons import EndReason
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.exploration.exploration_run import OPPOSITE, SPIRAL, Explorer, Touched
from sim.exploration.trial_extraction import Recording
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND

BOX = "ice tea box"
MODEL = Registry.built_in().get(BOX)
STATE = WorldState({BOX: SeenObject(BOX, PlanarPose(0.45, 0.0), MODEL)})
CELL = load_scene("kitchen").cell
REACH = ArmHandReach(CELL, ARM, HAND)

Fails = Mapping[tuple[Kind, FaceName], EndReason]


class Hand:
    """Reports what each experiment is expected to show, but where it fails; keeps what was tried.

    One that ends with a guard shows a slide, one that is out of reach shows nothing.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, fails: Fails | None = None) -> None:
        self.cell, self.seed, self.robot = CELL, 0, REACH
        self.fails = fails or {}
        self.tried: list[Experiment] = []
        self.learned: list[Touched] = []
        monkeypatch.setattr("sim.exploration.exploration_run.extract_trials", self.trials)
        self.explorer = Explorer(BOX, self, lambda: STATE, learn=self.learned.append)

    def look(self, models: Mapping[str, ObjectModel]) -> WorldState:
        return STATE

    def touch(self, experiment: Experiment, *_: object, **__: object) -> Recording:
        self.tried.append(experiment)
        end = self.fails.get((experiment.kind, experiment.push.face), "stroke")
        return Recording(experiment, end, f"ended with {end}", PlanarPose(0.45, 0.0))

    def trials(self, recording: Recording, *, repetition: int) -> tuple[Trial, ...]:
        return (
            () if recording.end == "unreachable" else expected_trials(recording.experiment, MODEL)
        )

    @property
    def names(self) -> list[str]:
        return [experiment.name for experiment in self.tried]


def test_a_repetition_has_every_kind_once_and_tilts_on_two_opposite_sides(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hand = Hand(monkeypatch)
    for repetition in range(2):
        hand.explorer.repeat(("tilt", "slide", "off-centre slide", "rub"), repetition)
    assert hand.names == [
        "tilt at the front", "tilt at the back", "slide at the front",
        "off-centre slide at the front", "rub at the front",
        "tilt at the left", "tilt at the right", "slide at the left",
        "off-centre slide at the left", "rub at the front",
    ]  # fmt: skip
    ends = [e.lateral for e in hand.tried if e.kind == "off-centre slide"]
    assert ends[0] > 0.0 > ends[1]
    assert hand.learned == hand.explorer.touches
    assert [touched.repetition for touched in hand.learned] == [0] * 5 + [1] * 5
    assert all(touched.as_meant for touched in hand.learned)
    assert hand.explorer.given_up == ()


def test_slides_go_along_a_spiral(monkeypatch: pytest.MonkeyPatch) -> None:
    hand = Hand(monkeypatch)
    for repetition in range(len(SPIRAL)):
        hand.explorer.repeat(("slide",), repetition)
    assert tuple(e.push.face for e in hand.tried) == SPIRAL
    steps = np.array([e.push.direction_W[:2] for e in hand.tried])
    places = np.vstack(([0.0, 0.0], np.cumsum(steps, axis=0)))
    # No two slides begin at one place, and none leads far away.
    assert len(np.unique(np.round(places[:-1]), axis=0)) == len(SPIRAL)
    assert np.abs(places).max() <= 2.0 + 1e-9


def test_a_side_that_fails_is_given_up_and_the_next_one_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hand = Hand(monkeypatch, {("slide", "front"): "unreachable", ("slide", "back"): "guard"})
    hand.explorer.repeat(("slide",), 0)
    assert hand.names == ["slide at the front", "slide at the back", "slide at the left"]
    assert hand.explorer.given_up == (
        "slide at the front: ended with unreachable", "slide at the back: ended with guard",
    )  # fmt: skip
    # What showed something else is learned from, what showed nothing is not.
    assert [t.experiment.push.face for t in hand.learned] == ["back", "left"]
    assert [t.as_meant for t in hand.explorer.touches] == [False, False, True]
    # What was given up is not tried again.
    hand.explorer.repeat(("slide",), 0)
    assert hand.names[3:] == ["slide at the left"]
    left = {(e.kind, e.push.face) for e in hand.explorer.possible(("slide", "tilt"))}
    assert left == {("slide", "left"), ("slide", "right")} | {
        ("tilt", face) for pair in OPPOSITE for face in pair
    }


def test_tilts_need_both_sides_of_a_pair(monkeypatch: pytest.MonkeyPatch) -> None:
    hand = Hand(monkeypatch, {("tilt", "back"): "unreachable"})
    hand.explorer.repeat(("tilt",), 0)
    assert hand.names == [f"tilt at the {face}" for face in ("front", "back", "left", "right")]


def test_where_nothing_works_everything_is_tried_once(monkeypatch: pytest.MonkeyPatch) -> None:
    faces: tuple[FaceName, ...] = ("front", "back", "left", "right")
    hand = Hand(monkeypatch, {("slide", face): "unreachable" for face in faces})
    for repetition in range(3):
        hand.explorer.repeat(("slide",), repetition)
    assert sorted(hand.names) == sorted(f"slide at the {face}" for face in faces)
    assert hand.learned == []
    assert len(hand.explorer.given_up) == 4
