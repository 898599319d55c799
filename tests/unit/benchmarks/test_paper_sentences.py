"""Worlds in which the paper's sentences are said."""

import pytest

from benchmarks.goals.hard_worlds import VISION, WIDE
from benchmarks.goals.worlds import believed
from benchmarks.paper_sentences import world


@pytest.mark.parametrize("seed", [0, 17])
def test_truths_are_others_within_their_bounds(seed: int) -> None:
    scene, registry = world(seed), believed(wide=True)
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
    assert world(seed) == scene
    assert world(seed + 1) != scene
