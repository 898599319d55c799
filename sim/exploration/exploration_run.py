"""One touch after another: which experiments are made, and what becomes of each.

A *repetition* has one experiment of each kind that is asked for: tilts on two opposite sides, a
slide, an off-centre slide, a rub. Tilts take turns over the sides, slides move the object along a
spiral: friction differs from place to place, and no two slides are then at one. Where the hand does
not get, or where a touch showed something else than was meant, the next side is tried; what was
given up is told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from objectmodels.identification import Trial
from planner.touch_experiments import Experiment, Kind, experiments
from planner.types.actions import FaceName
from planner.types.world_state import WorldState
from sim.exploration.trial_extraction import Recording, extract_trials
from sim.supervision import Monitor

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel
    from planner.types.robot import Robot
    from sim.robots.cell_description import CellDescription
    from sim.supervision import Progress

OPPOSITE: tuple[tuple[FaceName, FaceName], ...] = (("front", "back"), ("left", "right"))
"""Pairs of sides whose tilts together tell the weight from the centre of mass."""


SPIRAL: tuple[FaceName, ...] = (
    "front",
    "left",
    "back",
    "back",
    "right",
    "right",
    "front",
    "front",
    "front",
    "left",
    "left",
    "left",
)
"""Sides at which one slide after another pushes."""


@dataclass(frozen=True)
class Touched:
    """One touch and what it showed.

    Attributes:
        recording: what the robot felt and saw.
        trials: balances of forces; none if nothing moved.
        repetition: in which it was made, from 0.
    """

    recording: Recording
    trials: tuple[Trial, ...]
    repetition: int

    @property
    def experiment(self) -> Experiment:
        """The experiment that was tried."""
        return self.recording.experiment

    @property
    def as_meant(self) -> bool:
        """True if it showed what it was to show."""
        return self.recording.end == "stroke" and bool(self.trials)


class TouchExecutor(Protocol):
    """The part of an executor that explorations need; see `nlcontrol.session.executor`."""

    cell: CellDescription
    seed: int

    @property
    def robot(self) -> Robot:
        """Reach of arm and hand."""

    def look(self, models: Mapping[str, ObjectModel]) -> WorldState:
        """The robot's beliefs now, with models of the objects by their names."""

    def touch(
        self, experiment: Experiment, state: WorldState, progress: Progress | None = None
    ) -> Recording:
        """Carries out a touch experiment from a state since which nothing has moved."""


class Explorer:
    """Touches one object again and again.

    Args:
        name: of the object in the scene.
        executor: the robot.
        look: what is believed now; called before each touch.
        learn: told of each touch that showed something.
        progress: told of the phase, the simulated time [s] and what happens.

    Attributes:
        name: as given.
        touches: all that was tried, in order.
    """

    def __init__(
        self,
        name: str,
        executor: TouchExecutor,
        look: Callable[[], WorldState],
        *,
        learn: Callable[[Touched], None],
        progress: Progress | None = None,
    ) -> None:
        self.touches: list[Touched] = []
        self.name = name
        self._executor = executor
        self._look = look
        self._learn = learn
        self._monitor = Monitor.of(progress)
        self._given_up: dict[tuple[Kind, FaceName], str] = {}

    @property
    def given_up(self) -> tuple[str, ...]:
        """Experiments that were tried in vain, with the reason."""
        return tuple(f"{kind} at the {face}: {why}" for (kind, face), why in self._given_up.items())

    def possible(self, kinds: Iterable[Kind]) -> list[Experiment]:
        """Experiments of these kinds that were not given up, planned with what is known now."""
        wanted = set(kinds)
        found = experiments(self._look().objects[self.name], self._executor.robot.limits)
        return [e for e in found if e.kind in wanted and _key(e) not in self._given_up]

    def repeat(self, kinds: Sequence[Kind], repetition: int) -> None:
        """One repetition: every kind once, tilts on two opposite sides."""
        for kind in kinds:
            if kind == "tilt":
                self._tilt_both(repetition)
            else:
                self._first(kind, _sides(kind, repetition), repetition)

    def touch(self, kind: Kind, face: FaceName, repetition: int, lateral: float = 0.0) -> bool:
        """One touch at a side; returns whether it showed what it was to show.

        The sign of `lateral` says at which end of the side, if it is off-centre.
        """
        self._monitor.stop.check()
        if (kind, face) in self._given_up:
            return False
        state = self._look()
        tried = next(
            (
                e
                for e in experiments(state.objects[self.name], self._executor.robot.limits)
                if (e.kind, e.push.face) == (kind, face) and e.lateral * lateral >= 0.0
            ),
            None,
        )
        if tried is None:
            return False
        recording = self._executor.touch(tried, state, self._monitor)
        touched = Touched(recording, extract_trials(recording, repetition=repetition), repetition)
        self.touches.append(touched)
        if touched.trials:
            self._learn(touched)
        if not touched.as_meant:
            self._given_up[_key(tried)] = recording.detail
        return touched.as_meant

    def _tilt_both(self, repetition: int) -> None:
        """Tilts on two opposite sides, of the pair whose turn it is, or of the other one."""
        first = repetition % len(OPPOSITE)
        for pair in OPPOSITE[first:] + OPPOSITE[:first]:
            if all(self.touch("tilt", face, repetition) for face in pair):
                return

    def _first(self, kind: Kind, sides: Iterable[tuple[FaceName, float]], repetition: int) -> None:
        """The first touch that shows what it is to show."""
        for face, lateral in sides:
            if self.touch(kind, face, repetition, lateral):
                return


def _key(experiment: Experiment) -> tuple[Kind, FaceName]:
    return experiment.kind, experiment.push.face


def _sides(kind: Kind, repetition: int) -> list[tuple[FaceName, float]]:
    """Sides and their ends in the order in which they are tried.

    The first one moves the object on along a spiral, so that no two slides are at one place.
    """
    first = SPIRAL[(repetition // 2 if kind == "rub" else repetition) % len(SPIRAL)]
    others = [face for pair in OPPOSITE for face in pair if face != first]
    end = (1.0 if repetition % 2 == 0 else -1.0) if kind == "off-centre slide" else 0.0
    return [(face, end) for face in (first, *others)]
