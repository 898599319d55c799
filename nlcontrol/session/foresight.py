"""Foresight: plan after plan over predicted states, before anything moves.

Steps by which a command can be done that cannot be done as it stands.

Objects that are named together ("both", "all") are moved in any order, and what stands in the way
is moved aside before. What the hand does not get to is brought to where it does; what it holds and
does not get to its place is put down and grasped anew (`planner.clearing`). The search is depth
first over predicted states: each step is planned from where those before it leave everything, so
that the whole is planned before anything moves, as far as what comes of a step is predicted. The
first way that is found is taken; objects are moved aside as few as possible, since a way without
that is looked for first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, get_args

from grammar import paraphrase
from grammar.frames import command as g
from nlcontrol.errors import ControlError, ErrorInfo, refusal_error
from nlcontrol.session.executor import PlanningRobot, StoppableRobot
from nlcontrol.text_format import place_text
from objectmodels.geometry.rotations import from_quaternion
from planner import plan, planning
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
from planner.problem.directions import angle_between
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.true_reasons import REASON_WORK
from planner.types.cure import Cure, CureKind
from planner.types.defaults import CLEARED, Defaults
from planner.types.plan import Plan, PlanningResult, Reached
from planner.types.refusal import Refusal
from planner.types.robot import ReachAnswer, ReachEffort, Robot
from sim.robots.cell_description import LOOK, Vision
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from nlcontrol.session.events import Supervisor
    from planner.types.actions import Push
    from planner.types.world_state import PlanarPose, WorldState
    from sim.traces.trace import Trace

    PlanStep = Callable[[g.Frame, WorldState], PlanningResult]
    Places = dict[str, PlanarPose]
    Frames = tuple[g.Frame, ...]
    Steps = list[tuple[g.Frame, Plan | Reached]]


# Steps of a command behind its first, planned from where everything is predicted to be then.
#
# What would end halfway is told before anything moves, or the first step is made otherwise:
# something is held so that it can be put down, too. It is looked through as far as what comes of
# each step is predicted: of poses and of the hand, not of contents, lids, and what touching finds
# out.


MOST_EACH = 500
"""Work of planning what comes after one way to hold something."""


def plan_with_foresight(
    controller: PlanningRobot,
    made: Plan | Reached,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    kept: KeptPlans,
) -> PlanningResult:
    """The plan of the first step, or another one, after which the others can be done; or why not.

    Args:
        controller: that plans.
        made: the plan of the first step.
        state: from where that was made.
        frames: all steps, their objects resolved.
        stop: asked whether to go on.
        kept: takes the plans that are made.

    Raises:
        Stopped: that was asked for.
        ControlError: as of `Controller.plan`.
    """

    def plan_step(frame: g.Frame, then: WorldState) -> PlanningResult:
        return kept.plan(frame, then, lambda: controller.plan(frame, then, stop=stop))

    refused = _refused_ahead(plan_step, made, state, frames)
    if refused is not None and isinstance(made, Plan) and made.task == "lift":
        budget = SearchBudget(controller.defaults.most_work)
        lift = partial(lasting_lift, controller, state, frames, stop, budget)
        other = kept.plan(tuple(frames), state, lift)
        if isinstance(other, Plan):
            return other
    return made if refused is None else refused


def lasting_lift(
    controller: PlanningRobot,
    state: WorldState,
    frames: Sequence[g.Frame],
    stop: StopToken,
    budget: SearchBudget,
) -> PlanningResult:
    """A plan of the first of some frames, with a grasp after which the others can be done."""
    robot = _ForesightedRobot(controller, frames, stop)
    planner = controller.planner or partial(planning.plan, budget=budget)
    return planner(frames[0], state, robot, defaults=controller.defaults)


def _refused_ahead(
    plan_step: PlanStep, made: Plan | Reached, state: WorldState, frames: Sequence[g.Frame]
) -> Refusal | None:
    """The refusal of the first step that will have no plan; None as far as all have one."""
    for number, frame in enumerate(frames[1:], start=1):
        after = state_after(made, state)
        if after is None or frame.action == "explore":
            return None
        state, made = after, Reached()
        if frame.query is not None:
            continue
        answer = plan_step(frame, state)
        if isinstance(answer, Refusal):
            before = paraphrase(frames[:number])
            told = f"nothing is moved: after “{before}” {answer.message}"
            return answer.model_copy(update={"message": told})
        made = answer
    return None


class _ForesightedRobot(StoppableRobot):
    """A robot that gets to a grasp only if it can do what comes after it."""

    def __init__(
        self, controller: PlanningRobot, frames: Sequence[g.Frame], stop: StopToken
    ) -> None:
        super().__init__(controller.robot, stop, controller.time_limit)
        self._controller, self._frames = controller, frames

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        """Answer of the robot, and of planning what comes after."""
        answer = super().reach_plan(plan, state)
        if not answer.ok:
            return answer
        budget, defaults = SearchBudget(MOST_EACH), self._controller.defaults
        planner = self._controller.planner or partial(planning.plan, budget=budget)

        def plan_step(frame: g.Frame, then: WorldState) -> PlanningResult:
            return planner(frame, then, self._robot, defaults=defaults)

        refused = _refused_ahead(plan_step, plan, state, self._frames)
        if refused is None:
            return replace(answer, work=answer.work + budget.done)
        work, words = answer.work + budget.done, {"text": refused.message}
        return ReachAnswer(False, "approach", "told", work=work, words=words)


# Whether another push would bring an object nearer to its aim, as far as the camera can tell.
#
# Where it came to differs from where it was by what two looks tell, whose constant errors are
# equal; but the hand goes to a place that is off by all of that error, so that small pushes end
# anywhere within it. What is nearer than that, and well within what is asked, is left as it is;
# so is what is within what is asked and was brought no nearer by the last push.


_WELL = 0.5  # share of a tolerance within which is well within it


LEFT_SO = "it is left there: another push would bring it no nearer that the camera sees"
"""Note of a result that was not corrected any further."""


class Corrections:
    """Pushes by which one frame is corrected.

    Args:
        vision: data sheet of the camera.
        defaults: tolerances.
    """

    def __init__(self, vision: Vision, defaults: Defaults) -> None:
        looks = math.sqrt(2.0 / max(vision.rate_hz * LOOK, 1.0))
        self._known = math.hypot(looks * vision.position_noise_m, vision.position_bias_m)
        noise, bias = vision.angle_noise_deg, vision.angle_bias_deg
        self._known_angle = math.radians(math.hypot(looks * noise, bias))
        self._defaults = defaults
        self._before: PlanarPose | None = None
        self._nearest = math.inf

    def begin_at(self, before: PlanarPose) -> None:
        """Takes the pose from which the frame begins."""
        self._before = before

    def are_worth(self, made: Plan, state: WorldState) -> bool:
        """Return False if the pushes of a plan would bring the object no nearer to its aim."""
        aim, before, d = made.aim, self._before, self._defaults
        if aim is None or before is None or not made.pushes:
            return True
        pose = state.objects[made.object].pose
        way = math.dist((aim.x, aim.y), (before.x, before.y))
        off = math.dist((aim.x, aim.y), (pose.x, pose.y))
        tolerance = _tolerance(d.distance_tolerance, way)
        # 0.7: share of the tolerance of a direction.
        aside = 0.7 * way * math.tan(d.direction_tolerance) or math.inf
        turn = asked = 0.0
        if aim.yaw is not None:
            turn = abs(angle_between(aim.yaw, pose.yaw))
            asked = abs(angle_between(aim.yaw, before.yaw))
        turn_tolerance = _tolerance(d.turn_tolerance, asked)
        if off > tolerance or turn > turn_tolerance:
            return True
        share = max(off / tolerance, turn / turn_tolerance)
        bettered, self._nearest = share < self._nearest, min(share, self._nearest)
        well = min(max(d.aim_position, self._known), _WELL * tolerance, aside)
        well_turned = min(max(d.aim_angle, self._known_angle), _WELL * turn_tolerance)
        return bettered and (off > well or turn > well_turned)


def _tolerance(usual: float, amount: float) -> float:
    """The tolerance of an amount: less than the usual one of a small amount, but for none."""
    # A tolerance is at most a third of the amount.
    return min(usual, (1.0 / 3.0) * amount) or usual


def spent_text(made: Plan, times: int) -> str:
    """Remark that a frame's budget is used up."""
    what, several = ("push", "pushes") if made.pushes else ("try", "tries")
    return f"this may take {times} {what if times == 1 else several} at most"


