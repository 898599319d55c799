"""A bundle repeats its run, tells what came out otherwise, and harms nobody who reads it."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.bundle import (
    bundle_run,
    read_bundle,
    report_lines,
    rerun,
    result_differences,
    run_request,
    trace_differences,
    version_differences,
)
from nlcontrol.service.documents import RunInfo, SessionSpec
from nlcontrol.service.run_store import RunStore, bundle_file
from nlcontrol.service.session import Session
from nlcontrol.session import recipe as recipes
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels.files import yaml_documents
from sim.traces.trace import ContactEvent, Trace

N = 20


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundle of a sentence that was said after two others, and moves nothing."""
    path = tmp_path_factory.mktemp("bundle") / "run.zip"
    controller = Controller(seed=3)
    conversation = Conversation(controller)
    conversation.say("push the mug 2 cm to the left", plan_only=True)
    bundle_run(controller, conversation.say("where is it?"), path)
    return path


def changed(bundle: Path, path: Path, name: str, change: Callable[[Any], object]) -> Path:
    """A copy of a bundle with one of its documents changed."""
    with zipfile.ZipFile(bundle) as old, zipfile.ZipFile(path, "w") as new:
        for each in old.infolist():
            content = old.read(each)
            if each.filename == name:
                document = json.loads(content)
                change(document)
                content = json.dumps(document).encode()
            new.writestr(each.filename, content)
    return path


def test_a_run_is_repeated_to_the_digit(bundle: Path) -> None:
    report = rerun(read_bundle(bundle))
    assert report.ok
    assert (report.differences, report.found, report.error) == ((), 0, None)
    assert report.text == "where is it?"


def test_another_seed_is_told(bundle: Path, tmp_path: Path) -> None:
    def change(document: Any) -> None:
        document["recipe"]["seed"] = 4
        document["versions"]["numpy"] = "0.9\x1b[2J"

    report = rerun(read_bundle(changed(bundle, tmp_path / "b.zip", "request.json", change)))
    assert not report.ok
    assert report.error is not None
    assert report.error.code == "run_differs"
    found = {each.place: each for each in report.differences}
    assert found["numpy"].recorded == "0.9\\x1b[2J"
    assert (found["seed"].recorded, found["seed"].repeated) == ("3", "4")
    numbers = [d.largest for place, d in found.items() if place.startswith("answer.numbers")]
    assert numbers
    assert all(number is not None and 0.0 < number < 0.01 for number in numbers)
    assert report.found == len(report.differences) - 1
    assert all(line.isprintable() for line in report_lines(report))


def test_a_run_without_a_recipe_is_not_repeatable(tmp_path: Path) -> None:
    controller = Controller()
    controller.watch("mug")
    result = Conversation(controller).say("where is the mug?")
    bundle_run(controller, result, tmp_path / "b.zip")
    found = read_bundle(tmp_path / "b.zip")
    assert found.request.recipe is None
    with pytest.raises(ControlError) as raised:
        rerun(found)
    assert raised.value.code == "not_repeatable"


def test_too_many_deeds_have_no_recipe(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recipes, "MOST_DEEDS", 3)
    controller = Controller()
    for _ in range(3):
        result = Conversation(controller).say("where is the mug?")
    assert run_request(controller, result).why_not is None
    for _ in range(3):
        Conversation(controller).say("where is the mug?")
    assert len(controller.journal.deeds) == 3
    assert "more than 3" in (run_request(controller, result).why_not or "")


# --- comparison ---------------------------------------------------------------------------------


def trace(**changes: Any) -> Trace:
    poses = np.column_stack([np.ones(N), np.zeros((N, 6))])
    made = Trace(
        time=np.arange(N) / 10.0, phase=np.array(["push"] * N), poses={"mug": poses},
        seen={"mug": poses}, joints=np.zeros((N, 2)), joint_names=("a", "b"),
        tips={"ring": np.zeros((N, 3))}, felt={"ring": np.zeros((N, 3))},
        force_limit=np.full(N, 5.0), contacts=(ContactEvent(1.0, "ring", "mug"),), pushed="mug",
        direction=np.array([1.0, 0.0, 0.0]), end="stroke", detail="", seed=0,
    )  # fmt: skip
    return replace(made, **changes)


