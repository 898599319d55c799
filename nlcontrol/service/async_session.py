"""A planning service for programs that await: as `nlcontrol.service.remote_session` otherwise.

    from nlcontrol import AsyncClient

    async with AsyncClient(url) as client, await client.sessions.open("kitchen") as session:
        print(await session.say("push the ice tea box away"))

A wait that is cancelled stops what it waits for.
"""

from __future__ import annotations

import asyncio
import inspect
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from types import TracebackType
from typing import Any, Concatenate, Generic, Literal, ParamSpec, Self, TypeVar, cast, overload

from pydantic import BaseModel

from nlcontrol.argument_types import checked_arguments
from nlcontrol.errors import ControlError
from nlcontrol.results.result import Result
from nlcontrol.service.connection import AwaitedConnection
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
from nlcontrol.service.methods import QUESTIONS, Question, Questions, asks_only, plan_id_of
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

Given = ParamSpec("Given")
Answer = TypeVar("Answer")

EventListener = Callable[[Event], object | Awaitable[object]]
"""What is told of events: a function, or one that is awaited."""


class AsyncRun:
    """A run at a server, awaited; see `nlcontrol.service.methods.Run`.

    Args:
        connection: connection to the service.
        run_id: name of the run.
        on_event: told of every event, in a task of its own. If it fails, the run is told to stop,
            and `result` raises what it raised.
    """

    def __init__(
        self, connection: AwaitedConnection, run_id: str, on_event: EventListener | None = None
    ) -> None:
        self._connection, self._run_id = connection, run_id
        self._calls = RunCalls(connection, run_id)
        self._failure: Exception | None = None
        self._listener: asyncio.Task[None] | None = None
        if on_event is not None:
            self._listener = asyncio.create_task(self._listen(on_event))

    def __repr__(self) -> str:
        return f"<AsyncRun {self._run_id} at {self._connection.url}>"

    @property
    def run_id(self) -> str:
        """Name of the run."""
        return self._run_id

    async def info(self) -> RunInfo:
        """The run as it is now."""
        return await self._connection.run(self._calls.read())

    async def events(self, after: int = 0) -> AsyncIterator[NumberedEvent]:
        """Its events as they happen, until it has ended; what is lost on the way is had again.

        Args:
            after: number of the last event that is known already.

        Raises:
            ControlError: `no_service` if the service stays away.
        """
        reading = EventReading(after)
        while True:
            try:
                path = f"{self._calls.path}/events"
                async for data in self._connection.stream(path, reading.after):
                    if (told := reading.fresh_event(data)) is None:
                        continue
                    yield told
                    if told.event.kind == "ended":
                        return
            except ControlError as lost:
                reading.require_hope(lost)
            if reading.is_over(await self.info()):
                return
            await asyncio.sleep(reading.next_pause())

    async def result(self) -> Result:
        """The result once it has ended; `asyncio.timeout` limits the wait.

        Raises:
            ControlError: it has no result; the code says why.
            Exception: what the callback has raised.
        """
        info = await self._ended_info()
        if self._failure is not None:
            raise self._failure
        return result_of(info)

    async def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""
        await self._connection.run(self._calls.stop())

    async def trace(self) -> Trace | None:
        """The trace of what happened, once it has ended; None if nothing moved."""
        await self._ended_info()
        return await self._connection.run(self._calls.trace())

    async def _ended_info(self) -> RunInfo:
        if self._listener is not None:
            await asyncio.shield(self._listener)
        return await self._connection.run(self._calls.read_ended(None))

    async def _listen(self, on_event: EventListener) -> None:
        try:
            async for told in self.events():
                if self._failure is None:
                    await self._tell(on_event, told.event)
        except ControlError as lost:
            LOGGER.warning("events of run %s are missing: %s", self._run_id, lost)

    async def _tell(self, on_event: EventListener, event: Event) -> None:
        try:
            done = on_event(event)
            if inspect.isawaitable(done):
                await done
        except Exception as raised:
            self._failure = raised
            await self.stop()


