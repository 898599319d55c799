"""Events of a sentence on its way, told while it is carried out.

A callback that fails stops the motion as a stop would; once the robot is at rest, what it raised is
raised. Each event is also a debug record of the logger `nlcontrol`.
"""

from __future__ import annotations

import logging
import math
import time as wall_clock
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from nlcontrol.checks.verdicts import Check
from nlcontrol.json_document import DocumentPart
from nlcontrol.learning.learning_reports import Lesson
from nlcontrol.results.result import Result, ResultStatus
from objectmodels.geometry.rotations import Array
from planner.types.plan import Plan
from sim.supervision import Monitor, Progress, StopToken

EventKind = Literal[
    "understood", "planned", "phase", "contact", "force", "replanned", "lesson", "verdict", "ended"
]

KINDS: Mapping[EventKind, tuple[str, str]] = MappingProxyType(
    {
        "understood": ("the sentence was read; `text` is how it is understood", "`left_out`"),
        "planned": ("a frame has its first plan", "`plan`"),
        "phase": ("something begins; of the phases of a trace, or `plan`, `learn`", "`phase`"),
        "contact": ("the fingers have felt what they were to touch", "`forces`"),
        "force": ("what the fingers feel, at the rate asked for", "`forces`"),
        "replanned": ("a frame has another plan, after a look", "`plan`"),
        "lesson": ("a push or a grasp has changed what is believed", "`lesson`"),
        "verdict": ("a clause was checked", "`check`"),
        "ended": ("nothing moves any more, and the result follows", "`status`"),
    }
)
"""Meaning of each kind, and its own field."""

FORCE_RATE = 10.0
"""Events of kind `force` per second of the robot's time, if nothing else is asked for."""

LOGGER = logging.getLogger("nlcontrol")
LOGGER.addHandler(logging.NullHandler())


class Event(DocumentPart):
    """One thing that happens on the way of a sentence.

    Attributes:
        kind: see `KINDS`.
        time: time of the robot's clock [s].
        wall_time: since the sentence was said [s].
        text: the same in words.
        left_out: words of the sentence that set nothing.
        frame: place of the frame in the sentence that it is about, from 0.
        phase: phase that begins.
        forces: per finger [N].
        plan: plan that was made.
        lesson: lesson that was learned.
        check: the verdict.
        status: status of the result.
    """

    kind: EventKind
    time: float
    wall_time: float
    text: str
    left_out: tuple[str, ...] | None = None
    frame: int | None = None
    phase: str | None = None
    forces: dict[str, float] | None = None
    plan: Plan | None = None
    lesson: Lesson | None = None
    check: Check | None = None
    status: ResultStatus | None = None


class _Wish(StopToken):
    """The caller's request, or one of our own."""

    def __init__(self, caller: StopToken | None) -> None:
        super().__init__()
        self._caller = caller

    @property
    def requested(self) -> bool:
        return super().requested or (self._caller is not None and self._caller.requested)


class Supervisor(Monitor):
    """The supervision of one sentence.

    Args:
        progress: called at each phase.
        stop: the caller's.
        on_event: called with every event, in the thread that carries the sentence out.
        force_rate: events of kind `force` per second of the robot's time; none if 0 [Hz].
        clock: the robot's time [s].

    Attributes:
        frame: frame that is carried out.
    """

    def __init__(
        self,
        progress: Progress | None = None,
        stop: StopToken | None = None,
        *,
        on_event: Callable[[Event], object] | None = None,
        force_rate: float = FORCE_RATE,
        clock: Callable[[], float] = lambda: 0.0,
    ) -> None:
        super().__init__(progress, _Wish(stop))
        self.frame: int | None = None
        self._on_event = on_event
        self._force_rate = force_rate
        self._clock = clock
        self._began = wall_clock.monotonic()
        self._due = -math.inf if force_rate > 0.0 else math.inf  # time of the next force [s]
        self._failure: Exception | None = None

    def __call__(self, phase: str, time: float, text: str) -> None:
        """Tells what begins now; see `Monitor`."""
        self._call(super().__call__, phase, time, text)
        self.tell("phase", text, time=time, phase=phase)

    def contact(self, time: float, fingers: Sequence[str], forces: Array) -> None:
        """Tells of a contact; see `Monitor`."""
        sizes = _sizes(fingers, forces)
        self.tell("contact", f"felt by {', '.join(sizes)}", time=time, forces=sizes)

    def feel(self, time: float, fingers: Sequence[str], forces: Array) -> None:
        """Tells what is felt, at the rate asked for; see `Monitor`."""
        if self._on_event is None or time < self._due:
            return
        self._due = time + 1.0 / self._force_rate
        sizes = _sizes(fingers, forces)
        self.tell("force", f"{sum(sizes.values()):.2f} N", time=time, forces=sizes)

    def tell(
        self, kind: EventKind, text: str, *, time: float | None = None, **details: Any
    ) -> None:
        """Tells of an event.

        Args:
            kind: kind of the event.
            text: the event in words.
            time: time of the robot's clock [s]; now, if not given.
            details: field of its kind.
        """
        now = self._clock() if time is None else time
        wall = wall_clock.monotonic() - self._began
        LOGGER.debug("%s at %.2f s (%.2f s of wall time): %s", kind, now, wall, text)
        if self._on_event is not None:
            event = Event(
                kind=kind, time=now, wall_time=wall, text=text, frame=self.frame, **details
            )
            self._call(self._on_event, event)

    def end(self, result: Result) -> Result:
        """Tells that the sentence has ended, and returns its result.

        Raises:
            Exception: what a callback has raised.
        """
        self.tell("ended", result.error.message if result.error else "", status=result.status)
        if self._failure is not None:
            raise self._failure
        return result

    def _call(self, told: Callable[..., object], *arguments: Any) -> None:
        if self._failure is None:
            try:
                told(*arguments)
            except Exception as raised:
                self._failure = raised
                self.stop.request()


def _sizes(fingers: Sequence[str], forces: Array) -> dict[str, float]:
    return dict(zip(fingers, np.linalg.norm(forces, axis=1).tolist(), strict=True))