def test_traces_differ_by_so_much_from_then_on() -> None:
    assert list(trace_differences(trace(), trace())) == []
    assert list(trace_differences(None, None)) == []
    poses = trace().poses["mug"].copy()
    poses[7:, 5] += np.linspace(1e-15, 0.002, N - 7)
    (moved,) = trace_differences(trace(), trace(poses={"mug": poses}))
    assert (moved.place, moved.unit, moved.begins) == ("poses/mug (place)", "m", 0.7)
    assert moved.largest == pytest.approx(0.002)
    (ended,) = trace_differences(trace(), trace(end="guard"))
    assert (ended.place, ended.recorded, ended.repeated) == ("end", "stroke", "guard")
    (phase,) = trace_differences(trace(), trace(phase=np.array(["push"] * (N - 1) + ["settle"])))
    assert (phase.begins, phase.repeated) == (1.9, "settle")
    (missing,) = trace_differences(trace(), trace(poses={}))
    assert (missing.place, missing.repeated) == ("poses/mug", None)
    (none,) = trace_differences(trace(), None)
    assert (none.recorded, none.repeated) == ("20 samples", None)
    broken = trace(force_limit=np.full(N, np.nan))
    (nan,) = trace_differences(broken, trace())
    assert (nan.largest, nan.begins) == (None, 0.0)


def test_traces_of_unlike_lengths_are_compared_as_far_as_both_go() -> None:
    longer = trace(time=np.arange(N + 5) / 10.0, force_limit=np.full(N + 5, 6.0))
    found = list(trace_differences(trace(), longer))
    shapes, force = (each for each in found if each.place == "force_limit")
    assert (shapes.recorded, shapes.repeated) == ("shape (20,)", "shape (25,)")
    assert (force.largest, force.unit, force.begins) == (1.0, "N", 0.0)
    assert [each.place for each in found if each.place == "time"] == ["time"]


def test_results_and_versions_differ_by_field() -> None:
    recorded = {"a": [1, 2.0, {"b": "x"}], "c": None, "files": {"trace": "here"}, "d": 10**400}
    repeated = {"a": [1, 2.5, {"b": "y"}, 3], "c": True, "e": 1, "d": 0.5}
    found = {each.place: each for each in result_differences(recorded, repeated)}
    assert list(found) == ["a", "a[1]", "a[2].b", "c", "d", "e"]
    assert found["a[1]"].largest == 0.5
    assert found["d"].largest is None
    assert (found["c"].recorded, found["c"].repeated) == (None, "True")
    (other,) = version_differences({"numpy": "1", "drake": "2"}, {"numpy": "1", "drake": "3"})
    assert (other.place, other.recorded, other.repeated) == ("drake", "2", "3")


# --- hostile files ------------------------------------------------------------------------------


