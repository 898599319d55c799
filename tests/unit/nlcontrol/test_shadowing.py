"""Importing nlcontrol where somebody's own folder bears the name of one of its packages."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import nlcontrol

ROOT = Path(nlcontrol.__file__).parents[1]


def _python(code: str, *, first: Path | None = None) -> subprocess.CompletedProcess[str]:
    paths = [str(p) for p in (first, ROOT) if p]
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        cwd=first or ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", ["grammar", "objectmodels", "planner", "sim"])
def test_a_package_of_the_same_name_is_reported_with_its_path(tmp_path: Path, name: str) -> None:
    culprit = tmp_path / name
    culprit.mkdir()
    (culprit / "__init__.py").write_text("raise SystemExit('the wrong package was imported')")
    done = _python(f"import nlcontrol, {name}", first=tmp_path)
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError:")
    assert f"'{name}'" in last
    assert str(culprit) in last


def test_a_module_of_the_same_name_is_reported(tmp_path: Path) -> None:
    (tmp_path / "planner.py").write_text("")
    done = _python("from nlcontrol import Plan", first=tmp_path)
    assert str(tmp_path / "planner.py") in done.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize("name", ["grammar", "sim"])
def test_a_command_tells_it_in_its_one_document(tmp_path: Path, name: str) -> None:
    (tmp_path / f"{name}.py").write_text("")
    code = "from nlcontrol.cli import main; main(['plan', 'push it', '--json'])"
    done = _python(code, first=tmp_path)
    document = json.loads(done.stdout)
    assert (done.returncode, document["error"]["code"]) == (1, "cannot_import")
    assert str(tmp_path / f"{name}.py") in document["error"]["message"]
    assert document["error"]["suggestions"]
    assert not done.stderr


def test_an_already_imported_culprit_is_reported(tmp_path: Path) -> None:
    (tmp_path / "sim.py").write_text("")
    code = (
        f"import sys, sim; sys.path[:2] = []; sys.path.insert(0, {str(ROOT)!r}); import nlcontrol"
    )
    done = _python(code, first=tmp_path)
    assert str(tmp_path / "sim.py") in done.stderr.strip().splitlines()[-1]


def test_a_folder_without_init_does_not_shadow(tmp_path: Path) -> None:
    (tmp_path / "sim").mkdir()
    done = _python("import nlcontrol; print(nlcontrol.__version__)", first=tmp_path)
    assert done.stdout.strip() == nlcontrol.__version__, done.stderr


def test_importing_is_light() -> None:
    done = _python("import sys, nlcontrol; print(*sys.modules)")
    loaded = set(done.stdout.split())
    assert "nlcontrol" in loaded
    assert not loaded & {"numpy", "pydantic", "pydrake", "lark", "rich", "matplotlib", "scipy"}


def test_every_exported_name_is_there() -> None:
    for name in nlcontrol.__all__:
        assert getattr(nlcontrol, name) is not None
    assert set(nlcontrol.__all__) <= set(dir(nlcontrol))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = nlcontrol.nonsense
