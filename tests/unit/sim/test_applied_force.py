"""Pushes by a force alone: they meet the exact tier of the true parameters."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from sim import appliedforce, load_scene
from sim.scene import Scene
from sim.touches import Contact, TouchResult, Vector

SCENE = load_scene("kitchen")
ICE_TEA, CEREAL = "ice tea box", "cereal box"


def true_model(name: str, scene: Scene = SCENE) -> BoxModel:
    truth = scene.object(name).truth
    assert truth.size_m is not None
    return BoxModel(
        name=name, size=truth.size_m, mass=truth.mass_kg, friction=truth.friction_table,
        com=truth.centre_of_mass, support="corners",
    )  # fmt: skip


def touched(name: str, point: Vector, direction: Vector, scene: Scene = SCENE) -> TouchResult:
    u = np.array(direction) / np.linalg.norm(direction)
    contact = Contact(name, "front", point, (-1.0, 0.0, 0.0), tuple(u.tolist()))
    return appliedforce.touch(scene, contact, seed=0)


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
    appliedforce._world.cache_clear()
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
