"""Which words became which parameters of the hand: the rows of `push_explanation` for its plans."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from grammar.frames import command as g
from planner.explanation.push_explanation import belief_values
from planner.explanation.rows import (
    Clause,
    Row,
    Value,
    amount_value,
    clause_text,
    object_name,
    outcome_value,
    place_text,
    plan_rows,
    si_text,
)
from planner.types.actions import Carry, FlipOver, LiftUp, PourOut, TurnCap
from planner.types.plan import Plan
from planner.types.turning_actions import TurnOver

if TYPE_CHECKING:
    from planner.explanation.push_explanation import Basis
    from planner.types.plan import DefaultUsed


def explain_hand(frame: g.Frame, plan: Plan, text: str, basis: Basis) -> tuple[Row, ...]:
    """The rows of a frame of a sentence that a whole hand carries out, from its plan."""

    def values(clause: Clause) -> Iterable[Value]:
        match clause.part:
            case "hand controller":
                return _controller(plan)
            case "object model":
                return belief_values(basis.target)
            case "wanted outcome":
                return _outcome(plan)
            case "left open":
                return _open_values(plan)
        return _constraint(clause.said, plan)

    return plan_rows(frame, text, "hand controller", values)


def _controller(plan: Plan) -> Iterator[Value]:
    steps = ", ".join(step.kind.replace("_", " ") for step in plan.steps)
    grasp = plan.grasp
    if grasp is None:
        yield Value("controller", f"with a fingertip: {steps}")
        return
    yield Value("controller", f"with the whole hand: {steps}")
    part = "its lid " if grasp.part == "lid" else ""
    yield Value(
        "grasp", f"{part}{grasp.approach_text}, {si_text(grasp.p_BG[2], 'm')} above its base"
    )
    least, most = f"{grasp.needed:.1f} N just hold", f"the fingers have {grasp.strongest:.1f} N"
    yield Value("squeeze", f"{grasp.squeeze:.1f} N; {least}, {most}")


def _outcome(plan: Plan) -> Iterator[Value]:
    yield outcome_value(plan.task, plan)

    def from_table(prefix: str) -> DefaultUsed | None:
        return next((each for each in plan.defaults if each.name.startswith(prefix)), None)

    for step in plan.steps:
        match step:
            case LiftUp() if plan.task == "lift":
                yield amount_value("height", si_text(step.height, "m"), from_table("lift_"))
            case TurnOver():
                yield Value("turned over", si_text(step.angle, "rad"))
            case PourOut():
                volume = "everything" if step.volume is None else si_text(step.volume, "m³")
                yield amount_value("volume", volume, from_table("pour_"))
                yield Value("tilt", f"up to {si_text(step.angle, 'rad')}")
            case FlipOver():
                yield Value("lid", f"{si_text(step.start, 'rad')} to {si_text(step.end, 'rad')}")
            case TurnCap():
                yield Value("turn", si_text(abs(step.angle), "rad"))
            case Carry():
                yield Value("aim", place_text(step.to.x, step.to.y))


def _constraint(clause: Any, plan: Plan) -> Iterator[Value]:
    match clause:
        case g.NoTouch():
            other = object_name(clause.object) if clause.object else "everything"
            kept = dict(plan.limits.clear_of)
            apart = max(kept.values(), default=0.0)
            yield Value("free way", f"{si_text(apart, 'm')} or more from the {other}")
        case g.NoSpill() if pours := [a for a in plan.actions if isinstance(a, PourOut)]:
            yield Value("spilled", f"{si_text(pours[0].prediction.spilled, 'm³')} foreseen")
        case g.Gentle() | g.Slow() | g.MaxSpeed() | g.Speed() | g.MinSpeed() if (
            plan.speed is not None
        ):
            yield Value("largest speed", si_text(plan.speed, "m/s"))
        case g.MaxForce() | g.Force() if plan.grasp is not None:
            yield Value("squeeze", f"{plan.grasp.squeeze:.1f} N")
        case g.ContactRegion() if plan.grasp is not None:
            yield Value("grasp", f"{si_text(plan.grasp.p_BG[2], 'm')} above its base")
        case _:
            yield Value("kept", clause_text(clause))


def _open_values(plan: Plan) -> Iterator[Value]:
    """Values that no clause of the sentence decided."""
    if plan.speed and any(used.name == "carry_speed" for used in plan.defaults):
        speed = si_text(plan.speed, "m/s")
        yield Value("largest speed", f"{speed} (not said: by default)", default=True, said=False)
