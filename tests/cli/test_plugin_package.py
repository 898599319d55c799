"""A package of somebody else brings a kind of model, and a sentence is said about its object.

The class is the guide's own (docs/models.md), installed with pip into a folder of the test.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

GUIDE = (Path(__file__).parents[2] / "docs" / "models.md").read_text(encoding="utf-8")

PROJECT = """\
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"

[project]
name = "nlcontrol-cartons"
version = "0.1.0"

[tool.hatch.build.targets.wheel]
packages = ["cartons"]

"""

MILK = """\
format: carton/1
name: milk carton
synonyms: [milk]
size_m: [0.07, 0.07, 0.20]
shell_kg: 0.03
fill: 0.5
mass_kg: 0.53
mass_kg_sd: 0.02
friction_table: 0.30
friction_table_sd: 0.02
friction_finger: 0.6
centre_of_mass_m_sd: [0.001, 0.001, 0.005]
provenance: {source: a test}
"""

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


def block(language: str) -> str:
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)
    return str(found)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the package was installed."""
    source, target = tmp_path_factory.mktemp("cartons"), tmp_path_factory.mktemp("site")
    package = source / "cartons"
    (package / "models").mkdir(parents=True)
    code = block("python kind") + "\n\nMODELS = Path(__file__).parent / 'models'\n"
    code = code.replace("from typing import", "from pathlib import Path\nfrom typing import", 1)
    (package / "__init__.py").write_text(code, encoding="utf-8")
    (package / "models" / "milk.yaml").write_text(MILK, encoding="utf-8")
    (package / "models" / "broken.yaml").write_text("format: carton/1\n", encoding="utf-8")
    (source / "pyproject.toml").write_text(PROJECT + block("toml"), encoding="utf-8")
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps"]
    command += ["--no-build-isolation", "--target", str(target), str(source)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    return target


def nlcontrol(site: Path, *args: str) -> subprocess.CompletedProcess[str]:
    paths = [str(site), str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    return subprocess.run(
        [sys.executable, "-m", "nlcontrol", *args],
        capture_output=True, text=True, encoding="utf-8", timeout=300, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)},
    )  # fmt: skip


def test_the_class_of_the_guide_has_thirty_lines() -> None:
    assert len(block("python kind").rstrip().splitlines()) <= 36


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


@pytest.mark.slow
def test_a_sentence_about_its_object_is_carried_out(site: Path, tmp_path: Path) -> None:
    scene = tmp_path / "breakfast.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    sentence = "push the milk carton away without toppling it"
    told = nlcontrol(site, "say", sentence, "--scene", str(scene), "--json")
    document = json.loads(told.stdout)
    assert (told.returncode, document["status"]) == (0, "done"), told.stderr
