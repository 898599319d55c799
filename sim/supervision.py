"""A motion under supervision: it tells what it does, and is asked to stop.

A stop takes effect at the next control step, and while planning at the next question to the robot.
The hand then lets go, goes back, and nothing moves any more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from objectmodels.geometry.rotations import Array
    from sim.traces.trace import Trace

Progress = Callable[[str, float, str], None]
"""Told of the phase, the robot's time [s] and what happens."""


class Stopped(Exception):  # noqa: N818 - it is no error
    """Raised where a stop was asked for, once the robot is at rest.

    Args:
        trace: of what was done before.
    """

    def __init__(self, trace: Trace | None = None) -> None:
        super().__init__("it was told to stop")
        self.trace = trace


class StopToken:
    """A request to stop, which any thread may make; it is never taken back."""

    def __init__(self) -> None:
        # A lock would not do: the handler of a signal runs in the midst of its own thread.
        self._requested = False

    def request(self) -> None:
        """Asks for a stop."""
        self._requested = True

    @property
    def requested(self) -> bool:
        """A stop was asked for."""
        return self._requested

    def check(self) -> None:
        """Ends what is going on, if that was asked for.

        Raises:
            Stopped: a stop was asked for.
        """
        if self.requested:
            raise Stopped


class Monitor:
    """The supervision of one execution; called as a `Progress` is.

    Args:
        progress: told of the phases; nobody if not given.
        stop: asked at every control step whether to go on.

    Attributes:
        stop: as given.
    """

    def __init__(self, progress: Progress | None = None, stop: StopToken | None = None) -> None:
        self.stop = StopToken() if stop is None else stop
        self._progress = progress

    @classmethod
    def of(cls, progress: Progress | None) -> Self:
        """The supervision that a caller hands over, be it no more than a function, or none."""
        if isinstance(progress, cls):
            return progress
        return cls(progress, progress.stop if isinstance(progress, Monitor) else None)

    def __call__(self, phase: str, time: float, text: str) -> None:
        """Tells what begins now.

        Args:
            phase: as in a trace.
            time: of the robot [s].
            text: what happens, in words.
        """
        if self._progress is not None:
            self._progress(phase, time, text)

    def contact(self, time: float, fingers: Sequence[str], forces: Array) -> None:
        """Tells that the fingers have felt what they were to touch; see `feel`."""

    def feel(self, time: float, fingers: Sequence[str], forces: Array) -> None:
        """Tells what the fingers feel at a control step.

        Args:
            time: of the robot [s].
            fingers: their names.
            forces: on the object in W, shape (k, 3) [N].
        """
