"""`nlcontrol explore`: what it finds, tells and keeps, and that mistakes cost nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from nlcontrol.cli import run
from nlcontrol.errors import ControlError
from nlcontrol.learning.exploration_session import explore
from nlcontrol.session.controller import Controller
from objectmodels import Registry
from planner.touch_experiments import experiments
from planner.types.plan import Plan
from planner.types.world_state import WorldState
from sim import load_scene
from sim.simulated_executor import SimulatedExecutor, simulation
from tests.cli.json_answer import told_answer

BOX = "ice tea box"
ONCE = ["explore", "ice tea box", "--trials", "1", "--parameters", "mass,friction"]
TRUE = {"mass": 1.06, "friction": 0.345, "com_x": 0.0, "com_y": 0.0, "com_z": 0.075}
BELIEVED = {"mass": 0.9952, "friction": 0.378}


@pytest.mark.slow
def test_one_repetition_found_told_kept_and_used(
    capsys: pytest.CaptureFixture[str], objects_folder: Path, tmp_path: Path
) -> None:
    output, picture = tmp_path / "found.yaml", tmp_path / "curves.png"
    status, found, told = told_answer(
        capsys, *ONCE, "--output", str(output), "--picture", str(picture), "--save"
    )
    assert (status, found["ok"], found["object"]) == (0, True, BOX)
    assert (found["scene"], found["seed"], found["given_up"]) == ("kitchen", 0, [])
    assert {
        "touches", "repeated", "parameters", "correlations", "friction_spread", "rms", "support",
        "dropped", "notes", "truth", "saved", "instead_of", "files",
    } <= set(found)  # fmt: skip
    assert [touch["experiment"] for touch in found["touches"]] == [
        "tilt at the front", "tilt at the back", "slide at the front"
    ]  # fmt: skip
    assert all(touch["as_meant"] and touch["force"] > 1.0 for touch in found["touches"])
    assert found["truth"].items() >= TRUE.items()
    for name, believed in BELIEVED.items():
        row = found["parameters"][name]
        # A hundredth: bias and joints' errors of the sensors, on top of noise.
        assert row["value"] == pytest.approx(TRUE[name], rel=0.02)
        assert row["low"] < row["value"] < row["high"]
        assert row["believed"] == believed
        assert found["repeated"][name]["n"] == 1
        assert found["repeated"][name]["sd"] is None
        assert found["repeated"][name]["mean"] == pytest.approx(row["value"], rel=0.02)
    # The half-empty box: its mass lies 4 cm lower than believed.
    assert found["parameters"]["com_z"]["value"] == pytest.approx(0.075, abs=0.01)
    assert found["rms"] < 0.02

    # Each touch is told while it happens, on standard error.
    (line,) = [line for line in told.splitlines() if "1. tilt at the back" in line]
    assert "it was tilted by" in line
    assert "now believed: mass 1.0" in line

    assert found["files"] == {"picture": str(picture), "model": str(output)}
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    front = np.abs(pixels - (0, 114, 178)).max(axis=2) < 30  # colour of that face's curves
    assert front.sum() > 200
    assert found["saved"] == str(objects_folder / "ice_tea_box.yaml")
    assert found["instead_of"].startswith("built in")
    assert output.read_text(encoding="utf-8") == Path(found["saved"]).read_text(encoding="utf-8")
    kept = Registry.default().get(BOX)
    assert kept.mass == found["parameters"]["mass"]["value"]
    assert kept.synonyms == Registry.built_in().get(BOX).synonyms
    assert "explored by touching in simulation (scene kitchen, seed 0)" in kept.provenance.source
    assert "as believed before" in kept.provenance.method

    # The robot goes by it from now on.
    status, said, _ = told_answer(
        capsys, "say", "push the ice tea box away without toppling it", "--plan-only"
    )
    assert status == 0
    force = kept.mass * kept.friction * 9.81
    assert said["plan"]["actions"][0]["prediction"]["slide_force"] == pytest.approx(force, rel=0.02)


@pytest.mark.slow
def test_the_report_in_words_and_a_name_of_its_own(
    capsys: pytest.CaptureFixture[str], objects_folder: Path
) -> None:
    assert run([*ONCE[:-1], "finger_friction", "--save", "my carton"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("ice tea box, scene kitchen, seed 0: 1 touches, 1 as meant\n")
    (row,) = [line for line in out.splitlines() if line.lstrip().startswith("friction, finger")]
    mean, least, most, joint, _, believed, truth = map(float, row.split()[2:])
    assert mean == least == most
    assert joint == pytest.approx(0.62, rel=0.05)
    assert (believed, truth) == (0.693, 0.62)
    assert f"Saved: {objects_folder / 'my_carton.yaml'}" in out
    assert "instead of" not in out
    registry = Registry.default()
    assert registry.get("my carton").synonyms == ()
    assert registry.find_one("ice tea box").finger_friction == 0.693


@pytest.mark.slow
def test_with_a_precision_only_as_many_touches_as_needed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    args = ["explore", BOX, "--parameters", "friction", "--precision", "0.1"]
    status, found, _ = told_answer(capsys, *args)
    assert status == 0
    # The mass is known to 4 %: a slide tells the friction well enough.
    assert len(found["touches"]) == 1
    assert found["touches"][0]["experiment"].startswith("slide at the ")
    row = found["parameters"]["friction"]
    assert row["sd"] / row["value"] < 0.1
    assert abs(row["value"] - 0.345) < 2.0 * row["sd"]
    assert any("believed" in note for note in found["notes"])


def test_what_is_known_well_enough_is_not_touched(capsys: pytest.CaptureFixture[str]) -> None:
    args = ["explore", BOX, "--parameters", "mass", "--precision", "0.5"]
    status, found, _ = told_answer(capsys, *args)
    assert (status, found["error"]["code"]) == (4, "not_explorable")
    assert "known to 50% already" in found["error"]["message"]
    assert found["error"]["suggestions"]


@pytest.mark.parametrize(
    ("args", "status", "code", "words"),
    [
        ([], 2, "usage", "OBJECT"),
        (["iced tee bocks"], 3, "unknown_object", "ice tea box"),
        (["soup can"], 3, "not_on_table", "kitchen"),
        (["box"], 3, "ambiguous_object", "cereal box"),
        (["ice tea box", "--parameters", "mas"], 2, "usage", "did you mean 'mass'"),
        (["ice tea box", "--parameters", "colour"], 2, "usage", "centre_of_mass"),
        (["ice tea box", "--parameters", ""], 2, "usage", "no parameter"),
        (["ice tea box", "--precision", "0"], 2, "usage", "0"),
        (["ice tea box", "--precision", "1.5"], 2, "usage", "1.5"),
        (["ice tea box", "--precision", "nan"], 2, "usage", "nan"),
        (["ice tea box", "--guess", "1"], 2, "usage", "1"),
        (["ice tea box", "--trials", "0"], 2, "usage", "0"),
        (["ice tea box", "--seed", "-1"], 2, "usage", "-1"),
        (["ice tea box", "--scene", "kitchn"], 2, "unknown_scene", "kitchen"),
        (["ice tea box", "--output", "found.csv"], 2, "usage", ".yaml"),
        (["ice tea box", "--output", "/nowhere/found.yaml"], 2, "cannot_write", "/nowhere"),
        (["ice tea box", "--picture", "curves.gif"], 2, "usage", ".png"),
        (["ice tea box", "--picture", "/nowhere/curves.png"], 2, "cannot_write", "/nowhere"),
        (["ice tea box", "--save= x "], 2, "bad_value", "cannot be a name"),
        (["ice tea box", "--save", "tomato soup"], 2, "duplicate_name", "soup can"),
    ],
)
def test_mistakes_are_explained_before_anything_is_touched(
    capsys: pytest.CaptureFixture[str],
    objects_folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    args: list[str],
    status: int,
    code: str,
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(SimulatedExecutor, "touch", pytest.fail)
    found_status, found, _ = told_answer(capsys, "explore", *args)
    assert (found_status, found["error"]["code"]) == (status, code)
    assert words in json.dumps(found["error"], ensure_ascii=False)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_where_no_touch_shows_anything_nothing_is_written(
    capsys: pytest.CaptureFixture[str],
    objects_folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The book is too low for every experiment."""
    scene = tmp_path / "reading.yaml"
    scene.write_text(
        "version: 1\nname: reading\n"
        "robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}\n"
        "objects:\n  - name: book\n    model: book\n    pose: {x_m: 0.45, y_m: 0.0}\n"
        "    truth: {size_m: [0.15, 0.21, 0.03], mass_kg: 0.5, friction_table: 0.4,"
        " friction_finger: 0.6}\n",
        encoding="utf-8",
    )
    args = ["explore", "book", "--scene", str(scene), "--save"]
    files = ["--output", str(tmp_path / "o.yaml"), "--picture", str(tmp_path / "p.png")]
    status, found, _ = told_answer(capsys, *args, *files)
    assert (status, found["error"]["code"]) == (4, "not_explorable")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [scene]
    status, found, _ = told_answer(capsys, *args, *files, "--precision", "0.01")
    assert (status, found["error"]["code"]) == (4, "not_explorable")


