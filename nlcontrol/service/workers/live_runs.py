"""Runs that are queued or under way: their turn, their events, their end, noted in the store."""

from __future__ import annotations

import hashlib
import json
import logging
import secrets
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from nlcontrol.errors import INTERNAL, ControlError, ErrorInfo, error
from nlcontrol.service.documents import NumberedEvent, RunInfo, RunState
from nlcontrol.service.workers.session_host import RunEnd
from nlcontrol.service.workers.worker_process import LoopNotifier, daemon_timer, queue_full
from nlcontrol.session.events import Event

if TYPE_CHECKING:
    from nlcontrol.service.run_store import RunStore
    from nlcontrol.service.workers.live_session import LiveSession


# Queue of runs: so many simulate at once, the next ones wait in order, the rest are refused.


class SimulationQueue:
    """Runs that simulate, and those that wait.

    Args:
        workers: runs that may simulate at once.
        length: runs that may wait.
        on_moved: called with a run and its place in the queue, from 1, whenever that has changed.
    """

    def __init__(
        self, workers: int, length: int, on_moved: Callable[[str, int], object] = lambda r, p: None
    ) -> None:
        self._workers, self._length, self._on_moved = workers, length, on_moved
        self._lock = threading.Lock()
        self._running: set[str] = set()
        self._waiting: dict[str, Callable[[], object]] = {}  # what begins each, in their order

    @property
    def running(self) -> int:
        """Runs that simulate."""
        return len(self._running)

    @property
    def waiting(self) -> int:
        """Runs that wait."""
        return len(self._waiting)

    def place(self, run_id: str) -> int | None:
        """Place of a run among those that wait, from 1; None if it does not."""
        with self._lock:
            ids = list(self._waiting)
        return ids.index(run_id) + 1 if run_id in ids else None

    def enter(self, run_id: str, begin: Callable[[], object]) -> None:
        """Lets a run begin, or wait for its turn.

        Args:
            run_id: name of the run.
            begin: begins it; called here, or when another run leaves, in that thread.

        Raises:
            ControlError: `queue_full`.
        """
        with self._lock:
            free = len(self._running) < self._workers
            if free:
                self._running.add(run_id)
            elif len(self._waiting) >= self._length:
                message = f"{len(self._running)} runs are under way and {len(self._waiting)} wait"
                waiting = len(self._waiting)
                raise queue_full(message, waiting, "ask again in a while", retry_after=10.0)
            else:
                self._waiting[run_id] = begin
                place = len(self._waiting)
        if free:
            begin()
        else:
            self._on_moved(run_id, place)

    def leave(self, run_id: str) -> None:
        """Takes out a run that has ended, or that is to begin no more; the next one begins."""
        with self._lock:
            self._running.discard(run_id)
            self._waiting.pop(run_id, None)
            following: list[Callable[[], object]] = []
            while self._waiting and len(self._running) < self._workers:
                first = next(iter(self._waiting))
                self._running.add(first)
                following.append(self._waiting.pop(first))
            places = [(waiting, i) for i, waiting in enumerate(self._waiting, start=1)]
        for begin in following:
            begin()
        for moved, place in places:
            self._on_moved(moved, place)


ENDING = 10.0
"""Longest time that the end of a run is waited for before the next one begins [s]."""


WRITTEN_AGAIN = 2.0
"""Time after which an end that the store did not take is written again [s]."""

LOGGER = logging.getLogger("nlcontrol.service")


class LiveRun:
    """A run that has not ended.

    Attributes:
        info: the run as it is now.
        session: session of the run.
        changed: rung at each change.
        ended: set at its end.
        unwritten: events that the store has not taken yet.
        has_turn: it may simulate.
        is_ending: nothing moves any more; its trace and its result are on their way.
        is_aborted: its process is being ended.
    """

    def __init__(self, run_id: str, session: LiveSession) -> None:
        self.run_id, self.session = run_id, session
        self.info: RunInfo | None = None
        self.changed = LoopNotifier()
        self.ended = threading.Event()
        self.unwritten: list[NumberedEvent] = []
        self.has_turn = self.is_ending = self.is_aborted = False


