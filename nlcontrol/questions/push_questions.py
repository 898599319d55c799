"""Questions how hard and where to push: the force of an event, the places where it comes first.

Model: slow pushes, so what comes first at the onset decides. A force is told with its standard
deviation; `force_low` and `force_high` hold 95 % of it. Places are those of the outcome map of the
face, pushed straight in by a finger that does not turn the object or, for turning it, by one that
may. Heights are above the table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import TYPE_CHECKING, Literal

import numpy as np

from grammar.frames import command as g
from nlcontrol.errors import ControlError, error, refusal_error, whole_span
from nlcontrol.questions.answer import DOES, Answer, Chart, Considered, force_text
from nlcontrol.questions.push_prediction import (
    CERTAIN,
    PushPrediction,
    in_turn,
    needed_force,
    predict_push,
    threshold,
)
from nlcontrol.text_format import aside_text, quantity
from objectmodels.mechanics.outcome_map import OutcomeMap, outcome_map
from planner.affordances import SPACING, least, pushed_face, turning_map
from planner.problem.directions import FACE_HEADINGS, HEADINGS, heading_of, unit
from planner.problem.frame_interpretation import interpret_frame, why_not_resting
from planner.refusals.blocked import Blocked, dead_end
from planner.types.refusal import probability_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from objectmodels import Face
    from planner.problem.planning_problem import PushProblem
    from planner.types.actions import FaceName
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState


# The push that a question speaks of: which face, where on it, which way and how hard.
#
# It is read as the planner reads a command. What the question leaves open: the way is away from
# the robot, the height the middle of what is allowed, the force that of the onset. Frames:
# contacts and directions are in B, heights above the table.


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


def _unanswered(why: Blocked) -> ControlError:
    return ControlError(refusal_error(why.refusal))


def push_asked_about(frame: g.Frame, state: WorldState, defaults: Defaults) -> Inquiry:
    """The push of a question.

    Raises:
        ControlError: the planner's reason if it cannot be read as a push, or there is no such place
            on the object.
    """
    target = target_of(frame, state)
    asked = interpret_frame(_as_command(frame), state, defaults)
    if isinstance(asked, Blocked):
        raise _unanswered(asked)
    if why := why_not_resting(target):
        raise _unanswered(why)
    # The heading of the push if it is not straight in: what falls is pushed square to its face.
    by_default = any(used.name == "direction" for used in asked.defaults_used)
    square = by_default or asked.goal.outcome == "topple"
    heading = None if square else asked.goal.heading
    said, spans = asked.contact.face, asked.contact.spans
    if said == "top":
        raise _unanswered(dead_end("not_capable.press", spans=spans))
    if said is not None:
        into = FACE_HEADINGS[said] + math.pi
    else:
        into = HEADINGS["away"] if asked.goal.heading is None else asked.goal.heading
    found = pushed_face(target, into)
    if found is None or said not in (None, found[0]):
        where = "side" if said is None else f"{said} face"
        raise _unanswered(dead_end("no_side", spans=spans, object=target.name, where=where))
    face_name, face = found
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


_MAKE = {"moves": "move", "slides": "slide", "tips": "topple", "tilts": "tilt", "turns": "turn"}


def figures(found: PushPrediction) -> dict[str, float]:
    """The numbers of a prediction that exist."""
    told = {
        "height": found.push.height,
        "lateral": found.push.lateral,
        "given_force": found.push.force,
        "onset": found.onset,
        "slide": found.slide,
        "slide_sd": found.slide_sd,
        "topple": found.topple,
        "topple_sd": found.topple_sd,
    }
    return {name: value for name, value in told.items() if value is not None}


def how_hard(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The force at which an event begins, or up to which the object stays as it is."""
    event, kept = wanted_event(frame), {clause.kind for clause in frame.constraints}
    push = replace(push_asked_about(frame, state, defaults), force=None)
    if frame.event is None and "no_slide" in kept:
        return _up_to(push, ("slide", "topple"), defaults)
    if event == "stays_upright" or (frame.event is None and kept & {"no_topple", "no_tilt"}):
        return _without_toppling(push, defaults)
    return _needed_force(most_favourable(push, event, defaults), event)