def test_what_the_robot_cannot_see_changes_nothing_before_the_first_touch() -> None:
    """Two worlds that look alike: the first touch is planned as well for one as for the other."""
    kitchen = load_scene("kitchen")
    other = {
        "mass_kg": 3.0, "friction_table": 0.9, "friction_finger": 0.2,
        "centre_of_mass_m": (0.02, -0.01, 0.15),
    }  # fmt: skip
    objects = tuple(
        item.model_copy(update={"truth": item.truth.model_copy(update=other)})
        for item in kitchen.objects
    )
    strange = kitchen.model_copy(update={"objects": objects})
    found = []
    for scene in (kitchen, strange):
        controller = Controller(scene, seed=3)
        assert simulation(controller.executor).scene.object(BOX).truth == scene.object(BOX).truth
        state = controller.look()
        proposed = experiments(state.objects[BOX], controller.robot.limits)
        command = controller.resolve(controller.parse("push the ice tea box away"))
        plan = controller.plan(command.frames[0], state)
        assert isinstance(plan, Plan)
        found.append(
            (
                [(e.name, e.push, e.onset, e.angle, e.length, e.R_WB.tolist()) for e in proposed],
                plan,
                controller.models,
            )
        )
    assert found[0] == found[1]
    assert len(found[0][0]) == 20


def test_what_lies_is_not_explored() -> None:
    controller = Controller(seed=0)
    state = controller.look()
    box = state.objects[BOX]
    left = next(rest for rest in box.model.rests if rest.face == "left")
    lying = WorldState({BOX: replace(box, model=left.model, rest=left)})
    executor = controller.executor
    executor.look = lambda *_: lying  # type: ignore[method-assign]
    with pytest.raises(ControlError, match="lies on its left face") as raised:
        explore(executor, controller.models, BOX)
    assert raised.value.code == "not_explorable"
