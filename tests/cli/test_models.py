"""The commands about object models: predict, map, affordances, objects."""

from __future__ import annotations

import csv
import json
import math
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from nlcontrol.cli import run
from tests.cli.json_answer import json_answer

CRATE = """\
format: box/1
name: crate
synonyms: [wooden crate]
size_m: [0.1, 0.1, 0.2]
mass_kg: 1.0
friction_table: 0.4
provenance: {source: a test}
"""

HONEY = """\
<robot name="honey_jar"><link name="jar">
  <inertial><origin xyz="0 0 0.045"/><mass value="0.4"/></inertial>
  <collision><geometry><mesh filename="jar.stl" scale="0.001 0.001 0.001"/></geometry></collision>
</link></robot>
"""


# -- predict ----------------------------------------------------------------------------------


def test_predict_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    push = ["--face", "front", "--at", "0.0,0.05", "--direction", "1,0,0", "--force", "4"]
    assert run(["predict", "ice tea box", *push]) == 0
    out = capsys.readouterr().out
    # μ m g = 0.378 · 0.9952 · 9.81, and m g b / h.
    assert "with 4 N, the ice tea box slides." in out
    assert "It slides from 3.69 N on; it topples from 8.79 N on." in out
    assert "static friction; exact tier" in out


@pytest.mark.parametrize(
    ("push", "outcome", "words"),
    [
        (["--at", "0,0.05", "--force", "3"], "none", "stays where it is"),
        (["--at", "0,0.2", "--force", "3"], "topple", "falls by itself beyond 21.4°"),
        (["--at", "0,0.2"], "topple", "It topples from 2.20 N on"),
        (["--at", "0.04,0.05"], "slide", "turns left"),
        (["--at", "-0.04,0.05"], "slide", "turns right"),
        (["--at", "0,0.1", "--direction", "1,0,-1"], "slide", "45° downwards"),
        (["--at", "0,0.05", "--direction", "1,1,0"], "slide", "slips along the face"),
        (["--face", "left", "--at", "0,0.05"], "slide", "right"),
        (["--lying-on", "back", "--at", "0,0.085"], "slide", "slides from 3.69 N"),
    ],
)
def test_predict_as_data_says_the_same(
    capsys: pytest.CaptureFixture[str], push: list[str], outcome: str, words: str
) -> None:
    status, found = json_answer(capsys, "predict", "ice tea box", *push)
    assert (status, found["outcome"], found["object"]) == (0, outcome, "ice tea box")
    assert words in found["text"]
    assert sum(found["probability"].values()) == pytest.approx(1.0)
    assert found["residual"] < 1e-8
    assert found["tier"] == "exact"


def test_predict_a_drag_says_whether_it_goes_along(capsys: pytest.CaptureFixture[str]) -> None:
    # A book of 0.65 kg, friction 0.3 at the table and 0.6 at the finger: pressed over its middle it
    # takes μ (m g + N), and goes along from μ m g / (μ_f − μ) = 6.38 N on.
    at = ["--at", "0,0", "--direction", "0,1,0"]
    for press, outcome, words in ((6.3, "slips", "slips over it"), (6.5, "drags", "goes along")):
        status, found = json_answer(capsys, "predict", "book", *at, "--press", str(press))
        assert (status, found["outcome"], found["tier"]) == (0, outcome, "exact")
        assert found["force"] == pytest.approx(0.3 * (0.65 * 9.81 + press), rel=1e-6)
        assert found["grip"] == pytest.approx(0.6 * press)
        assert words in found["text"]
        assert 0.4 < found["probability"] < 0.6  # as believed it is at the limit
    aside = ["--at", "0.03,0", "--direction", "0,1,0", "--press", "30"]
    status, found = json_answer(capsys, "predict", "book", *aside)
    assert found["probability"] > 0.8  # the frictions of finger and table are not known for sure
    assert found["turning"] > 0.0
    assert "turns left" in found["text"]
    assert run(["predict", "book", *at, "--press", "6.5"]) == 0
    assert "led left" in capsys.readouterr().out


