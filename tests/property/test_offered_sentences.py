"""Sentences that are offered in place of a refused one are read, resolved and planned.

Sentences are drawn over scenes and families, feasible ones and others; nothing of what offers a
sentence is used to judge it.
"""

from __future__ import annotations

from functools import cache
from itertools import islice

import pytest

from benchmarks.agent_tasks import Task, tasks
from nlcontrol import Controller
from tests.sizes import ALL

SEEDS = range(301, 311) if ALL else range(301, 302)


@cache
def controller(scene: str) -> Controller:
    return Controller(scene)


def offered_in_place_of(task: Task) -> tuple[str, ...]:
    """The sentences that are offered, each of which has a plan."""
    said = controller(task.scene).say(task.text, plan_only=True)
    if said.error is None:
        return ()
    for sentence in said.error.say:
        again = controller(task.scene).say(sentence, plan_only=True)
        assert again.status == "planned", (task, sentence, again.error)
    quoted = {each for each in said.error.suggestions if each.startswith("say “")}
    assert quoted <= {f"say “{sentence}”" for sentence in said.error.say}, task
    return said.error.say


def test_what_is_offered_for_too_much_is_planned() -> None:
    drawn = [task for task in tasks(300) if task.refused_first]
    offered = [offered_in_place_of(task) for task in islice(drawn, 0, None, 2)]
    assert all(offered)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_whatever_is_offered_is_planned(seed: int) -> None:
    offered = [offered_in_place_of(task) for task in tasks(seed)]
    # Half of them ask too much, and of the rest some may be refused too.
    assert sum(map(bool, offered)) >= 8
