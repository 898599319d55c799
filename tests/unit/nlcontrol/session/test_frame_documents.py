"""Frames in place of sentences: they are planned alike, and refused with their place."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from grammar import Frame, parse
from grammar.frames.command import Displace, ObjectRef
from grammar.frames.constraints import CONSTRAINTS, EXCLUSIVE, FORBIDS
from grammar.frames.goals import GOALS
from nlcontrol import Result
from nlcontrol.cli import run
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_documents import Frames
from nlcontrol.session.remarks.undo_frames import UndoEntry

BOX: dict[str, Any] = {"text": "ice tea box"}
SHOVE: dict[str, Any] = {"action": "push", "object": BOX, "goal": {"kind": "displace"}}


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


def planned(controller: Controller, frames: Frames) -> Result:
    return Conversation(controller).say(frames, plan_only=True)


def pushed(*constraints: dict[str, Any], **goal: Any) -> list[dict[str, Any]]:
    goal = {"kind": "displace", **goal}
    return [{**SHOVE, "goal": goal, "constraints": list(constraints)}]


@pytest.mark.parametrize(
    "sentence",
    [
        "gently push the ice tea box 20 cm to the left without toppling it",
        "turn the coffee box a quarter turn",
        "push the coffee box 3 cm to the right, then push it away",
        "push the mug two box widths away",
        "how hard must I push the coffee box to make it tip?",
        "push the wide blue jug to the mug",
    ],
)
def test_frames_are_planned_as_their_sentence(kitchen: Controller, sentence: str) -> None:
    said = Conversation(kitchen).say(sentence, plan_only=True)
    done = planned(kitchen, json.loads(kitchen.parse(sentence).model_dump_json()))
    assert done.to_json() == said.to_json()


def test_without_a_text_the_paraphrase_is_shown(kitchen: Controller) -> None:
    command = parse("please push the mug over to the left")
    done = planned(kitchen, command.frames)
    assert done.text == done.paraphrase == "push the mug to the left"
    assert all(frame.spans == frame.goal.spans == () for frame in done.frames)


def test_an_id_is_honoured(kitchen: Controller) -> None:
    done = planned(kitchen, [{**SHOVE, "object": {"text": "my favourite thing", "id": "mug"}}])
    assert (done.status, done.plan and done.plan.object) == ("planned", "mug")
    length = {"value": 2.0, "side": "width", "of": {"text": "its", "id": "mug", "pronoun": True}}
    of_mug, of_box = (
        planned(kitchen, pushed(distance={**length, "of": of})).frames[0].goal
        for of in (length["of"], {"text": "its", "pronoun": True})
    )
    assert of_mug != of_box
    unknown = planned(kitchen, [{**SHOVE, "object": {"text": "mug", "id": "cofee box"}}])
    assert unknown.error
    assert unknown.error.code == "unknown_object"
    assert unknown.error.suggestions == ("did you mean 'coffee box'?",)


def test_frames_take_part_in_a_conversation(kitchen: Controller) -> None:
    talk = Conversation(kitchen)
    talk.say("push the mug 10 cm to the left", plan_only=True)
    it = {"text": "it", "pronoun": True}
    right = {"kind": "displace", "direction": "right"}
    talk.say([{"action": "push", "object": it, "goal": right}], plan_only=True)
    again = talk.say([{"dialogue": "repeat"}], plan_only=True)
    assert again.paraphrase == "push the mug to the right"
    corrected = talk.say([{"dialogue": "correct", "object": BOX}], plan_only=True)
    assert corrected.plan
    assert corrected.plan.object == "ice tea box"
    why = talk.say([{"query": "why"}])
    assert (why.status, why.plan) == ("answered", None)
    assert talk.say([{"dialogue": "stop"}]).status == "done"


def test_what_frames_did_is_undone(kitchen: Controller) -> None:
    talk = Conversation(kitchen)
    here = kitchen.look().objects["mug"].pose
    done = planned(kitchen, [{**SHOVE, "object": {"text": "mug"}}])
    there = type(here)(here.x - 0.1, here.y, here.yaw)
    talk.past.append(UndoEntry(done, "mug", there))
    back = talk.say([{"dialogue": "undo"}], plan_only=True)
    assert back.status == "planned"
    assert isinstance(back.frames[0].goal, Displace)
    assert back.frames[0].goal.distance == pytest.approx(0.1, abs=1e-6)


def code_and_path(result: Result) -> tuple[str, str | None]:
    assert result.status == "not_understood"
    assert result.error
    assert result.error.suggestions
    return result.error.code, result.error.path


@pytest.mark.parametrize(
    ("frames", "path", "hint"),
    [
        ([], "frames", None),
        ({"frame": [SHOVE]}, "frame", "did you mean 'frames'?"),
        ([{**SHOVE, "action": "psh"}], "frames[0].action", "did you mean 'push'?"),
        ([SHOVE, {**SHOVE, "goal": {"kind": "displce"}}], "frames[1].goal.kind",
         "did you mean 'displace'?"),
        (pushed(distnce=0.1), "frames[0].goal.distnce", "did you mean 'distance'?"),
        (pushed(distance={"value": 2, "of": BOX, "sid": "width"}), "frames[0].goal.distance.sid",
         "did you mean 'side'?"),
        (pushed(distance="far"), "frames[0].goal.distance", None),
        (pushed({"kind": "contact", "height": {"valu": 0.1, "from": "top"}}),
         "frames[0].constraints[0].height.valu", "did you mean 'value'?"),
        (pushed({"kind": "max_force"}), "frames[0].constraints[0].value", None),
        (pushed(bound="at_most"), "frames[0].goal.bound", "leave out frames[0].goal.bound"),
        ([{"action": "push", "goal": {"kind": "displace"}}], "frames[0]", None),
        ([{**SHOVE, "action": "lift"}], "frames[0]", None),
        ([{**SHOVE, "object": {"text": "mug", "pronoun": True}}], "frames[0].object.pronoun",
         "leave out frames[0].object.pronoun"),
        ({"frames": [{**SHOVE, "spans": [[0, 9]]}], "text": "push"}, "frames[0]", None),
        ({"frames": [SHOVE], "schema_version": "1.0"}, "schema_version", None),
    ],
)  # fmt: skip
def test_what_is_no_frame(kitchen: Controller, frames: Frames, path: str, hint: str | None) -> None:
    result = planned(kitchen, frames)
    assert code_and_path(result) == ("bad_frame", path)
    assert result.error
    assert hint is None or result.error.suggestions == (hint,)


@pytest.mark.parametrize(
    ("frames", "code", "path"),
    [
        (pushed(distance=20.0), "impossible_quantity", "frames[0].goal.distance"),
        (pushed({"kind": "force", "value": 1001.0}), "impossible_quantity",
         "frames[0].constraints[0]"),
        (pushed(direction="left", heading=0.5), "contradiction", "frames[0].goal.heading"),
        (pushed(toward={"text": "mug"}, distance=0.1, fraction=0.5), "said_twice",
         "frames[0].goal.fraction"),
        (pushed(distance=0.1, amount="lot"), "said_twice", "frames[0].goal.amount"),
        (pushed(fraction=0.5), "does_not_apply", "frames[0].goal.fraction"),
        ([SHOVE, {"query": "why", "action": "push", "object": BOX}], "unsupported_question",
         "frames[1].query"),
    ],
)  # fmt: skip
def test_what_no_sentence_may_say_no_frame_may(
    kitchen: Controller, frames: Frames, code: str, path: str
) -> None:
    assert code_and_path(planned(kitchen, frames)) == (code, path)


def values_of(kind: str) -> dict[str, Any]:
    fields = {"effector": {"tool": "hand"}, "until": {"event": "moves"}}
    return fields.get(kind, {"value": 1.0} if CONSTRAINTS[kind].words.unit else {})


@pytest.mark.parametrize(("first", "second"), sorted(EXCLUSIVE))
def test_clauses_that_exclude_each_other(kitchen: Controller, first: str, second: str) -> None:
    one, other = ({"kind": kind, **values_of(kind)} for kind in (first, second))
    other |= {"effector": {"tool": "arm"}, "until": {"event": "tips"}}.get(
        second, {"value": 2.0} if "value" in other else {}
    )
    assert code_and_path(planned(kitchen, pushed(one, other))) == (
        "contradiction",
        "frames[0].constraints[1]",
    )


@pytest.mark.parametrize("kind", sorted(FORBIDS))
def test_clauses_that_forbid_the_goal(kitchen: Controller, kind: str) -> None:
    goal: dict[str, Any] = {"kind": kind}
    if kind == "place":
        goal |= {"relation": "next_to", "reference": [{"text": "mug"}]}
    action = "push" if kind in ("displace", "place") else next(iter(GOALS[kind].words.verbs))
    for forbidden in sorted(FORBIDS[kind]):
        clause = {"kind": forbidden, **values_of(forbidden)}
        frame = {"action": action, "object": BOX, "goal": goal, "constraints": [clause]}
        code, path = code_and_path(planned(kitchen, [frame]))
        assert (code, path) == ("contradiction", "frames[0].constraints[0]")


def test_frames_of_a_program(kitchen: Controller) -> None:
    frame = Frame(action="push", object=ObjectRef(text="mug"), goal=Displace(direction="left"))
    assert planned(kitchen, [frame]).paraphrase == "push the mug to the left"
    assert planned(kitchen, parse("push it")).text == "push it"


def test_frames_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "frames.json"
    file.write_text(json.dumps(pushed(direction="left")))
    assert run(["parse", "--frames", str(file), "--json"]) == 0
    parsed = capsys.readouterr().out
    assert json.loads(parsed)["paraphrase"] == "push the ice tea box to the left"
    file.write_text(parsed)
    assert run(["plan", "--frames", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["plan"]["object"] == "ice tea box"
    assert run(["plan", "--frames", str(file), "push the mug"]) == 2
    assert run(["plan"]) == 2
    capsys.readouterr()
    for content in ("{", "[[]]"):
        file.write_text(content)
        with file.open() as stdin:
            monkeypatch.setattr("sys.stdin", stdin)
            assert run(["parse", "--frames", "-", "--json"]) == 3
        assert json.loads(capsys.readouterr().out)["error"]["code"] == "bad_frame"
