"""The push that a question speaks of: which face, where on it, which way and how hard.

It is read as the planner reads a command. What the question leaves open: the way is away from the
robot, the height the middle of what is allowed, the force that of the onset. Frames: contacts and
directions are in B, heights above the table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from grammar.frames import command as g
from nlcontrol.errors import ControlError, error, refusal_error, whole_span
from nlcontrol.questions.answer import Considered
from nlcontrol.questions.push_prediction import PushPrediction, predict_push
from nlcontrol.text_format import aside_text, quantity
from planner.affordances import pushed_face
from planner.problem.directions import FACE_HEADINGS, HEADINGS, heading_of, unit
from planner.problem.frame_interpretation import interpret_frame, require_resting
from planner.refusals.no_plan import no_plan, not_capable
from planner.types.refusal import NoPlanError

if TYPE_CHECKING:
    from objectmodels import Face
    from planner.problem.planning_problem import PushProblem
    from planner.types.actions import FaceName
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState

Vector3 = tuple[float, float, float]
EVENTS: dict[str, g.Event] = {"topple": "tips", "tilt": "tilts", "rotate": "turns"}
"""What a goal wants to happen; of any other it is that the object moves."""


@dataclass(frozen=True)
class Inquiry:
    """A push that is asked about, at one place.

    Attributes:
        target: the object.
        face_name: the face as the robot calls it.
        face: the face.
        lateral, height: the place on it [m].
        low, high: heights that the question allows [m].
        placed: whether the question says how high.
        direction: of the force in B; None for straight in.
        force: its size [N]; None for the force at the onset.
        sense: which way it is to turn, if that is asked.
    """

    target: SeenObject
    face_name: FaceName
    face: Face
    lateral: float
    height: float
    low: float
    high: float
    placed: bool
    direction: Vector3 | None
    force: float | None
    sense: Literal["left", "right"] | None

    @property
    def where(self) -> str:
        """The place in words: "on its front face, 192 mm above the table"."""
        off = aside_text(self.lateral)
        aside = f" {off} of its middle" if off else ""
        return f"on its {self.face_name} face{aside}, {quantity(self.height, 'm')} above the table"

    @property
    def push_in_answer(self) -> Considered:
        """The push as an answer tells it."""
        if self.direction is None:
            u = -np.array(self.face.points_at([self.lateral], [self.height])[1][0])
        else:
            u = np.array(self.direction)
        return Considered(
            face=self.face_name,
            height=self.height,
            lateral=self.lateral,
            heading=heading_of(self.target.pose.R_WB @ u),
            force=self.force,
        )

    def push_prediction(self) -> PushPrediction:
        """The prediction of the push, by the code behind `nlcontrol predict`."""
        return predict_push(
            self.target.model,
            self.face_name,
            self.face,
            lateral=self.lateral,
            height=self.height,
            direction=self.direction,
            force=self.force,
            yaw=self.target.pose.yaw,
        )


def wanted_event(frame: g.Frame) -> g.Event:
    """The event that a question is about: the one that it names, or what its goal means."""
    return frame.event or EVENTS.get(frame.goal.kind, "moves")


def outcome_of(event: g.Event) -> str:
    """The outcome at the onset by which an event begins."""
    return "topple" if event in ("tips", "tilts") else "slide"


def target_of(frame: g.Frame, state: WorldState) -> SeenObject:
    """The object that a question is about.

    Raises:
        ControlError: `unknown_object` if it names none.
    """
    if frame.object is None or frame.object.id is None:
        raise error(
            "unknown_object",
            "the question does not say which object it is about",
            suggestions=("name the object",),
        )
    return state.objects[frame.object.id]


def push_asked_about(frame: g.Frame, state: WorldState, defaults: Defaults) -> Inquiry:
    """The push of a question.

    Raises:
        ControlError: the planner's reason if it cannot be read as a push, or there is no such place
            on the object.
    """
    target = target_of(frame, state)
    try:
        asked = interpret_frame(_as_command(frame), state, defaults)
        require_resting(target)
        face_name, face, heading = _touched_face(asked, target)
    except NoPlanError as refused:
        raise ControlError(refusal_error(refused.refusal)) from refused
    low, high = max(asked.contact.low, face.bottom), min(asked.contact.high, face.top)
    if low > high:
        raise error(
            "impossible",
            f"no place on the {face_name} face of the {target.name} is "
            f"{asked.contact.region}: it reaches from {quantity(face.bottom, 'm')} to "
            f"{quantity(face.top, 'm')} above the table",
            span=whole_span(asked.contact.spans),
            suggestions=("leave out where to touch it",),
            numbers={"lowest": face.bottom, "highest": face.top},
        )
    return Inquiry(
        target=target,
        face_name=face_name,
        face=face,
        lateral=0.0,
        height=(low + high) / 2.0,
        low=low,
        high=high,
        placed=asked.contact.region is not None,
        direction=None if heading is None else _along(heading, asked, target, face_name, face),
        force=_force(frame),
        sense=_sense(frame),
    )


def _as_command(frame: g.Frame) -> g.Frame:
    """The command that says which way and where to push, and nothing else of the question."""
    goal = frame.goal
    clauses = (g.ContactRegion, g.Effector)
    if isinstance(goal, g.Displace):
        goal = g.Displace(
            direction=goal.direction,
            heading=goal.heading,
            toward=goal.toward,
            away_from=goal.away_from,
            spans=goal.spans,
        )
    elif isinstance(goal, g.Tilt):
        goal = g.Topple(direction=goal.direction, spans=goal.spans)
    elif isinstance(goal, g.Rotate | g.NoGoal):
        goal = g.Displace(spans=goal.spans)
    return frame.model_copy(
        update={
            "query": None,
            "event": None,
            "goal": goal,
            "constraints": tuple(c for c in frame.constraints if isinstance(c, clauses)),
        }
    )


def _touched_face(asked: PushProblem, target: SeenObject) -> tuple[FaceName, Face, float | None]:
    """The face that is touched, its name, and the heading of the push if it is not straight in."""
    heading = asked.goal.heading
    if (
        any(used.name == "direction" for used in asked.defaults_used)
        or asked.goal.outcome == "topple"
    ):
        heading = None  # what falls is pushed square to its face
    if asked.contact.face == "top":
        raise not_capable(
            "predicting presses on the top face",
            "questions are answered about pushes on side faces; the top face is not one",
            asked.contact.spans,
            "say “at the top” for the upper third of a side face",
        )
    if asked.contact.face is not None:
        into = FACE_HEADINGS[asked.contact.face] + math.pi
    else:
        into = HEADINGS["away"] if asked.goal.heading is None else asked.goal.heading
    found = pushed_face(target, into)
    if found is None or asked.contact.face not in (None, found[0]):
        where = "side" if asked.contact.face is None else f"{asked.contact.face} face"
        raise no_plan("no_side", spans=asked.contact.spans, object=target.name, where=where)
    return *found, heading


def _along(
    heading: float, asked: PushProblem, target: SeenObject, face_name: FaceName, face: Face
) -> Vector3:
    """A heading in W as a direction in B that must press on the face."""
    u = target.pose.R_WB.T @ unit(heading)
    if u @ np.array(face.normal) >= 0.0:
        raise error(
            "impossible",
            f"a push in that direction does not press on the {face_name} face",
            span=whole_span(asked.contact.spans),
            suggestions=("leave out where to touch it",),
        )
    x, y, z = u.tolist()
    return x, y, z


def _sense(frame: g.Frame) -> Literal["left", "right"] | None:
    if not isinstance(frame.goal, g.Rotate) or frame.goal.sense is None:
        return None
    return "left" if frame.goal.sense == "ccw" else "right"


def _force(frame: g.Frame) -> float | None:
    """The force that a question speaks of; of a limit, the limit."""
    said = [c.value for c in frame.constraints if isinstance(c, g.Force | g.MaxForce | g.MinForce)]
    return said[0] if said else None
