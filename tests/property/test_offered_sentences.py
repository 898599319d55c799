"""Sentences that are offered in place of a refused one are read, resolved and planned.

Sentences are drawn over scenes and families, feasible ones and others; nothing of what offers a
sentence is used to judge it.
"""

from __future__ import annotations

from functools import cache
from itertools import islice

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim.truth.scene_file import Scene, load_scene
from tests.agents.agent_tasks import Task, tasks
from tests.sizes import ALL

SEEDS = range(301, 311) if ALL else range(301, 302)


@cache
def controller(scene: str) -> Controller:
    return Controller(scene)


def offered_in_place_of(text: str, robot: Controller) -> tuple[str, ...]:
    """The sentences that are offered, each of which has a plan; where none is, that is said."""
    said = Conversation(robot).say(text, plan_only=True)
    if said.error is None:
        return ()
    for sentence in said.error.say:
        again = Conversation(robot).say(sentence, plan_only=True)
        assert again.status == "planned", (text, sentence, again.error)
    quoted = {each for each in said.error.suggestions if each.startswith("say “")}
    assert quoted <= {f"say “{sentence}”" for sentence in said.error.say}, text
    honest = said.error.suggestions[-1].startswith("nothing like it was found")
    assert honest == (not said.error.say), text
    return said.error.say


def offered_for(task: Task) -> tuple[str, ...]:
    return offered_in_place_of(task.text, controller(task.scene))


def narrow_table(rng: np.random.Generator) -> tuple[Scene, str]:
    """A box with a mug close to one of its sides, and a push of the box that takes a hand there."""
    scene = load_scene("kitchen")
    by_name = {item.name: item for item in scene.objects}
    box, mug = by_name["ice tea box"], by_name["mug"]
    gap, side = rng.uniform(0.01, 0.05), int(rng.integers(4))
    # Half of the box's side, and the mug's radius.
    away = 0.045 + gap + 0.04
    ways = ("toward me", "to the right", "away", "to the left")
    x, y = ((away, 0.0), (0.0, away), (-away, 0.0), (0.0, -away))[side]
    pose = box.pose.model_copy(update={"yaw_deg": 0.0})
    beside = pose.model_copy(update={"x_m": pose.x_m + x, "y_m": pose.y_m + y})
    objects = (
        box.model_copy(update={"pose": pose}),
        mug.model_copy(update={"pose": beside, "fragile": bool(rng.integers(2))}),
    )
    text = f"push the ice tea box {rng.integers(3, 12)} cm {ways[side]}"
    return scene.model_copy(update={"objects": objects}), text


def test_what_is_offered_for_too_much_is_planned() -> None:
    drawn = [task for task in tasks(300) if task.refused_first]
    offered = [offered_for(task) for task in islice(drawn, 0, None, 2)]
    assert all(offered)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_whatever_is_offered_is_planned(seed: int) -> None:
    offered = [offered_for(task) for task in tasks(seed)]
    # Half of them ask too much, and of the rest some may be refused too.
    assert sum(map(bool, offered)) >= 8


@pytest.mark.slow
def test_in_narrow_gaps_it_is_planned_or_something_is_offered() -> None:
    for seed in range(40 if ALL else 8):
        scene, text = narrow_table(np.random.default_rng((302, seed)))
        offered_in_place_of(text, Controller(scene))
