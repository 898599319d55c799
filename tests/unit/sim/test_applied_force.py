"""Pushes by a force alone: they meet the exact tier of the true parameters."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from sim import face_experiment as appliedforce
from sim import load_scene
from sim.face_experiment import Contact, TouchResult, Vector
from sim.random_streams import RandomStream, source
from sim.truth.scene_file import FrictionVariation, Hidden, Scene, sample_world
from sim.worlds.drake.single_object import single_object_world
from sim.worlds.drake.world_variation import FrictionField

SCENE = load_scene("kitchen")
ICE_TEA, CEREAL = "ice tea box", "cereal box"


def true_model(name: str, scene: Scene = SCENE) -> BoxModel:
    truth = scene.object(name).truth
    return BoxModel(
        name=name, size=truth.shape.extents, mass=truth.mass_kg, friction=truth.friction_table,
        com=truth.centre_of_mass, support="corners",
    )  # fmt: skip


def touched(
    name: str, point: Vector, direction: Vector, scene: Scene = SCENE, seed: int = 0
) -> TouchResult:
    u = np.array(direction) / np.linalg.norm(direction)
    contact = Contact(name, "front", point, (-1.0, 0.0, 0.0), tuple(u.tolist()))
    return appliedforce.touch(scene, contact, seed=seed)


@pytest.mark.parametrize(
    ("name", "point", "direction"),
    [
        (ICE_TEA, (-0.045, 0.0, 0.02), (1.0, 0.0, 0.0)),
        (ICE_TEA, (-0.045, 0.0, 0.22), (1.0, 0.0, 0.0)),
        (ICE_TEA, (-0.045, 0.04, 0.06), (1.0, 0.0, 0.0)),
        (ICE_TEA, (-0.045, -0.02, 0.06), (1.0, 0.3, -0.3)),
        # h* = b/μ = 130.4 mm: 2 % to either side of it.
        (ICE_TEA, (-0.045, 0.0, 0.1279), (1.0, 0.0, 0.0)),
        (ICE_TEA, (-0.045, 0.0, 0.1331), (1.0, 0.0, 0.0)),
        (CEREAL, (-0.026, -0.09, 0.03), (1.0, 0.0, 0.0)),
        (CEREAL, (-0.026, 0.05, 0.20), (1.0, 0.0, 0.2)),
    ],
)
def test_class_and_force_are_those_of_the_exact_tier(
    name: str, point: Vector, direction: Vector
) -> None:
    u = np.array([direction]) / np.linalg.norm(direction)
    t = true_model(name).thresholds(np.array([point]), u, exact=True)
    seen = touched(name, point, direction)
    assert seen.outcome == t.outcome.item()
    # The feet stand 0.1 mm inside of the corners, and creep at the onset moves the line by 0.1 %.
    assert seen.force == pytest.approx(t.onset.item(), rel=0.005)


def test_a_push_that_jams_moves_nothing() -> None:
    # Steeper than the friction angle: it presses harder than it pushes.
    assert touched(ICE_TEA, (-0.02, 0.0, 0.23), (0.3, 0.0, -1.0)) == TouchResult("none", None)


def test_the_answer_depends_on_nothing_that_went_before() -> None:
    point, ahead = (-0.045, 0.03, 0.1), (1.0, 0.0, 0.0)
    first = touched(ICE_TEA, point, ahead)
    touched(ICE_TEA, (-0.045, 0.0, 0.22), ahead)
    assert touched(ICE_TEA, point, ahead) == first
    single_object_world.cache_clear()
    assert touched(ICE_TEA, point, ahead) == first


def test_the_direction_is_that_of_the_object_however_it_stands() -> None:
    (item,) = [o for o in SCENE.objects if o.name == CEREAL]
    pose = item.pose.model_copy(update={"yaw_deg": 60.0})
    turned = SCENE.model_copy(update={"objects": (item.model_copy(update={"pose": pose}),)})
    push = (CEREAL, (-0.026, 0.05, 0.15), (1.0, 0.0, 0.0))
    before, after = touched(*push), touched(*push, scene=turned)
    assert (before.outcome, after.outcome) == ("topple", "topple")
    # Friction is solved in the world's axes, to some digits only.
    assert after.force == pytest.approx(before.force, rel=1e-4)


def test_a_push_beside_the_object_misses_it() -> None:
    ahead = (1.0, 0.0, 0.0)
    assert touched(ICE_TEA, (-0.045, 0.0, 0.24), ahead).outcome is None
    assert touched(ICE_TEA, (-0.045, 0.05, 0.1), ahead).outcome is None
    missed = touched(ICE_TEA, (-0.05, 0.04, 0.1), (1.0, 20.0, 0.0))
    assert missed == TouchResult(None, None, "it misses the ice tea box")
    # A force acts along its line: a contact believed 5 mm beside the surface is as good.
    on, beside = (touched(ICE_TEA, (x, 0.02, 0.1), ahead) for x in (-0.045, -0.05))
    assert on.force == pytest.approx(beside.force, rel=1e-3)


@pytest.mark.parametrize("seed", [0, 1])
def test_what_the_scene_hides_is_drawn_from_the_seed(seed: int) -> None:
    scene = SCENE.model_copy(update={"hidden": Hidden(mass=0.3, friction=0.3)})
    push = (ICE_TEA, (-0.045, 0.0, 0.05), (1.0, 0.0, 0.0))
    model = true_model(ICE_TEA, sample_world(scene, seed))
    assert abs(model.mass / 1.06 - 1.0) > 0.01
    seen = touched(*push, scene=scene, seed=seed)
    assert seen.force == pytest.approx(model.friction * model.weight, rel=0.005)


def test_friction_is_that_of_the_place_and_the_trial() -> None:
    push = (ICE_TEA, (-0.045, 0.0, 0.05), (1.0, 0.0, 0.0))
    variation = FrictionVariation(per_trial=0.2)
    table = SCENE.table.model_copy(update={"friction_variation": variation})
    scene = SCENE.model_copy(update={"table": table})
    log_sd = np.sqrt(np.log1p(0.2**2))
    draw = source(3, RandomStream.TRIAL_FRICTION).standard_normal()
    even, varied = touched(*push).force, touched(*push, scene=scene, seed=3).force
    assert even is not None
    assert varied == pytest.approx(even * np.exp(log_sd * draw - log_sd**2 / 2.0), rel=1e-3)
    over_table = FrictionVariation(over_table=0.3, length_m=0.5)
    table = SCENE.table.model_copy(update={"friction_variation": over_table})
    scene = SCENE.model_copy(update={"table": table})
    # The field hardly changes under the base, which is 90 mm long: about what it is in the middle.
    there = float(FrictionField(table, 4).at(np.array([0.45, 0.0])))
    assert there < 0.9
    assert touched(*push, scene=scene, seed=4).force == pytest.approx(even * there, rel=0.02)
