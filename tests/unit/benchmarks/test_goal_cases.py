"""Worlds and sentences are drawn from seed and number alone, within the stated bounds."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from benchmarks.goals.cases import Done, Watch, run
from benchmarks.goals.drawn_worlds import standing
from benchmarks.goals.sentences import KINDS, Job, kind_of, said
from benchmarks.rollouts import world
from nlcontrol import Registry
from nlcontrol.batches.drawn_scenes import (
    CENTRE_OF_MASS,
    FINGER_FRICTION,
    FRICTION,
    GAP,
    MASS,
    MOST,
    REACHED,
    STANDING,
    pushable_models,
)
from nlcontrol.results.result import Step
from nlcontrol.session.controller import Controller
from planner.problem.footprints import footprint, overlaps
from planner.types.plan import Plan
from planner.types.refusal import Refusal

CASES = 3 * len(KINDS)


def test_seed_and_number_say_everything() -> None:
    alone = said(Job(3, 11))
    _ = [said(Job(3, number)) for number in range(5)]
    assert said(Job(3, 11)) == alone
    for other in (Job(3, 11 + len(KINDS)), Job(4, 11)):
        assert said(other)[0].objects != alone[0].objects


@pytest.mark.parametrize("number", range(CASES))
def test_truths_lie_within_their_bounds(number: int) -> None:
    scene, _ = said(Job(1, number))
    registry = Registry.built_in()
    for item in scene.objects:
        believed, truth = registry.get(item.model), item.truth
        assert 0.0 < abs(truth.mass_kg / believed.mass - 1.0) <= MASS
        assert 0.0 < abs(truth.friction_table / believed.friction - 1.0) <= FRICTION
        off = truth.friction_finger / believed.finger_friction - 1.0
        assert 0.0 < abs(off) <= FINGER_FRICTION
        shift = np.abs(np.subtract(truth.centre_of_mass, believed.com))
        assert shift.max() <= CENTRE_OF_MASS + 1e-12  # rounding


@pytest.mark.parametrize("number", range(CASES))
def test_objects_stand_apart_and_within_reach(number: int) -> None:
    scene, sentence = said(Job(2, number))
    seen = list(standing(scene).values())
    assert 1 <= len(seen) <= MOST
    for k, one in enumerate(seen):
        assert not any(overlaps(footprint(one), footprint(other), GAP) for other in seen[:k])
        for at, (low, high) in zip(
            (one.pose.x, one.pose.y), STANDING if k else REACHED, strict=True
        ):
            assert low <= at <= high
    assert (seen[0].name, seen[0].fragile) == (sentence.target, False)


def test_some_of_the_others_are_fragile() -> None:
    others = [item for number in range(CASES) for item in said(Job(2, number))[0].objects[1:]]
    assert 0.0 < np.mean([item.fragile for item in others]) < 0.5


@pytest.mark.slow
def test_most_sentences_are_sensible_and_some_are_not() -> None:
    sensible = [said(Job(0, number))[1].sensible for number in range(10 * len(KINDS))]
    # Nine in ten are drawn so; 0.07 is two standard deviations of 70.
    assert np.mean(sensible) == pytest.approx(0.9, abs=0.07)


@pytest.mark.parametrize("number", range(2 * CASES))
def test_every_sentence_is_understood_as_its_kind(number: int) -> None:
    scene, sentence = said(Job(0, number))
    controller = Controller(scene, registry=Registry.built_in())
    frames = controller.resolve(controller.parse(sentence.text)).frames
    first = frames[0]
    assert first.object is not None
    assert first.object.id == sentence.target
    until = any(clause.kind == "until" for clause in first.constraints)
    match kind_of(Job(0, number)):
        case "until":
            assert until
        case "steps":
            assert len(frames) in (2, 3)
        case kind:
            assert [frame.goal.kind for frame in frames] == [kind]
            assert not until


@pytest.mark.slow
def test_a_case_is_the_same_bit_for_bit_in_any_process() -> None:
    job = Job(0, KINDS.index("displace"))
    with ProcessPoolExecutor(1) as pool:
        there = pool.submit(run, job).result()
    here = run(job)
    assert here.accepted
    assert here.digest == there.digest
    assert here == there
    assert Done.model_validate_json(here.model_dump_json()) == here


def test_what_is_too_flat_or_there_to_be_handled_is_left_out() -> None:
    left_out = set(Registry.built_in().names()) - {model.name for model in pushable_models()}
    assert left_out == {"book", "ice tea", "ice tea cup", "jar", "storage bin"}


def test_what_contradicts_itself_is_drawn_again() -> None:
    # First drawn is a push “near the top at the bottom”.
    _, sentence = said(Job(101, 225))
    assert sentence.sensible
    assert "near the top" not in sentence.text


def test_what_is_planned_once_something_is_moved_aside_counts_as_planned() -> None:
    robot = Controller(world(), registry=Registry.built_in())
    command = robot.resolve(robot.parse("push the ice tea box 5 cm"))
    made = robot.plan(command.frames[0])
    assert isinstance(made, Plan)
    refusal = Refusal(code="in_the_way", reason="blocked", message="something is in the way")
    watch = Watch(command.frames[0], plans=[refusal])
    assert watch.plan_of(Step(frame=0, status="planned", plan=made)) is made
    assert watch.plan_of(Step(frame=0, status="refused")) is None
