"""An agent that knows the tools' descriptions alone does tasks that are refused first."""

from __future__ import annotations

import pytest

from tests.agents.agent_tasks import Task, tasks
from tests.agents.scripted_agent import outcomes


def test_a_seed_draws_twenty_tasks_half_of_which_ask_too_much() -> None:
    drawn = list(tasks(0))
    assert drawn == list(tasks(0))
    assert drawn != list(tasks(1))
    assert len(set(drawn)) == 20
    assert sum(task.refused_first for task in drawn) == 10
    assert len({task.scene for task in drawn}) >= 3


@pytest.mark.slow
def test_it_says_again_what_was_refused_and_asks() -> None:
    asked = (
        Task("kitchen", "push the ice tea box to the left with at most 0.1 N", refused_first=True),
        Task("kitchen", "will the ice tea box topple if you push it away at the top?"),
    )
    for found in outcomes(asked):
        assert found.as_meant, found
