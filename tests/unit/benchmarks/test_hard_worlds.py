"""Hard worlds are hard as they say, and depend on seed and number alone."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.goals.drawn_worlds import APART, MANY, NARROW, TALL, WIDE, standing
from benchmarks.goals.sentences import HARD, Job, beliefs_of, kind_of, said, setting_of
from nlcontrol.batches.drawn_scenes import MASS
from nlcontrol.session.controller import Controller
from planner.problem.footprints import footprint, gap

ROUNDING = 1e-9  # of places found by a distance along edges' normals [m]


def cases(setting: str, count: int, seed: int = 3) -> list[Job]:
    every = (Job(seed, number, "hard") for number in range(4 * count))
    return [job for job in every if setting_of(job) == setting]


def test_seed_and_number_say_everything() -> None:
    job = Job(3, 6, "hard")
    assert said(job) == said(job)
    assert said(job)[0].objects != said(Job(4, 6, "hard"))[0].objects


def test_each_setting_takes_its_turn_with_each_of_its_kinds() -> None:
    asked = {(setting_of(job), kind_of(job)) for job in (Job(0, n, "hard") for n in range(200))}
    assert asked == {(setting, kind) for setting, kinds in HARD.items() for kind in kinds}


def test_something_high_stands_near_in_narrow_worlds() -> None:
    for job in cases("narrow", 6):
        target, *others = standing(said(job)[0]).values()
        gaps = [gap(footprint(target), footprint(other)) for other in others]
        assert 1 <= len(gaps) <= 2
        # Between two corners it is wider than along the normal of a side.
        assert all(NARROW[0] - ROUNDING <= each <= 1.5 * NARROW[1] for each in gaps)
        assert all(other.model.top >= TALL for other in others)


def test_a_fallen_target_lies_on_a_side_and_is_seen_so() -> None:
    for job in cases("fallen", 3):
        scene, sentence = said(job)
        assert standing(scene)[sentence.target].lies_on not in ("bottom", "top", "nothing flat")
        seen = Controller(scene, registry=beliefs_of(job)).look().objects[sentence.target]
        assert seen.lies_on == standing(scene)[sentence.target].lies_on
        item = scene.object(sentence.target)
        heights = (item.truth.shape.hull_corners @ item.pose.R_WB.T + item.p_WB)[:, 2]
        assert heights.min() == pytest.approx(0.0, abs=ROUNDING)


def test_many_stand_apart() -> None:
    for job in cases("many", 2):
        seen = list(standing(said(job)[0]).values())
        assert MANY[0] - 1 <= len(seen) <= MANY[1]
        for k, one in enumerate(seen):
            assert all(gap(footprint(one), footprint(o)) >= APART - ROUNDING for o in seen[:k])


def test_wide_truths_and_what_is_believed_of_them() -> None:
    off = []
    for job in cases("wide", 11):
        scene, _ = said(job)
        assert scene.vision.position_noise_m == 0.005
        for item in scene.objects:
            believed = beliefs_of(job).get(item.model)
            assert believed.mass_sd == pytest.approx(WIDE * believed.mass / np.sqrt(3.0))
            off.append(item.truth.mass_kg / believed.mass - 1.0)
            if item.truth.lid is not None and believed.lid is not None:
                assert item.truth.lid != believed.lid
    assert MASS < np.abs(off).max() <= WIDE
    assert {said(job)[0].objects[0].model for job in cases("wide", 11)} & {"ice tea cup", "jar"}
