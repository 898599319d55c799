"""The command line without the simulator: answers, errors, exit codes, one JSON document."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from nlcontrol.cli import run
from nlcontrol.interruption import EXIT_CODES
from nlcontrol.json_document import SCHEMA_VERSION
from nlcontrol.results.result import Result
from planner.types.plan import Plan
from sim.truth.scene_file import built_in_scenes
from tests.cli.json_answer import json_answer

SENTENCE = "push the ice tea box away without toppling it"


def test_parse_answers_with_text_frames_and_paraphrase(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "parse", SENTENCE)
    assert status == 0
    assert list(document) == ["schema_version", "ok", "text", "frames", "paraphrase", "asides"]
    assert document["text"] == SENTENCE
    (frame,) = document["frames"]
    assert frame["action"] == "push"
    assert [SENTENCE[a:b] for a, b in frame["object"]["spans"]] == ["ice tea box"]


def test_a_sentence_needs_no_quotes(capsys: pytest.CaptureFixture[str]) -> None:
    quoted = json_answer(capsys, "parse", SENTENCE)
    assert json_answer(capsys, "parse", *SENTENCE.split()) == quoted


def test_what_is_put_on_the_table_can_be_spoken_of(capsys: pytest.CaptureFixture[str]) -> None:
    sentence = "push the jar 5 cm to the right"
    assert run(["plan", sentence]) == 3
    assert "not_on_table" in capsys.readouterr().out
    status, document = json_answer(capsys, "plan", sentence, "--put", "jar@0.45,0.18,30")
    assert status == 0
    # The mean of 30 frames with 2 mm of noise each: eight deviations.
    assert document["steps"][0]["before"]["y"] == pytest.approx(0.18, abs=0.003)


def test_parse_as_text_quotes_the_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["parse", SENTENCE]) == 0
    out = capsys.readouterr().out
    assert "I understood: " in out
    assert "“without toppling it”" in out


def test_parse_as_text_shows_what_has_no_effect(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["parse", "please push the mug away, thanks"]) == 0
    assert "left out: “please”, “thanks”" in capsys.readouterr().out


def test_steps_of_a_sequence_are_numbered(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["parse", "push the ice tea box and the mug away, then topple it"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("I understood: push the ice tea box away, then push the mug away")
    numbers = [lines.index(number) for number in ("1.", "2.", "3.")]
    assert numbers == sorted(numbers)
    assert [lines[at + 1] for at in numbers] == [
        "  action: push  “push”", "  action: push  “push”", "  action: topple  “topple”",
    ]  # fmt: skip


def test_a_single_step_has_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["parse", SENTENCE]) == 0
    assert "1." not in capsys.readouterr().out.splitlines()


def _bare(value: Any) -> Any:
    """Frames without the places of the words, which made up sentences do not know."""
    if isinstance(value, dict):
        return {key: _bare(part) for key, part in value.items() if key != "spans"}
    return [_bare(part) for part in value] if isinstance(value, list) else value


def test_samples_mean_their_frames(capsys: pytest.CaptureFixture[str]) -> None:
    status, made = json_answer(capsys, "sample", "--seed", "1", "--count", "5")
    assert (status, len(made["sentences"])) == (0, 5)
    for one in made["sentences"]:
        status, document = json_answer(capsys, "parse", one["text"])
        assert status == 0
        assert _bare(document["frames"]) == _bare(one["frames"]), one["text"]


def test_samples_follow_from_their_seed_and_speak_of_the_nouns(
    capsys: pytest.CaptureFixture[str],
) -> None:
    args = ["sample", "--count", "20", "--noun", "zither", "--seed"]
    told = []
    for seed in ("1", "1", "2"):
        assert run([*args, seed]) == 0
        told.append(capsys.readouterr().out)
    assert told[0] == told[1] != told[2]
    assert len(told[0].splitlines()) == 20
    assert "zither" in told[0]
    assert "mug" not in told[0]


NOT_UNDERSTOOD = {
    "empty": "",
    "blank": "   ",
    "long": "push " + "x" * 10_000,
    "emoji": "push the 📦 away",
    "control": "push the box\x07 away",
    "surrogate": "push the \udcff away",
    "verb": "frobnicate the ice tea box",
    "two objects fit": "push the box away",
    "unknown object": "push the elephant away",
    "no object": "push away",
}


@pytest.mark.parametrize("command", ["plan", "say"])
@pytest.mark.parametrize("sentence", NOT_UNDERSTOOD.values(), ids=NOT_UNDERSTOOD.keys())
def test_what_is_not_understood(
    capsys: pytest.CaptureFixture[str], command: str, sentence: str
) -> None:
    status, document = json_answer(capsys, command, sentence)
    assert status == 3
    result = Result.model_validate(document)
    assert result.status == "not_understood"
    assert not result.ok
    assert result.error is not None
    assert result.error.message
    assert result.error.code != "internal"


@pytest.mark.parametrize("sentence", NOT_UNDERSTOOD.values(), ids=NOT_UNDERSTOOD.keys())
def test_errors_as_text_go_to_standard_error(
    capsys: pytest.CaptureFixture[str], sentence: str
) -> None:
    assert run(["plan", sentence]) == 3
    told = capsys.readouterr()
    assert "Traceback" not in told.out + told.err
    assert "(" in told.out + told.err


def test_a_misspelled_object_gets_a_suggestion(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "plan", "push the iced tee box away")
    assert status == 3
    assert document["error"]["code"] == "unknown_object"
    assert document["error"]["suggestions"] == ["did you mean 'ice tea box'?"]
    start, end = document["error"]["span"]
    assert "push the iced tee box away"[start:end] == "iced tee box"


def test_plan_answers_with_a_valid_result(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "plan", SENTENCE, "--seed", "3")
    assert status == 0
    result = Result.model_validate(document)
    assert (result.ok, result.status, result.seed) == (True, "planned", 3)
    assert isinstance(result.plan, Plan)
    assert result.plan.push.prediction.outcome == "slide"
    assert result.frames[0].object is not None
    assert result.frames[0].object.id == "ice tea box"
    assert result.execution is None


def test_plan_as_text_says_where_how_hard_and_why(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", SENTENCE]) == 0
    out = capsys.readouterr().out
    for part in ("I understood: ", "by default: distance 100 mm", " N at ", "above the table"):
        assert part in out
    assert "Why that is safe: the contact is " in out


def test_plan_and_parse_load_nothing_that_they_do_not_need() -> None:
    code = (
        "import sys; from nlcontrol.cli import run\n"
        f"assert run(['parse', {SENTENCE!r}]) == 0\n"
        f"assert run(['plan', {SENTENCE!r}, '--json']) == 0\n"
        "heavy = {'pydrake', 'matplotlib', 'scipy', 'rich', 'rapidfuzz', 'numpy.ma',\n"
        "    'planner.grasping', 'sim.control.plan_execution', 'nlcontrol.learning.lessons',\n"
        "    'nlcontrol.cli.commands.map_command'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_same_seed_gives_the_same_plan(capsys: pytest.CaptureFixture[str]) -> None:
    first = json_answer(capsys, "plan", SENTENCE, "--seed", "5")
    assert json_answer(capsys, "plan", SENTENCE, "--seed", "5") == first


def test_a_push_at_the_top_is_refused_with_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(
        capsys, "plan", "push the ice tea box at the top without toppling it"
    )
    assert status == 4
    assert document["status"] == "refused"
    numbers = document["error"]["numbers"]
    # h* = b/μ = 0.045/0.378, and the upper third of 0.23 m.
    assert any(value == pytest.approx(0.119, abs=0.001) for value in numbers.values())
    assert any(value == pytest.approx(0.153, abs=0.001) for value in numbers.values())
    assert "119 mm" in document["error"]["message"]
    assert "153 mm" in document["error"]["message"]


def test_a_hand_that_this_robot_lacks(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "plan", "push the ice tea box away with your left hand")
    assert status == 4
    assert document["status"] == "unsupported"
    assert "hand" in document["error"]["capability"]


@pytest.mark.parametrize(
    "args",
    [
        ["plan"],
        ["nonsense"],
        ["plan", SENTENCE, "--nonsense"],
        ["plan", SENTENCE, "--seed", "-1"],
        ["say", SENTENCE, "--plan-only", "--replay", "x.html"],
        ["say", SENTENCE, "--replay", "no/such/folder/x.html"],
        ["plan", SENTENCE, "--scene", "kichen"],
        ["plan", SENTENCE, "--scene", "no_such_file.yaml"],
        ["plan", SENTENCE, "--put", "jar"],
        ["plan", SENTENCE, "--put", "jar@here"],
        ["plan", SENTENCE, "--put", "jar@nan,0"],
        ["plan", SENTENCE, "--put", "jar@0.45,0"],
        ["plan", SENTENCE, "--put", "jar@3,0"],
        ["plan", "--put", "jar@0.45,0.18", "--frames", "x.json", "push", "the", "jar"],
    ],
    ids=" ".join,
)
def test_usage_errors(capsys: pytest.CaptureFixture[str], args: list[str]) -> None:
    status, document = json_answer(capsys, *args)
    assert status == 2
    assert document["ok"] is False
    assert document["error"]["message"]
    assert run(args) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err
    assert "Traceback" not in told.err


def test_a_defect_becomes_one_document_and_exit_1(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr("nlcontrol.session.controller.Controller.plan", broken)
    status, document = json_answer(capsys, "plan", SENTENCE)
    assert status == 1
    assert document["error"]["code"] == "internal"
    assert "ZeroDivisionError: by zero" in document["error"]["message"]
    assert run(["plan", SENTENCE]) == 1
    assert "Traceback" not in capsys.readouterr().err
    monkeypatch.setenv("NLCONTROL_DEBUG", "1")
    assert run(["plan", SENTENCE]) == 1
    assert "Traceback" in capsys.readouterr().err


def test_control_c_is_no_defect(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("nlcontrol.session.controller.Controller.plan", interrupted)
    assert run(["plan", SENTENCE]) == EXIT_CODES[signal.SIGINT]
    assert "interrupted" in capsys.readouterr().err


def test_objects_list_and_show(capsys: pytest.CaptureFixture[str]) -> None:
    status, models = json_answer(capsys, "objects", "list")
    assert status == 0
    assert {"ice tea box", "cereal box", "coffee box"} <= {m["name"] for m in models["objects"]}
    status, model = json_answer(capsys, "objects", "show", "ice tea box")
    assert status == 0
    assert model["name"] == "ice tea box"
    assert run(["objects", "list"]) == 0
    assert run(["objects", "show", "ice tea box"]) == 0
    out = capsys.readouterr().out
    assert "above 119 mm" in out


def test_an_unknown_model_gets_a_suggestion(
    capsys: pytest.CaptureFixture[str],
) -> None:
    status, document = json_answer(capsys, "objects", "show", "ice tee box")
    assert status == 3
    assert "ice tea box" in json.dumps(document["error"])


def test_doctor_finds_the_essentials(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "doctor")
    assert status == 0
    assert document["ok"]
    assert {"Python", "packages", "Drake", "object models", "scenes", "grammar"} <= {
        f["name"] for f in document["findings"] if f["ok"]
    }
    assert run(["doctor"]) == 0
    assert "All essentials are there." in capsys.readouterr().out


@pytest.mark.slow
def test_doctor_carries_out_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    status, document = json_answer(capsys, "doctor", "--run")
    (found,) = [f for f in document["findings"] if f["name"] == "simulation"]
    assert (status, found["ok"]) == (0, True)


def test_alone_it_greets_with_commands_that_work(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 0
    told = capsys.readouterr().out
    commands = [line for line in told.splitlines() if line.startswith("  nlcontrol ")]
    assert len(commands) == 3
    sentences = re.findall(r'"([^"]+)"', told)
    assert [run(["parse", sentence]) for sentence in sentences] == [0, 0]


def test_scenes_are_listed_and_shown(capsys: pytest.CaptureFixture[str]) -> None:
    _, document = json_answer(capsys, "scenes", "list")
    assert [scene["name"] for scene in document["scenes"]] == list(built_in_scenes())
    status, shown = json_answer(capsys, "scenes", "show", "pantry")
    assert (status, shown["objects"]) == (0, document["scenes"][3]["objects"])
    # Where things stand is shown, and not how they really are.
    assert set(shown["objects"][0]) == {"name", "model", "synonyms", "fragile", "fixed", "pose"}
    assert run(["scenes", "show"]) == 0
    assert "ice tea box      x   450  y     0 mm  turned by    1.5°" in capsys.readouterr().out
    assert run(["scenes", "show", "kitschen"]) == 2


def test_a_scene_of_ones_own_is_written_and_planned_in(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    first, second = str(tmp_path / "my.yaml"), str(tmp_path / "below" / "k.yaml")
    (tmp_path / "below").mkdir()
    assert json_answer(capsys, "scenes", "new", first)[0] == 0
    put = ("--put", "jar@0.45,0.18,30")
    status, document = json_answer(capsys, "scenes", "new", second, "--extends", first, *put)
    assert (status, document["file"]) == (0, second)
    _, shown = json_answer(capsys, "scenes", "show", second)
    assert [item["name"] for item in shown["objects"]] == ["ice tea box", "jar"]
    pose = {"x_m": 0.45, "y_m": 0.18, "yaw_deg": 30.0}
    assert shown["objects"][1]["pose"].items() >= pose.items()
    status, planned = json_answer(capsys, "plan", "push the jar away", "--scene", second)
    assert (status, planned["plan"]["object"]) == (0, "jar")


@pytest.mark.parametrize(
    "args", [["my.yaml"], ["mine"], ["no/folder/x.yaml"], ["x.yaml", "--put", "jar@0,5"],
             ["x.yaml", "--extends", "kichen.yaml"]],
)  # fmt: skip
def test_a_scene_that_cannot_be_written_leaves_no_file(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    args: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.yaml").write_text("mine")
    status, document = json_answer(capsys, "scenes", "new", *args)
    assert (status, bool(document["error"]["suggestions"])) == (2, True)
    assert [file.name for file in tmp_path.iterdir()] == ["my.yaml"]
    assert (tmp_path / "my.yaml").read_text() == "mine"


# A minus that belongs to no number: "-0 mm", "-0.0", but not "-0.3" or "2026-01-02".
MINUS_ZERO = re.compile(r"(?<![\w.])-0(\.0+)?(?![\w.]*\d)")


def test_nothing_is_minus_nought(capsys: pytest.CaptureFixture[str]) -> None:
    """All objects, scenes and figures that are told without a plan, some 250 rows."""
    assert MINUS_ZERO.search("y -0 mm")
    assert not MINUS_ZERO.search("-0.03 m")
    for model in json_answer(capsys, "objects", "list")[1]["objects"]:
        assert run(["objects", "show", model["name"]]) == 0
    for name in ("ice tea box", "mug", "jar"):
        assert run(["map", name, "--spacing", "30"]) == 0
    for scene in built_in_scenes():
        assert run(["scenes", "show", scene]) == 0
        assert run(["plan", "what is on the table?", "--scene", scene]) == 0
    assert run(["objects", "list"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert len(told) > 220
    assert [line for line in told if MINUS_ZERO.search(line)] == []


def test_doctor_fails_if_an_essential_is_missing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken() -> str:
        raise RuntimeError("no models")

    monkeypatch.setattr("nlcontrol.cli.commands.doctor_command._use_registry", broken)
    status, document = json_answer(capsys, "doctor")
    assert status == 1
    assert not document["ok"]


@pytest.mark.parametrize(
    "args",
    [
        ("parse", "push the ice tea box away"),
        ("parse", "frobnicate the ice tea box"),
        ("plan", "push the ice tea box away"),
        ("plan", "push the piano away"),
        ("predict", "ice tea box", "--at", "0,0.05"),
        ("map", "coffee box", "--spacing", "40"),
        ("map", "piano"),
        ("objects", "list"),
        ("objects", "show", "ice tea box"),
        ("objects", "show", "piano"),
        ("defaults",),
        ("sample", "--count", "2"),
        ("schema",),
        ("say",),
    ],
)
def test_every_document_bears_a_version_and_whether_all_went_well(
    capsys: pytest.CaptureFixture[str], args: tuple[str, ...]
) -> None:
    status = run(list(args) if args == ("schema",) else [*args, "--json"])
    document = json.loads(capsys.readouterr().out)
    assert list(document)[:2] == ["schema_version", "ok"]
    assert document["schema_version"] == SCHEMA_VERSION
    assert document["ok"] is (status == 0)
    assert document["ok"] is not bool(document.get("error"))


@pytest.mark.parametrize("version", ["2.0", "4.1"])
def test_a_saved_result_of_another_major_version_is_refused_with_both(
    capsys: pytest.CaptureFixture[str], version: str
) -> None:
    _, document = json_answer(capsys, "plan", "push the piano away")
    assert Result.model_validate(document).schema_version == SCHEMA_VERSION
    with pytest.raises(ValidationError, match=f"version {version}; .* version {SCHEMA_VERSION}"):
        Result.model_validate(document | {"schema_version": version})


def test_schema_is_one_document(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["schema"]) == 0
    assert "$defs" in json.loads(capsys.readouterr().out)


def test_explanation_as_table_json_and_drawing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(["plan", SENTENCE, "--explain"]) == 0
    out = capsys.readouterr().out
    for words in ("push", "ice tea box", "away", "without toppling it"):
        assert words in out.split("From the words to the controller")[1]
    picture = tmp_path / "words.png"
    status, document = json_answer(capsys, "plan", SENTENCE, "--explain", "--picture", str(picture))
    assert status == 0
    assert document["files"] == {"picture": str(picture)}
    assert {row["words"] for row in document["explanation"]} >= {"away", "without toppling it"}
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert [p.name for p in tmp_path.iterdir()] == ["words.png"]


def test_what_is_not_planned_is_explained_too(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    picture = tmp_path / "words.png"
    sentence = "push the ice tea box at the top without toppling it"
    status, document = json_answer(capsys, "plan", sentence, "--explain", "--picture", str(picture))
    assert (status, document["status"]) == (4, "refused")
    (marked,) = [row for row in document["explanation"] if row["problem"]]
    assert marked["words"] == "at the top"
    assert "153 mm" in marked["value"]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_picture_of_a_question_of_places_needs_no_explanation(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    picture = tmp_path / "map.png"
    question = "where can I push the ice tea box without toppling it?"
    status, document = json_answer(capsys, "plan", question, "--picture", str(picture))
    assert (status, document["files"]) == (0, {"picture": str(picture)})
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_an_unknown_picture_format_is_a_usage_error(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    picture = tmp_path / "words.doc"
    status, document = json_answer(capsys, "plan", SENTENCE, "--explain", "--picture", str(picture))
    assert status == 2
    assert document["error"]["code"] == "cannot_write"
    assert not list(tmp_path.iterdir())
