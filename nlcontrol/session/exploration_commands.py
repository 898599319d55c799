"""Sentences that have the robot find something out, by touching or by lifting.

"Find out how heavy it is" touches. "How slippery is it?" is answered from the model; if that does
not know it well, the answer says what a touch would improve, or, where a question may move the
robot, the touch comes first. The experiment that tells most is done next, until what is asked is
known.

The other way to a weight: the object is held, lifted, weighed by the finger joints' torques and set
down where it stood. What was believed before, perhaps from tilting it, stands beside what was felt.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import grammar
from grammar.frames import command as g
from nlcontrol.errors import ControlError, error, refusal_error, whole_span
from nlcontrol.learning.exploration_session import (
    CENTRE_OF_MASS,
    Exploration,
    expected_belief,
    explore,
    kinds_for,
    precisions_asked,
)
from nlcontrol.learning.lessons import SPREAD, felt_weight, weight_from_grasp
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.push_questions import target_of
from nlcontrol.results.result import (
    Result,
    Step,
    result_with,
    result_with_step,
    stop_info,
    unanswered_status,
)
from nlcontrol.text_format import join_words, with_sd_text
from objectmodels.identification.experiment_design import (
    Candidate,
    is_precise_enough,
    parameter_precisions,
    rank_candidates,
)
from objectmodels.mechanics.push_thresholds import GRAVITY
from planner.plan_explanation import Basis
from planner.touch_experiments import expected_trials, experiments
from planner.types.actions import SetDown
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from sim.supervision import Progress, Stopped

if TYPE_CHECKING:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.events import Supervisor
    from objectmodels import ObjectModel
    from planner.types.robot import RobotLimits
    from planner.types.world_state import WorldState


BY_TOUCH: dict[str, tuple[str, ...]] = {
    "mass": ("mass",),
    "friction": ("friction",),
    "centre_of_mass": CENTRE_OF_MASS,
}
"""Properties that touching finds out, with their parameters."""

EVERYTHING = ("mass", "friction", "friction_radius", *CENTRE_OF_MASS, "finger_friction")


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
        raise _unsupported_error(
            frame,
            f"touching an object does not tell its {what}",
            f"finding out the {what} of objects",
            f"ask for it: what is known of the {what} stands in the model",
        )
    # Clauses that every touch keeps.
    clause = next(
        (c for c in frame.constraints if c.kind not in {"no_topple", "gentle", "slow"}), None
    )
    if clause is not None:
        what = clause.kind.replace("_", " ")
        raise _unsupported_error(
            frame,
            f"touches that find something out do not keep the clause {what}",
            f"keeping {what} while exploring",
            "leave the clause out: a touch is slow, and lets the object down again",
        )
    named = [parameter for name in which for parameter in BY_TOUCH[name]]
    return tuple(named) or EVERYTHING


def _unsupported_error(frame: g.Frame, message: str, capability: str, hint: str) -> ControlError:
    span = whole_span(frame.goal.spans or frame.spans)
    return error("unsupported", message, span=span, capability=capability, suggestions=(hint,))


def is_unknown(frame: g.Frame, model: ObjectModel, known: float) -> bool:
    """True if a question asks for something that touching tells and that is not known well.

    A value is known well up to the relative standard deviation `known`.
    """
    goal = frame.goal
    if frame.query != "value" or not isinstance(goal, g.Parameters) or not goal.which:
        return False
    return any(sd > known for sd in parameter_precisions(model, _asked(goal)).values())


def _asked(goal: g.Parameters) -> list[str]:
    """Parameters in a question that touching tells."""
    return [name for name in goal.which if name in ("mass", "friction")]


def answer_with_offer(
    answer: Answer, frame: g.Frame, state: WorldState, limits: RobotLimits
) -> Answer:
    """The answer to a question for something not known well, with what one touch would improve."""
    goal, target = frame.goal, target_of(frame, state)
    assert isinstance(goal, g.Parameters), "no other question asks for a value"
    asked, kinds = _asked(goal), kinds_for(_asked(goal))
    candidates = [
        Candidate(touch.name, expected_trials(touch, target.model))
        for touch in experiments(target, limits)
        if touch.kind in kinds
    ]
    if not candidates:
        return answer
    best = rank_candidates(target.model, candidates, asked, spread=SPREAD)[0]
    better = join_words([f"its {name} to ± {sd:.0%}" for name, sd in best.precisions.items()])
    known = {
        f"{name}_after_sd": getattr(target.model, name) * sd for name, sd in best.precisions.items()
    }
    command = grammar.paraphrase(frame.model_copy(update={"query": None, "action": "explore"}))
    return answer.model_copy(
        update={
            "lines": (*answer.lines, f"one touch ({best.candidate.name}) would tell {better}"),
            "numbers": answer.numbers | known,
            "suggestions": (*answer.suggestions, f"say “{command}”: that touches it"),
        }
    )


def explore_parameters(
    controller: Controller, frame: g.Frame, progress: Progress | None
) -> tuple[Exploration | None, Answer]:
    """Touches an object until what a sentence asks is known, and tells it.

    What is known well enough already is told without a touch.

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
    # After six repetitions it is told as it is, however well it is known.
    found = explore(
        controller.executor,
        controller.models,
        name,
        parameters=parameters,
        repetitions=6,
        precision=precision,
        progress=progress,
    )
    lines = tuple(f"{t.experiment}: {t.outcome}" for t in found.report.touches)
    return found, controller.answer(question).model_copy(update={"lines": lines})


