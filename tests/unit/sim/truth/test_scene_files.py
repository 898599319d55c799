"""Scene files: what is read, and what is refused with the key at fault."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from planner.types.defaults import DEFAULTS
from sim import SceneError, load_scene
from sim.truth.scene_file import built_in_scenes, parse_scene

SCENE = """
version: 1
name: small
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: crate
    model: ice tea box
    pose: {x_m: 0.5, y_m: 0.0}
    truth: {size_m: [0.1, 0.1, 0.2], mass_kg: 1.0, friction_table: 0.4, friction_finger: 0.7}
"""


def test_what_is_left_out_has_a_default() -> None:
    scene = parse_scene(SCENE)
    truth = scene.object("crate").truth
    assert truth.centre_of_mass == (0.0, 0.0, 0.1)
    assert len(truth.support) == 4
    assert scene.names == ("crate",)


def test_built_in_scenes_load() -> None:
    assert "kitchen" in built_in_scenes()
    for name in built_in_scenes():
        assert load_scene(name).objects


def test_truth_of_the_default_scene_differs_from_every_belief() -> None:
    from objectmodels import Registry

    registry = Registry.default()
    for item in load_scene("kitchen").objects:
        believed = registry.get(item.model)
        assert item.truth.mass_kg != believed.mass
        assert item.truth.friction_table != believed.friction


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("mass_kg: 1.0", "mass_kg: -1.0", "mass_kg"),
        ("mass_kg: 1.0", "mass_kg: .nan", "mass_kg"),
        ("mass_kg: 1.0", "mass_kg: no", "mass_kg"),
        ("mass_kg: 1.0", "mass_kg: 1:30", "mass_kg"),
        ("mass_kg: 1.0", "mass_kg: 1.0, weight: 3.0", "weight"),
        ("friction_table: 0.4, ", "", "friction_table"),
        ("size_m: [0.1, 0.1, 0.2]", "size_m: [0.1, 0.1]", "size_m"),
        ("version: 1", "version: 2", "version"),
        ("name: small", "", "name"),
        ("truth: {", "truth: {centre_of_mass_m: [0.2, 0.0, 0.1], ", "centre_of_mass_m"),
        ("truth: {", "truth: {support_m: [[0.1, 0.0], [0.0, 0.1]], ", "support_m"),
    ],
)
def test_a_fault_names_its_key(old: str, new: str, key: str) -> None:
    with pytest.raises(SceneError) as raised:
        parse_scene(SCENE.replace(old, new), source="my.yaml")
    assert raised.value.code == "bad_scene"
    assert "my.yaml" in raised.value.message
    assert key in raised.value.message


def test_a_misspelt_key_of_a_shape_gets_a_suggestion() -> None:
    for key in ("size_m", "radius_m", "vertices_m"):
        wrong = SCENE.replace("size_m: [0.1, 0.1, 0.2]", f"{key[:-3]}_m: [0.1, 0.1, 0.2]")
        with pytest.raises(SceneError) as raised:
            parse_scene(wrong)
        assert f"{key[:-3]}_m" in raised.value.message
        assert f"did you mean '{key}'?" in raised.value.suggestions


def test_numbers_with_an_exponent_are_numbers() -> None:
    scene = parse_scene(SCENE.replace("mass_kg: 1.0", "mass_kg: 1e0"))
    assert scene.object("crate").truth.mass_kg == 1.0


def test_two_objects_of_one_name() -> None:
    twice = SCENE + SCENE[SCENE.index("  - name") :].replace("crate", "Crate")
    with pytest.raises(SceneError, match="unique"):
        parse_scene(twice)


POST = """  - name: post
    model: coffee box
    pose: {x_m: X, y_m: 0.02, z_m: Z}
    truth: {size_m: [0.09, 0.09, 0.2], mass_kg: 1.0, friction_table: 0.35, friction_finger: 0.6}