class awaited(Generic[Given, Answer]):  # noqa: N801 - a decorator
    """A question of `Questions`, with the same arguments, whose answer is awaited."""

    def __init__(self, asked: Callable[Concatenate[Questions, Given], Answer]) -> None:
        self._question: Question = asked.question  # type: ignore[attr-defined]
        self._signature = inspect.signature(asked)
        self._check = checked_arguments(inspect.unwrap(asked))
        self.__doc__ = asked.__doc__

    @overload
    def __get__(self, session: None, owner: type[AsyncSession]) -> Self: ...

    @overload
    def __get__(
        self, session: AsyncSession, owner: type[AsyncSession]
    ) -> Callable[Given, Awaitable[Answer]]: ...

    def __get__(
        self, session: AsyncSession | None, owner: type[AsyncSession]
    ) -> Self | Callable[Given, Awaitable[Answer]]:
        if session is None:
            return self

        async def ask(*args: Given.args, **kwargs: Given.kwargs) -> Answer:
            self._check(session, *args, **kwargs)
            arguments = self._signature.bind(session, *args, **kwargs).arguments
            document = await session.answer_question(
                self._question, self._question.asks.fields_of(arguments)
            )
            return cast("Answer", self._question.reads(document))

        return ask


class AsyncClosed(ABC):
    """Something that is closed at the end of an `async with` block."""

    @abstractmethod
    async def close(self) -> None:
        """Ends it."""

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.close()


