"""Workers in processes of their own: answers, fairness, limits, and no process left."""

from __future__ import annotations

import json
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from typing import Any

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.documents import TableSpec
from nlcontrol.service.workers.worker_pool import WorkerPool
from tests.patience import PATIENCE, wait_until
from tests.unit.nlcontrol.service.processes import descendants, halted

PUSH = "push the ice tea box 10 cm away"


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    pool = WorkerPool(most=2, sessions=0, queue=2, request_time=PATIENCE)
    pool.start()
    yield pool
    pool.close()
    assert not pool.pids


def plan(pool: WorkerPool, **table: Any) -> dict[str, Any]:
    content = pool.call("plan", TableSpec(**table), said=PUSH).result()
    answer: dict[str, Any] = json.loads(content)
    return answer


def test_a_plan_is_that_of_a_session_in_this_process(pool: WorkerPool) -> None:
    from nlcontrol.service.session import Session

    here = Session("kitchen", seed=3).plan(PUSH).result
    there = plan(pool, seed=3)["result"]
    assert there == here.model_dump(mode="json")


def test_nothing_is_remembered_from_one_call_to_the_next(pool: WorkerPool) -> None:
    plan(pool)
    again = json.loads(pool.call("plan", TableSpec(), said="push it further").result())
    assert again["result"]["error"]["code"] == "nothing_before"


def test_a_sentence_is_read_to_its_parts_or_to_sentences_that_can_be_read(
    pool: WorkerPool,
) -> None:
    read = json.loads(pool.call("parse", TableSpec(), said=PUSH).result())
    parts = {row["part"] for row in read["explanation"] if row["spans"]}
    assert parts >= {"controller", "object model", "wanted outcome"}
    unread = json.loads(pool.call("parse", TableSpec(), said="psuh the mug away").result())
    assert not unread["ok"]
    assert unread["error"]["span"] == [0, 4]
    assert unread["error"]["say"] == ["push the mug away"]


def test_a_plan_explains_its_words_if_asked(pool: WorkerPool) -> None:
    told = json.loads(pool.call("plan", TableSpec(), said=PUSH, explain=True).result())["result"]
    values = {row["parameter"] for row in told["explanation"]}
    assert "force limit" in values
    assert plan(pool)["result"]["explanation"] is None


def test_what_a_session_raises_reaches_the_caller(pool: WorkerPool) -> None:
    with pytest.raises(ControlError) as raised:
        pool.call("affordances", TableSpec(), name="grand piano").result()
    assert raised.value.code == "unknown_object"
    with pytest.raises(ControlError) as raised:
        pool.call("execute", TableSpec(), plan_id="").result()
    assert raised.value.code == "internal"


def test_a_long_search_delays_nobody_else(pool: WorkerPool) -> None:
    slow = pool.call("plan", TableSpec(), said="turn the cereal box by 170 degrees")
    plan(pool)
    assert not slow.done() or json.loads(slow.result())
    slow.result()
    assert pool.size == 2


def test_more_calls_than_may_wait_are_refused(pool: WorkerPool) -> None:
    table = TableSpec()
    open_calls: list[Future[bytes]] = []

    def call_on() -> None:
        while True:
            open_calls.append(pool.call("plan", table, said=PUSH))

    plan(pool)
    with halted(pool.pids), pytest.raises(ControlError) as raised:
        call_on()
    # Two wait, and either planner may work, or may just be starting.
    assert 2 <= len(open_calls) <= 4
    assert raised.value.code == "queue_full"
    assert raised.value.info.numbers["retry_after"] > 0.0
    for call in open_calls:
        call.result()


def test_a_call_of_a_killed_planner_is_made_again(pool: WorkerPool) -> None:
    call = pool.call("plan", TableSpec(scene="workbench"), said="push the tea tin 5 cm away")
    before = set(pool.pids)
    for pid in before:
        os.kill(pid, signal.SIGKILL)
    assert json.loads(call.result())["result"]["frames"]
    assert plan(pool)["result"]["status"] == "planned"
    assert not before & set(pool.pids)


def test_a_planner_that_is_killed_before_it_began_is_replaced() -> None:
    pool = WorkerPool(most=1, sessions=0, queue=2, request_time=PATIENCE)
    pool.start()
    call = pool.call("parse", TableSpec(), said=PUSH)
    for pid in pool.pids:
        os.kill(pid, signal.SIGKILL)
    assert json.loads(call.result())["frames"]
    pool.close()


def test_a_call_ends_with_its_time_and_a_planner_that_does_not_stop_is_ended() -> None:
    pool = WorkerPool(most=1, sessions=0, queue=2, request_time=0.3)
    pool.start()
    (before,) = pool.pids
    os.kill(before, signal.SIGSTOP)  # it does nothing at all any more
    with pytest.raises(ControlError) as raised:
        pool.call("plan", TableSpec(), said=PUSH).result()
    assert raised.value.code == "time_limit"
    pool.close()
    assert not descendants(os.getpid()) & {before}


def test_signals_of_a_terminal_do_not_end_a_planner(pool: WorkerPool) -> None:
    plan(pool)
    for pid in pool.pids:
        os.kill(pid, signal.SIGINT)
        os.kill(pid, signal.SIGTERM)
    before = set(pool.pids)
    assert plan(pool)["result"]["status"] == "planned"
    assert set(pool.pids) == before


def test_sessions_and_calls_take_the_same_workers() -> None:
    pool = WorkerPool(most=1, sessions=1, queue=2, request_time=PATIENCE)
    pool.start()
    before = set(pool.pids)
    assert len(before) == 2
    ended = threading.Event()
    leased = pool.lease(lambda topic, content: None, ended.set)
    assert leased.pid in before
    assert pool.size == 1
    assert plan(pool)["result"]["status"] == "planned"
    leased.kill()
    assert ended.wait(PATIENCE)
    wait_until(lambda: pool.size == 2)  # the next session finds one ready
    pool.close()
    assert not descendants(os.getpid()) & before


def test_a_lease_whose_worker_ends_before_it_began_is_told() -> None:
    pool = WorkerPool(most=1, sessions=1, queue=2, request_time=PATIENCE)
    ended = threading.Event()
    leased = pool.lease(lambda topic, content: None, ended.set)  # none was kept ready
    os.kill(leased.pid, signal.SIGKILL)
    assert ended.wait(PATIENCE)
    pool.close()
