"""The way back: frames that bring objects to where they were before something was done to them.

A held object is set down where it was taken; a lid that was opened is closed, and the other way
round; what was poured stays where it is, with a note. What was put on another object or into it, or
taken from there, is put back. Otherwise the way back is pushed: an object that turned is turned
back, and pushed from where the robot sees it now to where it saw it before, the last sentence
first. A round object is turned back only if it was to be turned; else a note names its turn.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import error
from nlcontrol.text_format import quantity
from planner.problem.directions import angle_between, heading_of, phrase

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from objectmodels.models.object_model import Resting
    from planner.plan_explanation import Basis
    from planner.types.defaults import Defaults
    from planner.types.plan import Plan, PlanTask
    from planner.types.world_state import PlanarPose, SeenObject, WorldState


@dataclass(frozen=True, eq=False)
class UndoEntry:
    """A push, or what a whole hand did, that was carried out.

    Attributes:
        of: result of the sentence that asked for it.
        object: name of the object in the scene.
        before: pose in which the robot saw it before.
        task: task of the plan.
        rest: attitude in which it lay then, if not on its bottom.
        on: object on or in which it stood then; None on the table.
    """

    of: Result
    object: str
    before: PlanarPose
    task: PlanTask = "push"
    rest: Resting | None = None
    on: str | None = None

    @classmethod
    def from_step(
        cls, of: Result, plan: Plan, before: PlanarPose, basis: Basis | None
    ) -> UndoEntry:
        """What a step did, whose plan had a basis."""
        if basis is None:
            return cls(of, plan.object, before, plan.task)
        return cls(of, plan.object, before, plan.task, basis.target.rest, basis.target.on)

    def object_before(self, now: SeenObject) -> SeenObject:
        """The object as it was before."""
        model = now.standing_model if self.rest is None else self.rest.model
        return replace(
            now, pose=self.before, model=model, rest=self.rest, attitude=None, on=self.on
        )


@dataclass(frozen=True)
class UndoPlan:
    """Frames that undo some pushes.

    Attributes:
        frames: frames to carry out, in this order.
        undoes: for each frame, the push that it undoes.
        notes: parts that are not undone, in plain words.
    """

    frames: tuple[g.Frame, ...]
    undoes: tuple[UndoEntry, ...]
    notes: tuple[str, ...]


def undo_frames(pushed: Sequence[UndoEntry], state: WorldState, defaults: Defaults) -> UndoPlan:
    """The way back from pushes given in the order in which they were made, the last one first."""
    here, found, notes = dict(state.objects), [], []
    held = None if state.held is None else state.held.name
    for push in reversed(pushed):
        now = here[push.object]
        if push.task == "pour":
            notes.append(f"what was poured from the {push.object} is not poured back")
        if push.task in _OPPOSITES:
            goal = _OPPOSITES[push.task]()
            found.append((_frame(goal.kind, now, goal), push))
        if held == push.object:
            found.append((_set_down(now, push.before, defaults), push))
            here[push.object], held = push.object_before(now), None
            continue
        before = push.object_before(now)
        if now.lies_on != before.lies_on != "bottom":
            notes.append(f"the {push.object} does not get back onto {before.side_below}")
            here[push.object] = before
            continue
        turn = abs(angle_between(now.pose.yaw, push.before.yaw))
        turns = not now.model.base.is_round or _was_to_turn(push)
        if not turns and turn > defaults.no_turn:
            notes.append(f"that the {push.object} turned by {quantity(turn, 'rad')} is not undone")
        if now.on != before.on:
            found.append((_put_back(now, before, state), push))
        else:
            found += [(frame, push) for frame in _back(now, before, turns, defaults)]
        # The push before it is undone from where this one will leave the object.
        here[push.object] = before
    return UndoPlan(tuple(f for f, _ in found), tuple(p for _, p in found), tuple(notes))


_OPPOSITES: dict[str, type[g.Open | g.Close]] = {"open": g.Close, "close": g.Open}


def _frame(action: g.Action, now: SeenObject, goal: g.Goal) -> g.Frame:
    return g.Frame(action=action, object=g.ObjectRef(text=now.name, noun=now.name), goal=goal)


def _set_down(now: SeenObject, there: PlanarPose, defaults: Defaults) -> g.Frame:
    """Sets down what is held, where it was taken."""
    way = there.p_WB - now.pose.p_WB
    if math.hypot(way[0], way[1]) < defaults.distance_tolerance:
        return _frame("place", now, g.SetDown())
    place = g.Place(relation="at", reference=g.Point(x=there.x, y=there.y))
    return _frame("place", now, place)


def _put_back(now: SeenObject, before: SeenObject, state: WorldState) -> g.Frame:
    """Puts an object on the table, on another one or into it, where it stood."""
    goal = g.Place(relation="at", reference=g.Point(x=before.pose.x, y=before.pose.y))
    if before.on is not None:
        lower = g.ObjectRef(text=before.on, noun=before.on)
        relation = "in" if state.stands_inside(before) else "on"
        goal = g.Place(relation=relation, reference=(lower,))
    return _frame("place", now, goal)


def _was_to_turn(push: UndoEntry) -> bool:
    names = (f.object.id for f in push.of.frames if isinstance(f.goal, g.Rotate) and f.object)
    return push.object in names


def _back(
    now: SeenObject, before: SeenObject, turns: bool, defaults: Defaults
) -> Iterator[g.Frame]:
    """Frames that bring an object back to where it was; none if it is there."""
    if now.lies_on != before.lies_on:
        yield _frame("place", now, g.Upright())
        return
    there = before.pose
    turn = angle_between(there.yaw, now.pose.yaw)
    if turns and abs(turn) > defaults.turn_tolerance:
        back = g.Rotate(angle=abs(turn), sense="ccw" if turn > 0.0 else "cw")
        yield _frame("turn", now, back)
    way = there.p_WB - now.pose.p_WB
    distance = math.hypot(way[0], way[1])
    if distance >= defaults.distance_tolerance:
        goal = g.Displace(heading=heading_of(way), distance=distance)
        yield _frame("push", now, goal)


_OTHER_WAY: dict[g.Direction, g.Direction] = {
    "away": "toward",
    "toward": "away",
    "left": "right",
    "right": "left",
}
_OTHER_SIDE: dict[str, g.Relation] = {
    "left_of": "right_of",
    "right_of": "left_of",
    "behind": "in_front_of",
    "in_front_of": "behind",
}


def reversed_goal(goal: g.Goal) -> g.Goal:
    """The goal of going the other way.

    Raises:
        ControlError: `nothing_before` if it has no direction.
    """
    if isinstance(goal, g.Rotate):
        sense = "ccw" if goal.sense == "cw" else "cw"
        return goal.model_copy(update={"sense": sense})
    if isinstance(goal, g.Displace) and goal.heading is not None:
        heading = math.remainder(goal.heading + math.pi, math.tau)
        return goal.model_copy(update={"heading": heading})
    if isinstance(goal, g.Place) and goal.relation in _OTHER_SIDE:
        return goal.model_copy(update={"relation": _OTHER_SIDE[goal.relation]})
    if isinstance(goal, g.Displace) and (goal.toward or goal.away_from):
        update = {"toward": goal.away_from, "away_from": goal.toward, "fraction": None}
        return goal.model_copy(update=update)
    if isinstance(goal, g.Displace | g.Topple | g.Tilt):
        way = goal.direction or "away"
        other = (
            tuple(_OTHER_WAY[each] for each in way) if isinstance(way, tuple) else _OTHER_WAY[way]
        )
        return goal.model_copy(update={"direction": other})
    raise error(
        "nothing_before",
        "what was done last has no opposite direction",
        suggestions=("say where to, as “to the left”",),
    )


def undo_text(frames: Sequence[g.Frame]) -> str:
    """The way back in plain words."""
    return ", then ".join(map(_step, frames))


def _step(frame: g.Frame) -> str:
    goal, name = frame.goal, frame.object.text if frame.object else "it"
    if isinstance(goal, g.SetDown | g.Place):
        return f"set the {name} down"
    if isinstance(goal, g.Open | g.Close):
        return f"{goal.kind} the {name}"
    if isinstance(goal, g.Rotate):
        side = "left" if goal.sense == "ccw" else "right"
        return f"turn the {name} by {quantity(goal.angle or 0.0, 'rad')} to the {side}"
    if not isinstance(goal, g.Displace):
        return f"set the {name} upright"
    assert isinstance(goal.distance, float)
    assert goal.heading is not None
    return f"push the {name} by {quantity(goal.distance, 'm')} {phrase(goal.heading)}"