class LiveRuns:
    """All that are queued or under way, and those whose end the store has not taken yet.

    What happens counts, whether or not it can be written: an end that the store refuses is told as
    it is, and written again until it is there. Nothing is written under the lock.

    Args:
        store: store that records them.
        workers: runs that may simulate at once.
        queue: runs that may wait.
    """

    def __init__(self, store: RunStore, workers: int, queue: int) -> None:
        self._store = store
        self._lock = threading.RLock()
        self._runs: dict[str, LiveRun] = {}
        self._unwritten: dict[str, LiveRun] = {}
        self._writing = threading.Lock()
        self.queue = SimulationQueue(workers, queue, self._note_place)

    def begin(self, session: LiveSession, asked: Mapping[str, Any], key: str | None) -> RunInfo:
        """Begins a run, or lets it wait for its turn; see `PlanningService.begin_run`."""
        request = hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).digest()
        with session.beginning():
            if key is not None:
                known = self._store.run_of_key(session.session_id, key, request)
                if known is not None:
                    return self.run(known.run_id)
            session.require_process()
            before = self._runs.get(session.run_id or "")
            if before is not None and before.is_ending:
                before.ended.wait(ENDING)
            session.wait_undone(ENDING)
            if session.run_id is not None:
                raise _busy(session.run_id)
            run = LiveRun(f"run-{secrets.token_hex(8)}", session)
            with self._lock:
                self._runs[run.run_id] = run
                session.run_id = run.run_id
            try:
                self.queue.enter(run.run_id, lambda: self._give_turn(run))
                begun = session.call("begin_run", **asked).result()
                try:
                    self._note_begin(run, RunInfo.model_validate_json(begun), key, request)
                except BaseException:
                    with suppress(ControlError):  # its process may have ended: there it waits
                        session.process.command("drop_run").result()
                    raise
            except BaseException:
                self._forget(run)
                raise
        return self.run(run.run_id)

    def run(self, run_id: str) -> RunInfo:
        """A run as it is now; raises `unknown_run`."""
        return self.live_info(run_id) or self._store.run(run_id)

    def live_info(self, run_id: str) -> RunInfo | None:
        """The run as it is now if the store does not have it so; waits for nothing."""
        live = self._runs.get(run_id) or self._unwritten.get(run_id)
        return None if live is None else live.info

    def wait(self, run_id: str, timeout: float | None) -> RunInfo:
        """The run once it has ended, or as it is after a time [s]; raises `unknown_run`."""
        live = self._live(run_id)
        if live is not None:
            live.ended.wait(timeout)
        return self.run(run_id)

    def stop(self, run_id: str) -> None:
        """Asks a run to come to rest; nothing if it is not under way. Waits for nothing."""
        live = self._runs.get(run_id)
        if live is not None and not live.session.is_lost:
            live.session.process.command("stop_run")

    def abort(self, run_id: str) -> None:
        """Ends the process of a run; nothing if it is not under way. Waits for nothing."""
        live = self._runs.get(run_id)
        if live is not None:
            live.is_aborted = True
            live.session.process.kill()

    def write_ends(self) -> None:
        """Writes the ends that the store has not taken yet.

        Raises:
            ControlError: it still does not.
        """
        with self._writing:
            for run in list(self._unwritten.values()):
                assert run.info is not None, "it has ended"
                with _absence_passed():
                    self._store.add_events(run.run_id, run.unwritten)
                    self._store.put_run(run.info)
                with self._lock:
                    self._unwritten.pop(run.run_id, None)

    async def events(self, run_id: str, after: int = 0) -> AsyncIterator[NumberedEvent]:
        """Events of a run after a number, as they happen, until it has ended."""
        live = self._live(run_id)
        with (live.changed if live is not None else LoopNotifier()).subscription() as changed:
            while True:
                changed.clear()
                has_ended = self._live(run_id) is None
                run = live or self._unwritten.get(run_id)
                fresh = [] if run is None else list(run.unwritten)
                for each in (*self._store.events(run_id, after), *fresh):
                    if each.number > after:
                        yield each
                        after = each.number
                if has_ended:
                    return
                await changed.wait()

    def take(self, session: LiveSession, topic: str, content: bytes) -> None:
        """Notes what the process of a session tells of its run."""
        run = self._runs.get(session.run_id or "")
        if run is None or run.info is None:
            return
        match topic:
            case "event":
                event = Event.model_validate_json(content)
                with self._lock:
                    assert run.info is not None, "it was begun"
                    number = run.info.events + 1
                    run.info = run.info.model_copy(update={"events": number})
                    run.unwritten.append(NumberedEvent(number=number, event=event))
                run.is_ending = event.kind == "ended"
                try:
                    self._store.add_events(run.run_id, run.unwritten)
                    run.unwritten.clear()
                except ControlError as raised:
                    LOGGER.error("events of a run are kept for later: %s", raised.info.message)
                run.changed.notify()
            case "trace" | "request":
                with self._store.write_file(run.run_id, topic) as path:
                    path.write_bytes(content)
            case "ended":
                end = RunEnd.model_validate_json(content)
                defect = end.error is not None and end.error.status.exit == INTERNAL
                self._end(run, "defect" if defect else "ended", end)

    def note_loss(self, session: LiveSession) -> None:
        """Ends the run of a session whose process has ended."""
        run = self._runs.get(session.run_id or "")
        if run is None or run.info is None:
            return
        state: RunState = "aborted" if run.is_aborted else "cut_off"
        message = "it was aborted" if run.is_aborted else "its process has ended unexpectedly"
        info = ErrorInfo(
            code="aborted" if run.is_aborted else "cut_off",
            message=f"{message}, and its session with it",
            suggestions=("open a new session, and look before anything moves",),
        )
        self._end(run, state, RunEnd(error=info))

    def _live(self, run_id: str) -> LiveRun | None:
        """A run that has not ended; None if it has.

        Raises:
            ControlError: `unknown_run`.
        """
        run = self._runs.get(run_id)
        if run is None and run_id not in self._unwritten:
            self._store.run(run_id)
        return run

    def _note_begin(self, run: LiveRun, begun: RunInfo, key: str | None, request: bytes) -> None:
        """Puts a run into the store, and lets it go on if it has its turn."""
        now = time.time()
        begun = begun.model_copy(
            update={
                "run_id": run.run_id,
                "session_id": run.session.session_id,
                "state": "queued",
                "place": None,
                "asked_at": now,
                "begun_at": None,
                "events": 0,
            }
        )
        self._store.add_run(begun, key=key, request=request)
        with self._lock:
            run.info = begun
        self._note_place(run.run_id, self.queue.place(run.run_id))
        self._go_on(run)

    def _give_turn(self, run: LiveRun) -> None:
        run.has_turn = True
        self._go_on(run)

    def _go_on(self, run: LiveRun) -> None:
        """Lets a run move that is begun and has its turn."""
        with self._lock:
            if run.info is None or run.info.state != "queued" or not run.has_turn:
                return
            changes = {"state": "running", "place": None, "begun_at": time.time()}
            run.info = info = run.info.model_copy(update=changes)
        try:
            self._store.put_run(info)
        except ControlError as raised:  # it was noted as one that waits
            LOGGER.error("a run that begins to move is not noted: %s", raised.info.message)
        run.changed.notify()
        run.session.process.command("take_turn")

    def _note_place(self, run_id: str, place: int | None) -> None:
        with self._lock:
            run = self._runs.get(run_id)
            if run is not None and run.info is not None and run.info.state == "queued":
                run.info = run.info.model_copy(update={"place": place})
                run.changed.notify()

    def _end(self, run: LiveRun, state: RunState, end: RunEnd) -> None:
        """Ends a run; who sees that it has ended may begin the next one."""
        changes = {"state": state, "place": None, "ended_at": time.time()}
        with self._lock:
            assert run.info is not None, "it was begun"
            run.info = run.info.model_copy(
                update={**changes, "result": end.result, "error": end.error}
            )
            self._unwritten[run.run_id] = run
        self._write_ends()
        self._forget(run)

    def _write_ends(self) -> None:
        """Writes the ends that are not written, now or later."""
        try:
            self.write_ends()
        except ControlError as raised:
            LOGGER.error("the end of a run is kept for later: %s", raised.info.message)
            daemon_timer(WRITTEN_AGAIN, self._write_ends)

    def _forget(self, run: LiveRun) -> None:
        """Lets the next one begin in the place of a run that has ended."""
        with self._lock:
            self._runs.pop(run.run_id, None)
            if run.session.run_id == run.run_id:
                run.session.run_id = None
                run.session.note_use()
        self.queue.leave(run.run_id)
        run.ended.set()
        run.changed.notify()


@contextmanager
def _absence_passed() -> Iterator[None]:
    """Context in which it is all the same that the store has no such run, or none any more."""
    try:
        yield
    except ControlError as raised:
        if raised.code != "unknown_run":
            raise


def _busy(run_id: str) -> ControlError:
    return error(
        "busy",
        f"the run {run_id} is under way or queued in this session",
        suggestions=("wait until it has ended", "stop it"),
    )