# Pushes that the hand did not get to, which stay so while what stopped it stays where it is.
#
# What is moved aside for a command changes little: most pushes that are asked for again are
# stopped by what still stands there. An object that was moved may stop more of them, never fewer.


class RecallingRobot(StoppableRobot):
    """A robot that is not asked again for what it could not do, while nothing matters has moved."""

    def __init__(self, robot: Robot, stop: StopToken | None, time_limit: float | None) -> None:
        super().__init__(robot, stop, time_limit)
        self._denied: dict[object, list[tuple[Places, ReachAnswer]]] = {}

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


# Plans of the steps of a command from predicted states, each of which is made once.


class KeptPlans:
    """What planning answered so far; beliefs other than poses and the hand stay what they are."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], PlanningResult] = {}

    def plan(
        self,
        frame: g.Frame | tuple[g.Frame, ...],
        state: WorldState,
        make: Callable[[], PlanningResult],
    ) -> PlanningResult:
        """The answer for a frame from a state; made if it is not known.

        Of several frames it is the one for the first after which the others can be done.
        """
        poses = ((name, seen.pose, seen.lies_on) for name, seen in state.objects.items())
        key = (frame, state.held, *poses)
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]


# Plans midway: to the aim of the plan before, or to another one that the sentence allows.
#
# A push that ends elsewhere than foreseen may leave an object where the hand does not get to it
# for the aim that was chosen. From there another aim is looked for, if the sentence does not
# measure it from where the object stood.


def onward_plan(
    planning: Callable[..., PlanningResult],
    frame: g.Frame,
    state: WorldState,
    previous: Plan | None,
) -> PlanningResult:
    """The plan of what is left of a frame, or why there is none to the aim that was chosen.

    Args:
        planning: of the frame from where everything is; the aim of a `previous` plan is kept.
        frame: that was begun.
        state: what is believed now.
        previous: the plan whose first push was made last; None if its aim is not kept.
    """
    made = planning(previous=previous)
    if previous is None or not isinstance(made, Refusal):
        return made
    if not (is_beyond_hand(made) and may_be_brought(frame, state)):
        return made
    anew = planning()
    if isinstance(anew, Plan):
        notes = (f"another aim, since {made.message}", *anew.notes)
        return anew.model_copy(update={"notes": notes})
    return made if isinstance(anew, Refusal) else anew


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
    controller: PlanningRobot,
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
    command = paraphrase(found.aside)
    kind: CureKind = "move" if found.aside[0].action == "move" else "first"
    cure = Cure(kind, f"{command} first", command)
    changes = {"suggestions": (cure.text,), "cures": (cure,)}
    return refusal_error(refusal).model_copy(update=changes)


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
        controller: PlanningRobot,
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
        # At most three objects are moved aside for one command.
        for most in range(4):
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
        # Looking through places that an object is brought to may take 0.3 of that work.
        share = 0.3 * MOST_WORKS * self._defaults.most_work
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


# What came to lie where the hand does not get to it, told before anybody asks for it.
#
# Where something is brought to, its place is chosen so that the hand gets to it again. Where it
# falls to is chosen by nobody: it is looked whether it can be pushed on or lifted from there.
# Frames: W.


_WAY = 0.05  # of a push, and up in a lift, that is a hold on an object [m]


def stranded_things(
    controller: PlanningRobot, trace: Trace, look: Callable[[], WorldState], stop: StopToken
) -> Iterator[str]:
    """Sentences on what fell, and is neither pushed nor lifted from where it lies."""
    names = fallen_things(trace)
    if not names:
        return
    try:
        state = look()
        held = state.held.name if state.held is not None else None
        for name in names:
            if name != held and name in state.objects:
                yield from _stranded(controller, name, state, stop)
    except (Stopped, ControlError):
        return  # what was done is told all the same


def fallen_things(trace: Trace) -> list[str]:
    """Names of what lies or stands on another face than at the beginning, as it was seen."""
    ups = {name: from_quaternion(seen[[0, -1], :4])[:, 2] for name, seen in trace.seen.items()}
    # 0.7: the cosine between what was up in an object and what is now, unless it fell.
    return [name for name, (first, last) in ups.items() if first @ last < 0.7]


def _stranded(
    controller: PlanningRobot, name: str, state: WorldState, stop: StopToken
) -> Iterator[str]:
    robot = RecallingRobot(controller.robot, stop, controller.time_limit)
    # Each plan may take a tenth of the usual work.
    most = int(0.1 * controller.defaults.most_work)
    for frame in _frames_of(name):
        plan = controller.planner or partial(planning.plan, budget=SearchBudget(most))
        made = plan(frame, state, robot, defaults=controller.defaults)
        if not isinstance(made, Refusal):
            return
    place = place_text(*state.objects[name].pose.p_WB[:2])
    yield (
        f"the {name} lies at {place} now, where the robot finds no way to push it or to lift it "
        "as things are"
    )


def _frames_of(name: str) -> Iterator[g.Frame]:
    """Small motions; what allows none of them is out of the hand's reach."""
    own = g.ObjectRef(text=name, noun=name, id=name)
    for way in get_args(g.Direction):
        yield g.Frame(action="push", object=own, goal=g.Displace(direction=way, distance=_WAY))
    yield g.Frame(action="lift", object=own, goal=g.Lift(height=_WAY))


# Whether what is toppled could be stood up again where it will lie, which is told beforehand.


def with_way_back(
    controller: PlanningRobot, made: PlanningResult, state: WorldState
) -> PlanningResult:
    """The plan, with a note if there is no way back from the fall in which it ends.

    Args:
        controller: that plans.
        made: from a state.
        state: what is believed.
    """
    if not isinstance(made, Plan) or not made.pushes or made.pushes[-1].ends_on != "toppled":
        return made
    then = state_after(made, state)
    if then is None:
        return made
    budget = SearchBudget(int(REASON_WORK * controller.defaults.most_work))
    own = g.ObjectRef(text=made.object, id=made.object)
    upright = g.Frame(action="place", object=own, goal=g.Upright())
    back = plan(upright, then, controller.robot, defaults=controller.defaults, budget=budget)
    if not isinstance(back, Refusal) or back.code == "work_used_up":
        return made
    note = f"where it will lie I could not stand it up again: {back.message}"
    return made.model_copy(update={"notes": (*made.notes, note)})
