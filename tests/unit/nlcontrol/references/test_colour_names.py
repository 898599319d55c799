"""Names of colours, against what people called them and against the built-in scenes."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import XKCD_COLORS, to_rgb

from nlcontrol.references.object_names import SHADES, colour_names
from sim import load_scene
from sim.worlds.camera import initial_frames


def test_the_shades_are_the_survey_s() -> None:
    for name, shades in SHADES.items():
        called = {value[1:]: key for key, value in XKCD_COLORS.items() if key.endswith(name)}
        assert set(shades) <= set(called), name


def test_most_colours_bear_the_name_that_people_gave_them() -> None:
    """All two-word names of the survey whose second word is a basic name, "tomato red"."""
    given = {key: key.removeprefix("xkcd:").split() for key in XKCD_COLORS}
    asked = {k: w[1] for k, w in given.items() if len(w) == 2 and w[1] in SHADES}
    right = [name in colour_names(to_rgb(XKCD_COLORS[key])) for key, name in asked.items()]
    assert len(right) > 300
    # People do not agree either: the survey's "mustard brown" is nearer to orange.
    assert np.mean(right) > 0.85


@pytest.mark.parametrize("name", sorted(SHADES))
def test_a_name_s_own_shades_bear_it(name: str) -> None:
    for shade in SHADES[name]:
        assert colour_names(to_rgb(f"#{shade}"))[0] == name


@pytest.mark.parametrize(
    ("colour", "names"),
    [
        ((1.0, 0.0, 0.0), ("red",)),
        ((0.0, 0.0, 1.0), ("blue",)),
        ((0.0, 1.0, 0.0), ("green",)),
        ((1.0, 1.0, 1.0), ("white",)),
        ((0.0, 0.0, 0.0), ("black",)),
        ((0.5, 0.5, 0.5), ("grey",)),
        ((0.95, 0.95, 0.95), ("white", "grey")),
    ],
)
def test_plain_colours_and_a_tie(colour: tuple[float, ...], names: tuple[str, ...]) -> None:
    assert colour_names(colour) == names


def test_the_built_in_scenes() -> None:
    seen = {
        (scene, name): colour_names(colour)
        for scene in ("kitchen", "counter")
        for name, colour in initial_frames(load_scene(scene), 0.1, seed=0)[-1].colours.items()
    }
    assert seen == {
        ("kitchen", "ice tea box"): ("yellow",),
        ("kitchen", "cereal box"): ("red",),
        ("kitchen", "coffee box"): ("brown",),
        ("kitchen", "ice tea"): ("orange",),
        ("kitchen", "ice tea cup"): ("blue",),
        ("kitchen", "mug"): ("grey",),
        ("counter", "soup can"): ("red",),
        ("counter", "mug"): ("blue",),
        ("counter", "tea tin"): ("green",),
    }
