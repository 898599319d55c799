"""The guide to scene files: its example is good, its Python runs, every key is explained."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

from pydantic import BaseModel

from objectmodels.models.shapes import SHAPES
from sim.robots.cell_description import JointSensor, Vision
from sim.truth.object_truth import Truth
from sim.truth.scene_file import (
    FrictionVariation,
    Hidden,
    Pose,
    ScaledTorqueSensor,
    Scene,
    SceneObject,
    VaryingTable,
    built_in_scenes,
    load_scene,
    parse_scene,
)
from sim.worlds.drake.drake_world import DrakeWorld
from tests.docs.guide_blocks import only_block
from tests.fakes.robots import poses_in

GUIDE = (Path(__file__).parents[2] / "docs" / "scenes.md").read_text(encoding="utf-8")


def test_the_example_is_a_scene_in_which_things_stand() -> None:
    scene = parse_scene(only_block(GUIDE, "yaml"))
    assert scene.torque_sensor.bias_nm == 0.02
    assert scene.table.friction_variation.over_table == 0.18
    seen = poses_in(DrakeWorld(scene, seed=1), 0.5)["ice tea box"]
    # The mean of fifteen frames with 2 mm of noise, and a bias of 1 mm: four deviations.
    assert abs(seen.x - 0.45) < 0.0045


def test_the_python_of_the_guide() -> None:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python"), "scenes.md", "exec"), {})
    lines = out.getvalue().split("\n")
    for line, name in zip(lines, ("ice tea box", "tea tin"), strict=False):
        written, true = map(float, line.removeprefix(name).split())
        assert written == load_scene("workbench").object(name).truth.mass_kg
        assert 0.0 < abs(true / written - 1.0) <= 0.2 + 1e-3


def test_every_key_of_the_format_is_explained() -> None:
    parts: tuple[type[BaseModel], ...] = (
        Scene,
        SceneObject,
        Pose,
        Truth,
        VaryingTable,
        FrictionVariation,
        Vision,
        ScaledTorqueSensor,
        JointSensor,
        Hidden,
    )
    wanted = {key for part in parts for key in part.model_fields} - {"shape"}
    wanted |= {key for shape in SHAPES for key in shape.file_keys()}  # which stand in its place
    assert {key for key in wanted if not re.search(rf"\b{key}\b", GUIDE)} == set()


def test_defaults_in_the_tables_are_those_of_the_code() -> None:
    told = {
        (part, key): [float(value) for value in values.split(", ")]
        for part, key, values in re.findall(
            r"^\| `(torque_sensor|joint_sensor|vision)\.(\w+)`.*? \| ([-\d., e]+) \|", GUIDE, re.M
        )
    }
    assert len(told) == 11
    classes: dict[str, type[BaseModel]] = {
        "torque_sensor": ScaledTorqueSensor,
        "joint_sensor": JointSensor,
        "vision": Vision,
    }
    for (part, key), values in told.items():
        assert classes[part].model_fields[key].default == values[0]


def test_every_built_in_scene_is_named() -> None:
    assert all(f"`{name}`" in GUIDE for name in built_in_scenes())


def test_the_kitchen_is_described_as_it_is() -> None:
    assert "`kitchen` (three boxes, a carton, a mug and a cup)" in GUIDE
    names = [item.name for item in load_scene("kitchen").objects]
    assert (len(names), sum(name.endswith(" box") for name in names)) == (6, 3)
