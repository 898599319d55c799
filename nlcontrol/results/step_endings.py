"""Ends of steps: the result with one more of them, its status, and what a stop has left."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nlcontrol.errors import INTERNAL, NOT_UNDERSTOOD, ErrorInfo
from nlcontrol.results.result import Result, ResultStatus, Step, result_with

if TYPE_CHECKING:
    from planner.types.world_state import Held
    from sim.traces.trace import Trace


def result_with_step(
    result: Result, step: Step, status: ResultStatus, reason: ErrorInfo | None = None
) -> Result:
    """The result with the end of one more step."""
    step = step.model_copy(update={"status": status, "error": reason})
    return result_with(
        result, ok=reason is None, status=status, error=reason, steps=(*result.steps, step)
    )


def status_of(info: ErrorInfo) -> ResultStatus:
    """Status of a sentence that is not even planned."""
    return "failed" if info.status.exit == INTERNAL else "not_understood"


def stop_info(held: Held | None, trace: Trace | None) -> ErrorInfo:
    """The way in which a stop has left the robot."""
    told = "it was told to stop before anything moved" if trace is None else trace.detail
    left = "the hand is empty and at rest"
    if held is not None:
        left = f"the hand holds the {held.name} and stands still"
    hint = "say it again" if held is None else "say “put it down”"
    return ErrorInfo(code="interrupted", message=f"{told}; {left}", suggestions=(hint,))


def unanswered_status(info: ErrorInfo) -> ResultStatus:
    """Status of a question without an answer, or of a frame that got no further."""
    if info.code in ("unsupported", "uncheckable"):
        return "unsupported"
    if info.status.exit == INTERNAL:
        return "failed"
    return "not_understood" if info.status.exit == NOT_UNDERSTOOD else "refused"
