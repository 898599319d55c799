"""The file of results: it goes on after a crash, and never takes a wrong line for a result."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nlcontrol.errors import ControlError
from nlcontrol.json_document import SCHEMA_VERSION
from nlcontrol.outcome_maps.face_experiment import Record
from sim.face_experiment import Contact, TouchResult

PUSH = Contact("crate", "front", (-0.05, 0.01, 0.1), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
SLID, STAYED = TouchResult("slide", 3.69), TouchResult("none", None)
MISSED = TouchResult(None, None, "it misses the crate – schräg")


def written(path: Path) -> Path:
    """A record of three results."""
    record = Record(path)
    for key, result in (("a", SLID), ("b", STAYED), ("c", MISSED)):
        record.add(key, PUSH, "force", 0, result)
    return path


def test_what_was_added_is_read_again(tmp_path: Path) -> None:
    path = written(tmp_path / "touches.jsonl")
    assert dict(Record(path).results) == {"a": SLID, "b": STAYED, "c": MISSED}
    lines = path.read_text(encoding="utf-8").splitlines()
    assert json.loads(lines[0]) == {"format": "touches", "schema_version": SCHEMA_VERSION}
    assert json.loads(lines[1])["point"] == [-0.05, 0.01, 0.1]


def test_a_record_that_is_not_there_is_empty_and_not_made(tmp_path: Path) -> None:
    path = tmp_path / "touches.jsonl"
    assert not Record(path).results
    assert not path.exists()


@pytest.mark.parametrize("left", range(0, 400, 7))
def test_a_run_that_was_killed_anywhere_can_go_on(tmp_path: Path, left: int) -> None:
    path = written(tmp_path / "touches.jsonl")
    content = path.read_bytes()[:left]
    path.write_bytes(content)
    record = Record(path)
    whole = max(content.count(b"\n") - 1, 0)
    assert list(record.results) == ["a", "b", "c"][:whole]
    assert path.read_bytes() == content  # reading changes nothing
    record.add("d", PUSH, "force", 0, STAYED)
    assert list(Record(path).results) == [*["a", "b", "c"][:whole], "d"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("{", "line 3"),
        ("[]", "line 3"),
        ('{"key": "b"}', "object"),
        ('{"key": "b", "outcome": "flies"}', "outcome"),
    ],
)
def test_a_damaged_line_is_named(tmp_path: Path, line: str, words: str) -> None:
    path = written(tmp_path / "touches.jsonl")
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[2] = json.dumps(json.loads(lines[2]) | json.loads(line)) if "flies" in line else line
    before = "\n".join(lines) + "\n"
    path.write_text(before, encoding="utf-8")
    with pytest.raises(ControlError) as raised:
        Record(path)
    assert raised.value.code == "bad_record"
    assert "line 3" in raised.value.info.message
    assert words in raised.value.info.message
    assert path.read_text(encoding="utf-8") == before


@pytest.mark.parametrize("force", ["NaN", "-1.0", '"3"', "Infinity"])
def test_a_force_must_be_one(tmp_path: Path, force: str) -> None:
    path = written(tmp_path / "touches.jsonl")
    path.write_text(path.read_text(encoding="utf-8").replace("3.69", force), encoding="utf-8")
    with pytest.raises(ControlError, match="line 2"):
        Record(path)


@pytest.mark.parametrize(
    ("head", "version"),
    [
        ({"format": "touches/1"}, "1"),
        ({"format": "touches", "schema_version": "1.4"}, "1.4"),
        ({"format": "touches", "schema_version": "20.0"}, "20.0"),
    ],
)
def test_a_record_of_another_major_version_is_refused_with_both(
    tmp_path: Path, head: dict[str, str], version: str
) -> None:
    path = written(tmp_path / "touches.jsonl")
    _, *lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    before = "".join((json.dumps(head) + "\n", *lines))
    path.write_text(before, encoding="utf-8")
    with pytest.raises(ControlError) as raised:
        Record(path)
    assert raised.value.code == "bad_record"
    assert f"version {version}," in raised.value.info.message
    assert f"version {SCHEMA_VERSION}" in raised.value.info.message
    assert path.read_text(encoding="utf-8") == before


def test_a_record_of_a_later_minor_version_is_read(tmp_path: Path) -> None:
    path = written(tmp_path / "touches.jsonl")
    _, first, *lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    head = json.dumps({"format": "touches", "schema_version": "3.9"}) + "\n"
    more = json.dumps(json.loads(first) | {"weather": "fine"}) + "\n"
    path.write_text("".join((head, more, *lines)), encoding="utf-8")
    assert dict(Record(path).results) == {"a": SLID, "b": STAYED, "c": MISSED}


@given(text=st.text(min_size=1, max_size=40))
def test_a_file_of_something_else_is_refused_and_kept(
    tmp_path_factory: pytest.TempPathFactory, text: str
) -> None:
    path = tmp_path_factory.mktemp("other") / "notes.txt"
    path.write_bytes(text.encode())
    if '{"format": "touches", '.startswith(text):
        return
    with pytest.raises(ControlError) as raised:
        Record(path)
    assert raised.value.code == "bad_record"
    assert path.read_bytes() == text.encode()


def test_a_folder_is_no_record(tmp_path: Path) -> None:
    with pytest.raises(ControlError, match="cannot be read"):
        Record(tmp_path)
