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
    clause_text,
    frame_clauses,
    object_name,
    row,
    si_text,
)
from planner.types.actions import Carry, FlipOver, LiftUp, PourOut, TurnCap
from planner.types.plan import Plan

if TYPE_CHECKING:
    from planner.explanation.push_explanation import Basis
    from planner.types.plan import DefaultUsed


def explain_hand(frame: g.Frame, plan: Plan, text: str, basis: Basis) -> tuple[Row, ...]:
    """The rows of a frame that a whole hand carries out.

    Args:
        frame: what was asked.
        plan: what came of it.
        text: the sentence.
        basis: what was known when it was planned.
    """
    rows: list[Row] = []
    for clause in frame_clauses(frame, "hand controller"):
        values: Iterable[Value]
        if clause.part == "hand controller":
            values = _controller(plan)
        elif clause.part == "object model":
            values = belief_values(basis.target)
        elif clause.part == "wanted outcome":
            values = _outcome(plan)
        else:
            values = _constraint(clause.said, plan)
        rows += [row(clause, text, value) for value in values]
    rest = Clause("left open", "controller", (), None)
    return (*rows, *(row(rest, text, value) for value in _rest(plan)))


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
    likely = "over 0.999" if plan.probability > 0.999 else f"{plan.probability:.3f}"
    yield Value("outcome", f"{plan.task}, probability {likely}")
    used = {default.name: default for default in plan.defaults}
    for step in plan.steps:
        match step:
            case LiftUp() if plan.task == "lift":
                named_by = next((u for n, u in used.items() if n.startswith("lift_")), None)
                yield _amount("height", si_text(step.height, "m"), named_by)
            case PourOut():
                named_by = next((u for n, u in used.items() if n.startswith("pour_")), None)
                volume = "everything" if step.volume is None else _ml(step.volume)
                yield _amount("volume", volume, named_by)
                yield Value("tilt", f"up to {si_text(step.angle, 'rad')}")
            case FlipOver():
                yield Value("lid", f"{si_text(step.start, 'rad')} to {si_text(step.end, 'rad')}")
            case TurnCap():
                yield Value("turn", si_text(abs(step.angle), "rad"))
            case Carry():
                yield Value("aim", f"x {si_text(step.to.x, 'm')}, y {si_text(step.to.y, 'm')}")


def _ml(volume: float) -> str:
    return f"{1e6 * volume:.0f} ml"


def _amount(name: str, told: str, used: DefaultUsed | None) -> Value:
    """A number, and whether it comes from the table of defaults."""
    if used is None:
        return Value(name, told)
    in_words = used.reason.startswith("“")
    why = f"{used.reason}, from the table of defaults" if in_words else "not said: by default"
    return Value(name, f"{told} ({why})", default=True, said=in_words)


def _constraint(clause: Any, plan: Plan) -> Iterator[Value]:
    match clause:
        case g.NoTouch():
            other = object_name(clause.object) if clause.object else "everything"
            kept = dict(plan.limits.clear_of)
            apart = max(kept.values(), default=0.0)
            yield Value("free way", f"{si_text(apart, 'm')} or more from the {other}")
        case g.NoSpill() if pours := [a for a in plan.actions if isinstance(a, PourOut)]:
            yield Value("spilled", f"{_ml(pours[0].prediction.spilled)} foreseen")
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


def _rest(plan: Plan) -> Iterator[Value]:
    """What no clause of the sentence decided."""
    if plan.speed and any(used.name == "carry_speed" for used in plan.defaults):
        speed = si_text(plan.speed, "m/s")
        yield Value("largest speed", f"{speed} (not said: by default)", default=True, said=False)
