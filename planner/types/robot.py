"""The planner's question to the robot: can the hand get there?

`sim` answers it from the arm's kinematics; a real robot's driver may answer it from its own. The
planner only calls it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from planner.types.actions import Push
    from planner.types.plan import Plan
    from planner.types.world_state import WorldState


@dataclass(frozen=True)
class ReachAnswer:
    """Whether a push can be carried out by the hand.

    Attributes:
        ok: the whole way (approach, touch, stroke, retreat) is free and within joint limits.
        reason: if not ok, what stops it: `kinematics`, `table`, `object` (the pushed one),
            `obstacle` (another one), `approach`, `torque` (it gets there, but is too weak there),
            `failed` (a push there went wrong before).
        message: the same in words.
        blocker: name of the obstacle, if one is in the way.
        margin: if ok, smallest distance to a joint limit on the way [rad].
        numbers: figures behind the answer [SI].
    """

    ok: bool
    reason: str | None = None
    message: str = ""
    blocker: str | None = None
    margin: float = 0.0
    numbers: dict[str, float] = field(default_factory=dict)


class Reach(Protocol):
    """The hand's reach, in a state of the world."""

    fingertip_radius: float
    """Radius of a fingertip [m]."""

    finger_spreads: tuple[float, ...]
    """Distances between the two outer fingertips of a two-finger push, the largest first [m]."""

    max_force: float
    """Largest force that one fingertip can exert [N]."""

    force_skew: float
    """Largest vertical force at a fingertip per force along the push while the tip sticks: what the
    hand's own stiffness lets it transmit, whatever friction would allow."""

    lowest_height: float
    """Lowest contact height above the table that a fingertip reaches anywhere [m]."""

    def __call__(self, push: Push, state: WorldState) -> ReachAnswer:
        """Answers for one push."""
        ...

    def prospect(self, push: Push, state: WorldState) -> float:
        """Room to the joint limits at a glance [rad]; a push without may still be possible."""
        ...

    def thorough(self) -> Reach:
        """The same, which looks longer and lets the hand pass nearer: for when all else fails."""
        ...


@dataclass(frozen=True, eq=False)
class Grip:
    """How the hand closes about something of a width.

    Attributes:
        contacts: of the fingers that touch, the thumb first, in the plane across the closing
            direction, from the middle of the grasp: along the approach, and along
            approach × closing, shape (k, 2) [m].
        shares: of the squeeze that each of them bears; the thumb's is 1, the others' sum to 1,
            shape (k,).
        strongest: largest squeeze, with a tangential load as large beside it [N].
        room: free length beyond the fingers' side that the knuckles need, and beyond the thumb's,
            along the closing direction [m].
        ahead: how far the fingers reach beyond the middle, along the approach [m].
    """

    contacts: NDArray[np.float64]
    shares: NDArray[np.float64]
    strongest: float
    room: tuple[float, float]
    ahead: float = 0.0


class HandReach(Protocol):
    """What the hand can hold, and whether the arm can carry out a plan with it."""

    narrowest: float
    """Least width between thumb and fingers [m]."""

    widest: float
    """Largest width [m]."""

    lowest_level: float
    """Least height above the table of the middle of a grasp from beside [m]."""

    def grip(self, width: float) -> Grip | None:
        """How it closes about that width [m]; None if it does not."""
        ...

    def pinch(self, width: float) -> Grip | None:
        """How it closes about a knob or a cap of that width [m]; None if it does not."""
        ...

    def handles(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Whether arm and hand can carry out a plan, all of its way free."""
        ...


class GivenUpError(Exception):
    """Too many questions; it never leaves the planner.

    Attributes:
        answers: those that were given.
    """

    def __init__(self, answers: list[ReachAnswer]) -> None:
        super().__init__(f"{len(answers)} questions")
        self.answers = answers


class Patient:
    """A reach that answers so many questions of one plan.

    Args:
        reach: of the robot.
        most: questions.
        now: what is believed when the plan is made.
        foreseen: answers for pushes of an object that will stand elsewhere by then; the same reach
            if not given.
    """

    def __init__(
        self, reach: Reach, most: int, now: WorldState, foreseen: Reach | None = None
    ) -> None:
        self._reach = reach
        self._most = most
        self._now = now
        self._foreseen = foreseen or reach
        self._answers: list[ReachAnswer] = []
        self.fingertip_radius = reach.fingertip_radius
        self.finger_spreads = reach.finger_spreads
        self.max_force = reach.max_force
        self.force_skew = reach.force_skew
        self.lowest_height = reach.lowest_height

    @property
    def denied(self) -> bool:
        """Whether the hand did not get to something that it has not tried before."""
        return any(not answer.ok and answer.reason != "failed" for answer in self._answers)

    def __call__(self, push: Push, state: WorldState) -> ReachAnswer:
        """Answers for one push.

        Raises:
            GivenUpError: there were too many questions before.
        """
        if len(self._answers) == self._most:
            raise GivenUpError(self._answers)
        here = state.objects[push.object].pose == self._now.objects[push.object].pose
        answer = self._reach(push, state) if here else self._foreseen(push, state)
        self._answers.append(answer)
        return self._answers[-1]

    def prospect(self, push: Push, state: WorldState) -> float:
        """At a glance, which does not count."""
        return self._reach.prospect(push, state)

    def again(self) -> Patient:
        """As many questions to the same."""
        return Patient(self._reach, self._most, self._now, self._foreseen)

    def thorough(self, most: int | None = None) -> Patient:
        """So many questions, or as many, to one that looks longer.

        What is foreseen will not stand exactly there: then the hand must get there as usual.
        """
        return Patient(self._reach.thorough(), most or self._most, self._now, self._reach)
