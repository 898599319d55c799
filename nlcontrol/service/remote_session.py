"""A planning service as a program uses it: sessions and runs as those of this process are.

    from nlcontrol import Client

    with Client("http://127.0.0.1:8000") as client, client.sessions.open("kitchen") as session:
        print(session.say("push the ice tea box away"))

Making a client calls nothing; a lost connection is made anew where nothing is done twice by that.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from threading import Thread
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel

from nlcontrol.argument_types import checked_arguments
from nlcontrol.errors import ControlError
from nlcontrol.results.result import Result
from nlcontrol.service.connection import BlockingConnection
from nlcontrol.service.documents import (
    Health,
    NumberedEvent,
    ObjectDescription,
    ObjectList,
    ObjectSummary,
    Offer,
    RunInfo,
    RunPage,
    SceneList,
    SceneSummary,
    SessionInfo,
    SessionList,
    SessionSpec,
    StatedObject,
    session_spec,
)
from nlcontrol.service.methods import Closed, PlanningSession, Question, is_question
from nlcontrol.service.remote_calls import (
    EventReading,
    HostCalls,
    RunCalls,
    SessionCalls,
    result_of,
)
from nlcontrol.session.events import LOGGER, Event
from nlcontrol.session.executor import Motion
from nlcontrol.session.frame_documents import Frames
from sim.traces.trace import Trace

if TYPE_CHECKING:
    pass


class RemoteRun:
    """A run at a server; see `nlcontrol.service.methods.Run`.

    Args:
        connection: connection to the service.
        run_id: name of the run.
        on_event: told of every event, in a thread of its own. If it fails, the run is told to stop,
            and `result` raises what it raised.
    """

    def __init__(
        self,
        connection: BlockingConnection,
        run_id: str,
        on_event: Callable[[Event], object] | None = None,
    ) -> None:
        self._connection, self._run_id = connection, run_id
        self._calls = RunCalls(connection, run_id)
        self._listener: Thread | None = None
        self._failure: Exception | None = None
        if on_event is not None:
            self._listener = Thread(target=self._listen, args=(on_event,), daemon=True)
            self._listener.start()

    def __repr__(self) -> str:
        return f"<Run {self._run_id} at {self._connection.url}>"

    @property
    def run_id(self) -> str:
        """Name of the run."""
        return self._run_id

    def info(self) -> RunInfo:
        """The run as it is now."""
        return self._connection.run(self._calls.read())

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended; what is lost on the way is had again.

        Args:
            after: number of the last event that is known already.

        Raises:
            ControlError: `no_service` if the service stays away.
        """
        reading = EventReading(after)
        while True:
            try:
                for data in self._connection.stream(f"{self._calls.path}/events", reading.after):
                    if (told := reading.fresh_event(data)) is None:
                        continue
                    yield told
                    if told.event.kind == "ended":
                        return
            except ControlError as lost:
                reading.require_hope(lost)
            if reading.is_over(self.info()):
                return
            time.sleep(reading.next_pause())

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended.

        Args:
            timeout: longest time to wait, by the clock on the wall [s]; None for no limit.

        Raises:
            TimeoutError: it goes on.
            ControlError: it has no result; the code says why.
            Exception: what the callback has raised.
        """
        info = self._ended_info(timeout)
        if self._failure is not None:
            raise self._failure
        return result_of(info)

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""
        self._connection.run(self._calls.stop())

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""
        self._ended_info(None)
        return self._connection.run(self._calls.trace())

    def _ended_info(self, timeout: float | None) -> RunInfo:
        """The run once it has ended, and the callback was told so."""
        if self._listener is not None:
            begun = time.monotonic()
            self._listener.join(timeout)
            timeout = None if timeout is None else timeout - (time.monotonic() - begun)
        return self._connection.run(self._calls.read_ended(timeout))

    def _listen(self, on_event: Callable[[Event], object]) -> None:
        try:
            for told in self.events():
                if self._failure is None:
                    self._tell(on_event, told.event)
        except ControlError as lost:
            LOGGER.warning("events of run %s are missing: %s", self._run_id, lost)

    def _tell(self, on_event: Callable[[Event], object], event: Event) -> None:
        try:
            on_event(event)
        except Exception as raised:
            self._failure = raised
            self.stop()


class RemoteSession(PlanningSession):
    """A planning session at a server; see `nlcontrol.service.methods.PlanningSession`.

    Every call raises `no_service` where the service is lost.

    Args:
        connection: connection to the service.
        info: the session as it was opened.
    """

    def __init__(self, connection: BlockingConnection, info: SessionInfo) -> None:
        self._connection = connection
        self._calls = SessionCalls(connection, info)
        self.session_id, self.spec = info.session_id, info.spec
        self._has_robot = info.has_robot

    def __repr__(self) -> str:
        return f"<Session {self.session_id} of {self.spec.scene} at {self._connection.url}>"

    @property
    def has_robot(self) -> bool:
        """Plans can be carried out here; not on a table that was stated."""
        return self._has_robot

    def answer_question(self, asked: Question, fields: Mapping[str, Any]) -> BaseModel:
        """The document with which the service answers a question."""
        return self._connection.run(self._calls.answer(asked, fields))

    @checked_arguments
    def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """The answer to a question; it moves nothing unless that is allowed."""
        if motion == "simulate" and is_question(self, said):
            return self.say(said, motion=motion)
        return super().ask(said)

    @checked_arguments
    def start(
        self,
        said: str | Frames | Offer | None = None,
        *,
        plan_id: str | None = None,
        text: str | None = None,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> RemoteRun:
        """Begins to do what a sentence says, or what was planned; see `PlanningSession.start`."""
        info = self._connection.run(self._calls.start(said, plan_id, text, motion))
        return RemoteRun(self._connection, info.run_id, on_event)

    def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped."""
        self._connection.run(self._calls.post("stop"))

    def reset(self) -> None:
        """Puts everything back as it was at the beginning; see `PlanningSession.reset`."""
        self._connection.run(self._calls.post("reset"))

    def close(self) -> None:
        """Ends the session; one that has ended with its server is left at that."""
        self._connection.run(self._calls.close())