def _needed_force(push: Inquiry, event: g.Event) -> Answer:
    """The least force that makes the event happen, or that something else comes first."""
    found = push.push_prediction()
    first, other = in_turn(found)
    outcome = first if event == "moves" else outcome_of(event)
    p, name = found.probability[outcome], push.target.name
    does = DOES[outcome if event == "moves" else event]
    likely = f"(probability that it {does} {probability_text(p)})"
    value, sd = needed_force(found, outcome)
    if outcome != first or value is None:
        never = "never" if value is None else "not"
        before = "" if value is None else f", before the {force_text(value, sd)} that would do it"
        pushed = "Even pushed" if not push.placed else "Pushed"
        text = (
            f"{pushed} {push.where}, the {name} would {never} {_MAKE[event]}: it "
            f"{threshold(found, first, force_text)}{before} {likely}."
        )
        return _force_answer(push, text, figures(found), p, yes=False)
    text = (
        f"It takes {force_text(value, sd)} to {_verb(event, name)}, pushed {push.where}: "
        f"it then {DOES[first]}{' and turns' if event == 'turns' else ''} and "
        f"{threshold(found, other, force_text, only=True)} {likely}."
    )
    return _force_answer(push, text, figures(found) | _range(value, sd), p, yes=True)


def _force_answer(
    push: Inquiry,
    text: str,
    numbers: dict[str, float],
    probability: float,
    *,
    yes: bool | None = None,
) -> Answer:
    return Answer(
        query="how_hard",
        text=text,
        numbers=numbers,
        probability=probability,
        yes=yes,
        push=push.push_in_answer,
    )


def _verb(event: g.Event, name: str) -> str:
    verb = _MAKE[event]
    return f"make the {name} slide" if verb == "slide" else f"{verb} the {name}"


def _range(value: float, sd: float | None) -> dict[str, float]:
    if sd is None:
        return {"force": value}
    low, high = max(value - CERTAIN * sd, 0.0), value + CERTAIN * sd
    return {"force": value, "force_sd": sd, "force_low": low, "force_high": high}


def _without_toppling(push: Inquiry, defaults: Defaults) -> Answer:
    """Up to which force it stays upright; however hard it is pushed, if it is sure to slide."""
    found = push.push_prediction()
    p = found.probability["topple"]
    if p > 1.0 - defaults.probability:
        return _up_to(push, ("topple",), defaults)
    slides = threshold(found, "slide", force_text)
    topples = threshold(found, "topple", force_text, only=True)
    text = (
        f"Pushed slowly {push.where}, the {push.target.name} does not topple however hard it is "
        f"pushed: it {slides} and {topples} (probability that it topples {probability_text(p)})."
    )
    return _force_answer(push, text, figures(found), 1.0 - p)


def _up_to(push: Inquiry, outcomes: tuple[str, ...], defaults: Defaults) -> Answer:
    """The force up to which outcomes are as improbable as a plan must have them."""
    found, sigmas = push.push_prediction(), NormalDist().inv_cdf(defaults.probability)
    thresholds = [needed_force(found, outcome) for outcome in outcomes]
    sure = [force - sigmas * (sd or 0.0) for force, sd in thresholds if force is not None]
    most = max(min(sure, default=0.0), 0.0)
    at_most = replace(push, force=most).push_prediction().probability
    p = 1.0 - sum(at_most[outcome] for outcome in outcomes)
    stays = "stays upright" if outcomes == ("topple",) else "stays where it is"
    first, other = in_turn(found)
    text = (
        f"With up to {force_text(most)} the {push.target.name}, pushed {push.where}, {stays} "
        f"(probability {probability_text(p)}): it {threshold(found, first, force_text)} and "
        f"{threshold(found, other, force_text, only=True)}."
    )
    return _force_answer(push, text, figures(found) | {"force": most}, p)


@dataclass(frozen=True)
class Places:
    """Places of a face where an event comes; arrays over the contacts of an outcome map.

    Attributes:
        chart: the map; undecided are places where no outcome is sure.
        first: whether the event comes first.
        sure: whether it does so with the probability that was asked for.
        likely: its probability.
    """

    chart: OutcomeMap
    first: NDArray[np.bool_]
    sure: NDArray[np.bool_]
    likely: NDArray[np.float64]


