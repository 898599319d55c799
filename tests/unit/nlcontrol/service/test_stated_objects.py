"""Tables on which the caller says where everything stands."""

from __future__ import annotations

import math
from typing import Any

import pytest
from pydantic import ValidationError

from nlcontrol import Session
from nlcontrol.errors import ControlError
from nlcontrol.service.documents import SessionSpec, StatedObject, TableView
from nlcontrol.service.workers.session_host import session_answer
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.world_state import PlanarPose
from sim.stated_table import StatedTable

BOX = StatedObject(name="ice tea box", x=0.45, y=0.0)
MUG = StatedObject(name="my cup", model="mug", x=0.3, y=0.3, yaw=0.5, synonyms=("beaker",))
AWAY = "push the ice tea box 5 cm away"


@pytest.fixture(scope="module")
def session() -> Session:
    return Session("kitchen", objects=(BOX, MUG))


def refused(*objects: StatedObject, **others: Any) -> tuple[str | None, dict[str, float]]:
    """Place and numbers of the error of a table that makes no sense."""
    with pytest.raises(ControlError) as raised:
        Session("kitchen", objects=objects, **others)
    info = raised.value.info
    assert (info.code, info.status.http) == ("bad_table", 400)
    assert info.suggestions
    return info.path, info.numbers


def test_it_stands_where_it_was_stated(session: Session) -> None:
    view = session.look([BOX, MUG])
    assert (view.source, view.scene, view.held) == ("stated", "kitchen", None)
    assert [(item.name, item.model) for item in view.objects] == [
        ("ice tea box", "ice tea box"),
        ("my cup", "mug"),
    ]
    assert [(item.x, item.y, item.yaw) for item in view.objects] == [(0.45, 0, 0), (0.3, 0.3, 0.5)]


def test_plans_are_those_of_a_robot_that_sees_the_same() -> None:
    """The plan on a simulated table, and on one that is stated as it was seen there."""
    controller = Controller("kitchen")
    seen = controller.look().objects.values()
    stated = [
        StatedObject(name=each.name, x=each.pose.x, y=each.pose.y, yaw=each.pose.yaw)
        for each in seen
    ]
    offer = Session("kitchen", objects=stated).plan(AWAY)
    assert (offer.plan_id, offer.expires_in) == (None, None)
    assert offer.result.plan == Conversation(controller).say(AWAY, plan_only=True).plan


def test_what_is_planned_is_not_carried_out(session: Session) -> None:
    for call in (
        lambda: session.start(plan_id="plan-0"),
        lambda: session.start(AWAY),
        lambda: session.ask("how heavy is the beaker?", motion="simulate"),
    ):
        with pytest.raises(ControlError) as raised:
            call()
        assert raised.value.code == "no_robot"
    assert session.ask("how heavy is the beaker?").status == "answered"
    executor = StatedTable(session.controller.cell, {})
    with pytest.raises(ControlError) as raised:
        Controller(executor=executor).watch("mug")
    assert raised.value.code == "no_robot"


def test_objects_are_stated_anew_while_the_conversation_goes_on(session: Session) -> None:
    before = session.look([BOX, MUG])
    session.plan(AWAY)
    moved = BOX.model_copy(update={"x": 0.5, "yaw": math.pi / 6})
    coffee = StatedObject(name="coffee box", x=0.6, y=-0.36)
    after = session.look([moved, coffee])
    assert after.digest != before.digest
    result = session.plan("push it 3 cm to the left").result
    assert result.steps[0].before == PlanarPose(0.5, 0.0, math.pi / 6)
    assert session.plan("push the coffee box 3 cm to the left").ok
    assert session.plan("push the beaker away").result.status == "not_understood"
    session.reset()
    assert session.look() == before


def test_objects_come_over_a_wire(session: Session) -> None:
    stated = {"objects": [MUG.model_dump(mode="json")]}
    view = TableView.model_validate_json(session_answer(session, "look", stated))
    assert [item.name for item in view.objects] == [MUG.name]
    same = TableView.model_validate_json(session_answer(session, "look", {"objects": None}))
    assert same == view


def test_a_robot_with_a_camera_is_not_told() -> None:
    with Session("kitchen") as session, pytest.raises(ControlError) as raised:
        session.look([BOX])
    assert raised.value.code == "bad_table"


def test_nonsense_is_told_with_its_place() -> None:
    same = BOX.model_copy(update={"name": "Ice Tea Box", "x": 0.7})
    assert refused(BOX, same)[0] == "objects[1].name"
    inside = MUG.model_copy(update={"x": 0.45, "y": 0.06})
    path, numbers = refused(BOX, inside)
    # Half the box, and half the mug across its round side, less 60 mm.
    assert path == "objects[1]"
    assert numbers["overlap"] == pytest.approx(0.045 + 0.04 - 0.06, abs=1e-3)
    path, numbers = refused(BOX.model_copy(update={"y": 0.79}))
    assert path == "objects[0]"
    assert numbers["beyond"] == pytest.approx(0.035)
    assert refused(MUG, BOX.model_copy(update={"model": "ice te box"}))[0] == "objects[1].model"
    assert refused(StatedObject(name="gnome", x=0.4, y=0.0))[0] == "objects[0].name"
    with pytest.raises(ValidationError):
        StatedObject(name=" ", x=0.4, y=0.0)
    with pytest.raises(ValidationError):
        SessionSpec(objects=(BOX,) * 61)


def test_what_touches_in_the_eyes_of_a_camera_is_taken() -> None:
    beside = StatedObject(name="coffee box", x=0.45, y=0.0915 - 0.002)
    assert Session("kitchen", objects=(BOX, beside)).plan(AWAY).result.status != "not_understood"


def test_an_empty_table() -> None:
    with Session("kitchen", objects=()) as session:
        assert session.look().objects == ()
        assert session.plan(AWAY).result.error is not None
