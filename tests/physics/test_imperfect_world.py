"""The robot's pushes in a world that is not ideal: felt, drawn anew by a touch, and repeatable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from planner.types.plan import Plan
from sim import Trace, load_scene
from sim.random_streams import RandomStream, source
from sim.simulated_executor import simulation
from sim.truth.object_truth import Truth
from sim.truth.scene_file import FrictionVariation, Scene
from sim.worlds.drake.drake_world import DrakeWorld
from tests.lone_objects import with_only

pytestmark = pytest.mark.slow

GRAVITY = 9.81
NAME = "ice tea box"
PER_TRIAL = 0.2
SEED = 7  # draws 12 % more and then 16 % less friction, which the planned force still moves


@dataclass(frozen=True)
class Pushed:
    """A push and the truth of the pushed object before and after it."""

    trace: Trace
    before: Truth
    after: Truth
    world: DrakeWorld


def _scene(variation: FrictionVariation, shift_m: float) -> Scene:
    kitchen = with_only(load_scene("kitchen"), NAME, "coffee box")
    box = kitchen.object(NAME)
    truth = box.truth.model_copy(update={"contents_shift_m": shift_m})
    return kitchen.model_copy(
        update={
            "table": kitchen.table.model_copy(update={"friction_variation": variation}),
            "objects": (box.model_copy(update={"truth": truth}), *kitchen.objects[1:]),
        }
    )


def _pushed(controller: Controller) -> Pushed:
    before = simulation(controller.executor).world.truth_now(NAME)
    command = controller.resolve(controller.parse(f"push the {NAME} away 6 cm"))
    plan = controller.plan(command.frames[0])
    assert isinstance(plan, Plan)
    trace = controller.execute(plan)
    return Pushed(
        trace,
        before,
        simulation(controller.executor).world.truth_now(NAME),
        simulation(controller.executor).world,
    )


@pytest.fixture(scope="module")
def trials() -> list[Pushed]:
    """Two pushes after each other on an even table, friction and contents drawn for each."""
    controller = Controller(_scene(FrictionVariation(per_trial=PER_TRIAL), 0.004), seed=SEED)
    return [_pushed(controller) for _ in range(2)]


def test_each_push_is_one_trial(trials: list[Pushed]) -> None:
    own = trials[0].before
    log_sd = np.sqrt(np.log1p(PER_TRIAL**2))
    drawn = source(SEED, RandomStream.TRIAL_FRICTION).standard_normal(2)
    expected = own.friction_table * np.exp(log_sd * drawn - log_sd**2 / 2.0)
    found = [trial.after.friction_table for trial in trials]
    # Fingertips that chatter do not draw again; changes below 0.1 % are not carried out.
    np.testing.assert_allclose(found, expected, rtol=1e-3)
    centres = [own.centre_of_mass, *(trial.after.centre_of_mass for trial in trials)]
    assert len(set(centres)) == 3
    # What was not touched stays as it was.
    world = trials[-1].world
    assert world.truth_now("coffee box") == world.scene.object("coffee box").truth


def test_the_fingers_feel_the_friction_of_the_trial(trials: list[Pushed]) -> None:
    for trial in trials:
        trace, push = trial.trace, trial.trace.push_force()
        moving = np.flatnonzero(trace.phase == "push")[-90:-30]  # before it slows down
        lift = sum(force[moving, 2] for force in trace.felt.values()).mean()
        friction = trial.after.friction_table * (trial.after.mass_kg * GRAVITY - lift)
        # As in a world that is ideal: joints that flex and where the sphere touches.
        assert push[moving].mean() == pytest.approx(friction, rel=0.04)


def test_a_seed_gives_one_trace_bit_for_bit() -> None:
    scene = _scene(FrictionVariation(over_table=0.18, per_trial=0.1), 0.004)
    one, same = (_pushed(Controller(scene, seed=4)) for _ in range(2))
    np.testing.assert_array_equal(one.trace.poses[NAME], same.trace.poses[NAME])
    np.testing.assert_array_equal(one.trace.push_force(), same.trace.push_force())
    assert one.trace.tips.keys() == same.trace.tips.keys()
    for finger, tips in one.trace.tips.items():
        np.testing.assert_array_equal(tips, same.trace.tips[finger])
    assert one.after == same.after
    assert one.after != one.before


def test_changes_too_small_to_notice_change_nothing() -> None:
    """With the machinery running, and without it: the same bits."""
    plain = _pushed(Controller(_scene(FrictionVariation(), 0.0), seed=4))
    tiny = _pushed(Controller(_scene(FrictionVariation(over_table=1e-6), 1e-300), seed=4))
    np.testing.assert_array_equal(plain.trace.poses[NAME], tiny.trace.poses[NAME])
    np.testing.assert_array_equal(plain.trace.push_force(), tiny.trace.push_force())
