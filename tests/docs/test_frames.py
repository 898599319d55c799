"""The guide to frames: what it shows is what comes out."""

from __future__ import annotations

import importlib.util
import io
import json
import re
import shlex
from pathlib import Path
from typing import Any, get_args

import pytest

from grammar.frames import vocabulary as words
from grammar.frames.constraints import CONSTRAINTS
from grammar.frames.goals import GOALS
from grammar.parser import default_parser
from nlcontrol.cli import run
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_documents import command_of
from tests.docs.guide_blocks import code_blocks, only_block

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = (DOCS / "frames.md").read_text(encoding="utf-8")
KINDS = GUIDE.partition("\n## Kinds\n")[2]


def command(line: str) -> tuple[list[str], str]:
    """Arguments and standard input of a line of the guide."""
    echoed, _, last = line.rpartition(" | ")
    said = shlex.split(echoed, comments=True)
    return shlex.split(last, comments=True)[1:], said[1] if said else ""


def test_the_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in code_blocks(GUIDE, "bash")[0].splitlines():
        shown, _, target = line.partition(" > ")
        args, said = command(shown)
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(said.encode())))
        assert run(args) == 0
        printed = capsys.readouterr().out
        if target:
            Path(target).write_text(printed)


def test_the_error(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    line, _, shown = code_blocks(GUIDE, "console")[0].removeprefix("$ ").partition("\n")
    args, said = command(line)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(said.encode())))
    assert run(args) == 3
    assert capsys.readouterr().err == shown


def test_the_python(capsys: pytest.CaptureFixture[str]) -> None:
    code = only_block(GUIDE, "python")
    found: dict[str, object] = {}
    exec(code, found)
    assert re.findall(r"print\(.*\)  # (.*)", code) == capsys.readouterr().out.splitlines()
    assert getattr(found["again"], "status") == "planned"  # noqa: B009


# --- the list of kinds -------------------------------------------------------------------------


def test_the_list_is_that_of_the_schema() -> None:
    path = DOCS / "list_frame_kinds.py"
    spec = importlib.util.spec_from_file_location("list_frame_kinds", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.kinds_text() == KINDS, "run docs/list_frame_kinds.py"


def examples() -> list[dict[str, Any]]:
    """The frames of the guide; that of a constraint is put into a push, or a tilt."""
    found = [json.loads(text) for text in re.findall(r"`(\{.*\})`", KINDS)]
    return [frame if "kind" not in frame else _constrained(frame) for frame in found]


def _constrained(clause: dict[str, Any]) -> dict[str, Any]:
    action, goal = ("tilt", "tilt") if clause["kind"] == "no_slide" else ("push", "displace")
    box = {"text": "ice tea box"}
    return {"action": action, "object": box, "goal": {"kind": goal}, "constraints": [clause]}


def test_every_kind_has_an_example_that_makes_sense() -> None:
    frames = [command_of([frame], default_parser()).frames[0] for frame in examples()]
    assert {frame.goal.kind for frame in frames} == set(GOALS)
    assert {clause.kind for frame in frames for clause in frame.constraints} == set(CONSTRAINTS)
    assert {frame.query for frame in frames if frame.query} == set(get_args(words.Query))
    assert {frame.dialogue for frame in frames if frame.dialogue} == set(get_args(words.Dialogue))


REFUSED = {
    "hand_over": "unsupported",
    "duration": "unsupported",
    "undo": "nothing_before",  # what was planned only is not undone
}


@pytest.mark.slow
def test_every_example_is_planned_or_answered() -> None:
    talk = Conversation(Controller("kitchen"))
    for frame in examples():
        result = talk.say([frame], plan_only=True)
        clauses = [frame.get("goal", {}), *frame.get("constraints", ())]
        kinds = [frame.get("dialogue"), *(clause.get("kind") for clause in clauses)]
        codes = [REFUSED[kind] for kind in kinds if kind in REFUSED]
        assert (result.error and [result.error.code]) == (codes or None), frame