def test_predict_with_kinetic_friction_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    push = ["--at", "0,0.05", "--friction", "kinetic"]
    status, found = json_answer(capsys, "predict", "coffee box", *push)
    assert (status, found["friction"]) == (0, "kinetic")
    assert found["slide"] == pytest.approx(0.2403 * 0.5102 * 9.81, rel=1e-9)
    status, found = json_answer(capsys, "predict", "mug", *push)
    assert (status, found["error"]["code"]) == (2, "unknown_parameter")


@pytest.mark.parametrize(
    ("args", "status", "code", "words"),
    [
        (["predict", "iced tee box", "--at", "0,0.05"], 3, "unknown_object", "ice tea box"),
        (["predict", "ice tea box", "--at", "0,0.5"], 2, "bad_push", "0 to 230 mm"),
        (["predict", "ice tea box", "--at", "0"], 2, "usage", "2 numbers"),
        (["predict", "ice tea box", "--at", "0,nan"], 2, "usage", "2 numbers"),
        (["predict", "ice tea box"], 2, "usage", "--at"),
        (["predict", "mug", "--at", "0,0.05", "--face", "lid"], 2, "unknown_face", "front"),
        (["predict", "mug", "--at", "0,0.05", "--direction", "-1,0,0"], 2, "bad_push", "press"),
        (["predict", "mug", "--at", "0,0.05", "--lying-on", "left"], 2, "unknown_face", "bottom"),
        (["predict", "mug", "--at", "0,0.05", "--force", "-1"], 2, "usage", "-1"),
        (["predict", "book", "--at", "0.08,0", "--press", "9"], 2, "bad_push", "80 mm, 0 mm"),
        (["predict", "book", "--at", "0,0", "--press", "9", "--direction", "1,0,1"], 2, "bad_push",
         "level"),
        (["predict", "book", "--at", "0,0", "--press", "9", "--force", "2"], 2, "usage", "leave"),
        (["predict", "book", "--at", "0,0", "--press", "9", "--face", "left"], 2, "usage", "leave"),
        (["predict", "book", "--at", "0,0", "--press", "0"], 2, "usage", "0"),
        (["map", "mug", "--spacing", "0"], 2, "bad_value", "spacing"),
        (["map", "mug", "--output", "map.gif"], 2, "usage", ".png"),
        (["map", "mug", "--output", "/nowhere/map.png"], 2, "cannot_write", "/nowhere"),
        (["affordances", "unicorn"], 3, "unknown_object", "known"),
        (["objects", "add", "missing.yaml"], 2, "unreadable_file", "missing.yaml"),
        (["objects", "import", "missing.stl", "--name", "x", "--mass", "1"], 2, "unreadable_file",
         "missing.stl"),
        (["objects", "import", "x.stl", "--name", "x"], 2, "usage", "--mass or --density"),
        (["objects", "remove", "mug"], 2, "not_yours", "built in"),
    ],
)  # fmt: skip
def test_mistakes_are_explained(
    capsys: pytest.CaptureFixture[str], args: list[str], status: int, code: str, words: str
) -> None:
    found_status, found = json_answer(capsys, *args)
    assert (found_status, found["error"]["code"]) == (status, code)
    assert words in json.dumps(found["error"], ensure_ascii=False)


# -- map --------------------------------------------------------------------------------------


