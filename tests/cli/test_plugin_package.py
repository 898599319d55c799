"""The two packages of `examples`: a kind of object and words, and sentences said with them.

They are installed with pip into a folder of the test.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.patience import PATIENCE

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"

SCENE = """\
version: 1
name: breakfast
robot:
  home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]
objects:
  - name: milk carton
    model: milk carton
    pose: {x_m: 0.45, y_m: 0.0}
    truth: {size_m: [0.07, 0.07, 0.20], mass_kg: 0.55, friction_table: 0.28, friction_finger: 0.55,
            centre_of_mass_m: [0.0, 0.0, 0.052]}
"""


def block(page: str, language: str) -> str:
    guide = (ROOT / "docs" / page).read_text(encoding="utf-8")
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)
    return str(found)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the packages were installed, one of their files broken."""
    copies, target = tmp_path_factory.mktemp("copies"), tmp_path_factory.mktemp("site")
    for name in ("cartons", "workshop"):
        shutil.copytree(EXAMPLES / name, copies / name)
    broken = copies / "cartons" / "cartons" / "models" / "broken.yaml"
    broken.write_text("format: carton/1\n", encoding="utf-8")
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps"]
    command += ["--no-build-isolation", "--target", str(target)]
    command += [str(copies / "cartons"), str(copies / "workshop")]
    subprocess.run(command, check=True, capture_output=True, timeout=PATIENCE)
    return target


def nlcontrol(site: Path, *args: str) -> subprocess.CompletedProcess[str]:
    paths = [str(site), str(ROOT), os.environ.get("PYTHONPATH", "")]
    return subprocess.run(
        [sys.executable, "-m", "nlcontrol", *args],
        capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)},
    )  # fmt: skip


def test_the_packages_are_those_of_the_guides() -> None:
    kind = block("models.md", "python kind")
    assert len(kind.rstrip().splitlines()) <= 36
    source = (EXAMPLES / "cartons" / "cartons" / "__init__.py").read_text("utf-8")
    assert source.replace("from pathlib import Path\n", "").startswith(kind)
    assert 'MODELS = Path(__file__).parent / "models"' in source
    words = (EXAMPLES / "workshop" / "workshop" / "__init__.py").read_text("utf-8")
    assert words == block("language_reference.md", "python words")
    for package, page in (("cartons", "models.md"), ("workshop", "language_reference.md")):
        told = tomllib.loads(block(page, "toml"))["project"]["entry-points"]
        project = tomllib.loads((EXAMPLES / package / "pyproject.toml").read_text("utf-8"))
        assert project["project"]["entry-points"] == told


def test_its_objects_are_listed_and_its_broken_file_is_skipped(site: Path) -> None:
    told = nlcontrol(site, "objects", "list")
    assert told.returncode == 0, told.stderr
    assert "milk carton" in told.stdout
    assert "plug-in 'milk' of nlcontrol-cartons" in told.stdout
    assert "ice tea box" in told.stdout
    assert "skipped" in told.stderr
    assert "broken.yaml" in told.stderr


def test_its_centre_of_mass_follows_from_its_own_parameters(site: Path) -> None:
    told = nlcontrol(site, "objects", "show", "milk", "--json")
    shown = json.loads(told.stdout)
    assert (shown["kind"], shown["fill"]) == ("carton", 0.5)
    # The shell at half the height, half a litre at a quarter.
    assert shown["com"][2] == pytest.approx((0.03 * 0.1 + 0.5 * 0.05) / 0.53, rel=1e-9)


def test_a_sentence_about_its_object_is_planned(site: Path, tmp_path: Path) -> None:
    scene = tmp_path / "breakfast.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    sentence = "push the milk carton away without toppling it"
    told = nlcontrol(site, "plan", sentence, "--scene", str(scene), "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["status"]) == (0, "planned"), told.stderr
    assert document["plan"]["actions"][0]["prediction"]["outcome"] == "slide"


def test_a_sentence_in_its_words_is_planned(site: Path) -> None:
    told = nlcontrol(site, "plan", "shimmy the mug 3 cm to port with kid gloves", "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["status"]) == (0, "planned"), told.stderr
    assert document["frames"][0]["goal"]["direction"] == "left"


def test_its_models_are_checked_and_the_broken_file_is_named(site: Path) -> None:
    told = nlcontrol(site, "objects", "check", "carton", "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["ok"]) == (0, True), told.stdout
    assert {row["object"] for row in document["checks"]} == {"milk carton"}
    told = nlcontrol(site, "objects", "check", "nlcontrol-cartons", "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["error"]["code"]) == (2, "missing_key")
    faults = [row["object"] for row in document["checks"] if row["error"]]
    assert faults == ["nlcontrol-cartons"]


@pytest.mark.slow
def test_a_sentence_about_its_object_is_carried_out(site: Path, tmp_path: Path) -> None:
    scene = tmp_path / "breakfast.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    sentence = "push the milk carton away without toppling it"
    told = nlcontrol(site, "say", sentence, "--scene", str(scene), "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["status"]) == (0, "done"), told.stderr