class RemoteSessions:
    """The sessions of a service."""

    def __init__(self, connection: BlockingConnection) -> None:
        self._connection, self._calls = connection, HostCalls(connection)

    def __repr__(self) -> str:
        return f"<Sessions at {self._connection.url}>"

    @checked_arguments
    def open(
        self,
        scene: SessionSpec | str = "kitchen",
        *,
        seed: int = 0,
        defaults: Mapping[str, float] | None = None,
        objects: Sequence[StatedObject] | None = None,
        approval: Literal["plan", "none"] = "none",
    ) -> RemoteSession:
        """Opens a session.

        Args:
            scene: name of a scene of the host, or all that is asked for of the session.
            seed: seed of everything random.
            defaults: meanings of clauses by their names, on top of the scene's.
            objects: all that stands on a table of the caller's own.
            approval: `plan` if nothing may move but what was approved.

        Raises:
            ControlError: `no_service`, or what the service has against it.
        """
        spec = session_spec(scene, seed, defaults, objects, approval)
        info = self._connection.run(self._calls.open_session(spec))
        return RemoteSession(self._connection, info)

    @checked_arguments
    def get(self, session_id: str) -> RemoteSession:
        """A session that is open; raises `unknown_session`."""
        info = self._connection.run(self._calls.read(SessionInfo, f"sessions/{session_id}"))
        return RemoteSession(self._connection, info)

    def list(self) -> tuple[SessionInfo, ...]:
        """All that are open."""
        return self._connection.run(self._calls.read(SessionList, "sessions")).sessions


class RemoteRuns:
    """The runs of a service, and those that it remembers."""

    def __init__(self, connection: BlockingConnection) -> None:
        self._connection, self._calls = connection, HostCalls(connection)

    def __repr__(self) -> str:
        return f"<Runs at {self._connection.url}>"

    @checked_arguments
    def get(self, run_id: str) -> RemoteRun:
        """A run by its name; raises `unknown_run`."""
        info = self._connection.run(self._calls.read(RunInfo, f"runs/{run_id}"))
        return RemoteRun(self._connection, info.run_id)

    @checked_arguments
    def list(
        self, *, session: str | None = None, cursor: str | None = None, limit: int = 50
    ) -> RunPage:
        """Runs, the latest first.

        Args:
            session: those of one session alone, by its name.
            cursor: cursor of the page before.
            limit: runs on the page, at most.
        """
        page = self._calls.read(RunPage, "runs", session=session, cursor=cursor, limit=limit)
        return self._connection.run(page)

    @checked_arguments
    def delete(self, run_id: str) -> None:
        """Has the service forget a run that has ended, its events and its files."""
        self._connection.run(self._calls.delete_run(run_id))


class Client(Closed):
    """A planning service; making one calls nothing.

    Args:
        url: address of the service, like `http://127.0.0.1:8000`.
        token: token that the service asks for, if any.
        timeout: longest wall-clock time to wait for an answer [s].
        transport: carrier of the requests, if not a network.

    Attributes:
        sessions: opens sessions, and lists those that are open.
        runs: under way, and those that the service remembers.

    Raises:
        ControlError: `missing_extra` without httpx; `usage` if the URL is none. Every call raises
            `no_service` where the service is not reached.
    """

    @checked_arguments
    def __init__(
        self,
        url: str,
        *,
        token: str | None = None,
        timeout: float = 120.0,
        transport: Any = None,
    ) -> None:
        self._connection = BlockingConnection(
            url, token=token, timeout=timeout, transport=transport
        )
        self._calls = HostCalls(self._connection)
        self.sessions = RemoteSessions(self._connection)
        self.runs = RemoteRuns(self._connection)

    def __repr__(self) -> str:
        return f"<Client of {self._connection.url}>"

    def health(self) -> Health:
        """Version of the service, and how much it has to do."""
        return self._connection.run(self._calls.read(Health, "health"))

    def scenes(self) -> tuple[SceneSummary, ...]:
        """Scenes in which sessions can be opened."""
        return self._connection.run(self._calls.read(SceneList, "scenes")).scenes

    def objects(self) -> tuple[ObjectSummary, ...]:
        """Object models of the host, in a few figures."""
        return self._connection.run(self._calls.read(ObjectList, "objects")).objects

    @checked_arguments
    def object(self, name: str) -> ObjectDescription:
        """An object model by its name or a synonym; raises `unknown_object`."""
        return self._connection.run(self._calls.read(ObjectDescription, f"objects/{name}"))

    def close(self) -> None:
        """Ends the connection; sessions and runs of the service go on."""
        self._connection.close()