def where_answer(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The places of a face where an event is sure, with the map that shows them."""
    event, push = wanted_event(frame), push_asked_about(frame, state, defaults)
    found = event_places(push, event, defaults.probability)
    middle, normals = push.face.points_at([0.0], [push.height])
    height = push.target.model.cone_thresholds(middle, normals, yaw=False).critical_height[0]
    numbers = {"probability": defaults.probability} | (
        {"critical_height": float(height)} if np.isfinite(height) else {}
    )
    if found.sure.any():
        heights = found.chart.height[found.sure]
        numbers |= {"lowest": float(heights.min()), "highest": float(heights.max())}
    return Answer(
        query="where",
        text=_places_text(push, event, found, numbers),
        numbers=numbers,
        probability=float(found.likely.max(initial=0.0)),
        yes=bool(found.sure.any()),
        push=push.push_in_answer.model_copy(update={"height": None}),
        chart=Chart(object=push.target.name, face=push.face_name),
        map=found.chart,
    )


def event_places(push: Inquiry, event: g.Event, probability: float) -> Places:
    """Places where an event comes first, and where it does so with a probability or more."""
    if event == "turns":
        chart, turns = turning_map(push.target, push.face, push.sense)
    else:
        chart = outcome_map(
            push.target.model, push.face, spacing=SPACING, level=probability, turning=False
        )
        turns = np.ones(len(chart.height), dtype=bool)
    allowed = (chart.height >= push.low - 1e-9) & (chart.height <= push.high + 1e-9)
    outcome = outcome_of(event)
    first = chart.topple < chart.slide if outcome == "topple" else chart.slide < chart.topple
    return Places(
        chart=chart,
        first=first & turns & allowed,
        sure=chart.is_safe(outcome, probability) & first & turns & allowed,
        likely=np.where(turns & allowed, getattr(chart.likelihood, outcome), 0.0),
    )


def most_favourable(push: Inquiry, event: g.Event, defaults: Defaults) -> Inquiry:
    """The same push where the event takes the least force, if the question leaves the place open.

    A question that says what is to happen, and not where, means a place that lets it happen: one
    where it is sure, else where it comes first, else where it is most probable.
    """
    if push.placed or event in ("moves", "stays_upright"):
        return push
    found = event_places(push, event, defaults.probability)
    best = least(found.chart, found.sure)
    if best is None:
        best = least(found.chart, found.first)
    if best is None:
        aside = np.abs(found.chart.lateral).round(6)
        best = int(np.lexsort((aside, -found.likely.round(4)))[0])
    chart = found.chart
    return replace(push, lateral=float(chart.lateral[best]), height=float(chart.height[best]))


def _places_text(push: Inquiry, event: g.Event, found: Places, numbers: dict[str, float]) -> str:
    name, level = push.target.name, f"{numbers['probability']:g}"
    does = "slides and stays upright" if event == "moves" else DOES[event]
    flip = _flipping(event, numbers.get("critical_height"))
    if not found.sure.any():
        return (
            f"Nowhere on its {push.face_name} face is it sure that the {name} {does} (no place "
            f"has probability {level}): {flip}."
        )
    low, high = quantity(numbers["lowest"], "m"), quantity(numbers["highest"], "m")
    return (
        f"On its {push.face_name} face, {low} to {high} above the table{_aside(event, found)}: "
        f"pushed there the {name} {does} with probability {level} or more; {flip}."
    )


def _flipping(event: g.Event, height: float | None) -> str:
    if height is None:
        return "it slides before it topples all over that face"
    if outcome_of(event) == "topple":
        return f"below {quantity(height, 'm')} it slides before it topples"
    return f"above {quantity(height, 'm')} it topples before it slides"


def _aside(event: g.Event, found: Places) -> str:
    """Least way off the middle at which a push turns the object, in words."""
    if event != "turns":
        return ""
    lateral = found.chart.lateral[found.sure]
    side = "the right" if lateral[0] > 0.0 else "the left"
    if np.ptp(np.sign(lateral)) > 0.0:
        side = "either side"
    return f", at least {quantity(float(np.abs(lateral).min()), 'm')} to {side} of its middle"
