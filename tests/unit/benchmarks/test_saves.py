"""Saves that are killed, and saves at once, in small."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.kills.saves import kill_saves, write_at_once


@pytest.mark.slow
def test_killed_saves_leave_whole_files(objects_folder: Path) -> None:
    kill_saves(objects_folder, 10, seed=0)


@pytest.mark.slow
def test_writes_at_once_lose_nothing(objects_folder: Path) -> None:
    assert write_at_once(objects_folder, 60) == 20
