"""An agent that knows the tools' descriptions alone does tasks that are refused first."""

from __future__ import annotations

import pytest

from benchmarks.scripted_agent import TASKS, outcomes


def test_half_of_the_tasks_are_refused_first() -> None:
    assert len(TASKS) == len(set(TASKS)) == 20
    assert sum(task.refused_first for task in TASKS) == 10
    assert len({task.scene for task in TASKS}) >= 3


@pytest.mark.slow
def test_it_says_again_what_was_refused_and_asks() -> None:
    for found in outcomes(TASKS[:2]):
        assert found.as_meant, found
