"""The other way to a weight: the object is held, lifted, and weighed by the finger joints' torques.

It is set down again where it stood. What was believed before, perhaps from tilting it, is told
beside what was felt.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import ControlError, ErrorInfo, error, refusal_error
from nlcontrol.learning.lessons import felt_weight, weight_from_grasp
from nlcontrol.questions.answer import Answer
from nlcontrol.text_format import with_sd_text
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.types.actions import SetDown
from planner.types.plan import Plan
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.executor import Progress


def asks_for_lifting(frame: g.Frame) -> bool:
    """Whether a sentence asks for that way."""
    return isinstance(frame.goal, g.Parameters) and frame.goal.method == "lift"


def weigh_by_lifting(
    controller: Controller, name: str, frame: g.Frame, progress: Progress | None
) -> Answer:
    """Lifts an object, weighs it, and sets it down.

    Args:
        controller: of the robot.
        name: of the object in the scene.
        frame: what is asked.
        progress: told what the hand does.

    Raises:
        ControlError: the reason for which it cannot be lifted; `unsupported` if more than its
            weight is asked; `not_explorable` if it was not held.
    """
    plan = _planned(controller, name, frame)
    model = controller.models[name]
    trace = controller.execute(plan, progress)
    felt, found = felt_weight(plan, trace), weight_from_grasp(plan, model, trace)
    if felt is None:
        raise error("not_explorable", f"the {name} was not lifted: {trace.detail}")
    if found is not None:
        controller.models[name] = found[0]
    measured = with_sd_text(felt.mean / GRAVITY, felt.sd / GRAVITY, " kg")
    before = with_sd_text(model.mass, model.mass_sd, " kg")
    after = controller.models[name]
    return Answer(
        query="value",
        text=f"The {name} weighs {measured} in the hand; {before} was believed "
        f"(source: {model.provenance.source}).",
        numbers={
            "mass": felt.mean / GRAVITY,
            "mass_sd": felt.sd / GRAVITY,
            "believed": model.mass,
            "believed_sd": model.mass_sd,
            "mass_now": after.mass,
            "mass_now_sd": after.mass_sd,
        },
    )


def _planned(controller: Controller, name: str, frame: g.Frame) -> Plan:
    """Up, and down again where it stood."""
    goal = frame.goal
    if isinstance(goal, g.Parameters) and not set(goal.which) <= {"mass"}:
        raise ControlError(
            ErrorInfo(
                code="unsupported",
                message="lifting an object tells its weight, and nothing else of it",
                span=goal.spans[0] if goal.spans else None,
                capability="finding out more than the weight by lifting",
                suggestions=("find it out by tilting it",),
            )
        )
    lift = g.Frame(action="lift", object=frame.object, goal=g.Lift(amount="little"))
    made = controller.plan(lift)
    if isinstance(made, Refusal):
        raise ControlError(refusal_error(made))
    assert made.status == "planned", "what is to be lifted is never reached beforehand"
    assert made.grasp is not None, "nothing but a hand lifts"
    if made.grasp.held:
        return made
    actions = (*made.actions, SetDown())
    return made.model_copy(update={"actions": actions, "committed": len(actions)})
