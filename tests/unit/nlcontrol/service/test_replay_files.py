"""The replay of a stored run tells its sentence and verdicts, from its result as JSON."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from nlcontrol.service.workers.session_host import write_view
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim import load_scene
from tests.fakes.pushed_trace import pushed_trace


@pytest.mark.parametrize("known", [True, False], ids=["with its result", "without one"])
def test_a_replay_tells_what_is_known_of_its_run(tmp_path: Path, known: bool) -> None:
    trace, page = tmp_path / "trace.npz", tmp_path / "replay.html"
    pushed_trace(load_scene("kitchen"), "coffee box").save(trace)
    said = "push the coffee box away <b>gently</b>" if known else ""
    result = Conversation(Controller(seed=0)).say("push the coffee box away", plan_only=True)
    result = result.model_copy(update={"text": said})
    told = result.model_dump_json() if known else None
    write_view("replay", str(trace), "kitchen", str(page), told)
    title = "push the coffee box away &lt;b&gt;gently&lt;/b&gt;" if known else "A run with the"
    assert f"<title>{title}" in page.read_text("utf-8")


def test_a_recording_is_what_the_replay_shows(tmp_path: Path) -> None:
    trace, page = tmp_path / "trace.npz", tmp_path / "recording.json.gz"
    pushed_trace(load_scene("kitchen"), "coffee box").save(trace)
    write_view("recording", str(trace), "kitchen", str(page), None)
    told = json.loads(gzip.decompress(page.read_bytes()))
    assert set(told) == {"scene", "recording", "story"}
    pushed = told["scene"]["bodies"][told["recording"]["pushed"]]
    assert pushed["object"] == "coffee box"
    assert told["story"]["title"].endswith("coffee box")