def zipped(*members: tuple[str, bytes]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in members:
            made.writestr(name, content)
    return file.getvalue()


def pickled() -> bytes:
    file = io.BytesIO()
    np.savez(file, allow_pickle=True, time=np.array([{}], dtype=object))
    return file.getvalue()


HOSTILE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda good: b"",
    "no zip": lambda good: b"PK\x03\x04 and nothing more",
    "cut": lambda good: good[: len(good) // 2],
    "broken": lambda good: good[:200] + bytes(100) + good[300:],
    "other members": lambda good: zipped(("../../request.json", b"{}")),
    "no JSON": lambda good: zipped(("request.json", b"{"), ("result.json", b"{}")),
    "deep JSON": lambda good: _with(good, "result.json", b"[" * 200_000),
    "a list": lambda good: _with(good, "result.json", b"[]"),
    "another version": lambda good: _with(good, "result.json", b'{"schema_version": "9.0"}'),
    "a bomb": lambda good: _with(good, "request.json", b" " * 3_000_000),
    "many members": lambda good: zipped(*((f"{n}", b"") for n in range(2000))),
    "a pickle": lambda good: _with(good, "trace.npz", pickled()),
    "no trace": lambda good: _with(good, "trace.npz", b"trace"),
}


def _with(good: bytes, name: str, content: bytes) -> bytes:
    with zipfile.ZipFile(io.BytesIO(good)) as old:
        kept = [(n, old.read(n)) for n in old.namelist() if n != name]
    return zipped(*kept, (name, content))


@pytest.mark.parametrize("kind", HOSTILE)
def test_what_is_no_bundle_is_refused(
    kind: str, bundle: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = yaml_documents.LIMITS["bundle_part"]._replace(most=2_000_000)
    monkeypatch.setattr(
        "nlcontrol.service.bundle.LIMITS",
        {**yaml_documents.LIMITS, "bundle_part": small},
    )
    path = tmp_path / "b.zip"
    path.write_bytes(HOSTILE[kind](bundle.read_bytes()))
    with pytest.raises(ControlError) as raised:
        read_bundle(path)
    assert raised.value.code == "bad_bundle"
    assert raised.value.info.suggestions


def test_a_recipe_reads_no_files(bundle: Path, tmp_path: Path) -> None:
    def change(document: Any) -> None:
        document["recipe"]["scene"]["models"] = ["/etc/passwd"]

    found = read_bundle(changed(bundle, tmp_path / "b.zip", "request.json", change))
    with pytest.raises(ControlError) as raised:
        rerun(found)
    assert raised.value.code == "bad_recipe"


def test_the_bundle_of_a_run_in_a_store(tmp_path: Path) -> None:
    controller, store = Controller(seed=3), RunStore(tmp_path)
    store.add_session("s", SessionSpec(seed=3))
    result = Conversation(controller).say("where is the mug?")
    for name, state in (("whole", "ended"), ("cut", "aborted")):
        store.add_run(
            RunInfo(
                run_id=name, session_id="s", kind="say", state="running", text="t", asked_at=1.0
            )
        )
        with pytest.raises(ControlError) as raised:
            bundle_file(store, name)
        assert raised.value.code == "run_under_way"
        info = store.run(name).model_copy(update={"state": state, "ended_at": 2.0})
        store.put_run(info.model_copy(update={"result": result if name == "whole" else None}))
    with store.write_file("whole", "request") as path:
        path.write_text(run_request(controller, result, "digest").model_dump_json())
    bundle = read_bundle(bundle_file(store, "whole"))
    assert bundle.request.digest == "digest"
    assert rerun(bundle).ok
    assert bundle_file(store, "whole") == store.file("whole", "bundle")
    aborted = read_bundle(bundle_file(store, "cut"))
    assert (aborted.result, aborted.trace, aborted.request.seed) == ({}, None, 3)
    with pytest.raises(ControlError) as raised:
        rerun(aborted)
    assert raised.value.code == "not_repeatable"
    store.close()


@pytest.mark.slow
def test_a_plan_that_was_approved_is_repeated_to_the_digit(tmp_path: Path) -> None:
    with Session(seed=5) as session:
        first = session.plan("push the mug 2 cm to the left")
        session.plan("push the ice tea box 2 cm away")
        session.ask("where is the coffee box?")
        assert first.plan_id is not None
        run = session.start(plan_id=first.plan_id)
        result = run.result()
        events = tuple(run.events())
        bundle_run(session.controller, result, tmp_path / "b.zip", events=events)
    assert run.request is not None
    assert run.request.digest == first.digest
    bundle = read_bundle(tmp_path / "b.zip")
    assert bundle.request.recipe == run.request.recipe
    report = rerun(bundle)
    assert report.ok, list(report_lines(report))
    assert report.samples > 0
