"""A program moves from its own process to a service by changing one line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from nlcontrol import Client
from nlcontrol.errors import ControlError
from nlcontrol.service.methods import PlanningSession
from nlcontrol.service.session import Session
from tests.fakes.counted_executor import motions_in
from tests.patience import PATIENCE
from tests.service_process import ServerProcess, serving_counted_robot

PUSH = "push the mug 3 cm to the left"


def refusal(call: Any) -> tuple[str, str, tuple[str, ...]]:
    with pytest.raises(ControlError) as raised:
        call()
    info = raised.value.info
    return info.code, info.message, info.suggestions


def conversation(robot: PlanningSession) -> list[Any]:
    """What a program gets that looks, asks, plans, and is refused."""
    offer = robot.plan("push the mug 3 m away")
    return [
        robot.look().objects,
        robot.parse(PUSH),
        robot.plan(robot.parse(PUSH)).result.model_dump(mode="json"),
        robot.plan(
            [frame.model_dump(mode="json") for frame in robot.parse(PUSH).frames]
        ).result.plan,
        robot.ask("how heavy is the ice tea box?").answer,
        robot.predict("ice tea box", height=0.03, force=1.5),
        robot.map("ice tea box", face="left", spacing=0.02),
        robot.affordances("mug"),
        offer.result.error,
        offer.plan_id,
        refusal(lambda: robot.parse("frobnicate the mug")),
        refusal(lambda: robot.predict("teapot", height=0.03)),
        refusal(lambda: robot.predict("ice tea box", height=-1.0)),
        refusal(lambda: robot.start(plan_id="plan-0"))[0],
    ]


def run(robot: PlanningSession) -> list[Any]:
    """What a program gets that approves a plan and carries it out."""
    offer = robot.plan(PUSH)
    assert offer.plan_id is not None
    heard: list[str] = []
    begun = robot.start(plan_id=offer.plan_id, on_event=lambda event: heard.append(event.kind))
    result = begun.result(PATIENCE)
    trace = begun.trace()
    assert trace is not None
    kinds = [told.event.kind for told in begun.events()]
    assert heard == kinds
    used = refusal(lambda: robot.start(plan_id=offer.plan_id or ""))[0]
    again = robot.ask("where is the mug?").answer
    return [result.model_dump(mode="json"), trace, kinds, used, again]


def test_questions_and_refusals_are_the_same(server: ServerProcess) -> None:
    with Session("kitchen") as robot:
        here = conversation(robot)
    with Client(server.url, timeout=PATIENCE).sessions.open("kitchen") as robot:
        there = conversation(robot)
    assert len(here) == len(there)
    for mine, other in zip(here, there, strict=True):
        assert mine == other


@pytest.mark.slow
def test_a_push_is_the_same(server: ServerProcess) -> None:
    with Session("kitchen", seed=3) as robot:
        here = run(robot)
    with Client(server.url, timeout=PATIENCE).sessions.open("kitchen", seed=3) as robot:
        there = run(robot)
    assert here[0].pop("files", None) == there[0].pop("files", None)
    for mine, other in zip(here, there, strict=True):
        assert mine == other


def test_a_question_may_move_there_too(tmp_path: Path) -> None:
    asked = "how slippery is the mug?"
    with (
        serving_counted_robot(tmp_path, "--planners", "1") as server,
        Client(server.url, timeout=PATIENCE).sessions.open() as robot,
    ):
        assert robot.ask(PUSH, motion="simulate").status == "planned"
        before = robot.ask(asked)
        assert (before.status, motions_in(tmp_path)) == ("answered", 0)
        robot.ask(asked, motion="simulate")
        assert motions_in(tmp_path) > 0
