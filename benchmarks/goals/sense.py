"""What a person at the table would ask for: sentences that make sense by what is believed.

A sentence makes sense if every step of it does, each from where the one before would leave the
object. Only belief and plain geometry decide, never a planner or a reach, so that sensible
sentences may well be refused:

- What is moved, placed or turned ends within `TABLE` and no nearer than `ROOM` to anything that it
  is not to touch, or than the sentence says. If a direction is said, the straight way there is as
  free, and so is the circle of a turn. Nothing is pushed against what is fragile.
- What slides clearly does so (`SPARE`), by nominal parameters, if it is touched as low as the
  sentence and the fingertips allow. What topples or tilts clearly topples before it slides if it is
  pushed `BELOW` the highest place allowed on the face that the direction meets; a tilt is at most
  `TILT` of the angle of no return, and where the object lands or leans is free and on the table.
- A force that is allowed is at least `FORCE` times what the model says it takes, and a time is long
  enough for a push of that length.
- What takes a whole hand: see `hand_sense`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.goals.hand_sense import may_be_handled, may_be_held
from grammar.frames import command as g
from objectmodels import ObjectModel
from objectmodels.geometry.side_faces import Face
from planner.problem.directions import angle_between, heading_of
from planner.problem.footprints import footprint, free_travel, gap, landing_strip, travel_to_edge
from planner.problem.frame_interpretation import interpret_frame
from planner.problem.planning_problem import PushProblem, is_handled
from planner.pushing.push_paths import obliqueness
from planner.refusals.blocked import Blocked
from planner.types.actions import Aim
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.motion.robot_reach import lowest_contact
from sim.robots.robots import HAND

TABLE = ((0.36, 0.80), (-0.45, 0.45))
"""Where objects may be sent: least and largest x and y [m]."""
ROOM = 0.03
"""Least distance from what is not to be touched [m]."""
BELOW = 0.01
"""From the highest place of a contact down to the middle of a fingertip there [m]."""
TILT = 0.47
"""Largest tilt as a share of the angle of no return."""
SPARE = 0.8
"""What comes first when an object is pushed does so at this share of the force of what comes next,
or less: closer ones are nothing to ask for."""
FORCE = 1.5
"""Allowed force over the force needed."""

_STEP = 0.02  # between poses on a way that are looked at [m]
_TURN = math.radians(10.0)  # the same in a turn
_ROUNDING = 1e-4  # of places found by iteration [m]


def sensible(frames: Sequence[g.Frame], state: WorldState) -> bool:
    """Whether a person would ask for it.

    Args:
        frames: steps of a sentence, their objects resolved.
        state: how everything stands.
    """
    for frame in frames:
        if is_handled(frame):
            if not may_be_handled(frame, state):
                return False
            if not isinstance(frame.goal, g.Place):
                continue
        asked = interpret_frame(frame, state, DEFAULTS)
        if isinstance(asked, Blocked):
            return False
        assert frame.object is not None, "what is read has an object"
        target = state.objects[frame.object.id or ""]
        thought = _Thought(frame, asked, target, state)
        end = thought.end()
        if end is None:
            return False
        state = replace(state, objects={**state.objects, end.name: end})
    return True


def tips(model: ObjectModel) -> bool:
    """Whether an object topples before it slides when it is pushed high on one of its faces."""
    return any(onset(model, face, model.top - BELOW).topples for face in model.faces())


@dataclass(frozen=True)
class Onset:
    """How a push begins.

    Attributes:
        topples, slides: whether the object clearly does; neither is clear within `SPARE`.
        force: that it takes [N].
    """

    topples: bool
    slides: bool
    force: float


def onset(model: ObjectModel, face: Face, height: float) -> Onset:
    """How a push into the middle of a face begins, so high above the table [m]."""
    point, normal = face.points_at(0.0, height)
    found = model.thresholds(point[None], -normal[None])
    topple, slide = float(found.topple[0]), float(found.slide[0])
    return Onset(topple < SPARE * slide, slide < SPARE * topple, float(found.onset[0]))


@dataclass(frozen=True)
class _Thought:
    """One step of a sentence, thought through.

    Attributes:
        frame: the step.
        asked: what it asks.
        target: its object.
        state: how everything stands before it.
    """

    frame: g.Frame
    asked: PushProblem
    target: SeenObject
    state: WorldState

    def end(self) -> SeenObject | None:
        """The object after the step; None if the step makes no sense."""
        if self.asked.goal.outcome == "topple":
            return self._tipped()
        if is_handled(self.frame):
            fits = self._may_be_put
        else:
            touched = self._touched()
            kept = touched & {name for name, _ in self.asked.motion.clear_of}
            fragile = any(self.state.objects[name].fragile for name in touched)
            if kept or fragile or not self._slides():
                return None
            fits = self._may_be_sent
        return next((self._at(aim) for aim in self.asked.goal.aims if fits(aim)), None)

    def _at(self, aim: Aim) -> SeenObject:
        pose = self.target.pose
        yaw = pose.yaw if aim.yaw is None else aim.yaw
        return replace(self.target, pose=replace(pose, x=aim.x, y=aim.y, yaw=yaw))

    def _may_be_put(self, aim: Aim) -> bool:
        """Whether a hand may put it down there."""
        there = self._at(aim)
        return _is_on_table(aim) and self._clear(there, set()) and may_be_held(there, self.state)

    def _may_be_sent(self, aim: Aim) -> bool:
        """Whether an object may be sent to an aim, in the time that is said."""
        if not _is_on_table(aim):
            return False
        most = self.asked.motion.duration
        if most is not None:
            said = all(used.name != "speed" for used in self.asked.defaults_used)
            fastest = self.asked.motion.speed if said else DEFAULTS.speed_most
            if most < DEFAULTS.push_overhead + self._distance(aim) / fastest:
                return False
        touched = self._touched()
        return all(self._clear(pose, touched) for pose in self._way(self._at(aim)))

    def _distance(self, there: Aim | PlanarPose) -> float:
        return math.dist((there.x, there.y), (self.target.pose.x, self.target.pose.y))

    def _way(self, end: SeenObject) -> Iterator[SeenObject]:
        """Poses on the way to an end; that alone if no way is said."""
        here, there = self.target.pose, end.pose
        steps = 1
        if self.asked.goal.rotates:
            steps = math.ceil(abs(there.yaw - here.yaw) / _TURN)
        elif self.asked.goal.heading is not None:
            steps = math.ceil(self._distance(there) / _STEP)
        for share in np.linspace(0.0, 1.0, max(steps, 1) + 1)[1:].tolist():
            x, y, yaw = (
                a + share * (b - a)
                for a, b in ((here.x, there.x), (here.y, there.y), (here.yaw, there.yaw))
            )
            yield replace(self.target, pose=replace(here, x=x, y=y, yaw=yaw))

    def _touched(self) -> set[str]:
        """Names of what is to be touched."""
        goal = self.frame.goal
        names = {self.asked.goal.meets} if self.asked.goal.meets else set()
        if isinstance(goal, g.Place) and goal.relation == "touching":
            assert isinstance(goal.reference, tuple), "objects are touched"
            names |= {ref.id or "" for ref in goal.reference}
        return names

    def _clear(self, there: SeenObject, touched: set[str]) -> bool:
        """Whether an object keeps its distance from the others."""
        covered = footprint(there)
        return all(
            gap(covered, footprint(other)) >= apart - _ROUNDING
            for other, apart in self._others()
            if other.name not in touched
        )

    def _others(self) -> Iterator[tuple[SeenObject, float]]:
        """All else that stands there, and how far off it should stay [m]."""
        said = dict(self.asked.motion.clear_of)
        for name, other in self.state.objects.items():
            if name != self.target.name:
                yield other, max(ROOM, said.get(name, 0.0))

    def _slides(self) -> bool:
        """Whether it stays on its base, whichever of the faces that may be pushed is touched."""
        low, high = self._heights()
        if high < low:
            return False
        begun = [onset(self.target.model, face, low) for face in self._faces(self.target)]
        return all(each.slides and self.asked.force.max >= FORCE * each.force for each in begun)

    def _tipped(self) -> SeenObject | None:
        """The object, turned to the direction if it had to be, if one of its faces will do."""
        low, high = self._heights()
        there, heading = self.target, self.asked.goal.heading
        askew = 0.0 if heading is None else obliqueness(there, heading)
        if abs(askew) > 0.5 * DEFAULTS.side_tolerance:
            there = replace(there, pose=replace(there.pose, yaw=there.pose.yaw + askew))
        if high < low or not all(self._clear(pose, set()) for pose in self._way(there)):
            return None
        return there if any(self._tips(there, face, high) for face in self._faces(there)) else None

    def _tips(self, there: SeenObject, face: Face, height: float) -> bool:
        """Whether it clearly topples away from a face, and has room to land or lean there."""
        begun = onset(there.model, face, height)
        if not begun.topples or self.asked.force.max < FORCE * begun.force:
            return False
        inward = -np.array(face.normal)
        u = there.pose.R_WB @ inward
        tilt = self.asked.goal.tilt
        if tilt is None:
            strip = landing_strip(there, u)
            on_it = travel_to_edge(strip, self.state.table, u[:2], 0.0) >= ROOM
            return on_it and all(gap(strip, footprint(o)) >= apart for o, apart in self._others())
        over, here = there.model.top * math.sin(tilt), footprint(there)
        most = TILT * there.model.angle_of_no_return(inward) + 1e-9  # rounding
        return tilt <= most and all(
            free_travel(here, footprint(other), u[:2], apart) >= over
            for other, apart in self._others()
        )

    def _heights(self) -> tuple[float, float]:
        """The lowest and the highest contact allowed [m]."""
        top = self.target.model.top - BELOW
        return max(self.asked.contact.low, lowest_contact(HAND)), min(self.asked.contact.high, top)

    def _faces(self, there: SeenObject) -> list[Face]:
        """The face that the direction meets; all if none is said, or if it is turned."""
        heading = self.asked.goal.heading
        if heading is None or self.asked.goal.rotates:
            return list(there.model.faces())
        faces = there.model.faces([heading - there.pose.yaw])

        def oblique(face: Face) -> float:
            return abs(angle_between(heading_of(-there.pose.R_WB @ np.array(face.normal)), heading))

        return [min(faces, key=oblique)]


def _is_on_table(aim: Aim) -> bool:
    (x0, x1), (y0, y1) = TABLE
    return x0 <= aim.x <= x1 and y0 <= aim.y <= y1
