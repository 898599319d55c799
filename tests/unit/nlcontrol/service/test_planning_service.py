"""Sessions in processes of their own, and what the service keeps of them; nothing simulates."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.documents import SessionInfo, SessionSpec, TableSpec
from nlcontrol.service.planning_service import PlanningService
from nlcontrol.service.workers import live_session
from tests.patience import wait_until
from tests.service_process import patient_settings
from tests.unit.nlcontrol.service.processes import descendants, parent

PUSH = "push the ice tea box 10 cm away"


@pytest.fixture(scope="module")
def service() -> Iterator[PlanningService]:
    settings = patient_settings(workers=1, sessions=2, planners=1)
    with PlanningService(settings) as service:
        yield service


@pytest.fixture
def session(service: PlanningService) -> Iterator[SessionInfo]:
    opened = service.open_session(SessionSpec(approval="plan"))
    yield opened
    if any(each.session_id == opened.session_id for each in service.sessions()):
        service.close_session(opened.session_id)
        wait_until(lambda: not service.sessions())


def code_of(call: Callable[[], object]) -> str:
    with pytest.raises(ControlError) as raised:
        call()
    return raised.value.code


def test_a_session_remembers_and_a_call_without_one_does_not(
    service: PlanningService, session: SessionInfo
) -> None:
    sid = session.session_id
    offer = json.loads(service.call_session(sid, "plan", said=PUSH).result())
    assert offer["plan_id"]
    assert offer["result"]["status"] == "planned"
    why = json.loads(service.call_session(sid, "ask", said="why?").result())
    assert why["status"] == "answered"
    there = json.loads(service.call_planner("ask", TableSpec(), said="why?").result())
    assert there["error"]["code"] == "nothing_before"


def test_a_session_that_is_left_alone_makes_room_unless_its_plan_waits(
    service: PlanningService, session: SessionInfo, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = service.open_session(SessionSpec(seed=1))
    offer = json.loads(service.call_session(other.session_id, "plan", said=PUSH).result())
    assert offer["plan_id"]
    monkeypatch.setattr(live_session, "LEFT_ALONE", 0.0)
    third = service.open_session(SessionSpec(seed=2))
    open_now = {each.session_id for each in service.sessions()}
    assert open_now == {other.session_id, third.session_id}
    with pytest.raises(ControlError) as raised:
        service.call_session(session.session_id, "ask", said="why?")
    assert raised.value.code == "unknown_session"
    assert "made room" in raised.value.info.message
    for each in open_now:
        service.close_session(each)
    wait_until(lambda: not service.sessions())


def test_sessions_are_limited_and_a_closed_one_is_gone(
    service: PlanningService, session: SessionInfo
) -> None:
    other = service.open_session(SessionSpec(seed=1))
    assert code_of(lambda: service.open_session(SessionSpec())) == "too_many_sessions"
    assert {each.session_id for each in service.sessions()} == {
        session.session_id,
        other.session_id,
    }
    service.close_session(other.session_id)
    wait_until(lambda: len(service.sessions()) == 1)
    assert code_of(lambda: service.call_session(other.session_id, "look")) == "unknown_session"


def test_the_path_of_a_scene_is_no_scene(service: PlanningService) -> None:
    path = TableSpec(scene="../../sim/scenes/kitchen.yaml")
    assert code_of(lambda: service.call_planner("look", path)) == "unknown_scene"


def test_an_unusable_table_leaves_no_session(service: PlanningService) -> None:
    before = len(service.sessions())
    spec = SessionSpec(defaults={"no_such_default": 1.0})
    assert code_of(lambda: service.open_session(spec)) == "bad_default"
    assert len(service.sessions()) == before


def test_nothing_is_begun_that_was_not_approved(
    service: PlanningService, session: SessionInfo
) -> None:
    sid = session.session_id
    assert code_of(lambda: service.begin_run(sid, said=PUSH)) == "approval_required"
    assert code_of(lambda: service.begin_run(sid, plan_id="plan-0")) == "unknown_plan"
    assert code_of(lambda: service.run("run-0")) == "unknown_run"
    assert service.session(sid).state == "idle"
    assert not service.runs().runs
    assert service.health()["running"] == 0


def test_a_session_whose_process_dies_is_lost(service: PlanningService) -> None:
    lost = service.open_session(SessionSpec())
    call = service.call_session(lost.session_id, "plan", said=PUSH)
    for pid in service.session_pids():
        os.kill(pid, signal.SIGKILL)
    with pytest.raises(ControlError) as raised:
        call.result()
    assert raised.value.code == "session_lost"
    wait_until(lambda: service.session(lost.session_id).state == "lost")
    assert code_of(lambda: service.call_session(lost.session_id, "look")) == "session_lost"
    service.close_session(lost.session_id)
    wait_until(lambda: not service.sessions())


@pytest.mark.slow
def test_an_idle_session_is_closed() -> None:
    settings = patient_settings(workers=1, planners=1, idle_time=1.0)
    with PlanningService(settings) as service:
        assert service.open_session(SessionSpec()).state == "idle"
        wait_until(lambda: not service.sessions())


def test_no_process_outlives_a_killed_service(tmp_path: Path) -> None:
    script = textwrap.dedent(
        """
        import signal
        from nlcontrol.service.documents import SessionSpec
        from nlcontrol.service.planning_service import PlanningService
        from nlcontrol.service.service_settings import ServiceSettings

        if __name__ == "__main__":
            with PlanningService(ServiceSettings(planners=1)) as service:
                service.open_session(SessionSpec())
                print("open", flush=True)
                signal.pause()
        """
    )
    path = tmp_path / "service.py"
    path.write_text(script, encoding="utf-8")
    process = subprocess.Popen([sys.executable, str(path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "open\n"
    left = descendants(process.pid)
    assert len(left) >= 3
    process.kill()
    process.wait()
    wait_until(lambda: all(parent(pid) is None for pid in left))
