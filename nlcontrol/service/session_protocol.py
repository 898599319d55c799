"""A planning session and its runs, in this process or over a wire.

`nlcontrol.service.session.Session` is one in this process, `nlcontrol.service.client.Client` opens
one at a server. A program that uses one can use the other.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol, Self

from nlcontrol.errors import ControlError
from nlcontrol.service.methods import Questions

if TYPE_CHECKING:
    from types import TracebackType

    from nlcontrol.results.result import Result
    from nlcontrol.service.documents import NumberedEvent, RunInfo
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames
    from sim.traces.trace import Trace


class Run(Protocol):
    """Something that is carried out."""

    @property
    def run_id(self) -> str:
        """Name of the run."""

    def info(self) -> RunInfo:
        """The run as it is now."""

    def events(self, after: int = 0) -> Iterator[NumberedEvent]:
        """Its events as they happen, until it has ended.

        Args:
            after: number of the last event that is known already.
        """

    def result(self, timeout: float | None = None) -> Result:
        """The result; waits until it has ended.

        Args:
            timeout: longest time to wait, by the clock on the wall [s]; None for no limit.

        Raises:
            TimeoutError: it goes on.
            ControlError: it has no result; the code says why.
        """

    def stop(self) -> None:
        """Asks it to let go and come to rest; its result is then `cancelled`."""

    def trace(self) -> Trace | None:
        """The trace of what happened; None if nothing moved. Waits until it has ended."""


class PlanningSession(Questions, ABC):
    """A table, a robot and a conversation: look, plan, approve, do, verify."""

    @abstractmethod
    def execute(
        self,
        plan_id: str,
        *,
        text: str | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Run:
        """Begins to carry out a sentence by the plan that was approved.

        The robot looks again first. A plan id is used once, and expires.

        Args:
            plan_id: of an `Offer`.
            text: under which the plan was approved, such as the sentence that a person saw beside
                it; not compared if not given.
            on_event: told of every event, in the thread that carries it out.

        Raises:
            ControlError: `unknown_plan`, `used_plan`, `expired_plan`, `stale_plan` (something
                moved, or is believed in another way), `other_sentence` (the text is not the one
                that was planned), `busy`, `no_robot` (the table was stated).
        """

    @abstractmethod
    def say(
        self,
        said: str | Frames,
        *,
        motion: Motion | None = None,
        on_event: Callable[[Event], object] | None = None,
    ) -> Run:
        """Begins to do what a sentence says, planned and executed at one go.

        Args:
            said: a sentence, or frames.
            motion: `simulate` also lets a question move something, `never` nothing at all.
            on_event: told of every event, in the thread that carries it out.

        Raises:
            ControlError: `approval_required` if plans are to be approved first, `busy`, `no_robot`.
        """

    @abstractmethod
    def stop(self) -> None:
        """Asks what is being carried out to let go and come to rest; plans are dropped."""

    @abstractmethod
    def reset(self) -> None:
        """Puts everything back as it was at the beginning: table, beliefs, conversation, plans.

        Raises:
            ControlError: `busy`, `no_reset` (a real robot's table).
        """

    @abstractmethod
    def close(self) -> None:
        """Ends the session; what is being carried out is stopped first."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()


def is_question(session: PlanningSession, said: str | Frames) -> bool:
    """Return True if all that is said asks, and nothing commands."""
    try:
        frames = session.parse(said).frames
    except ControlError:
        return False
    return all(frame.query is not None for frame in frames)
