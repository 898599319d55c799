"""Steps by which a command can be done that cannot be done as it stands.

Objects that are named together ("both", "all") are moved in any order, and what stands in the way
is moved aside before. What the hand does not get to is brought to where it does; what it holds and
does not get to its place is put down and grasped anew (`planner.clearing`). The search is depth
first over predicted states: each step is planned from where those before it leave everything, so
that the whole is planned before anything moves, as far as what comes of a step is predicted. The
first way that is found is taken; objects are moved aside as few as possible, since a way without
that is looked for first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from grammar import paraphrase
from nlcontrol.errors import ControlError, refusal_error
from nlcontrol.session.foresight.foreseen_steps import lasting_lift
from nlcontrol.session.foresight.kept_denials import RecallingRobot
from planner import planning
from planner.clearing import (
    bringing_frames,
    clearing_frames,
    is_beyond_hand,
    may_be_brought,
    may_be_cleared,
    may_be_grasped_anew,
    obstacles,
    setting_down_frame,
)
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.types.defaults import CLEARED
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from sim.supervision import Stopped

if TYPE_CHECKING:
    from grammar.frames import command as g
    from nlcontrol.errors import ErrorInfo
    from nlcontrol.session.events import Supervisor
    from nlcontrol.session.foresight.foreseen_steps import StepPlanner
    from nlcontrol.session.foresight.kept_plans import KeptPlans
    from planner.types.world_state import WorldState
    from sim.supervision import StopToken

    Frames = tuple[g.Frame, ...]
    Steps = list[tuple[g.Frame, Plan | Reached]]

MOST_WORKS = 1.7
"""Work of all plans of an answer, the refused first one included, in that of one plan."""

MOST_WORKS_GIVEN_UP = 1.3
"""The same where that first plan was given up: beside what takes so long little else is found."""

MOST_SHARE = 0.5
"""Of the same, the work of each plan of a search.

What can be done after a step mostly shows soon, and what stops the hand then shows as soon.
"""

MOST_BRINGING = 0.3
"""Of that, the share in which places are looked through that an object is brought to."""

MOST_ASIDE = 3
"""Objects that are moved aside for one command."""


@dataclass(frozen=True)
class Ways:
    """Steps in place of those of a command.

    Attributes:
        frames: what is done, in order; what is moved aside stands among them.
        aside: those of them that move something aside.
        first: plan of the first step.
        why: the command cannot be done as it stands.
    """

    frames: Frames
    aside: Frames
    first: Plan | Reached
    why: str

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence on what is moved aside; none if only the order is another one."""
        return (f"first {paraphrase(self.aside)}, since {self.why}",) if self.aside else ()


def ways_around(
    controller: StepPlanner,
    frames: Frames,
    index: int,
    refused: tuple[Refusal, WorldState] | None,
    supervisor: Supervisor,
    kept: KeptPlans,
) -> Ways | ErrorInfo | None:
    """Steps in place of frames of which one was refused, or an error that tells them.

    Args:
        controller: that plans.
        frames: of the command, their objects resolved.
        index: of the frame that was refused; what stands before it is done.
        refused: why, and what was believed then; None if it was not.
        supervisor: told of a search, and asked whether to go on.
        kept: plans that were made for the command from there.

    Returns:
        None if there are none; the error if they are not to be done without being asked.
    """
    left = frames[index:]
    if refused is None:
        return None
    refusal, state = refused
    elsewhere = may_be_brought(left[0], state) or may_be_grasped_anew(left[0], state)
    brought = is_beyond_hand(refusal) and elsewhere
    if not (obstacles(refusal) or brought or len(_next_frames(left)) > 1):
        return None
    supervisor("plan", 0.0, f"looking for other steps, since {refusal.message}")
    moved = frozenset(f.object.id or "" for f in frames[:index] if f.object is not None)
    try:
        done = refusal.numbers.get("tried_work", 0.0)
        search = StepSearch(controller, left, moved, supervisor.stop, kept, done)
        found = search.ways(state, refusal.message)
    except (Stopped, ControlError):
        return None
    if found is None or not found.aside or controller.defaults.clear == CLEARED.index("yes"):
        return found
    step = f"{paraphrase(found.aside)} first"
    return refusal_error(refusal).model_copy(update={"suggestions": (step,)})


