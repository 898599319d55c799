"""The last look: what the robot saw, for as long as nothing was done since."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from planner.types.world_state import WorldState


class Camera(Protocol):
    """A robot that looks; see `nlcontrol.session.executor.Executor`."""

    @property
    def time(self) -> float:
        """The robot's time [s]."""

    def look(self, models: Mapping[str, ObjectModel], /) -> WorldState:
        """Looks at the table and returns what the robot believes then."""


class _Seen(NamedTuple):
    state: WorldState
    time: float
    models: dict[str, ObjectModel]


class LastLook:
    """Looks of a robot, of which the last one is remembered.

    It holds until something is done or learned, or the robot's time goes on; a real one's goes on
    by itself.
    """

    def __init__(self) -> None:
        self._seen: _Seen | None = None
        self._holds = False

    @property
    def state(self) -> WorldState | None:
        """The belief at the last look; None if something was done since."""
        return None if self._seen is None else self._seen.state

    def look(self, camera: Camera, models: Mapping[str, ObjectModel]) -> WorldState:
        """The belief now, or within `kept` that of the last look, where it still holds."""
        seen = self._seen
        if self._holds and seen and (seen.time, seen.models) == (camera.time, models):
            return seen.state
        state = camera.look(models)
        self._seen = _Seen(state, camera.time, dict(models))
        return state

    def forget(self) -> None:
        """Notes that something is done."""
        self._seen = None

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Context in which the last look is enough."""
        before, self._holds = self._holds, True
        try:
            yield
        finally:
            self._holds = before
