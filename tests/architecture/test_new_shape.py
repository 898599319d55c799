"""The recipe of CONTRIBUTING, followed to the letter: a new shape touches two files.

The edits are made in a copy of the packages. An object of the new shape is then read from a file,
checked, pushed by a plan, true in a scene, drawn, and written for other simulators.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.architecture.product import copy_edited

ROOT = Path(__file__).parents[2]

A, B, HEIGHT, MASS, FRICTION = 0.05, 0.03, 0.12, 0.6, 0.35

SHAPE = '''class EllipticCylinder(ShapeKeys):
    """An upright cylinder over an ellipse.

    Attributes:
        semi_axes: of the ellipse along x and y of B [m].
        height: of the cylinder [m].
    """

    semi_axes: Annotated[
        tuple[Length, Length], BeforeValidator(as_tuples), Field(alias="semi_axes_m")
    ]
    height: Annotated[Length, Field(alias="height_m")]

    @cached_property
    def footprint(self) -> Polygon:
        """Points of the rim."""
        turns = 2.0 * np.pi * np.arange(48) / 48
        return Polygon(np.column_stack((np.cos(turns), np.sin(turns))) * self.semi_axes)

    @property
    def outline(self) -> Array:
        """A polygon around the side."""
        return self.footprint.vertices / np.cos(np.pi / len(self.footprint.vertices))

    @property
    def top(self) -> float:
        """Its height."""
        return self.height

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Of the solid cylinder."""
        (a, b), h = self.semi_axes, self.height
        z2 = h**2 / 12.0
        return (b**2 / 4.0 + z2, a**2 / 4.0 + z2, (a**2 + b**2) / 4.0)

    @property
    def silhouette(self) -> Places:
        """Points of the rim."""
        return _thinned(_places(self.footprint.vertices))

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Strips of the side that look against each heading, as curved as it is there."""
        a, b = self.semi_axes
        found = []
        for heading in np.atleast_1d(AXES if headings is None else np.asarray(headings, float)):
            n = -np.array([np.cos(heading), np.sin(heading)])
            middle = np.array([a * a, b * b]) * n / np.hypot(a * n[0], b * n[1])
            t = np.arctan2(middle[1] / b, middle[0] / a)
            bend = a * b / ((a * np.sin(t)) ** 2 + (b * np.cos(t)) ** 2) ** 1.5
            found.append(Face.upright(n, middle, min(a, b), self.height, float(bend)))
        return tuple(found)


SHAPES: tuple[type[ShapeKeys], ...] = (EllipticCylinder, '''

KIND = '''class EllipticCylinderModel(EllipticCylinder, ObjectModel):
    """An upright cylinder over an ellipse."""

    kind: Literal["elliptic_cylinder"] = "elliptic_cylinder"


KINDS: Mapping[str, type[ObjectModel]] = {
    "elliptic_cylinder": EllipticCylinderModel,
'''

EDITS = [
    (
        "objectmodels/models/shapes.py",
        "SHAPES: tuple[type[ShapeKeys], ...] = (",
        SHAPE,
    ),
    (
        "objectmodels/models/kinds.py",
        "shapes import Box, Cylinder,",
        "shapes import Box, Cylinder, EllipticCylinder,",
    ),
    (
        "objectmodels/models/kinds.py",
        "KINDS: Mapping[str, type[ObjectModel]] = {\n",
        KIND,
    ),
]

MODEL = f"""\
format: elliptic_cylinder/1
name: soap bottle
semi_axes_m: [{A}, {B}]
height_m: {HEIGHT}
mass_kg: {MASS}
friction_table: {FRICTION}
friction_finger: 0.6
support: corners
provenance: {{source: a test}}
"""
SCENE = f"""\
version: 1
name: washstand
models: [bottle.yaml]
robot:
  home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]
objects:
  - name: soap bottle
    model: soap bottle
    pose: {{x_m: 0.45, y_m: 0.0}}
    truth: {{semi_axes_m: [{A}, {B}], height_m: {HEIGHT}, mass_kg: 0.7, friction_table: 0.3,
            friction_finger: 0.6}}
"""

USED = """
import json
import sys

from objectmodels import Registry
from objectmodels.descriptions.description_reading import description_texts
from sim.truth.object_truth import whole_truth
from sim.truth.scene_file import Scene, load_scene
from sim.views.trace_scene import TraceScene
from sim.views.viewer_recording import believed_scene, viewer_scene

scene = load_scene("table.yaml")
registry = Registry.default()
registry.load("bottle.yaml")
model, truth = registry.get("soap bottle"), scene.object("soap bottle").truth
stage = TraceScene(scene, lambda builder, plant: None).model
body = stage.bodies["soap bottle"]
shown = viewer_scene(scene, stage)
believed = believed_scene("mine", {"soap bottle": model})
written = json.loads(json.dumps(scene.model_dump(mode="json", exclude={"defaults", "models"})))
json.dump({
    "model": type(model.bare_shape()).__name__,
    "truth": type(truth.shape).__name__,
    "as believed": whole_truth(model).shape == truth.shape,
    "again": Scene.model_validate_json(json.dumps(written)).objects == scene.objects,
    "document": written["objects"][0]["truth"],
    "mass": body.default_mass(),
    "moments": (body.default_mass() * body.default_unit_inertia().get_moments()).tolist(),
    "feet": stage.feet["soap bottle"].p_B.tolist(),
    "shown": shown,
    "believed": believed,
    "files": {form: description_texts(model, form) for form in ("mjcf", "sdf", "urdf")},
}, sys.stdout)
"""

CHECKED = """
import json
import sys
from pathlib import Path

