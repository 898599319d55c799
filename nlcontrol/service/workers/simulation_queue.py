"""Queue of runs: so many simulate at once, the next ones wait in order, the rest are refused."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

from nlcontrol.errors import error


@dataclass(frozen=True)
class _Turn:
    """The turn of a run that waits."""

    run_id: str
    begin: Callable[[], object]


class SimulationQueue:
    """Runs that simulate, and those that wait.

    Args:
        workers: runs that may simulate at once.
        length: runs that may wait.
        on_moved: told that a run waits at a place, from 1; called when that has changed.
    """

    def __init__(
        self, workers: int, length: int, on_moved: Callable[[str, int], object] = lambda r, p: None
    ) -> None:
        self._workers, self._length, self._on_moved = workers, length, on_moved
        self._lock = threading.Lock()
        self._running: set[str] = set()
        self._waiting: list[_Turn] = []

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
            ids = [turn.run_id for turn in self._waiting]
        return ids.index(run_id) + 1 if run_id in ids else None

    def enter(self, run_id: str, begin: Callable[[], object]) -> None:
        """Lets a run begin, or wait for its turn.

        Args:
            run_id: of it.
            begin: begins it; called here, or when another run leaves, in that thread.

        Raises:
            ControlError: `queue_full`.
        """
        with self._lock:
            free = len(self._running) < self._workers
            if free:
                self._running.add(run_id)
            elif len(self._waiting) >= self._length:
                raise error(
                    "queue_full",
                    f"{len(self._running)} runs are under way and {len(self._waiting)} wait",
                    suggestions=("ask again in a while",),
                    numbers={"waiting": float(len(self._waiting)), "retry_after": 10.0},
                )
            else:
                self._waiting.append(_Turn(run_id, begin))
                place = len(self._waiting)
        if free:
            begin()
        else:
            self._on_moved(run_id, place)

    def leave(self, run_id: str) -> None:
        """Takes out a run that has ended, or that is to begin no more; the next one begins."""
        with self._lock:
            self._running.discard(run_id)
            self._waiting = [turn for turn in self._waiting if turn.run_id != run_id]
            following: list[_Turn] = []
            while self._waiting and len(self._running) < self._workers:
                following.append(self._waiting.pop(0))
                self._running.add(following[-1].run_id)
            places = [(turn.run_id, i) for i, turn in enumerate(self._waiting, start=1)]
        for turn in following:
            turn.begin()
        for moved, place in places:
            self._on_moved(moved, place)
