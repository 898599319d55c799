"""A release: one version, which the citation has too, and a recipe that refuses another one."""

from __future__ import annotations

import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

import nlcontrol
from nlcontrol.installed_versions import DISTRIBUTION

ROOT = Path(__file__).parents[2]


def test_the_version_stands_in_one_place() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["dynamic"] == ["version"]
    assert (ROOT / project["tool"]["hatch"]["version"]["path"]).samefile(nlcontrol.__file__)


def test_the_distribution_has_the_name_that_doctor_looks_for() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["name"] == DISTRIBUTION != "nlcontrol"
    of_itself = [x for each in project["optional-dependencies"].values() for x in each if "[" in x]
    assert {x.partition("[")[0] for x in of_itself if x.startswith("nlcontrol")} == {DISTRIBUTION}


def test_the_citation_is_of_this_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert citation["version"] == nlcontrol.__version__
    assert {"cff-version", "message", "title", "authors"} <= citation.keys()


@pytest.mark.parametrize("tag", ["v9.9.9", f"v{nlcontrol.__version__}x", ""])
def test_another_tag_is_refused_before_anything_is_built(tag: str) -> None:
    done = subprocess.run(
        [ROOT / ".ci" / "release", tag], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stderr
