"""`batch`: rows of a file to lines of results, wherever they are carried out, and what is told."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.batches.proof import DASK, compare_ways
from nlcontrol.cli.command_line import run
from nlcontrol.errors import INTERNAL, OK, USAGE

Row = dict[str, object]

QUESTIONS: list[Row] = [{"text": f"how heavy is the {name}?"} for name in ("mug", "ice tea box")]
MIXED: list[Row] = [*QUESTIONS, {"text": "dance"}, {"text": "push the mug away", "execute": False}]
BAD = '{"text": "push it", "sede": 3}\n'


def written(folder: Path, *lines: str) -> str:
    path = folder / "rows.jsonl"
    path.write_text("".join(lines), encoding="utf-8")
    return str(path)


def jsonl(rows: list[Row]) -> list[str]:
    return [json.dumps(row) + "\n" for row in rows]


@pytest.fixture
def batch(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Runs the command; exit code, standard output and standard error."""

    def call(*args: str) -> tuple[int, str, str]:
        status = run(["batch", *args])
        told = capsys.readouterr()
        return status, told.out, told.err

    return call


Batch = Callable[..., tuple[int, str, str]]


def test_results_are_lines_and_a_summary_ends_them(tmp_path: Path, batch: Batch) -> None:
    rows, output = written(tmp_path, *jsonl([MIXED[2], QUESTIONS[0]]), BAD), tmp_path / "out.jsonl"
    status, out, err = batch(rows, "--output", str(output), "--workers", "1", "--events", "--json")
    assert status == USAGE  # of the bad row
    summary = json.loads(out)
    assert summary["statuses"] == {"not_understood": 1, "answered": 1, "bad_row": 1}
    assert (summary["ok"], summary["error"]["code"]) == (False, "bad_row")
    assert "line 3" in summary["error"]["message"]
    events = [json.loads(line) for line in err.splitlines()]
    assert [(each["done"], each["total"]) for each in events] == [(1, 3), (2, 3), (3, 3)]
    lines = [json.loads(line) for line in output.read_text("utf-8").splitlines()]
    assert [line["status"] for line in lines] == ["not_understood", "answered", "bad_row"]
    assert lines[1]["result"]["answer"]

    picture = tmp_path / "summary.png"
    status, out, _ = batch("summary", str(output), "--json", "--picture", str(picture))
    assert (status, json.loads(out)) == (OK, summary)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert batch("summary", str(output))[1].startswith("3 rows\n")


def test_a_bad_row_can_stop_it_and_it_goes_on_from_there(tmp_path: Path, batch: Batch) -> None:
    output = tmp_path / "out.jsonl"
    good = jsonl([MIXED[2]])
    rows = written(tmp_path, *good, BAD)
    common = (rows, "--output", str(output), "--workers", "1")
    status, _, err = batch(*common, "--on-error", "stop")
    assert status == USAGE
    assert "Error (bad_row): line 2" in err
    assert len(output.read_text("utf-8").splitlines()) == 1
    assert batch(*common)[0] == USAGE  # it holds something
    written(tmp_path, *good, *good)
    assert batch(*common, "--resume")[0] == OK
    assert len(output.read_text("utf-8").splitlines()) == 2


@pytest.mark.parametrize("args", [("--resume",), ("--json",), ("--on-error", "never")])
def test_options_that_say_nothing_are_refused(
    args: tuple[str, ...], tmp_path: Path, batch: Batch
) -> None:
    assert batch(written(tmp_path), *args)[0] == USAGE


def test_help_names_both_commands(batch: Batch) -> None:
    told = batch("--help")[1]
    assert "run" in told
    assert "summary" in told
    assert "--dask" in batch("run", "--help")[1]


def test_no_scheduler_answers(tmp_path: Path, batch: Batch) -> None:
    pytest.importorskip("distributed")
    status, _, err = batch(written(tmp_path), "--dask", "no-such-protocol://x:1")
    assert status == INTERNAL
    assert "Error (no_service)" in err


@pytest.mark.slow
def test_equal_digests_on_a_cluster_and_after_kills(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    ways = (DASK, "killed and resumed")
    assert compare_ways(MIXED * 3, tmp_path, ways) == {}


@pytest.mark.slow
def test_an_interrupted_batch_ends_as_documented_and_goes_on(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    assert compare_ways(MIXED * 3, tmp_path, ["interrupted and resumed"]) == {}
