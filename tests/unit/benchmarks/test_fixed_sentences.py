"""Worlds lie within the stated bounds, and a failure counts as what it is."""

from __future__ import annotations

import pytest

from benchmarks.goals.drawn_worlds import VISION, WIDE, believed
from benchmarks.goals.fixed import (
    APART,
    FILLED,
    HANDS,
    SENTENCES,
    SHIFT,
    TURN,
    Done,
    Job,
    Suite,
    report,
    robot_of,
    world,
)
from nlcontrol import Registry
from sim.truth.scene_file import load_scene

SEEDS = range(5)
ROUNDING = 1e-9


@pytest.mark.parametrize("sentence", HANDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_worlds_lie_within_their_bounds(sentence: str, seed: int) -> None:
    drawn, registry = world(Job("hands", sentence, seed)), Registry.built_in()
    for before, item in zip(load_scene(HANDS[sentence][0]).objects, drawn.objects, strict=True):
        was, pose = before.pose, item.pose
        assert max(abs(pose.x_m - was.x_m), abs(pose.y_m - was.y_m)) <= SHIFT
        assert abs(pose.yaw_deg - was.yaw_deg) <= TURN
        believed, truth = registry.get(item.model), item.truth
        assert truth.friction_table / believed.friction == pytest.approx(1.0, abs=APART)
        assert truth.friction_finger / believed.finger_friction == pytest.approx(1.0, abs=APART)
        if item.name != "ice tea":
            assert truth.mass_kg / believed.mass == pytest.approx(1.0, abs=APART + ROUNDING)
        if truth.lid is not None and truth.lid.kind == "flip":
            assert believed.lid is not None
            assert believed.lid.kind == "flip"
            torque = truth.lid.friction_torque / believed.lid.friction_torque
            assert torque == pytest.approx(1.0, abs=APART)
            assert truth.lid.snap_torque / believed.lid.snap_torque == pytest.approx(torque)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_carton_weighs_what_is_in_it(seed: int) -> None:
    truth, believed = world(Job("hands", "pour", seed)).object("ice tea").truth, Registry.built_in()
    assert truth.container is not None
    assert truth.vessel is not None
    share = truth.container.contents / truth.vessel.capacity
    assert FILLED[0] <= share <= FILLED[1]
    model = believed.get("ice tea")
    assert model.container is not None
    shell = truth.mass_kg - truth.container.mass
    assert shell / (model.mass - model.container.mass) == pytest.approx(1.0, abs=APART + ROUNDING)
    # The fuller, the higher its middle, from the floor up to that of the cavity.
    assert 0.01 < truth.centre_of_mass[2] < 0.08


def test_a_seed_says_everything() -> None:
    assert world(Job("hands", "open", 3)) == world(Job("hands", "open", 3))
    assert world(Job("hands", "open", 3)).objects == world(Job("hands", "pour", 3)).objects
    assert world(Job("hands", "open", 4)).objects != world(Job("hands", "open", 3)).objects


@pytest.mark.parametrize(
    ("suite", "sentence"), [(suite, name) for suite, texts in SENTENCES.items() for name in texts]
)
def test_every_sentence_is_about_something_of_its_world(suite: Suite, sentence: str) -> None:
    job = Job(suite, sentence, 0)
    robot = robot_of(job)
    frame = robot.resolve(robot.parse(job.text)).frames[0]
    assert frame.object is not None
    assert frame.object.id in world(job).names


@pytest.mark.parametrize("seed", [0, 17])
def test_truths_for_the_papers_sentences_lie_within_what_is_believed(seed: int) -> None:
    scene, registry = world(Job("paper", "push", seed)), believed(wide=True)
    assert scene.vision == VISION
    for item in scene.objects:
        model, truth = registry.get(item.model), item.truth
        for true, thought in (
            (truth.mass_kg, model.mass),
            (truth.friction_table, model.friction),
            (truth.friction_finger, model.finger_friction),
        ):
            assert 0.0 < abs(true / thought - 1.0) <= WIDE
        if model.container is not None:
            assert truth.container is not None
            full = truth.container.contents_l * truth.container.density / 1000.0
            assert full < truth.mass_kg
    assert world(Job("paper", "push", seed + 1)) != scene


@pytest.mark.parametrize(
    ("done", "outcome"),
    [
        ({"status": "done", "end": "handled"}, "satisfied"),
        ({"status": "refused"}, "refused"),
        ({"status": "unsupported"}, "refused"),
        ({"status": "crashed"}, "crashed"),
        ({"status": "failed", "end": "slipped"}, "told"),
        ({"status": "failed", "end": "handled", "stuck": True}, "told"),
        ({"status": "failed", "end": "handled"}, "silent"),
    ],
)
def test_a_failure_that_the_robot_does_not_know_of_is_silent(
    done: dict[str, object], outcome: str
) -> None:
    kept = Done.model_validate({"job": Job("hands", "open", 0), **done})
    assert kept.outcome == outcome
    again = Done.model_validate_json(kept.model_dump_json())
    assert again == kept


def test_tables_count_and_show_what_went_wrong() -> None:
    every = [
        Done(job=Job("hands", "open", 0), status="done", end="handled", tries=1),
        Done(job=Job("hands", "open", 1), status="done", end="handled", tries=2),
        Done(job=Job("hands", "open", 2), status="failed", end="missed", tries=2),
    ]
    text = report(every)
    assert text.splitlines()[1].split() == ["open", "2", "0", "1", "0", "0", "1.67"]
    assert "open 2 told: missed" in text
    assert "open 1" not in text