"""


def with_post(x: float, z: float = 0.0) -> str:
    return SCENE + POST.replace("X", str(x)).replace("Z", str(z))


@pytest.mark.parametrize(
    ("x", "z", "depth"),
    [(0.53, 0.0, 65), (0.5, 0.0, 75), (0.5, 0.17, 30), (0.594, 0.0, 1)],
)
def test_what_stands_in_each_other_is_refused_with_the_depth(
    x: float, z: float, depth: int
) -> None:
    with pytest.raises(SceneError, match=rf"crate and the post stand {depth} mm in each other"):
        parse_scene(with_post(x, z))


@pytest.mark.parametrize(("x", "z"), [(0.595, 0.0), (0.5945, 0.0), (0.5, 0.2), (0.7, 0.0)])
def test_what_touches_or_stands_on_another_is_taken(x: float, z: float) -> None:
    """Up to a millimetre, to which people measure, things touch."""
    assert parse_scene(with_post(x, z)).names == ("crate", "post")


def test_what_stands_in_an_open_box_is_taken_but_not_in_its_wall() -> None:
    size = "size_m: [0.1, 0.1, 0.2]"
    box = SCENE.replace(
        size, "size_m: [0.3, 0.3, 0.1], inside: {size_m: [0.28, 0.28], floor_m: 0.01}"
    )
    inside = box + POST.replace("X", "0.55").replace("Z", "0.01")
    assert parse_scene(inside).names == ("crate", "post")
    for wrong in (inside.replace("0.55", "0.61"), inside.replace("z_m: 0.01", "z_m: 0.0")):
        with pytest.raises(SceneError, match="in each other"):
            parse_scene(wrong)


@pytest.mark.parametrize("text", ["", "- 1\n- 2", "{", "objects: 3", "\x00"])
def test_no_scene_at_all(text: str) -> None:
    with pytest.raises(SceneError):
        parse_scene(text)


def test_unknown_names_get_a_suggestion(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as raised:
        load_scene("kichen")
    assert raised.value.code == "unknown_scene"
    assert "kitchen" in " ".join(raised.value.suggestions)
    with pytest.raises(SceneError, match=r"missing\.yaml"):
        load_scene(tmp_path / "missing.yaml")


def test_a_file_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(SCENE, encoding="utf-8")
    assert load_scene(path) == parse_scene(SCENE)


def test_what_words_mean_at_a_table() -> None:
    scene = parse_scene(SCENE + "defaults: {distance_m: 0.2, turn_deg: 45}\n")
    assert (scene.defaults.distance, scene.defaults.turn) == (0.2, math.radians(45))
    assert parse_scene(SCENE).defaults == DEFAULTS
    assert hash(scene) != hash(parse_scene(SCENE))


@pytest.mark.parametrize(
    ("text", "message", "suggestion"),
    [
        ("{distanc_m: 0.2}", "there is no default 'distanc_m'", "did you mean 'distance_m'?"),
        ("{turn: 45}", "there is no default 'turn'", "did you mean 'turn_deg'?"),
        ("{turn_deg: 400}", "at most 360, found 400", None),
        ("{turn_deg: no}", "must be a number", None),
        ("[0.2]", "defaults are names and numbers", None),
    ],
)
def test_a_default_that_is_none_is_named(text: str, message: str, suggestion: str | None) -> None:
    with pytest.raises(SceneError) as raised:
        parse_scene(SCENE + f"defaults: {text}\n")
    assert raised.value.code == "bad_scene"
    assert message in raised.value.message
    if suggestion:
        assert suggestion in raised.value.suggestions


def test_what_has_fallen_lies_on_the_table() -> None:
    fallen = SCENE.replace("y_m: 0.0}", "y_m: 0.0, yaw_deg: 30.0, roll_deg: 90.0}")
    item = parse_scene(fallen).object("crate")
    corners = item.truth.shape.hull_corners @ item.pose.R_WB.T + item.p_WB
    # On its side it is as high as it is deep.
    assert corners[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert corners[:, 2].max() == pytest.approx(0.1, abs=1e-12)
    upright = parse_scene(SCENE).object("crate")
    assert upright.p_WB.tolist() == [0.5, 0.0, 0.0]