def test_a_map_in_letters(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["map", "ice tea box", "--straight"]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = [m for line in lines if (m := re.match(r" *(\d+) mm  ([sT?·](?: [sT?·])*) ", line))]
    assert len(rows) == 23
    for row in rows:
        letters = set(row[2].split())
        if int(row[1]) < 110:  # h* = 119 mm, and a band of 5 %
            assert letters == {"s"}
        elif int(row[1]) > 130:
            assert letters == {"T"}
    assert "undecided: thresholds within 5 %" in lines[-2]


def test_a_map_in_every_format(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    files = [tmp_path / f"map.{suffix}" for suffix in ("png", "svg", "pdf", "csv", "json")]
    outputs = [part for file in files for part in ("--output", str(file))]
    status, document = json_answer(capsys, "map", "ice tea box", *outputs)
    assert status == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(f.name for f in files)
    assert json.loads((tmp_path / "map.json").read_text(encoding="utf-8")) == document
    with (tmp_path / "map.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(document["contacts"]) > 100
    for row, contact in zip(rows, document["contacts"], strict=True):
        assert row["outcome"] == contact["outcome"]
        assert float(row["force_n"]) == pytest.approx(contact["force"], rel=1e-12)
    assert {row["outcome"] for row in rows} == {"slide", "topple", "undecided"}
    assert "<svg" in (tmp_path / "map.svg").read_text(encoding="utf-8")


SLIDES, TOPPLES = (38, 135, 190), (219, 118, 38)
UNDECIDED = (146, 146, 146)
"""Colours of `outcome_map_drawing.COLOURS` on white, as opaque as they are drawn."""


def painted(path: Path, rgb: tuple[int, int, int]) -> int:
    """Number of pixels near a colour."""
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    return int((np.abs(pixels - rgb).max(axis=2) < 40).sum())


@pytest.mark.parametrize("options", [[], ["--3d"], ["--shade"], ["--straight"]])
def test_the_picture_has_the_colours_of_all_outcomes(tmp_path: Path, options: list[str]) -> None:
    path = tmp_path / "map.png"
    assert run(["map", "ice tea box", "--output", str(path), *options]) == 0
    topples, slides = painted(path, TOPPLES), painted(path, SLIDES)
    assert topples > 200
    assert slides > 200
    if "--shade" not in options:  # there the undecided are the palest
        assert painted(path, UNDECIDED) > 50


def test_a_map_of_probability(capsys: pytest.CaptureFixture[str]) -> None:
    _, loose = json_answer(capsys, "map", "ice tea box", "--level", "0.6")
    _, strict = json_answer(capsys, "map", "ice tea box", "--level", "0.99")
    undecided = [
        sum(contact["outcome"] == "undecided" for contact in document["contacts"])
        for document in (loose, strict)
    ]
    assert undecided[0] < undecided[1]


# -- affordances ------------------------------------------------------------------------------


@pytest.mark.slow
def test_affordances_of_the_ice_tea_box(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "affordances", "ice tea box")
    assert status == 0
    found = {(a["outcome"], a["direction"]): a for a in document["affordances"]}
    assert len(found) == 16
    away = found["slide", "away"]
    assert (away["can"], away["face"]) == (True, "front")
    assert away["least_force"] == pytest.approx(0.378 * 0.9952 * 9.81, rel=1e-6)
    assert found["topple", "left"]["face"] == "right"
    # A hand would get around it, but it is too heavy to be held.
    lift = found["lift", ""]
    assert (lift["possible"], lift["can"]) == (True, False)
    assert "needs 14." in lift["message"]
    turning = found["turn", "left"]
    assert (turning["possible"], turning["can"], turning["reason"]) == (True, True, None)
    assert turning["message"].startswith("3 pushes, first one finger")
    assert turning["least_force"] < away["least_force"]
    # Pushed left of the middle it turns right, seen from above; the place says so.
    for sense, side in (("left", 1.0), ("right", -1.0)):
        turn = found["turn", sense]
        pushed = ["--face", turn["face"], "--at", "{},{}".format(*turn["place"])]
        _, push = json_answer(capsys, "predict", "ice tea box", *pushed)
        assert np.sign(push["motion"]["turning"]) == side


def test_affordances_of_what_is_not_on_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["affordances", "book"]) == 0
    out = capsys.readouterr().out
    (line,) = (line for line in out.splitlines() if line.startswith("✗ topple away"))
    assert line.endswith(": pushed anywhere on that face, the book never topples first")
    assert "slide away: from the front" in out


# -- objects ----------------------------------------------------------------------------------


def test_add_show_predict_remove(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    file = tmp_path / "my crate.yaml"
    file.write_text(CRATE, encoding="utf-8")
    assert run(["objects", "validate", str(file)]) == 0
    capsys.readouterr()
    status, added = json_answer(capsys, "objects", "add", str(file))
    assert status == 0
    assert Path(added["file"]) == objects_folder / "crate.yaml"
    status, shown = json_answer(capsys, "objects", "show", "wooden crate")
    assert (shown["mass"], shown["place"]) == (1.0, added["file"])
    status, found = json_answer(capsys, "predict", "crate", "--at", "0,0.15")
    assert found["topple"] == pytest.approx(9.81 * 0.05 / 0.15, rel=1e-9)
    status, refused = json_answer(capsys, "objects", "add", str(file))
    assert (status, refused["error"]["code"]) == (2, "duplicate_name")
    status, removed = json_answer(capsys, "objects", "remove", "crate")
    assert (status, removed["removed"]) == (0, "crate")
    assert list(objects_folder.iterdir()) == []


def test_validate_names_every_bad_file(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    good.write_text(CRATE, encoding="utf-8")
    bad.write_text(CRATE.replace("1.0", "heavy"), encoding="utf-8")
    status, verdict = json_answer(capsys, "objects", "validate", str(good), str(bad))
    assert (status, verdict["ok"]) == (2, False)
    assert [file["ok"] for file in verdict["files"]] == [True, False]
    assert "mass_kg: found 'heavy', expected a valid number" in verdict["files"][1]["error"]


def test_a_broken_file_of_the_user_is_told_and_skipped(
    capsys: pytest.CaptureFixture[str], objects_folder: Path
) -> None:
    (objects_folder / "bad.yaml").write_text("format: box/1\n", encoding="utf-8")
    assert run(["objects", "list"]) == 0
    told = capsys.readouterr()
    assert "ice tea box" in told.out
    assert "skipped" in told.err
    assert "bad.yaml" in told.err


def test_import_a_mesh_and_predict_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    mesh = tmp_path / "jar.stl"
    trimesh.creation.cylinder(radius=40, height=90, sections=60).export(mesh)
    options = ["--name", "jam jar", "--mass", "0.4", "--unit", "mm", "--synonym", "preserve"]
    status, told = json_answer(capsys, "objects", "import", str(mesh), *options)
    assert status == 0
    assert Path(told["file"]) == objects_folder / "jam_jar.yaml"
    status, found = json_answer(capsys, "objects", "show", "preserve")
    assert found["kind"] == "cylinder"
    assert (found["radius"], found["height"]) == pytest.approx((0.04, 0.09), abs=1e-6)
    status, document = json_answer(capsys, "predict", "jam jar", "--at", "0,0.02")
    assert (status, document["outcome"]) == (0, "slide")
    elsewhere = tmp_path / "other.yaml"
    density = ["--name", "other", "--density", "900", "--unit", "mm", "--output", str(elsewhere)]
    assert run(["objects", "import", str(mesh), *density]) == 0
    assert "mass from 900 kg/m³" in elsewhere.read_text(encoding="utf-8")
    # π R² h ρ; sixty sides have 0.2 % less area.
    mass = float(re.findall(r"mass_kg: ([\d.]+)", elsewhere.read_text(encoding="utf-8"))[0])
    assert mass == pytest.approx(900 * math.pi * 0.04**2 * 0.09, rel=0.003)


def test_export_a_model_for_another_simulator(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    options = ["--output", str(tmp_path), "--format"]
    status, told = json_answer(capsys, "objects", "export", "mug", *options, "sdf")
    assert (status, told["files"]) == (0, [str(tmp_path / "mug.sdf")])
    assert "<mass>0.118</mass>" in Path(told["files"][0]).read_text("utf-8")
    status, told = json_answer(capsys, "objects", "export", "unicorn", *options, "mjcf")
    assert (status, told["error"]["code"]) == (3, "unknown_object")


@pytest.mark.parametrize("form", ["mjcf", "urdf"])
def test_what_was_exported_is_added_and_its_next_command_works(
    form: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    export = ["objects", "export", "soup can", "--format", form, "--output", str(tmp_path)]
    (file,) = json_answer(capsys, *export)[1]["files"]
    status, told = json_answer(
        capsys, "objects", "add", file, "--name", "old can", "--friction", "0.3"
    )
    assert (status, told["name"]) == (0, "old can")
    _, shown = json_answer(capsys, "objects", "show", "old can")
    assert (shown["radius"], shown["friction"], shown["support"]) == (0.033, 0.3, "corners")
    program, command, *said = shlex.split(told["next"])
    assert (program, command) == ("nlcontrol", "say")
    status, planned = json_answer(capsys, "plan", *said)
    assert (status, planned["status"]) == (0, "planned")


def test_a_described_hull_is_mapped_and_its_push_is_planned(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    shutil.copy(Path(__file__).parents[2] / "examples" / "jar.stl", tmp_path)
    (tmp_path / "honey.urdf").write_text(HONEY, encoding="utf-8")
    status, told = json_answer(capsys, "objects", "add", str(tmp_path / "honey.urdf"))
    assert (status, told["name"]) == (0, "honey jar")
    assert json_answer(capsys, "objects", "show", "honey jar")[1]["kind"] == "hull"
    status, chart = json_answer(capsys, "map", "honey jar")
    # It topples above 94 mm alone, where its lid is too narrow for a fingertip.
    assert (status, {c["outcome"] for c in chart["contacts"]}) == (0, {"slide"})
    status, planned = json_answer(capsys, "plan", *shlex.split(told["next"])[2:])
    assert (status, planned["status"]) == (0, "planned")


def test_options_of_a_description_are_not_those_of_a_model_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    (tmp_path / "crate.yaml").write_text(CRATE, encoding="utf-8")
    status, told = json_answer(
        capsys, "objects", "add", str(tmp_path / "crate.yaml"), "--mass", "2"
    )
    assert (status, told["error"]["code"]) == (2, "usage")
    assert list(objects_folder.iterdir()) == []


@pytest.mark.slow
def test_what_can_be_done_with_an_imported_mesh(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    mesh = tmp_path / "jar.stl"
    trimesh.creation.cylinder(radius=40, height=90, sections=60).export(mesh)
    options = ["--name", "jam jar", "--mass", "0.4", "--unit", "mm"]
    assert json_answer(capsys, "objects", "import", str(mesh), *options)[0] == 0
    _, document = json_answer(capsys, "affordances", "jam jar")
    assert any(a["can"] for a in document["affordances"])


def test_what_has_no_side_for_a_finger_is_told(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, objects_folder: Path
) -> None:
    trimesh.creation.box(extents=(0.006, 0.006, 0.3)).export(tmp_path / "needle.stl")
    options = ["--name", "needle", "--mass", "0.05"]
    assert run(["objects", "import", str(tmp_path / "needle.stl"), *options]) == 0
    capsys.readouterr()
    for command in (["predict", "needle", "--at", "0,0.1"], ["map", "needle"]):
        status, found = json_answer(capsys, *command)
        assert (status, found["error"]["code"]) == (2, "unknown_face")
        assert "wide enough for a fingertip" in found["error"]["message"]
    assert run(["affordances", "needle"]) == 0
    assert "no side" in capsys.readouterr().out


def test_show_says_all_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["objects", "show", "mug"]) == 0
    out = capsys.readouterr().out
    for words in ("a round base, on its rim", "never topples", "built in", "YCB", "0.1180 ±"):
        assert words in out
