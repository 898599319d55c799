"""Bad files, names and options on the command line: an error with a code and a suggestion."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import trimesh

from nlcontrol.cli import run
from tests.cli.json_answer import json_answer

CRATE = """\
format: box/1
name: crate
size_m: [0.1, 0.1, 0.1]
mass_kg: 1.0
friction_table: 0.4
provenance: {source: a test}
"""
SCENE = """\
version: 1
name: small
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: crate
    model: ice tea box
    pose: {x_m: 0.5, y_m: 0.0}
    truth: {size_m: [0.1, 0.1, 0.2], mass_kg: 1.0, friction_table: 0.4, friction_finger: 0.7}
"""
BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)  # fmt: skip


def test_one_bad_file_stops_no_command(
    capsys: pytest.CaptureFixture[str], objects_folder: Path
) -> None:
    bad = {
        "wall": CRATE + "container: {wall_m: 0.06, opening: {radius_m: 0.02}}\n",
        "tag": CRATE.replace("1.0", "!!int abc"),
        "digits": CRATE.replace("1.0", "9" * 5000),
        "bomb": BOMB + "format: *i\n",
        "escape": CRATE.replace("crate", '"\\e[31m"'),
        "weights": CRATE + "support: [[0.04, 0, 1e308], [0, 0.04, 1e308], [-0.04, -0.04, 1e308]]\n",
    }
    for name, text in bad.items():
        (objects_folder / f"{name}.yaml").write_text(text)
    os.mkfifo(objects_folder / "pipe.yaml")
    (objects_folder / "endless.yaml").symlink_to("/dev/zero")
    for name in ("one", "two"):
        (objects_folder / f"{name}.yaml").symlink_to(".")
    (objects_folder / "good.yaml").write_text(CRATE)
    assert run(["objects", "list"]) == 0
    out, err = capsys.readouterr()
    assert "crate" in out
    assert sorted(line.split(".yaml")[0].rpartition("/")[2] for line in err.splitlines()) == sorted(
        [*bad, "pipe", "endless", "one", "two"]
    )
    assert "container.wall_m" in err
    assert (err + out).replace("\n", "").isprintable()


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("name: crate", "name: ''", "objects.0.name"),
        ("name: crate", "name: ' '", "objects.0.name"),
        ("name: small", 'name: "\\u202e"', "line 2"),
        ("x_m: 0.5", "x_m: 1e300", "objects.0.pose.x_m"),
        ("mass_kg: 1.0", "mass_kg: 1e-30", "objects.0.truth.mass_kg"),
        ("mass_kg: 1.0", "mass_kg: !!int abc", "line 8"),
        ("[41.0", "[1e300", "robot.home_deg.0"),
        ("[41.0,", "[", "robot.home_deg"),
        ("version: 1", "version: 1\nvision: {rate_hz: 1e9}", "vision.rate_hz"),
        ("version: 1", "version: 1\nvision: &a [*a]", "line 2"),
        ("version: 1", "version: 1\n" + BOMB, "line"),
        (SCENE[SCENE.index("  - ") :], SCENE[SCENE.index("  - ") :] * 200, "objects"),
    ],
)
def test_bad_scenes_are_refused_before_anything_moves(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, old: str, new: str, place: str
) -> None:
    (tmp_path / "e.yaml").write_text(SCENE.replace(old, new))
    status, found = json_answer(capsys, "say", "push it away", "--scene", str(tmp_path / "e.yaml"))
    assert (status, found["error"]["code"]) == (2, "bad_scene")
    assert place in found["error"]["message"]
    assert found["error"]["suggestions"]


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (["--name", "", "--mass", "1"], "bad_value"),
        (["--name", "a", "--mass", "1", "--synonym", ""], "bad_value"),
        (["--name", "a", "--mass", "1", "--friction", "nan"], "bad_value"),
        (["--name", "a", "--density", "1e-5"], "bad_value"),
        (["--name", "a", "--mass", "1", "--output", "/dev/null"], "cannot_write"),
        (["--name", "a", "--mass", "1", "--output", "x" * 300], "cannot_write"),
    ],
)
def test_bad_options_of_import(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, options: list[str], code: str
) -> None:
    trimesh.creation.box(extents=(0.06, 0.08, 0.2)).export(tmp_path / "box.stl")
    status, found = json_answer(capsys, "objects", "import", str(tmp_path / "box.stl"), *options)
    assert (status, found["error"]["code"]) == (2, code)
    assert found["error"]["suggestions"]


def test_a_folder_that_cannot_be(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "crate.yaml").write_text(CRATE)
    monkeypatch.setenv("NLCONTROL_OBJECTS", str(tmp_path / ("x" * 300)))
    assert json_answer(capsys, "objects", "show", "mug")[0] == 0
    status, found = json_answer(capsys, "objects", "add", str(tmp_path / "crate.yaml"))
    assert (status, found["error"]["code"]) == (2, "cannot_write")
