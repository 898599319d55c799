"""Sentences that have the robot find something out by touching.

"Find out how heavy it is" always touches. "How slippery is it?" is answered from the model if the
answer is known well enough, else by touching first; where nothing may move, the model answers. The
experiment that tells most is done next, until what is asked is known.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.errors import ControlError, ErrorInfo, error
from nlcontrol.learning.exploration_session import (
    CENTRE_OF_MASS,
    Exploration,
    explore,
    kinds_for,
    precisions_asked,
)
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.asked_push import target_of
from nlcontrol.session.weighing import asks_for_lifting, weigh_by_lifting
from nlcontrol.text_format import enumeration
from objectmodels.identification.experiment_design import is_precise_enough, parameter_precisions

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.executor import Progress
    from objectmodels import ObjectModel
    from planner.types.world_state import WorldState

BY_TOUCH: dict[str, tuple[str, ...]] = {
    "mass": ("mass",),
    "friction": ("friction",),
    "centre_of_mass": CENTRE_OF_MASS,
}
"""Properties that touching finds out, with their parameters."""

EVERYTHING = ("mass", "friction", "friction_radius", *CENTRE_OF_MASS, "finger_friction")

MOST_REPETITIONS = 6
"""Repetitions after which it is told as it is, however well it is known."""

_KEPT = {"no_topple", "gentle", "slow"}
"""Clauses that every touch keeps."""


def requested_parameters(frame: g.Frame) -> tuple[str, ...]:
    """The parameters that a sentence wants to have found out.

    Raises:
        ControlError: `unsupported` if touching does not tell a property, or a clause is not kept.
    """
    goal = frame.goal
    which = goal.which if isinstance(goal, g.Parameters) else ()
    other = next((name for name in which if name not in BY_TOUCH), None)
    if other is not None:
        what = other.replace("_", " ")
        raise _unsupported(
            frame,
            f"touching an object does not tell its {what}",
            f"finding out the {what} of objects",
            f"ask for it: what is known of the {what} stands in the model",
        )
    clause = next((c for c in frame.constraints if c.kind not in _KEPT), None)
    if clause is not None:
        what = clause.kind.replace("_", " ")
        raise _unsupported(
            frame,
            f"touches that find something out do not keep the clause {what}",
            f"keeping {what} while exploring",
            "leave the clause out: a touch is slow, and lets the object down again",
        )
    named = [parameter for name in which for parameter in BY_TOUCH[name]]
    return tuple(named) or EVERYTHING


def _unsupported(frame: g.Frame, message: str, capability: str, hint: str) -> ControlError:
    spans = frame.goal.spans or frame.spans
    return ControlError(
        ErrorInfo(
            code="unsupported",
            message=message,
            span=(min(s for s, _ in spans), max(e for _, e in spans)) if spans else None,
            capability=capability,
            suggestions=(hint,),
        )
    )


def is_unknown(frame: g.Frame, model: ObjectModel, known: float) -> bool:
    """Whether a question asks for something that touching tells and that is not known well.

    Args:
        frame: the question.
        model: what is believed.
        known: relative standard deviation up to which a value is known well.
    """
    goal = frame.goal
    if frame.query != "value" or not isinstance(goal, g.Parameters) or not goal.which:
        return False
    asked = [name for name in goal.which if name in ("mass", "friction")]
    return any(sd > known for sd in parameter_precisions(model, asked).values())


def explore_parameters(
    controller: Controller, frame: g.Frame, progress: Progress | None
) -> tuple[Exploration | None, Answer]:
    """Touches an object until what a sentence asks is known, and tells it.

    What is known well enough already is told without a touch.

    Args:
        controller: of the robot.
        frame: what is asked, its object resolved.
        progress: told what the hand does.

    Raises:
        ControlError: `unsupported`, `not_on_table`, `not_explorable`.
    """
    if asks_for_lifting(frame):
        return None, weigh_by_lifting(controller, _on_table(controller, frame), frame, progress)
    name, parameters = _on_table(controller, frame), requested_parameters(frame)
    precision, model = controller.defaults.found_to, controller.models[name]
    question = frame.model_copy(update={"query": "value", "action": None, "constraints": ()})
    if is_precise_enough(model, precisions_asked(model, parameters, precision)):
        line = f"known to {precision:.0%} already: nothing was touched"
        return None, controller.answer(question).model_copy(update={"lines": (line,)})
    found = explore(
        controller.executor,
        controller.models,
        name,
        parameters=parameters,
        repetitions=MOST_REPETITIONS,
        precision=precision,
        progress=progress,
    )
    lines = tuple(f"{t.experiment}: {t.outcome}" for t in found.report.touches)
    return found, controller.answer(question).model_copy(update={"lines": lines})


def exploration_notice(controller: Controller, frame: g.Frame, state: WorldState) -> str:
    """What would be done, in a sentence.

    Raises:
        ControlError: as for `find_out`.
    """
    name = _on_table(controller, frame)
    if asks_for_lifting(frame):
        return f"the {name} would be lifted, weighed in the hand and set down again"
    kinds = kinds_for(requested_parameters(frame))
    target = target_of(frame, state)
    share = f"{100.0 * controller.defaults.found_to:.0f} %"
    return (
        f"the {target.name} would be touched ({enumeration(kinds)}) until that is known to {share}"
    )


def _on_table(controller: Controller, frame: g.Frame) -> str:
    """Name of the object in the scene."""
    name = frame.object.id if frame.object else None
    if name is None or name not in controller.cell.names:
        text = name or "object"
        raise error("not_on_table", f"the {text} is not on the table, so that it cannot be touched")
    return name
