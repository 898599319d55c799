"""The guide to model files: its example is a good file, and its Python runs."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from objectmodels import Registry
from objectmodels.modelfile import BUILT_IN_KINDS, keys

GUIDE = (Path(__file__).parents[2] / "docs" / "models.md").read_text(encoding="utf-8")


def _block(language: str) -> str:
    (block,) = re.findall(rf"^```{language}\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)
    return str(block)


@pytest.fixture
def crate(tmp_path: Path) -> Path:
    path = tmp_path / "crate.yaml"
    path.write_text(_block("yaml"), encoding="utf-8")
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
        exec(compile(_block("python"), "models.md", "exec"), {})
    # m g b / h = 1.0 · 9.81 · 0.05 / 0.15
    assert out.getvalue().strip() == "[3.27]"


def test_every_key_of_the_format_is_explained() -> None:
    wanted = {key for cls in BUILT_IN_KINDS.values() for key in keys(cls)}
    assert {key for key in wanted if key not in GUIDE} == set()