class AsyncSession(AsyncClosed):
    """A planning session at a server, awaited; see `nlcontrol.service.methods.PlanningSession`.

    Args:
        connection: connection to the service.
        info: the session as it was opened.
    """

    look = awaited(Questions.look)
    parse = awaited(Questions.parse)
    predict = awaited(Questions.predict)
    map = awaited(Questions.map)
    affordances = awaited(Questions.affordances)
    plan = awaited(Questions.plan)

    def __init__(self, connection: AwaitedConnection, info: SessionInfo) -> None:
        self._connection = connection
        self._calls = SessionCalls(connection, info)
        self.session_id, self.spec = info.session_id, info.spec
        self.has_robot = info.has_robot

    def __repr__(self) -> str:
        return f"<AsyncSession {self.session_id} of {self.spec.scene} at {self._connection.url}>"

    async def answer_question(self, asked: Question, fields: Mapping[str, Any]) -> BaseModel:
        """The document with which the service answers a question."""
        return await self._connection.run(self._calls.answer(asked, fields))

    @checked_arguments
    async def ask(self, said: str | Frames, *, motion: Motion = "never") -> Result:
        """The answer to a question; it moves nothing unless that is allowed."""
        if motion == "simulate" and await self._is_question(said):
            return await self.say(said, motion=motion)
        return await self._ask(said)

    _ask = awaited(Questions.ask)

    async def _is_question(self, said: str | Frames) -> bool:
        """All that is said asks, and nothing commands; see `nlcontrol.service.methods`."""
        try:
            command = await self.parse(said)
        except ControlError:
            return False
        return asks_only(command)

    @checked_arguments
    async def start(
        self,
        said: str | Frames | Offer | None = None,
        *,
        plan_id: str | None = None,
        text: str | None = None,
        motion: Motion | None = None,
        on_event: EventListener | None = None,
    ) -> AsyncRun:
        """Begins to do what a sentence says, or what was planned; see `PlanningSession.start`."""
        info = await self._connection.run(self._calls.start(said, plan_id, text, motion))
        return AsyncRun(self._connection, info.run_id, on_event)

    @checked_arguments
    async def say(
        self,
        said: str | Frames,
        *,
        motion: Motion | None = None,
        on_event: EventListener | None = None,
    ) -> Result:
        """Does what a sentence says, and tells what came of it; see `PlanningSession.say`.

        If the wait is cancelled, the run is stopped.
        """
        return await _ended_result(await self.start(said, motion=motion, on_event=on_event))

    @checked_arguments
    async def execute(
        self, plan: Offer | str, *, text: str | None = None, on_event: EventListener | None = None
    ) -> Result:
        """Carries out what was planned; see `PlanningSession.execute`."""
        run = await self.start(plan_id=plan_id_of(plan), text=text, on_event=on_event)
        return await _ended_result(run)

    async def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped."""
        await self._connection.run(self._calls.post("stop"))

    async def reset(self) -> None:
        """Puts everything back as it was at the beginning."""
        await self._connection.run(self._calls.post("reset"))

    async def close(self) -> None:
        """Ends the session; one that has ended with its server is left at that."""
        await self._connection.run(self._calls.close())


# Type checkers see the questions that the class names; any other one is asked just the same.
for _question in QUESTIONS:
    if not hasattr(AsyncSession, _question.name):
        setattr(AsyncSession, _question.name, awaited(getattr(Questions, _question.name)))


async def _ended_result(run: AsyncRun) -> Result:
    """The result of a run; if the wait for it is cancelled, the run is stopped."""
    try:
        return await run.result()
    except asyncio.CancelledError:
        await asyncio.shield(run.stop())
        raise


class AsyncSessions:
    """The sessions of a service, awaited."""

    def __init__(self, connection: AwaitedConnection) -> None:
        self._connection, self._calls = connection, HostCalls(connection)

    def __repr__(self) -> str:
        return f"<AsyncSessions at {self._connection.url}>"

    @checked_arguments
    async def open(
        self,
        scene: SessionSpec | str = "kitchen",
        *,
        seed: int = 0,
        defaults: Mapping[str, float] | None = None,
        objects: Sequence[StatedObject] | None = None,
        approval: Literal["plan", "none"] = "none",
    ) -> AsyncSession:
        """Opens a session; see `nlcontrol.service.remote_session.RemoteSessions.open`."""
        spec = session_spec(scene, seed, defaults, objects, approval)
        info = await self._connection.run(self._calls.open_session(spec))
        return AsyncSession(self._connection, info)

    @checked_arguments
    async def get(self, session_id: str) -> AsyncSession:
        """A session that is open; raises `unknown_session`."""
        info = await self._connection.run(self._calls.read(SessionInfo, f"sessions/{session_id}"))
        return AsyncSession(self._connection, info)

    async def list(self) -> tuple[SessionInfo, ...]:
        """All that are open."""
        return (await self._connection.run(self._calls.read(SessionList, "sessions"))).sessions


class AsyncRuns:
    """The runs of a service, awaited."""

    def __init__(self, connection: AwaitedConnection) -> None:
        self._connection, self._calls = connection, HostCalls(connection)

    def __repr__(self) -> str:
        return f"<AsyncRuns at {self._connection.url}>"

    @checked_arguments
    async def get(self, run_id: str) -> AsyncRun:
        """A run by its name; raises `unknown_run`."""
        info = await self._connection.run(self._calls.read(RunInfo, f"runs/{run_id}"))
        return AsyncRun(self._connection, info.run_id)

    @checked_arguments
    async def list(
        self, *, session: str | None = None, cursor: str | None = None, limit: int = 50
    ) -> RunPage:
        """Runs, the latest first; see `nlcontrol.service.remote_session.RemoteRuns.list`."""
        page = self._calls.read(RunPage, "runs", session=session, cursor=cursor, limit=limit)
        return await self._connection.run(page)

    @checked_arguments
    async def delete(self, run_id: str) -> None:
        """Has the service forget a run that has ended, its events and its files."""
        await self._connection.run(self._calls.delete_run(run_id))


class AsyncClient(AsyncClosed):
    """A planning service, awaited; making one calls nothing.

    Args:
        url, token, timeout, transport: as of `nlcontrol.Client`.

    Attributes:
        sessions: opens sessions, and lists those that are open.
        runs: under way, and those that the service remembers.
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
        self._connection = AwaitedConnection(url, token=token, timeout=timeout, transport=transport)
        self._calls = HostCalls(self._connection)
        self.sessions = AsyncSessions(self._connection)
        self.runs = AsyncRuns(self._connection)

    def __repr__(self) -> str:
        return f"<AsyncClient of {self._connection.url}>"

    async def health(self) -> Health:
        """Version of the service, and how much it has to do."""
        return await self._connection.run(self._calls.read(Health, "health"))

    async def scenes(self) -> tuple[SceneSummary, ...]:
        """Scenes in which sessions can be opened."""
        return (await self._connection.run(self._calls.read(SceneList, "scenes"))).scenes

    async def objects(self) -> tuple[ObjectSummary, ...]:
        """Object models of the host, in a few figures."""
        return (await self._connection.run(self._calls.read(ObjectList, "objects"))).objects

    @checked_arguments
    async def object(self, name: str) -> ObjectDescription:
        """An object model by its name or a synonym; raises `unknown_object`."""
        return await self._connection.run(self._calls.read(ObjectDescription, f"objects/{name}"))

    async def close(self) -> None:
        """Ends the connection; sessions and runs of the service go on."""
        await self._connection.close()