def explore_frame(
    controller: Controller,
    index: int,
    frame: g.Frame,
    result: Result,
    plan_only: bool,
    supervisor: Supervisor,
) -> Result:
    """The result with what touching the object found out."""
    step = Step(frame=index, status="failed")
    try:
        state = controller.believed_state(frame)
        step = step.model_copy(update={"basis": Basis.of(frame, state, controller.defaults)})
        if plan_only:
            notes = (*result.notes, exploration_notice(controller, frame, state))
            return result_with_step(result_with(result, notes=notes), step, "planned")
        found, answer = explore_parameters(controller, frame, supervisor)
    except Stopped as stopped:
        result = result_with(result, trace=stopped.trace)
        return result_with_step(
            result, step, "cancelled", stop_info(controller.held, stopped.trace)
        )
    except ControlError as raised:
        return result_with_step(result, step, unanswered_status(raised.info), raised.info)
    step = step.model_copy(update={"exploration": found and found.report, "answer": answer})
    result = result_with(result, answer=answer, trace=found and found.trace)
    return result_with_step(result, step, "done" if frame.query is None else "answered")


def exploration_notice(controller: Controller, frame: g.Frame, state: WorldState) -> str:
    """The touches that would be made, in a sentence.

    Raises:
        ControlError: as for `explore_parameters`.
    """
    name = _on_table(controller, frame)
    if asks_for_lifting(frame):
        return f"the {name} would be lifted, weighed in the hand and set down again"
    kinds = kinds_for(requested_parameters(frame))
    target = target_of(frame, state)
    share = f"{100.0 * controller.defaults.found_to:.0f} %"
    return (
        f"the {target.name} would be touched ({join_words(kinds)}) until that is known to {share}"
    )


def state_once_explored(controller: Controller, frame: g.Frame, state: WorldState) -> WorldState:
    """The belief when that is found out for which a sentence touches or lifts an object.

    Raises:
        ControlError: as for `explore_parameters`.
    """
    name = _on_table(controller, frame)
    found = ("mass",) if asks_for_lifting(frame) else requested_parameters(frame)
    seen = state.objects[name]
    known = expected_belief(seen.model, found, controller.defaults.found_to)
    return replace(state, objects={**state.objects, name: replace(seen, model=known)})


def _on_table(controller: Controller, frame: g.Frame) -> str:
    """Name of the object in the scene."""
    name = frame.object.id if frame.object else None
    if name is None or name not in controller.executor.cell.names:
        text = name or "object"
        raise error(
            "not_on_table",
            f"the {text} is not on the table, so that it cannot be touched",
            suggestions=(f"on the table: {', '.join(controller.executor.cell.names)}",),
        )
    return name


def asks_for_lifting(frame: g.Frame) -> bool:
    """A sentence asks for a weight by lifting."""
    return isinstance(frame.goal, g.Parameters) and frame.goal.method == "lift"


def weigh_by_lifting(
    controller: Controller, name: str, frame: g.Frame, progress: Progress | None
) -> Answer:
    """Lifts an object, weighs it, and sets it down.

    Raises:
        ControlError: the reason for which it cannot be lifted; `unsupported` if more than its
            weight is asked; `not_explorable` if it was not held.
    """
    plan = _lift_and_return(controller, name, frame)
    model = controller.models[name]
    trace = controller.execute(plan, progress)
    if trace.end == "stopped":
        raise Stopped(trace)
    felt, found = felt_weight(plan, trace), weight_from_grasp(plan, model, trace)
    if felt is None:
        raise error(
            "not_explorable",
            f"the {name} was not lifted: {trace.detail}",
            suggestions=("find its weight out by tilting it",),
        )
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


def _lift_and_return(controller: Controller, name: str, frame: g.Frame) -> Plan:
    """Up, and down again where it stood."""
    goal = frame.goal
    if isinstance(goal, g.Parameters) and not set(goal.which) <= {"mass"}:
        raise error(
            "unsupported",
            "lifting an object tells its weight, and nothing else of it",
            span=goal.spans[0] if goal.spans else None,
            capability="finding out more than the weight by lifting",
            suggestions=("find it out by tilting it",),
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
