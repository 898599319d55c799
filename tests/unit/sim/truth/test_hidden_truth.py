"""Hidden truth: drawn from the seed, within its bounds, the same every time."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels.models.shapes import Box
from sim import load_scene
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Hidden, Scene, sample_world
from sim.worlds.drake.drake_world import DrakeWorld

SPREAD = Hidden(mass=0.10, friction=0.15, finger_friction=0.05, centre_of_mass_m=0.002)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("kitchen").model_copy(update={"hidden": SPREAD})


def test_what_hides_nothing_stays_as_it_is() -> None:
    kitchen = load_scene("kitchen")
    assert sample_world(kitchen, 3) is kitchen


def test_spreads_are_those_of_the_file(scene: Scene) -> None:
    written = scene.object("coffee box").truth
    truths = [sample_world(scene, seed).object("coffee box").truth for seed in range(1000)]
    for field, spread in (
        ("mass_kg", 0.10),
        ("friction_table", 0.15),
        ("friction_finger", 0.05),
    ):
        ratio = np.array([getattr(t, field) / getattr(written, field) for t in truths]) - 1.0
        assert np.abs(ratio).max() <= 2.0 * spread + 1e-12
        # Clipping at two deviations leaves 0.96 of one; known to 2.2 %, and four of those.
        assert ratio.std() == pytest.approx(0.96 * spread, rel=0.09)
        assert abs(ratio.mean()) < 4.0 * spread / np.sqrt(1000)
    centres = np.array([t.centre_of_mass for t in truths]) - written.centre_of_mass
    np.testing.assert_allclose(centres.std(axis=0), 0.96 * 0.002, rtol=0.09)


def test_a_seed_gives_one_truth_and_another_seed_another(scene: Scene) -> None:
    assert sample_world(scene, 5) == sample_world(scene, 5)
    assert sample_world(scene, 5) != sample_world(scene, 6)
    # What is drawn hides nothing any more.
    assert sample_world(sample_world(scene, 5), 5) == sample_world(scene, 5)


def test_one_spread_leaves_the_others_alone(scene: Scene) -> None:
    alone = scene.model_copy(update={"hidden": Hidden(friction=0.15)})
    for name in scene.names:
        one, all_ = (sample_world(s, 2).object(name).truth for s in (alone, scene))
        assert one.friction_table == all_.friction_table
        assert one.mass_kg == scene.object(name).truth.mass_kg


def test_the_world_is_as_drawn(scene: Scene) -> None:
    world = DrakeWorld(scene, seed=7)
    assert world.scene == sample_world(scene, 7)
    assert world.truth_now("coffee box") == world.scene.object("coffee box").truth


def test_nothing_is_shifted_so_far_that_it_falls() -> None:
    post = Truth(
        shape=Box(size=(0.02, 0.02, 0.3)), mass_kg=1.0, friction_table=0.3, friction_finger=0.5
    )
    assert post.with_shift([0.004, 0.0, 0.0]).centre_of_mass == (0.004, 0.0, 0.15)
    assert post.with_shift([0.016, 0.0, 0.0]).centre_of_mass == (0.008, 0.0, 0.15)
    assert post.with_shift([0.05, 0.0, 0.0]) == post
    tripod = post.model_copy(update={"support_m": ((0.01, 0.0), (-0.005, 0.008), (-0.005, -0.008))})
    # Half of it would still lie beyond the two feet on that side.
    assert tripod.with_shift([-0.012, 0.0, 0.0]).centre_of_mass == (-0.003, 0.0, 0.15)
