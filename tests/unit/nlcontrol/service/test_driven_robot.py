"""A service that drives the robot of a class which its operator names, and no simulated one."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.documents import PoseFrame, SessionSpec
from nlcontrol.service.planning_service import PlanningService
from tests.fakes.counted_executor import FOLDER_VARIABLE, first_poses, motions_in, write_poses
from tests.patience import PATIENCE, wait_until
from tests.service_process import patient_settings

PUSH = "push the ice tea box 5 cm away"


@pytest.fixture
def service(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[PlanningService]:
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
    write_poses(tmp_path, first_poses())
    robot = "tests.fakes.counted_executor:CountedExecutor"
    with PlanningService(patient_settings(planners=1, executor=robot)) as service:
        yield service


async def first_frame(service: PlanningService, session_id: str) -> PoseFrame:
    async for content in service.live(session_id):
        return PoseFrame.model_validate_json(content)
    raise AssertionError("the session has ended")


def test_one_session_drives_the_robot_by_plans_that_hold(
    service: PlanningService, tmp_path: Path
) -> None:
    session_id = service.open_session(SessionSpec(approval="plan")).session_id
    with pytest.raises(ControlError) as raised:
        service.open_session(SessionSpec())
    assert raised.value.code == "too_many_sessions"

    plans = [json.loads(service.call_session(session_id, "plan", said=PUSH).result())]
    run = service.begin_run(session_id, plan_id=plans[0]["plan_id"])
    ended = service.wait_for_run(run.run_id, PATIENCE)
    assert ended.result is not None
    assert (ended.state, ended.result.execution is not None) == ("ended", True)
    motions = motions_in(tmp_path)
    assert motions >= 1

    plans.append(json.loads(service.call_session(session_id, "plan", said=PUSH).result()))
    x, y, yaw = first_poses()["mug"]
    write_poses(tmp_path, {**first_poses(), "mug": (x + 0.02, y, yaw)})
    with pytest.raises(ControlError) as raised:
        service.begin_run(session_id, plan_id=plans[1]["plan_id"])
    assert raised.value.code == "stale_plan"
    assert raised.value.info.numbers["mug: moved"] == pytest.approx(0.02, abs=1e-6)
    assert motions_in(tmp_path) == motions
    assert service.session(session_id).state == "idle"

    frame = asyncio.run(first_frame(service, session_id))
    assert frame.source == "belief"
    assert frame.poses["mug"][4:6] == pytest.approx((x + 0.02, y), abs=1e-6)

    fresh = json.loads(service.call_session(session_id, "plan", said=PUSH).result())["plan_id"]
    service.stop_run(run.run_id)  # it has ended, so that nothing is stopped
    service.stop_session(session_id)
    with pytest.raises(ControlError) as raised:
        service.begin_run(session_id, plan_id=fresh)
    assert raised.value.code == "expired_plan"

    service.close_session(session_id)
    wait_until(lambda: not service.sessions())
    assert service.open_session(SessionSpec()).has_robot


def test_a_robot_that_cannot_be_made_is_told_when_a_session_is_opened() -> None:
    settings = patient_settings(planners=1, executor="tests.fakes.counted_executor:NoSuchClass")
    with PlanningService(settings) as service:
        with pytest.raises(ControlError) as raised:
            service.open_session(SessionSpec())
        assert raised.value.code == "bad_executor"
        assert not service.sessions()
