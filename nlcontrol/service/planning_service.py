"""The planning service: sessions, plans and runs for many callers; HTTP and MCP are its faces.

Each session has a worker process of its own, callers without one share some others, and the runs of
all sessions queue up for the processors. Methods may be called from any thread. Those that wait for
a process return a future, of a JSON document.
"""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import AsyncIterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal, NoReturn, Self

from nlcontrol.errors import ControlError, error
from nlcontrol.service.run_store import RunStore, bundle_file, unwritable
from nlcontrol.service.service_settings import ServiceSettings
from nlcontrol.service.workers.live_runs import LiveRuns
from nlcontrol.service.workers.live_session import LiveSession
from nlcontrol.service.workers.session_host import SessionHost
from nlcontrol.service.workers.worker_pool import WorkerPool
from nlcontrol.service.workers.worker_process import WorkerProcess
from objectmodels.errors import suggest
from sim.truth.scene_file import built_in_scenes

if TYPE_CHECKING:
    from nlcontrol.service.documents import (
        NumberedEvent,
        RunInfo,
        RunPage,
        SessionInfo,
        SessionSpec,
        TableSpec,
    )
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames
    from objectmodels import ObjectModel


FileOfRun = Literal["trace", "replay", "recording", "bundle"]


class RunFiles:
    """Files of the runs of a store.

    Args:
        store: store of the runs.
        time_limit: longest time for making a replay [s].
    """

    def __init__(self, store: RunStore, time_limit: float) -> None:
        self._store, self._time_limit = store, time_limit
        self._making = threading.Lock()

    def file(self, run_id: str, kind: FileOfRun) -> Path:
        """A file of a run; all but its trace are made the first time.

        The trace is an npz file (`sim.traces.trace`), the replay an HTML page, the recording what a
        replay shows, for the page's viewer, and the bundle all of it in one zip file
        (`nlcontrol.service.bundle`).

        Raises:
            ControlError: `unknown_run`; `no_file`, or of a bundle `run_under_way`.
        """
        if kind == "trace":
            return self._store.file(run_id, kind) or _refuse(run_id, "nothing has moved in it")
        if kind != "bundle":
            return self._made(run_id, kind)
        if self._store.file(run_id, kind) is None and self._store.file(run_id, "trace"):
            with suppress(ControlError):  # a bundle without it is better than none
                self._made(run_id, "replay")
        return bundle_file(self._store, run_id)

    def _made(self, run_id: str, kind: Literal["replay", "recording"]) -> Path:
        trace = self.file(run_id, "trace")
        with self._making:
            made = self._store.file(run_id, kind)
            if made is not None:
                return made
            run = self._store.run(run_id)
            session = self._store.session_spec(run.session_id)
            if session is None:
                return _refuse(run_id, "its session is not known any more")
            process = WorkerProcess(SessionHost)
            try:
                with self._store.write_file(run_id, kind) as path:
                    process.call(
                        kind,
                        trace=str(trace),
                        scene=session.scene,
                        path=str(path),
                        result=run.result and run.result.model_dump_json(),
                    ).result(self._time_limit)
            except ControlError as raised:
                # The trace was written here, so that no caller is to blame if it cannot be read.
                if raised.code in ("bad_trace", "unreadable_file"):
                    return _refuse(run_id, f"its trace is damaged: {raised.info.message}")
                # The process could not write its file into the store.
                if raised.code in ("system_error", "cannot_write"):
                    raise unwritable(raised.info.message) from raised
                raise
            finally:
                process.kill()
        return self._store.file(run_id, kind) or _refuse(run_id, "it was deleted")


def _refuse(run_id: str, why: str) -> NoReturn:
    raise error(
        "no_file",
        f"the run {run_id} has no such file: {why}",
        suggestions=("read the run itself, and its events",),
    )


