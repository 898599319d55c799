"""Imports that the guides of the version before have shown, and plug-ins written by them."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from nlcontrol import package_imports
from tests.patience import PATIENCE

ROOT = Path(__file__).parents[3]

SHOWN = [
    ("grammar.lexicon", "default_lexicon"),
    ("grammar.parser", "Parser"),
    ("nlcontrol", "BoxModel", "Controller", "CylinderModel", "Registry"),
    ("nlcontrol.exploring", "explore"),
    ("objectmodels", "BoxModel", "ObjectModel", "Polygon", "sides", "opening"),
    ("objectmodels.identification", "fit"),
    ("objectmodels.identification.datafile", "read_data"),
    ("objectmodels.identification.recordings", "Recording", "trial_from_series", "tilted_trial"),
    ("objectmodels.parameters", "Size"),
    ("objectmodels.parts", "Container", "Opening"),
    ("objectmodels.pouring", "angle_for", "pour"),
    ("objectmodels.tilting", "tilt_level"),
    ("planner.defaults", "DEFAULTS"),
    ("planner.settings", "changed"),
    ("sim", "load_scene"),
    ("sim.hidden", "drawn"),
]

CARTONS = '''
from typing import Annotated, Literal

from pydantic import Field

from objectmodels import ObjectModel, Polygon, sides
from objectmodels.parameters import Size


class CartonModel(ObjectModel):
    """A carton of a shell and a liquid."""

    size: Annotated[Size, Field(alias="size_m")]
    shell: Annotated[float, Field(gt=0.0, alias="shell_kg")]
    fill: Annotated[float, Field(ge=0.0, le=1.0)]
    kind: Literal["carton"] = "carton"

    @property
    def footprint(self):
        return Polygon.rectangle(*self.size[:2])

    @property
    def top(self):
        return self.size[2]

    @property
    def centre(self):
        liquid = (self.mass - self.shell) * self.fill
        return (0.0, 0.0, (self.shell + liquid) * self.top / 2.0 / self.mass)

    def faces(self, headings=None):
        return sides(self.footprint, self.top)


MILK = CartonModel(
    name="milk carton", size=(0.07, 0.07, 0.20), shell=0.03, fill=0.5, mass=0.53, friction=0.3
)
'''

WORDS = """
from grammar.lexicon import default_lexicon

assert "shimmy" not in default_lexicon().verbs

WORDS = {
    "verbs": [{"says": ["shimmy", "jiggle [over]"], "action": "slide", "goal": "displace"}],
    "terminals": {
        "DIRECTION": {"left": ["to port"], "right": ["to starboard"]},
        "MANNER": {"gentle": ["with kid gloves"]},
    },
    "adjectives": {"grey": ["silver"]},
    "names": ["hard drive"],
}
"""

ENTRY_POINTS = """\
[nlcontrol.objectmodels]
carton = cartons:CartonModel
milk = cartons:MILK

[nlcontrol.lexicon]
workshop = workshop:WORDS
"""


def run(*arguments: str, site: Path | None = None) -> str:
    """What a new interpreter prints, with the packages of a folder installed."""
    paths = os.pathsep.join(str(path) for path in (site, ROOT) if path)
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True, text=True, encoding="utf-8", timeout=PATIENCE, check=False,
        env={**os.environ, "PYTHONPATH": paths},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plug-in package, as pip would install it."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "cartons.py").write_text(CARTONS, encoding="utf-8")
    (folder / "workshop.py").write_text(WORDS, encoding="utf-8")
    information = folder / "former_plugins-0.1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: former-plugins\nVersion: 0.1.0\n", encoding="utf-8"
    )
    (information / "entry_points.txt").write_text(ENTRY_POINTS, encoding="utf-8")
    return folder


def test_every_import_that_was_shown_still_works() -> None:
    lines = [f"from {module} import {', '.join(names)}" for module, *names in SHOWN]
    run("-W", "ignore", "-c", "\n".join(["import nlcontrol", *lines]))


@pytest.mark.parametrize("old", package_imports.FORMER)
def test_a_former_name_warns_and_gives_the_same_things(old: str) -> None:
    home, renamed = package_imports.FORMER[old]
    sys.modules.pop(old, None)
    with pytest.warns(DeprecationWarning, match=rf"{old} is now {home}") as caught:
        module = importlib.import_module(old)
    assert [Path(warning.filename).name for warning in caught] == ["__init__.py"]
    assert all(getattr(module, name) is not None for name in renamed)
    (shown,) = [names for shown_module, *names in SHOWN if shown_module == old] or [[]]
    for name in set(shown) - set(renamed):
        assert getattr(module, name) is getattr(importlib.import_module(home), name)
    with pytest.raises(AttributeError):
        _ = module.surely_not


def test_what_never_was_is_not_found() -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("objectmodels.never_was")


def test_a_kind_of_model_written_for_the_version_before_is_plugged_in(site: Path) -> None:
    printed = run("-m", "nlcontrol", "objects", "show", "milk carton", "--json", site=site)
    assert '"kind": "carton"' in printed
    # The shell at half the height, half a litre at a quarter.
    assert f"{(0.03 * 0.1 + 0.5 * 0.05) / 0.53:.6f}" in printed


def test_words_written_for_the_version_before_are_plugged_in(site: Path) -> None:
    sentence = "shimmy the silver hard drive to port with kid gloves"
    printed = run("-m", "nlcontrol", "parse", sentence, "--json", site=site)
    assert '"displace"' in printed
    assert '"left"' in printed
