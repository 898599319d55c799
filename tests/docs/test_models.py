"""The guide to model files: its example is a good file, and its Python runs."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

import pytest

from objectmodels import Registry
from objectmodels.files.yaml_documents import file_keys
from objectmodels.models.kinds import KINDS
from objectmodels.models.object_parts import (
    Container,
    FlipLid,
    Graspable,
    LiftOffLid,
    Opening,
    ScrewCap,
)
from objectmodels.models.predictor import PREDICTIONS
from objectmodels.registry.model_registry import load_model
from tests.docs.guide_blocks import only_block

GUIDE = (Path(__file__).parents[2] / "docs" / "models.md").read_text(encoding="utf-8")


PARTS = {
    "container": (Container,),
    "lid": (FlipLid, LiftOffLid, ScrewCap),
    "grasp": (Graspable,),
}


@pytest.fixture
def crate(tmp_path: Path) -> Path:
    path = tmp_path / "crate.yaml"
    path.write_text(only_block(GUIDE, "yaml"), encoding="utf-8")
    return path


def test_the_example_is_a_model_file(crate: Path) -> None:
    registry = Registry()
    registry.load(crate)
    model = registry.get("crate")
    assert (model.mass, model.friction, model.finger_friction_sd) == (1.0, 0.4, 0.07)
    assert model.synonyms == ("wooden crate",)


def test_the_python_of_the_guide(crate: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(crate.parent)
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python"), "models.md", "exec"), {})
    # m g b / h = 1.0 · 9.81 · 0.05 / 0.15
    assert out.getvalue().strip() == "[3.27]"


def test_the_learned_model_of_the_guide_is_taken_and_one_that_is_too_sure_is_not() -> None:
    out = io.StringIO()
    names: dict[str, Any] = {}
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python learned"), "models.md", "exec"), names)
    assert out.getvalue().strip() == "not_calibrated"
    assert "oiled crate" in names["registry"]
    assert set(re.findall(r"`(\w+)`", _section("A learned model"))) >= set(PREDICTIONS)


def _section(title: str) -> str:
    return GUIDE.partition(f"### {title}\n")[2].partition("```")[0]


def test_the_blocks_of_the_guide_go_into_a_model_file(tmp_path: Path) -> None:
    path = tmp_path / "crate.yaml"
    path.write_text(only_block(GUIDE, "yaml") + only_block(GUIDE, "yaml parts"), encoding="utf-8")
    model = load_model(path)
    assert isinstance(model.lid, FlipLid)
    assert model.container is not None
    assert model.grasp is not None
    assert (model.lid.tab_heading_deg, model.container.contents_l) == (90.0, 0.24)
    assert model.grasp.crush == 20.0


def test_what_opens_a_lid_is_told() -> None:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(only_block(GUIDE, "python opening"), "models.md", "exec"), {})
    flip, turn = out.getvalue().strip().split("\n")
    # 2 R + 0.7 · 20 mm of lever against 20 + 30 mN·m and 20 g at R; see tests of `opening`.
    assert flip == "0.68 N, margin 1.9, 100%"
    assert turn == "60 of 47 mN·m"  # μ m g c̄ = 0.3 · 0.55 · 9.81 · 0.029


def test_the_tables_of_the_blocks_have_their_keys_and_defaults() -> None:
    tables = re.findall(r"^\| `(container|lid|grasp)`(?: of kind `(\w+)`)? \| default.*?\n\n",
                        GUIDE, re.MULTILINE | re.DOTALL)  # fmt: skip
    assert len(tables) == 5
    for block, classes in PARTS.items():
        for part in classes:
            kind = part.model_fields["kind"].default if "kind" in part.model_fields else None
            of = rf" of kind `{kind}`" if kind else ""
            (table,) = re.findall(
                rf"^\| `{block}`{of} \| default.*?\n\n", GUIDE, re.MULTILINE | re.DOTALL
            )
            told = _told(table)
            fields = {
                field.alias or name: field
                for name, field in part.model_fields.items()
                if name != "kind"
            }
            assert set(told) == set(fields)
            for key, default in told.items():
                field = fields[key]
                if field.is_required():
                    assert default == "required", key
                else:
                    assert float(default) == field.default, key
    assert {"centre_m", "radius_m"} == {
        field.alias or name for name, field in Opening.model_fields.items()
    }


def _told(table: str) -> dict[str, str]:
    """Keys of a table and the defaults told of them; one default may stand for several keys."""
    told: dict[str, str] = {}
    for row in table.strip().split("\n")[2:]:
        keys, defaults, _ = (cell.strip() for cell in row.strip("|").split(" | ", 2))
        names = re.findall(r"`(\w+)`", keys)
        values = defaults.split(", ")
        told |= dict(zip(names, values * (len(names) // len(values)), strict=True))
    return told


def test_every_key_of_the_format_is_explained() -> None:
    wanted = {key for cls in KINDS.values() for key in file_keys(cls)}
    assert {key for key in wanted if key not in GUIDE} == set()