class PlanningService:
    """The service, from `start` to `close`.

    Args:
        settings: settings of the service.

    Attributes:
        waiting_room: threads for those who wait for a process, a disk or a run; nobody else's.
    """

    def __init__(self, settings: ServiceSettings | None = None) -> None:
        self.settings = settings = settings or ServiceSettings()
        self._resources = ExitStack()
        folder = settings.store
        if folder is None:
            folder = Path(self._resources.enter_context(TemporaryDirectory(prefix="nlcontrol-")))
        self._store = RunStore(folder, keep_bytes=settings.keep_bytes)
        self._resources.callback(self._store.close)
        self._workers = WorkerPool(
            settings.planners, self._most_sessions, settings.queue, settings.request_time
        )
        self._runs = LiveRuns(self._store, settings.workers, settings.queue)
        self._files = RunFiles(self._store, settings.request_time)
        # 64 callers wait for a process at once; the next ones wait for them.
        self.waiting_room = ThreadPoolExecutor(64, "waiting")
        self._lock = threading.RLock()
        self._sessions: dict[str, LiveSession] = {}
        self._gone: dict[str, str] = {}
        self._closed = threading.Event()

    def start(self) -> None:
        """Starts the first workers."""
        self._workers.start()
        threading.Thread(target=self._close_idle_sessions, daemon=True).start()

    def close(self) -> None:
        """Asks all runs to come to rest, waits for that, and ends all processes."""
        self._closed.set()
        sessions = list(self._sessions.values())
        for session in sessions:
            self._ask_to_rest(session)
        deadline = time.monotonic() + self.settings.stop_time
        while time.monotonic() < deadline and any(s.run_id is not None for s in sessions):
            time.sleep(0.05)
        self._workers.close()
        self.waiting_room.shutdown(wait=False, cancel_futures=True)
        with suppress(ControlError):  # it was told to the log when it was tried
            self._runs.write_ends()
        self._resources.close()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def call_planner(self, method: str, table: TableSpec, **arguments: Any) -> Future[bytes]:
        """Calls a method of a session that is opened for this call alone; nothing moves.

        Args:
            method: `parse`, `ask`, `predict`, `map`, `affordances`, `plan` or `look`.
            table: table to plan for.
            arguments: arguments of the method.

        Raises:
            ControlError: `unknown_scene`, `queue_full`; the future also what the method raises,
                and `time_limit`.
        """
        self._require_scene(table)
        return self._workers.call(method, table, **arguments)

    def scenes(self) -> tuple[str, ...]:
        """Names of the scenes that may be asked for."""
        named = self.settings.scenes
        return built_in_scenes() if named is None else named

    def objects(self) -> tuple[ObjectModel, ...]:
        """Object models of the host."""
        from objectmodels import Registry

        return tuple(Registry.default())

    def health(self) -> dict[str, int]:
        """Numbers of what there is and what waits."""
        return {
            "sessions": len(self._sessions),
            "planners": self._workers.size,
            "running": self._runs.queue.running,
            "queued": self._runs.queue.waiting,
        }

    def open_session(self, spec: SessionSpec) -> SessionInfo:
        """Opens a session; waits until its table is there.

        Where all places are taken, the session that was left alone the longest makes room.

        Raises:
            ControlError: `unknown_scene`, `too_many_sessions`; what is wrong with the table.
        """
        self._require_scene(spec)
        session_id = f"session-{secrets.token_hex(8)}"
        with self._lock:
            self._make_room()
            session = LiveSession(session_id, spec, self.settings)
            session.process = self._workers.lease(
                partial(self._take, session), partial(self._note_loss, session)
            )
            self._sessions[session_id] = session
        try:
            session.call(
                "open",
                spec=spec.model_dump_json(),
                executor=self.settings.executor,
                time_limit=self.settings.request_time,
            ).result()
        except BaseException:
            self._end_session(session)
            raise
        self._store.add_session(session_id, spec)
        return session.info()

    def sessions(self) -> tuple[SessionInfo, ...]:
        """The sessions that are open."""
        with self._lock:
            sessions = list(self._sessions.values())
        return tuple(session.info() for session in sessions)

    def session_pids(self) -> tuple[int, ...]:
        """Numbers of the processes of the sessions that are open."""
        with self._lock:
            return tuple(session.process.pid for session in self._sessions.values())

    def session(self, session_id: str) -> SessionInfo:
        """A session that is open; raises `unknown_session`."""
        return self._session(session_id).info()

    def call_session(self, session_id: str, method: str, **arguments: Any) -> Future[bytes]:
        """Calls a method of a session: those of `call_planner`, and `reset`.

        Raises:
            ControlError: `unknown_session`, `session_lost`, `queue_full`; the future also what the
                method raises, and `time_limit`.
        """
        return self._session(session_id).call(method, **arguments)

    def stop_session(self, session_id: str) -> None:
        """Asks the run of a session to come to rest; its plans are dropped. Waits for nothing."""
        session = self._session(session_id)
        session.require_process()
        session.process.command("stop")

    def close_session(self, session_id: str) -> None:
        """Closes a session; its run comes to rest first, but not for longer than `stop_time`."""
        session = self._session(session_id)
        self._ask_to_rest(session)
        threading.Thread(target=self._end_at_rest, args=(session,), daemon=True).start()

    def leave_session(self, session_id: str, after: float) -> None:
        """Closes a session once nobody has used it for a time [s], unless it is taken up before."""
        self._session(session_id).leave(after)

    def scene_geometry(self, session_id: str) -> Future[bytes]:
        """All that a viewer draws of a session (JSON of `SceneGeometry`), for `live`."""
        return self._session(session_id).call("geometry")

    async def live(self, session_id: str) -> AsyncIterator[bytes]:
        """Frames of poses for a viewer (JSON of `PoseFrame`), as long as the session is open."""
        session = self._session(session_id)
        session.take_up()
        with session.frames.subscription() as heard:
            session.tell_frames(wanted=True)
            try:
                heard.set()
                while session.session_id in self._sessions and not session.is_lost:
                    await heard.wait()
                    heard.clear()
                    if session.frame is not None:
                        yield session.frame
            finally:
                session.tell_frames(wanted=session.frames.listeners > 1)

    def begin_run(
        self,
        session_id: str,
        plan_id: str | None = None,
        said: str | Frames | None = None,
        motion: Motion | None = None,
        *,
        idempotency_key: str | None = None,
    ) -> RunInfo:
        """Begins to carry out a plan that was approved, or a sentence; it may have to queue.

        Args:
            session_id: name of the session.
            plan_id: name of the plan of an `Offer` of the session.
            said: a sentence, or frames; with a plan id the text under which it was approved, if
                that is to be compared.
            motion: motion that a sentence may make; see `PlanningSession.say`.
            idempotency_key: asked twice under it, the run is begun once.

        Raises:
            ControlError: `unknown_session`, `session_lost`, `queue_full`, `key_reused`; what
                `PlanningSession.start` raises.
        """
        return self._runs.begin(
            self._session(session_id),
            {"plan_id": plan_id, "said": said, "motion": motion},
            idempotency_key,
        )

    def runs(
        self, session_id: str | None = None, cursor: str | None = None, limit: int = 50
    ) -> RunPage:
        """Runs, the newest first, a page at a time; see `RunStore.runs`."""
        page = self._store.runs(session_id, cursor=cursor, limit=limit)
        now = (self._runs.live_info(stored.run_id) or stored for stored in page.runs)
        return page.model_copy(update={"runs": tuple(now)})

    def run(self, run_id: str) -> RunInfo:
        """A run as it is now; raises `unknown_run`."""
        return self._runs.run(run_id)

    def events_so_far(self, run_id: str, after: int = 0) -> tuple[NumberedEvent, ...]:
        """Events of a run after a number; raises `unknown_run`."""
        return self._store.events(run_id, after)

    def events(self, run_id: str, after: int = 0) -> AsyncIterator[NumberedEvent]:
        """Events of a run after a number, as they happen, until it has ended."""
        return self._runs.events(run_id, after)

    def wait_for_run(self, run_id: str, timeout: float | None = None) -> RunInfo:
        """The run once it has ended, or as it is after a time [s]; raises `unknown_run`."""
        return self._runs.wait(run_id, timeout)

    def stop_run(self, run_id: str) -> None:
        """Asks a run to let go and come to rest, if it is under way; waits for nothing."""
        self._runs.stop(run_id)

    def abort_run(self, run_id: str) -> None:
        """Ends the process of a run that is under way, its session with it; waits for nothing."""
        self._runs.abort(run_id)

    def live_run(self, run_id: str) -> RunInfo | None:
        """A run that is under way, as it is now; None if it is not. Waits for nothing."""
        return self._runs.live_info(run_id)

    def delete_run(self, run_id: str) -> None:
        """Removes a run that has ended; raises `unknown_run`, `run_under_way`."""
        self._runs.write_ends()
        self._store.delete_run(run_id)

    def run_file(self, run_id: str, kind: FileOfRun) -> Path:
        """A file of a run; see `RunFiles.file`."""
        return self._files.file(run_id, kind)

    def _session(self, session_id: str) -> LiveSession:
        session = self._sessions.get(session_id)  # without a lock: a stop comes by here
        if session is None:
            raise error(
                "unknown_session",
                f"there is no open session {session_id[:80]!r}: "
                + self._gone.get(session_id, "it was closed, or nothing was asked of it for long"),
                suggestions=("open a new one",),
            )
        return session

    def _require_scene(self, table: TableSpec) -> None:
        """Keeps out what is no name, such as the path of a file."""
        if table.scene not in self.scenes():
            raise error(
                "unknown_scene",
                f"there is no scene {table.scene[:80]!r}",
                suggestions=suggest(table.scene[:80], self.scenes()) or self.scenes(),
            )

    @property
    def _most_sessions(self) -> int:
        return 1 if self.settings.executor is not None else self.settings.sessions

    def _make_room(self) -> None:
        """Gives the place of the session that was left alone the longest to the next one.

        Raises:
            ControlError: `too_many_sessions` if none was.
        """
        if len(self._sessions) < self._most_sessions:
            return
        left = [s for s in self._sessions.values() if s.is_left_alone]
        if not left:
            raise error(
                "too_many_sessions",
                f"{len(self._sessions)} sessions are in use, and no more are allowed",
                suggestions=("close one", "ask again when one has ended"),
                numbers={"sessions": float(self._most_sessions), "retry_after": 30.0},
            )
        gone = max(left, key=lambda session: session.idle_for)
        self._gone[gone.session_id] = f"it was unused for {gone.idle_for:.0f} s and made room"
        # It is still told why the last thousand are gone.
        while len(self._gone) > 1000:
            del self._gone[next(iter(self._gone))]
        self._end_session(gone)

    def _take(self, session: LiveSession, topic: str, content: bytes) -> None:
        if topic == "pose_frame":
            session.frame = content
            session.frames.notify()
        else:
            self._runs.take(session, topic, content)

    def _note_loss(self, session: LiveSession) -> None:
        session.is_lost = True
        self._runs.note_loss(session)
        session.frames.notify()

    def _ask_to_rest(self, session: LiveSession) -> None:
        if session.run_id is not None and not session.is_lost:
            session.process.command("stop_run")

    def _end_at_rest(self, session: LiveSession) -> None:
        """Ends a session once its run has come to rest, or its time for that is over."""
        if session.run_id is not None:
            self._runs.wait(session.run_id, self.settings.stop_time)
        self._end_session(session)

    def _end_session(self, session: LiveSession) -> None:
        with self._lock:
            self._sessions.pop(session.session_id, None)
        session.process.kill()
        session.frames.notify()

    def _close_idle_sessions(self) -> None:
        # Idle sessions are looked for once a second.
        while not self._closed.wait(1.0):
            with self._lock:
                sessions = list(self._sessions.values())
            for session in sessions:
                if session.expires_in == 0.0:
                    self._end_session(session)
