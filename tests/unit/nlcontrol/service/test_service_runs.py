"""Runs in worker processes: their queue, events, files, ends; and that none changes another."""

from __future__ import annotations

import asyncio
import json
import os
import signal
from collections.abc import Callable

import numpy as np
import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.documents import PoseFrame, RunInfo, SessionSpec
from nlcontrol.service.planning_service import PlanningService
from sim.traces.trace import Trace
from tests.patience import PATIENCE, wait_until
from tests.service_process import patient_settings
from tests.unit.nlcontrol.service.processes import halted

pytestmark = pytest.mark.slow

PUSH = "push the ice tea box 3 cm away"
LONG_PUSH = "push the ice tea box 25 cm away"  # which is stopped on its way


def code_of(call: Callable[[], object]) -> str:
    with pytest.raises(ControlError) as raised:
        call()
    return raised.value.code


def traces(workers: int, seeds: tuple[int, ...]) -> dict[int, Trace]:
    """Traces of a push in sessions with these seeds, so many at once."""
    settings = patient_settings(workers=workers, sessions=len(seeds), planners=1)
    with PlanningService(settings) as service:
        opened = {seed: service.open_session(SessionSpec(seed=seed)) for seed in seeds}
        runs = {
            seed: service.begin_run(each.session_id, said=PUSH) for seed, each in opened.items()
        }
        states = [run.state for run in runs.values()]
        assert states.count("running") == workers
        ended = {seed: service.wait_for_run(run.run_id, PATIENCE) for seed, run in runs.items()}
        assert all(run.state == "ended" and run.result for run in ended.values())
        return {
            seed: Trace.load(service.run_file(run.run_id, "trace")) for seed, run in runs.items()
        }


def test_the_number_of_workers_changes_no_trace() -> None:
    alone, together = traces(1, (0, 1)), traces(2, (0, 1))
    for seed, trace in alone.items():
        other = together[seed]
        assert np.array_equal(trace.time, other.time)
        assert np.array_equal(trace.joints, other.joints)
        assert all(np.array_equal(rows, other.poses[name]) for name, rows in trace.poses.items())
        assert all(np.array_equal(rows, other.felt[name]) for name, rows in trace.felt.items())
    assert not np.array_equal(alone[0].seen["mug"], alone[1].seen["mug"])


async def frames_of(service: PlanningService, session_id: str, run_id: str) -> list[PoseFrame]:
    """Frames that a viewer gets until a run has ended."""
    frames: list[PoseFrame] = []

    async def look() -> None:
        async for content in service.live(session_id):
            frames.append(PoseFrame.model_validate_json(content))  # noqa: PERF401 - it is ended

    looking = asyncio.create_task(look())
    async for _ in service.events(run_id):
        assert not looking.done()
    looking.cancel()
    return frames


def test_a_run_from_its_plan_to_its_files() -> None:
    with PlanningService(patient_settings(workers=1, sessions=2, planners=1, queue=1)) as service:
        first = service.open_session(SessionSpec(approval="plan")).session_id
        second = service.open_session(SessionSpec()).session_id
        plan_id = json.loads(service.call_session(first, "plan", said=PUSH).result())["plan_id"]
        run = service.begin_run(first, plan_id=plan_id, idempotency_key="a")
        assert (run.kind, run.text, run.plan_id) == ("execute", PUSH, plan_id)
        assert service.begin_run(first, plan_id=plan_id, idempotency_key="a").run_id == run.run_id
        assert code_of(lambda: service.begin_run(first, said="", idempotency_key="a")) == (
            "key_reused"
        )
        assert code_of(lambda: service.begin_run(first, plan_id=plan_id)) == "busy"
        assert code_of(lambda: service.call_session(first, "look").result()) == "busy"

        with halted(service.session_pids()[:1]):
            queued = service.begin_run(second, said=PUSH)
            assert (queued.state, queued.place) == ("queued", 1)
            assert service.session(second).state == "running"
            service.stop_run(queued.run_id)
            stopped = service.wait_for_run(queued.run_id, PATIENCE)
        assert stopped.result is not None
        assert (stopped.result.status, stopped.begun_at) == ("cancelled", None)

        frames = asyncio.run(frames_of(service, first, run.run_id))
        check_frames(frames, service, run)
        check_end(service, run)
        assert code_of(lambda: service.begin_run(first, plan_id=plan_id)) == "used_plan"


