"""Questions about what a whole hand does, and about liquid that is spilled; nothing moves for one.

What a hand would do is asked of the planner, whose plan holds the prediction. What a tilt or a push
spills follows from the cavity (`objectmodels.models.object_parts`): what stands above its lip runs
out. A push that topples an object lays it on its side.

Frames: W is the world, B the object. Headings are in W unless they are said to be in B.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.errors import error
from nlcontrol.plan_text import (
    deciding_figures,
    grasp_text,
    plan_reasons,
    predicted_outcomes,
    steps_text,
)
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.push_questions import most_favourable, push_asked_about, target_of
from nlcontrol.text_format import quantity
from planner import plan
from planner.grasping.lid_planner import is_open
from planner.problem.constraint_limits import tilt_goal
from planner.problem.directions import HEADINGS, phrase
from planner.problem.planning_problem import is_handled
from planner.types.plan import Plan
from planner.types.refusal import Refusal, probability_text

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import SeenObject, WorldState


_NOTHING = 1e-6  # less than this is not spilled [m³]


def possible_answer(made: Plan) -> Answer:
    """The answer that a hand can do it, how, and how surely."""
    why = "; ".join((*predicted_outcomes(made), *plan_reasons(made)))
    held = f", held {grasp_text(made.grasp)}" if made.grasp is not None else ""
    return Answer(
        query="possible",
        text=f"Yes: {steps_text(made)}{held} ({why}).",
        numbers=deciding_figures(made),
        probability=made.probability,
        yes=True,
    )


def asks_for_hand(frame: g.Frame) -> bool:
    """True if a question is about what a whole hand does."""
    return is_handled(frame) and frame.goal.kind != "place"


def hand_answer(frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults) -> Answer:
    """The prediction of a hand's plan, or the reason why there is no plan."""
    command = frame.model_copy(update={"query": None, "event": None})
    made = plan(command, state, robot, defaults=defaults)
    if isinstance(made, Refusal):
        no = "No: " if frame.event == "holds" else ""
        return Answer(
            query="predict",
            text=f"{no}{made.message}." if no else f"I would not do it: {made.message}.",
            numbers=made.numbers,
            yes=False if no else None,
            reason=made.reason,
            suggestions=made.suggestions,
        )
    if made.status == "reached":
        return Answer(query="predict", text="Nothing: it is so already.")
    told = "; ".join((*predicted_outcomes(made), *plan_reasons(made)))
    numbers = deciding_figures(made)
    spilled = numbers.get("spilled", 0.0)
    yes, p = None, made.probability
    if frame.event == "spills":
        yes = spilled > _NOTHING
    elif frame.event == "holds":
        p = numbers.get("holds", made.probability)
        yes = p >= 0.5
    start = {None: "", True: "Yes: ", False: "No: "}[yes]
    return Answer(
        query="predict",
        text=f"{start}I would {steps_text(made)}; {told}.",
        numbers=numbers,
        probability=p,
        yes=yes,
    )


def spill_answer(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The volume that a tilt or a push would spill.

    Raises:
        ControlError: `unsupported` if it is no container; as `push_asked_about` for a push.
    """
    target = target_of(frame, state)
    if target.model.vessel is None:
        raise error(
            "unsupported",
            f"the model of the {target.name} does not say that it holds anything",
            span=frame.object.spans[0] if frame.object and frame.object.spans else None,
            capability=f"knowing what is in the {target.name}",
            suggestions=("add a `container` block to its model",),
        )
    if isinstance(frame.goal, g.Tilt):
        angle = frame.goal.angle or tilt_goal(frame.goal, target.model, defaults)[0]
        heading = HEADINGS[frame.goal.direction or "away"]
        found = f"Tilted by {quantity(angle, 'rad')} {phrase(heading)}"
        return _spill_text(target, angle, heading, found, 1.0, defaults)
    push = most_favourable(push_asked_about(frame, state, defaults), "tips", defaults)
    p = push.push_prediction().probability["topple"]
    heading = push.push_in_answer.heading or 0.0
    start = f"Pushed {push.where}"
    if p < 0.5:
        text = (
            f"{start}, the {target.name} would spill nothing: it stays upright (probability "
            f"that it topples {probability_text(p)})."
        )
        return Answer(
            query="predict",
            text=text,
            numbers={"spilled": 0.0, "topple_probability": p},
            probability=p,
            yes=False,
            push=push.push_in_answer,
        )
    fallen = (
        f"{start}, the {target.name} would topple (probability {probability_text(p)}); on its side"
    )
    told = _spill_text(target, math.pi / 2.0, heading, fallen, p, defaults)
    return told.model_copy(update={"push": push.push_in_answer})


def _spill_text(
    target: SeenObject, angle: float, heading: float, start: str, p: float, d: Defaults
) -> Answer:
    """The volume that runs out of an object that leans, in words."""
    vessel, container = target.model.vessel, target.model.container
    assert container is not None
    assert vessel is not None, "it was found to be a container"
    in_B = heading - target.pose.yaw
    has, sd = container.contents, container.contents_sd
    closed = not is_open(target, d)
    brim = float(vessel.brim(min(angle, 0.999 * math.pi), in_B))
    cases = np.clip(np.array([has, has - sd, has + sd]), 0.0, vessel.capacity)
    lost, least, most = np.maximum(cases - brim, 0.0) * (not closed)
    begins = float(vessel.spill_angle(has, in_B)) if has > 0.0 else math.pi
    numbers = {"spilled": float(lost), "contents": has, "brim": brim, "spill_angle": begins}
    spread = f" ± {quantity(0.5 * float(most - least), 'm³')}" if most > least else ""
    if closed:
        why = "its lid is closed"
    elif has <= 0.0:
        why = "it is empty"
    else:
        why = f"it begins to run out at {quantity(begins, 'rad')}"
    what = f"{quantity(float(lost), 'm³')}{spread} of its {quantity(has, 'm³')}"
    spilled = lost > _NOTHING
    would = "it" if target.name in start else f"the {target.name}"
    return Answer(
        query="predict",
        text=f"{start}, {would} would spill {what if spilled else 'nothing'}: {why}.",
        numbers=numbers,
        probability=p,
        yes=bool(spilled),
    )
