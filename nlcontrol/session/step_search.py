"""Steps by which a command can be done that cannot be done as it stands.

Objects that are named together ("both", "all") are moved in any order, and what stands in the way
is moved aside before. What the hand does not get to is brought to where it does; what it holds and
does not get to its place is put down and grasped anew (`planner.clearing`). The search is depth
first over predicted states, so that the whole is planned before anything moves, as far as what
comes of a step is predicted. The first way that is found is taken; as few objects as possible are
moved aside, since a way without that is looked for first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from grammar import paraphrase
from grammar.frames import command as g
from nlcontrol.errors import ControlError, ErrorInfo, refusal_error
from nlcontrol.session.executor import CancellableRobot
from nlcontrol.session.foresight import BudgetedPlanner, Foresight, PlanCache, lasting_lift
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
from planner.problem.predicted_states import state_after
from planner.types.cure import Cure, CureKind
from planner.types.defaults import CLEARED
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from planner.types.robot import ReachAnswer, ReachEffort, Robot
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.events import Supervisor
    from planner.types.actions import Push
    from planner.types.world_state import PlanarPose, WorldState

    Frames = tuple[g.Frame, ...]
    Steps = list[tuple[g.Frame, Plan | Reached]]


class ReachCache(CancellableRobot):
    """A robot that is not asked again for what it could not do, while nothing matters has moved.

    What is moved aside for a command changes little: most pushes that are asked for again are
    stopped by what still stands there. An object that was moved may stop more of them, never fewer.
    """

    def __init__(self, robot: Robot, stop: StopToken | None, time_limit: float | None) -> None:
        super().__init__(robot, stop, time_limit)
        self._denied: dict[object, list[tuple[Mapping[str, PlanarPose], ReachAnswer]]] = {}

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        """Answer of the robot, or the one that it gave."""
        asked = push, state.objects[push.object].pose, effort
        denied = self._denied.setdefault(asked, [])
        for places, known in denied:
            if all(state.objects[name].pose == pose for name, pose in places.items()):
                # An answer that is known costs one unit of work.
                return replace(known, work=1)
        answer = super().reach(push, state, effort)
        if not answer.ok and answer.stopped_by is not None:
            places = {name: state.objects[name].pose for name in answer.stopped_by}
            denied.append((places, answer))
        return answer


MOST_WORKS = 1.7
"""Work of all plans of an answer, the refused first one included, in that of one plan."""

MOST_WORKS_GIVEN_UP = 1.3
"""The same where that first plan was given up: beside what takes so long little else is found."""

MOST_SHARE = 0.5
"""Of the same, the work of each plan of a search.

What can be done after a step mostly shows soon, and what stops the hand then shows as soon.
"""


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
    controller: Controller,
    frames: Frames,
    index: int,
    refused: tuple[Refusal, WorldState] | None,
    supervisor: Supervisor,
    cache: PlanCache,
) -> Ways | ErrorInfo | None:
    """Steps in place of frames of which one was refused, or an error that tells them.

    Args:
        controller: the controller that plans.
        frames: frames of the command, their objects resolved.
        index: index of the refused frame; what stands before it is done.
        refused: why, and what was believed then; None if it was not.
        supervisor: told of a search, and asked whether to go on.
        cache: plans that were made for the command from there.

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
        search = StepSearch(controller, left, moved, supervisor.stop, cache, done)
        found = search.ways(state, refusal.message)
    except (Stopped, ControlError):
        return None
    if found is None or not found.aside or controller.defaults.clear == CLEARED.index("yes"):
        return found
    command = paraphrase(found.aside)
    kind: CureKind = "move" if found.aside[0].action == "move" else "first"
    cure = Cure(kind, f"{command} first", command)
    changes = {"suggestions": (cure.text,), "cures": (cure,)}
    return refusal_error(refusal).model_copy(update=changes)


class StepSearch:
    """Looks for steps by which frames can be done.

    Args:
        controller: the controller that plans.
        frames: what is left of a command, its objects resolved.
        moved: names of objects that were moved for it by now, and stay where they are.
        stop: asked whether to go on.
        cache: plans that were made for the command from here.
        done: units of work that were done for the answer before.
    """

    def __init__(
        self,
        controller: Controller,
        frames: Frames,
        moved: frozenset[str],
        stop: StopToken,
        cache: PlanCache,
        done: float = 0.0,
    ) -> None:
        self._frames, self._moved = frames, moved
        self._defaults = controller.defaults
        self._controller, self._stop, self._cache = controller, stop, cache
        robot = ReachCache(controller.robot, stop, controller.time_limit)
        most = controller.defaults.most_work
        works = MOST_WORKS if done < most else MOST_WORKS_GIVEN_UP
        work, each = int(works * most - done), int(MOST_SHARE * most)
        self._planner = BudgetedPlanner(controller, robot, work, each)
        self._foresight = Foresight(self._planner, cache)

    def ways(self, state: WorldState, why: str) -> Ways | None:
        """The steps from where everything is; None if none are found with the work allowed."""
        # At most three objects are moved aside for one command.
        for most in range(4):
            if self._planner.left <= 0:
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
            made = self._foresight.plan(frame, state)
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
        # Looking through places that an object is brought to may take 0.3 of that work.
        share = 0.3 * MOST_WORKS * self._defaults.most_work
        least = max(0.0, self._planner.left - share)
        anew = may_be_grasped_anew(frame, state)
        steps = (
            (setting_down_frame(frame),) if anew else bringing_frames(frame, state, self._defaults)
        )
        for step in steps:
            if self._planner.left <= least:
                return None
            made = self._foresight.plan(step, state)
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
            if self._planner.left <= 0:
                return None
            made = self._foresight.plan(step, state)
            if not isinstance(made, Plan):
                continue
            if found := self._joined(step, made, frames, state, moved, most):
                return found
            then = state_after(made, state)
            again = None if then is None else self._foresight.plan(frame, then)
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
        lift = partial(lasting_lift, self._controller, state, ahead, self._stop, self._planner)
        return self._cache.plan(ahead, state, lift)


def _next_frames(frames: Frames) -> Frames:
    """The frames that may be done next: the first, and those said by the same words."""
    first = frames[0]
    if not first.spans or first.query is not None:
        return frames[:1]
    return tuple(frame for frame in frames if frame.spans == first.spans)
