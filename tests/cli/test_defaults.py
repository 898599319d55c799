"""--set, and `defaults`: what words mean, from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nlcontrol.cli import run
from nlcontrol.session.controller import Controller
from planner.types.defaults import DEFAULTS, with_settings
from tests.unit.sim.truth.test_scene_files import SCENE

SENTENCE = "push the crate away"


@pytest.fixture
def scene(tmp_path: Path) -> str:
    """A scene in which "away" means 70 mm."""
    path = tmp_path / "small.yaml"
    path.write_text(SCENE + "defaults: {distance_m: 0.07}\n", encoding="utf-8")
    return str(path)


def _distance(capsys: pytest.CaptureFixture[str], *args: str) -> float:
    assert run(["plan", SENTENCE, "--json", *args]) == 0
    used = json.loads(capsys.readouterr().out)["defaults"]
    return next(float(d["value"]) for d in used if d["name"] == "distance")


def test_the_command_line_stands_over_the_scene(
    capsys: pytest.CaptureFixture[str], scene: str
) -> None:
    assert _distance(capsys, "--scene", scene) == 0.07
    assert _distance(capsys, "--scene", scene, "--set", "distance_m=0.06") == 0.06
    # Of what is said twice the last counts.
    twice = ("--set", "distance_m=0.06", "--set", "distance_m=0.05")
    assert _distance(capsys, "--scene", scene, *twice) == 0.05


def test_what_is_given_in_python_stands_over_the_scene(scene: str) -> None:
    assert Controller(scene).defaults.distance == 0.07
    given = with_settings(DEFAULTS, {"turn_deg": 30})
    assert Controller(scene, defaults=given).defaults == given


@pytest.mark.parametrize(
    "args",
    [
        ["say", SENTENCE, "--plan-only"],
        ["plan", SENTENCE],
        ["shell"],
        ["explore", "crate"],
        ["affordances", "crate"],
        ["defaults"],
    ],
)
def test_every_command_with_a_scene_takes_it(
    capsys: pytest.CaptureFixture[str], args: list[str]
) -> None:
    assert run([*args, "--json", "--set", "distance=0.2"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["code"] == "bad_default"
    assert error["suggestions"] == ["did you mean 'distance_m'?"]


@pytest.mark.parametrize("value", ["distance_m", "distance_m=", "distance_m=far", "=="])
def test_what_is_no_assignment_is_a_usage_error(
    capsys: pytest.CaptureFixture[str], value: str
) -> None:
    assert run(["plan", SENTENCE, "--json", "--set", value]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "usage"


def test_the_list(capsys: pytest.CaptureFixture[str], scene: str) -> None:
    assert run(["defaults", "--scene", scene, "--set", "turn_deg=45", "--json"]) == 0
    listed = {
        each["name"]: each["value"] for each in json.loads(capsys.readouterr().out)["defaults"]
    }
    assert (listed["distance_m"], listed["turn_deg"]) == (0.07, 45.0)
    assert listed["tilt_deg"] == 10.0


@pytest.mark.parametrize(
    ("names", "listed"),
    [
        (("tilt_deg",), {"tilt_deg"}),
        (("tilt_d", "turn_deg"), {"tilt_deg", "turn_deg"}),
        (("pour_l",), {"pour_little_ml", "pour_lot", "pour_least"}),
    ],
)
def test_defaults_by_the_beginning_of_their_names(
    capsys: pytest.CaptureFixture[str], names: tuple[str, ...], listed: set[str]
) -> None:
    assert run(["defaults", *names, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["defaults"]
    assert {each["name"] for each in told} == listed


def test_a_name_of_no_default_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["defaults", "dist_m", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["suggestions"][0]) == ("bad_default", "did you mean 'distance_m'?")
