"""A run repeated from its bundle: the same to the digit, or what came out otherwise."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain
from typing import TYPE_CHECKING

from nlcontrol.errors import ErrorInfo, error
from nlcontrol.installed_versions import installed_versions, platform_name
from nlcontrol.json_document import Document
from nlcontrol.service.bundles.run_comparison import (
    Difference,
    result_differences,
    trace_differences,
    version_differences,
)
from nlcontrol.session.recipe_rebuilding import repeat_recipe
from objectmodels.errors import printable

if TYPE_CHECKING:
    from nlcontrol.service.bundles.run_bundle import RunBundle
    from sim.supervision import Progress

MOST_DIFFERENCES = 50
"""Differences that are told."""


class RerunReport(Document):
    """Comparison of a run with its repetition.

    Attributes:
        ok: result and trace are the same to the digit.
        text: the sentence.
        samples: of the trace; 0 if nothing moved.
        differences: versions that are others, fields and arrays that came out otherwise; the first
            of each.
        found: number of fields and arrays that came out otherwise.
        error: `run_differs` if any did.
    """

    ok: bool
    text: str
    samples: int
    differences: tuple[Difference, ...]
    found: int
    error: ErrorInfo | None = None


def rerun(bundle: RunBundle, progress: Progress | None = None) -> RerunReport:
    """Does all again that led to a run, and the run, in simulation; then compares.

    Args:
        bundle: of the run.
        progress: told what happens during the simulation.

    Raises:
        ControlError: `not_repeatable`, `bad_recipe`.
    """
    request = bundle.request
    if request.recipe is None or not request.recipe.deeds:
        raise error(
            "not_repeatable",
            f"this run has no recipe: {printable(request.why_not or 'nothing was done')}",
            suggestions=("read its result, events and replay, which the bundle holds",),
        )
    _, result = repeat_recipe(request.recipe, exact=False, progress=progress)
    repeated = {} if result is None else json.loads(result.to_json())
    trace = None if result is None else result.trace
    versions = version_differences(
        {**request.versions, "platform": request.platform},
        {**installed_versions(), "platform": platform_name()},
    )
    others = tuple(versions)
    came_out = tuple(
        chain(
            result_differences(bundle.result, repeated),
            trace_differences(bundle.trace, trace),
        )
    )
    return RerunReport(
        ok=not came_out,
        text=printable(request.text),
        samples=0 if bundle.trace is None else len(bundle.trace.time),
        differences=(*others, *came_out[:MOST_DIFFERENCES]),
        found=len(came_out),
        error=_differs(len(came_out), others) if came_out else None,
    )


def _differs(found: int, others: tuple[Difference, ...]) -> ErrorInfo:
    names = ", ".join(f"{each.place} {each.recorded}" for each in others)
    hint = "report it with the bundle: with the same versions nothing may differ"
    if others:
        hint = f"repeat it with {names}, if it has to be the same to the digit"
    return ErrorInfo(
        code="run_differs",
        message=f"{found} fields and arrays came out otherwise",
        suggestions=(hint,),
        numbers={"found": found},
    )


def report_lines(report: RerunReport) -> Iterator[str]:
    """A report in words."""
    if report.ok:
        moved = f" and its trace of {report.samples} samples" if report.samples else ""
        yield f"Repeated to the digit: the result of “{report.text}”{moved}."
    else:
        yield f"It came out otherwise: “{report.text}”."
    for each in report.differences:
        yield f"  {each.part} {each.place}: {_difference_text(each)}"
    untold = report.found - sum(each.part != "version" for each in report.differences)
    if untold > 0:
        yield f"  and {untold} more"


def _difference_text(each: Difference) -> str:
    told = []
    if each.recorded is not None or each.repeated is not None:
        told.append(f"{each.recorded or 'nothing'} in the bundle, {each.repeated or 'nothing'} now")
    if each.largest is not None:
        told.append(f"up to {each.largest:.3g} {each.unit or ''}".rstrip())
    if each.begins is not None:
        told.append(f"from {each.begins:.3f} s on")
    return ", ".join(told)