class StepSearch:
    """Looks for steps by which frames can be done.

    Args:
        controller: that plans.
        frames: what is left of a command, its objects resolved.
        moved: names of objects that were moved for it by now, and stay where they are.
        stop: asked whether to go on.
        kept: plans that were made for the command from here.
        done: units of work that were done for the answer before.
    """

    def __init__(
        self,
        controller: StepPlanner,
        frames: Frames,
        moved: frozenset[str],
        stop: StopToken,
        kept: KeptPlans,
        done: float = 0.0,
    ) -> None:
        self._frames, self._moved = frames, moved
        self._defaults = controller.defaults
        self._controller, self._stop = controller, stop
        self._robot = RecallingRobot(controller.robot, stop, controller.time_limit)
        self._planner = controller.planner
        most = controller.defaults.most_work
        works = MOST_WORKS if done < most else MOST_WORKS_GIVEN_UP
        self._left = int(works * most - done)
        self._kept = kept

    def ways(self, state: WorldState, why: str) -> Ways | None:
        """The steps from where everything is; None if none are found with the work allowed."""
        for most in range(MOST_ASIDE + 1):
            if self._left <= 0:
                break
            found = self._steps(self._frames, state, self._moved, most)
            if found:
                frames = tuple(frame for frame, _ in found)
                aside = tuple(frame for frame in frames if frame not in self._frames)
                return Ways(frames, aside, found[0][1], why)
        return None

    def _steps(
        self, frames: Frames, state: WorldState, moved: frozenset[str], most: int
    ) -> Steps | None:
        """Steps for what is left, with so many objects moved aside at most; None if there are none.

        What was moved is not moved aside any more.
        """
        if not frames:
            return []
        refused: list[tuple[g.Frame, Refusal]] = []
        beyond_hand: list[g.Frame] = []
        for frame in _next_frames(frames):
            rest = tuple(other for other in frames if other is not frame)
            made = self._plan(frame, state)
            if isinstance(made, Refusal):
                refused.append((frame, made))
                beyond_hand += [frame] if is_beyond_hand(made) else []
            elif found := self._joined(frame, made, rest, state, moved, most):
                return found
            elif rest and isinstance(made, Plan) and made.task == "lift":
                made = self._lasting_lift(frame, rest, state)
                if isinstance(made, Plan):
                    return self._joined(frame, made, rest, state, moved, most)
                beyond_hand.append(frame)
        about = {other.object.id for other in frames if other.object is not None}
        for frame, refusal in refused if most else ():
            for name in obstacles(refusal):
                # What one of them is about is moved anyhow.
                asked = self._defaults.clear == CLEARED.index("no") and name not in about
                if asked or name in moved or not may_be_cleared(name, frames, state):
                    continue
                if found := self._cleared(name, frame, state, moved, frames, most - 1):
                    return found
        for frame in beyond_hand if most else ():
            if self._may_be_brought(frame, state, moved) and (
                found := self._brought(frame, state, moved, frames, most - 1)
            ):
                return found
        return None

    def _may_be_brought(self, frame: g.Frame, state: WorldState, moved: frozenset[str]) -> bool:
        """Return True if the object of a frame is moved so that the hand gets to it, or anew."""
        if self._defaults.clear == CLEARED.index("no"):
            return False
        own = frame.object.id if frame.object is not None else None
        brought = own not in moved and may_be_brought(frame, state)
        return brought or may_be_grasped_anew(frame, state)

    def _brought(
        self, frame: g.Frame, state: WorldState, moved: frozenset[str], frames: Frames, most: int
    ) -> Steps | None:
        """Steps for frames, the first of which brings the object of one to where it is reached.

        What is held is put down.
        """
        share = MOST_BRINGING * MOST_WORKS * self._defaults.most_work
        least = max(0.0, self._left - share)
        anew = may_be_grasped_anew(frame, state)
        steps = (
            (setting_down_frame(frame),) if anew else bringing_frames(frame, state, self._defaults)
        )
        for step in steps:
            if self._left <= least:
                return None
            made = self._plan(step, state)
            if not isinstance(made, Plan):
                continue
            if found := self._joined(step, made, frames, state, moved, most):
                return found
        return None

    def _cleared(
        self,
        name: str,
        frame: g.Frame,
        state: WorldState,
        moved: frozenset[str],
        frames: Frames,
        most: int,
    ) -> Steps | None:
        """Steps for frames, the first of which moves an object out of the way of one of them."""
        for step in clearing_frames(name, frame, state, self._defaults):
            if self._left <= 0:
                return None
            made = self._plan(step, state)
            if not isinstance(made, Plan):
                continue
            if found := self._joined(step, made, frames, state, moved, most):
                return found
            then = state_after(made, state)
            again = None if then is None else self._plan(frame, then)
            if isinstance(again, Refusal) and name not in obstacles(again):
                return None  # elsewhere it would be no more out of the way
        return None

    def _joined(
        self,
        frame: g.Frame,
        made: Plan | Reached,
        rest: Frames,
        state: WorldState,
        moved: frozenset[str],
        most: int,
    ) -> Steps | None:
        """A step and those after it; where its end is not predicted, they are as they were."""
        then = state_after(made, state)
        if then is None:
            return [(frame, made), *((other, Reached()) for other in rest)]
        own = frame.object.id if frame.object is not None else None
        found = self._steps(rest, then, moved | {own or ""}, most)
        return None if found is None else [(frame, made), *found]

    def _lasting_lift(self, frame: g.Frame, rest: Frames, state: WorldState) -> PlanningResult:
        """The plan of a lift with a grasp after which the rest can be done."""
        ahead = frame, *rest
        return self._kept.plan(ahead, state, lambda: self._new_lasting_lift(ahead, state))

    def _new_lasting_lift(self, frames: Frames, state: WorldState) -> PlanningResult:
        budget = self._share()
        made = lasting_lift(self._controller, state, frames, self._stop, budget)
        self._left -= budget.done
        return made

    def _share(self) -> SearchBudget:
        """The budget of the next plan."""
        return SearchBudget(min(self._left, int(MOST_SHARE * self._defaults.most_work)))

    def _plan(self, frame: g.Frame, state: WorldState) -> PlanningResult:
        """The plan of a step, with no more work than is left."""
        if frame.query is not None or frame.action == "explore":
            return Reached()
        return self._kept.plan(frame, state, lambda: self._new_plan(frame, state))

    def _new_plan(self, frame: g.Frame, state: WorldState) -> PlanningResult:
        budget = self._share()
        planner = self._planner or partial(planning.plan, budget=budget)
        made = planner(frame, state, self._robot, defaults=self._defaults)
        self._left -= budget.done
        return made


def _next_frames(frames: Frames) -> Frames:
    """The frames that may be done next: the first, and those said by the same words."""
    first = frames[0]
    if not first.spans or first.query is not None:
        return frames[:1]
    return tuple(frame for frame in frames if frame.spans == first.spans)
