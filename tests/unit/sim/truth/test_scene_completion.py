"""Scene files that extend others, or leave it to the model how an object really is."""

from __future__ import annotations

from pathlib import Path

import pytest

from objectmodels import Registry
from sim.errors import SceneError
from sim.truth.object_truth import whole_truth
from sim.truth.scene_file import load_scene, parse_scene

CRATE = """
format: box/1
name: crate
size_m: [0.1, 0.1, 0.16]
mass_kg: 0.8
friction_table: 0.4
friction_finger: 0.65
provenance: {source: guessed}
"""
HEAD = "version: 1\nname: mine\n"


def write(folder: Path, name: str, text: str) -> Path:
    (folder / name).write_text(text, "utf-8")
    return folder / name


def test_a_truth_that_is_left_out_is_what_the_model_says(tmp_path: Path) -> None:
    write(tmp_path, "crate.yaml", CRATE)
    objects = (
        "models: [crate.yaml]\nobjects:\n"
        "  - {name: box of mine, model: crate, pose: {x_m: 0.4, y_m: 0.1}}\n"
        "  - {name: jar, model: jar, pose: {x_m: 0.5, y_m: 0.4}}\n"
    )
    scene = load_scene(write(tmp_path, "table.yaml", HEAD + objects))
    truth = scene.object("box of mine").truth
    assert (truth.shape.extents, truth.mass_kg, truth.friction_table) == (
        (0.1, 0.1, 0.16),
        0.8,
        0.4,
    )
    assert scene.object("jar").truth == whole_truth(Registry.built_in().get("jar"))
    assert scene.object("jar").truth.lid is not None
    assert scene.robot == load_scene("kitchen").robot


def test_a_scene_extends_another_key_by_key(tmp_path: Path) -> None:
    kitchen = load_scene("kitchen")
    own = (
        "extends: kitchen\nvision: {position_noise_m: 0.005}\ndefaults: {distance_m: 0.07}\n"
        "objects:\n"
        "  - {name: mug, pose: {x_m: 0.3, y_m: -0.45}}\n"
        "  - {name: cereal box, model: tea tin, pose: {x_m: 0.6, y_m: 0.33}}\n"
        "  - {name: jar, model: jar, pose: {x_m: 0.5, y_m: 0.6}}\n"
    )
    scene = parse_scene(HEAD + own)
    assert scene.name == "mine"
    assert scene.names == (*kitchen.names, "jar")
    assert scene.object("ice tea box") == kitchen.object("ice tea box")
    assert scene.object("mug").truth == kitchen.object("mug").truth
    assert scene.object("mug").pose.x_m == 0.3
    # Another model is another thing: nothing of the old one's truth is left.
    assert scene.object("cereal box").truth.shape.top == Registry.built_in().get("tea tin").top
    assert scene.vision == kitchen.vision.model_copy(update={"position_noise_m": 0.005})
    assert scene.defaults.distance == 0.07


def test_what_is_extended_is_found_beside_the_file_with_its_models(tmp_path: Path) -> None:
    (tmp_path / "base").mkdir()
    write(tmp_path / "base", "crate.yaml", CRATE)
    standing = "objects: [{name: crate, model: crate, pose: {x_m: 0.4, y_m: 0.1}}]\n"
    write(
        tmp_path / "base",
        "below.yaml",
        HEAD + "extends: kitchen\nmodels: [crate.yaml]\n" + standing,
    )
    scene = load_scene(write(tmp_path, "table.yaml", HEAD + "extends: base/below.yaml\n"))
    assert scene.names == (*load_scene("kitchen").names, "crate")
    assert scene.models == (str(tmp_path / "base" / "crate.yaml"),)


@pytest.mark.parametrize(
    ("text", "code", "named"),
    [
        ("extends: kichen\n", "unknown_scene", "kichen"),
        ("extends: other.yaml\n", "unknown_scene", "other.yaml"),
        ("extends: 3\n", "bad_scene", "extends"),
        ("extends: table.yaml\n", "bad_scene", "extends"),
        ("extends: kitchen\nobjects: 3\n", "bad_scene", "objects"),
        ("extends: kitchen\nobjects: [{name: piano, pose: {x_m: 0.3, y_m: 0.1}}]\n", "bad_scene",
         "model"),
        ("objects: [{name: x, model: piano, pose: {x_m: 0.3, y_m: 0.1}}]\n", "bad_scene", "piano"),
        ("models: [no.yaml]\nobjects: [{name: x, model: mug, pose: {x_m: 0, y_m: 0}}]\n",
         "bad_scene", "no.yaml"),
        ("models: 3\nobjects: [{name: x, model: mug, pose: {x_m: 0, y_m: 0}}]\n", "bad_scene",
         "models"),
    ],
)  # fmt: skip
def test_what_cannot_be_completed_is_named(
    tmp_path: Path, text: str, code: str, named: str
) -> None:
    with pytest.raises(SceneError) as raised:
        load_scene(write(tmp_path, "table.yaml", HEAD + text))
    assert raised.value.code == code
    assert named in raised.value.message
    assert raised.value.suggestions