def check_frames(frames: list[PoseFrame], service: PlanningService, run: RunInfo) -> None:
    """A viewer sees what the observer has recorded, at most 30 times per second of its time."""
    trace = Trace.load(service.run_file(run.run_id, "trace"))
    times = np.array([frame.time for frame in frames])
    assert np.all(np.diff(times) > 0.5 / 30.0)
    assert (len(times) - 1) / (times[-1] - times[0]) <= 30.5, "fewer come to who is busy"
    moved = [frame for frame in frames if trace.time[0] <= frame.time <= trace.time[-1]]
    for frame in moved[:: max(1, len(moved) // 10)]:
        sample = int(np.argmin(np.abs(trace.time - frame.time)))
        true = trace.poses["ice tea box"][sample]
        assert frame.source == "observer"
        assert frame.poses["ice tea box/ice tea box"] == pytest.approx(tuple(true), abs=2e-5)


def check_end(service: PlanningService, run: RunInfo) -> None:
    """A run that has ended has its result, numbered events and files."""
    ended = service.wait_for_run(run.run_id, PATIENCE)
    assert ended.result is not None
    assert (ended.state, ended.result.status) == ("ended", "done")
    events = service.events_so_far(run.run_id)
    assert [each.number for each in events] == list(range(1, ended.events + 1))
    assert events[0].event.kind == "understood"
    assert events[-1].event.kind == "ended"
    assert service.events_so_far(run.run_id, after=ended.events - 1) == events[-1:]
    assert b"<html" in service.run_file(run.run_id, "replay").read_bytes()[:2000].lower()
    assert service.run_file(run.run_id, "bundle").stat().st_size > 1e5
    service.delete_run(run.run_id)
    assert code_of(lambda: service.run(run.run_id)) == "unknown_run"


def test_runs_that_are_stopped_aborted_and_cut_off() -> None:
    with PlanningService(patient_settings(workers=2, sessions=3, planners=1)) as service:
        ids = [service.open_session(SessionSpec(seed=seed)).session_id for seed in range(3)]
        stopped, aborted = (service.begin_run(each, said=LONG_PUSH).run_id for each in ids[:2])
        with halted(service.session_pids()[:2]):
            cut_off = service.begin_run(ids[2], said=LONG_PUSH).run_id
            assert service.run(cut_off).place == 1
        wait_until(lambda: service.run(stopped).events > 5)
        service.stop_run(stopped)
        wait_until(lambda: service.run(aborted).events > 5)
        service.abort_run(aborted)
        wait_until(lambda: service.run(cut_off).state == "running")
        wait_until(lambda: service.run(cut_off).events > 5)
        os.kill(service.session_pids()[2], signal.SIGKILL)

        ended = [service.wait_for_run(each, PATIENCE) for each in (stopped, aborted, cut_off)]
        assert [run.state for run in ended] == ["ended", "aborted", "cut_off"]
        assert ended[0].result is not None
        assert ended[0].result.status == "cancelled"
        assert [run.error and run.error.code for run in ended[1:]] == ["aborted", "cut_off"]
        states = [service.session(each).state for each in ids]
        assert states == ["idle", "lost", "lost"]
        assert service.health()["running"] == 0


def test_a_closed_session_lets_its_run_come_to_rest() -> None:
    with PlanningService(patient_settings(workers=1, planners=1)) as service:
        session_id = service.open_session(SessionSpec()).session_id
        run = service.begin_run(session_id, said=LONG_PUSH)
        wait_until(lambda: service.run(run.run_id).events > 5)
        with halted(service.session_pids()):  # it cannot come to rest, so nobody waits for that
            service.close_session(session_id)
        ended = service.wait_for_run(run.run_id, PATIENCE)
        assert ended.result is not None
        assert ended.result.status == "cancelled"
        wait_until(lambda: not service.sessions())


def test_who_hears_of_the_end_may_begin_the_next_run_at_once() -> None:
    with PlanningService(patient_settings(workers=1, planners=1)) as service:
        session_id = service.open_session(SessionSpec()).session_id

        def has_told_end(run_id: str) -> bool:
            return any(each.event.kind == "ended" for each in service.events_so_far(run_id))

        for number in range(20):
            run_id = service.begin_run(session_id, said="how heavy is the mug?").run_id
            while not (has_told_end(run_id) if number % 2 else service.run(run_id).result):
                pass
        service.wait_for_run(run_id)
        states = [info.state for info in service.runs().runs]
        assert states == ["ended"] * 20