from objectmodels.registry.model_checks import model_faults
from objectmodels.registry.model_registry import load_model

faults = model_faults(load_model(Path("bottle.yaml")))
json.dump({check: fault and str(fault) for check, fault in faults.items()}, sys.stdout)
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages with the new shape, an object of it, and a table on which it stands."""
    folder = tmp_path_factory.mktemp("recipe")
    copy_edited(folder, EDITS)
    (folder / "bottle.yaml").write_text(MODEL, encoding="utf-8")
    (folder / "table.yaml").write_text(SCENE, encoding="utf-8")
    return folder


def run(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def used(copy: Path) -> dict[str, Any]:
    """What the rest of the product makes of the shape."""
    made: dict[str, Any] = json.loads(run(copy, "-c", USED))
    return made


def test_recipe_names_these_two_files() -> None:
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = recipe.partition("## A new shape")[2].partition("##")[0]
    files = {name for name, _, _ in EDITS}
    assert len(files) == 2
    assert all(f"`{name}`" in recipe for name in files)


def test_model_of_the_new_shape_passes_all_checks(copy: Path) -> None:
    offer = "objectmodels.registry.model_registry:load_model"
    checked = run(
        copy,
        "-c",
        f"""
from pathlib import Path
from objectmodels.registry.model_checks import CHECKS
from {offer.replace(":", " import ")}
model = load_model(Path("bottle.yaml"))
for check in CHECKS.values():
    check(model)
print(len(CHECKS))
""",
    )
    assert int(checked) >= 8


def test_object_of_the_new_shape_is_pushed_by_a_plan(copy: Path) -> None:
    answer = json.loads(
        run(
            copy, "-m", "nlcontrol", "plan", "--json", "--scene", "table.yaml",
            "push the soap bottle 5 cm away",
        )
    )  # fmt: skip
    assert answer["ok"]
    (push,) = answer["plan"]["actions"]
    # It slides at μ m g and topples over the end of an axis of the ellipse, pushed in the middle.
    assert push["prediction"]["slide_force"] == pytest.approx(FRICTION * MASS * 9.81, rel=1e-3)
    assert push["prediction"]["probability"] > 0.99


def test_belief_and_truth_have_the_shape_and_keep_it_in_documents(used: dict[str, Any]) -> None:
    assert (used["model"], used["truth"]) == ("EllipticCylinder", "EllipticCylinder")
    assert used["as believed"]
    assert used["again"]
    assert used["document"]["semi_axes_m"] == [A, B]
    assert used["document"]["size_m"] is None


def test_world_has_a_body_of_the_new_shape(used: dict[str, Any]) -> None:
    mass, (x, y, z) = 0.7, used["moments"]
    assert used["mass"] == mass
    # About B's origin, half the height below its middle. The 48 sides enclose 0.3 % more than the
    # ellipse, and so the moments are off by less than 1 %.
    tall = HEIGHT**2 / 12 + HEIGHT**2 / 4
    assert x == pytest.approx(mass * (B**2 / 4 + tall), rel=0.01)
    assert y == pytest.approx(mass * (A**2 / 4 + tall), rel=0.01)
    assert z == pytest.approx(mass * (A**2 + B**2) / 4, rel=0.01)
    feet = np.array(used["feet"])
    # Feet are drawn in by a tenth of a millimetre.
    assert np.abs(feet).max(axis=0) == pytest.approx([A, B, HEIGHT], abs=2e-4)


def test_pictures_show_it_as_it_is_and_as_it_is_believed(used: dict[str, Any]) -> None:
    for document in (used["shown"], used["believed"]):
        (body,) = [body for body in document["bodies"] if body["object"] == "soap bottle"]
        (solid,) = [shape for shape in body["shapes"] if shape["name"] == "solid"]
        assert solid["kind"] == "mesh"
        corners = np.reshape(solid["corners"], (-1, 3))
        # The outline lies around the ellipse, by 1 / cos(π / 48).
        assert np.ptp(corners, axis=0) == pytest.approx([2 * A, 2 * B, HEIGHT], rel=3e-3)


def test_other_simulators_get_its_mesh(used: dict[str, Any]) -> None:
    for form in ("sdf", "urdf"):
        assert any(name.endswith(".obj") for name in used["files"][form])
    assert "<mesh" in "".join(used["files"]["mjcf"].values())


@pytest.mark.slow
def test_object_of_the_new_shape_is_pushed_in_the_world(copy: Path) -> None:
    answer = json.loads(
        run(
            copy, "-m", "nlcontrol", "say", "--json", "--scene", "table.yaml",
            "push the soap bottle 5 cm away",
        )
    )  # fmt: skip
    assert answer["ok"]
