"""A record of results: broken runs go on, half a line is no result."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest

from benchmarks.record import Kept, carried_out, recorded


class Square(NamedTuple):
    side: int


class Area(Kept[Square]):
    area: int


def area(job: Square) -> Area:
    if job.side > 3:
        raise RuntimeError("too large")
    return Area(job=job, area=job.side**2)


def unable(job: Square) -> Area:
    raise AssertionError(f"{job} was carried out already")


JOBS = [Square(side) for side in (1, 2, 3)]


def test_what_is_recorded_is_not_done_again(tmp_path: Path) -> None:
    record = tmp_path / "areas.jsonl"
    with ThreadPoolExecutor(1) as pool:
        carried_out(area, JOBS[:2], Area, executor=pool, record=record)
        again = carried_out(unable, JOBS[:2], Area, executor=pool, record=record)
    assert [done.area for done in again.values()] == [1, 4]


def test_a_torn_last_line_is_done_again(tmp_path: Path) -> None:
    record = tmp_path / "areas.jsonl"
    with ThreadPoolExecutor(1) as pool:
        carried_out(area, JOBS[:2], Area, executor=pool, record=record)
        whole = record.read_text()
        record.write_text(whole[:-5])
        assert [done.area for done in recorded(record, Area)] == [1]
        done = carried_out(area, JOBS, Area, executor=pool, record=record)
    assert [each.area for each in done.values()] == [1, 4, 9]
    assert sorted(each.area for each in recorded(record, Area)) == [1, 4, 9]


def test_what_was_done_before_a_failure_is_kept(tmp_path: Path) -> None:
    record = tmp_path / "areas.jsonl"
    with ThreadPoolExecutor(1) as pool, pytest.raises(RuntimeError):
        carried_out(area, [Square(1), Square(4)], Area, executor=pool, record=record)
    assert [done.area for done in recorded(record, Area)] == [1]


def test_new_results_are_told(tmp_path: Path) -> None:
    record = tmp_path / "areas.jsonl"
    told: list[Area] = []
    with ThreadPoolExecutor(1) as pool:
        carried_out(area, JOBS[:1], Area, executor=pool, record=record)
        carried_out(area, JOBS, Area, executor=pool, record=record, told=told.append)
    assert sorted(done.area for done in told) == [4, 9]
