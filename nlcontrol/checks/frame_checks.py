"""Did it happen as it was said? One check per clause, from the frame and the trace alone.

The checker knows nothing of the plan. Besides frame and trace it takes the believed shapes of the
objects where a clause is about them (the upper third of a height, a gap between surfaces), the
extent of the table, and the table of defaults for what a clause means when the sentence says no
more. What a place or a displacement means it shares with the planner
(`planner.problem.places`, `planner.problem.goal_poses`): a word has one meaning.

A clause without a check is an error, raised before anything is executed: no sentence is called
satisfied because a part of it was skipped.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.checks.constraint_checks import CONSTRAINTS, others
from nlcontrol.checks.goal_checks import GOALS
from nlcontrol.checks.verdicts import HAND_ENDS, PLANNED_ENDS, Check, Evidence, object_name
from nlcontrol.errors import ErrorInfo, error, whole_span
from planner.types.defaults import DEFAULTS, Defaults

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from planner.types.world_state import TableState
    from sim.traces.trace import Trace

_OF_PUSHES = frozenset(
    {
        "contact",
        "effector",
        "hard",
        "gentle",
        "fast",
        "slow",
        "force",
        "min_force",
        "max_force",
        "speed",
        "min_speed",
        "max_speed",
        "duration",
        "max_duration",
    }
)
"""Constraints on pushes, which say nothing where no push is needed."""


def check(
    frame: g.Frame,
    trace: Trace,
    models: Mapping[str, ObjectModel],
    table: TableState,
    *,
    defaults: Defaults = DEFAULTS,
    unsure: frozenset[str] = frozenset(),
    unseen: frozenset[str] = frozenset(),
) -> tuple[Check, ...]:
    """Checks every clause of a frame, and that nothing else was touched.

    Args:
        frame: what was asked, its objects resolved.
        trace: what happened, by one account of it.
        models: the believed models of the objects by name, for their shapes; that of the frame's
            object and of those that it speaks of must be there.
        table: extent of the table top.
        defaults: what a clause means when the sentence does not say more.
        unsure: objects that, by this account, may have been touched without being moved.
        unseen: objects that it does not know of in the end.

    Raises:
        ControlError: `uncheckable` if a clause has no check.
    """
    require_checkable(frame)
    e = Evidence.of(frame, trace, models, table, defaults, unsure=unsure, unseen=unseen)
    checks = list(GOALS[frame.goal.kind](frame.goal, e))
    for clause in frame.constraints:
        if trace.end == "reached" and clause.kind in _OF_PUSHES:
            checks.append(object_name(clause, "push", "none needed", "none needed"))
        else:
            checks += CONSTRAINTS[clause.kind](clause, e)
    return (*checks, *others(e))


def not_held(missed: Sequence[Check], trace: Trace, stuck: str | None = None) -> ErrorInfo:
    """The error of an execution in which some checks failed, or that was not finished.

    `stuck` is the reason why no further push was made, if that is the matter.
    """
    clauses = ", ".join(dict.fromkeys(map(_told, missed)))
    message = f"executed, but this did not hold: {clauses}" if missed else "it was not finished"
    if trace.end not in PLANNED_ENDS:
        what = "the hand stopped" if trace.end in HAND_ENDS else "the push ended early"
        message += f" ({what}: {trace.detail})"
    if stuck is not None:
        message += f" (nothing more was done: {stuck})"
    spans = missed[0].spans if missed else ()
    return error(
        "clause_not_held" if missed else "not_finished",
        message,
        span=spans[0] if spans else None,
        suggestions=("say it again: it is planned anew, with what was learned",),
    ).info


def not_told(unknown: Sequence[Check]) -> ErrorInfo:
    """The error of an execution of which some clauses can be neither confirmed nor denied."""
    clauses = ", ".join(dict.fromkeys(_told(c) for c in unknown))
    message = f"executed, but this can be neither confirmed nor denied: {clauses}"
    spans = unknown[0].spans
    hint = "look at it: what was measured is within its uncertainty of what was asked"
    if any(c.why == "not_perceived" for c in unknown):
        hint = "look at it: the robot could not perceive that"
    return error(
        "clause_unknown", message, span=spans[0] if spans else None, suggestions=(hint,)
    ).info


def _told(check: Check) -> str:
    """A clause by the name of its kind."""
    return {"others": "touching nothing else"}.get(check.clause, check.clause.replace("_", " "))


def require_checkable(frame: g.Frame) -> None:
    """Refuses a frame with a clause that could not be checked afterwards.

    Raises:
        ControlError: `uncheckable`, with the words of the clause.
    """
    goal = frame.goal
    if goal.kind not in GOALS:
        raise _uncheckable(goal.kind, goal.spans)
    for clause in frame.constraints:
        if clause.kind not in CONSTRAINTS:
            raise _uncheckable(clause.kind, clause.spans)


def _uncheckable(what: str, spans: g.Spans) -> Exception:
    return error(
        "uncheckable",
        f"this version cannot check '{what.replace('_', ' ')}' after the execution, "
        "so it does not execute it",
        span=whole_span(spans),
        suggestions=("leave that out",),
    )
