"""The report of an exploration as people read it: the paper's Table I for this run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.learning.exploration_session import CENTRE_OF_MASS
from nlcontrol.learning.learning_reports import ExplorationReport
from nlcontrol.learning.log_fitting import NAMES, UNITS
from objectmodels.geometry.base_shapes import mean_distance

if TYPE_CHECKING:
    from sim.truth.object_truth import Truth

_SCALES = {"m": (1e3, 1, "mm"), "kg": (1.0, 4, "kg"), "": (1.0, 4, "")}
_COLUMNS = ("mean", "sd", "%", "min", "max", "joint fit", "±", "believed", "truth")


def with_truth(report: ExplorationReport, truth: Truth) -> ExplorationReport:
    """The report of a finished exploration with how the object really is, by an observer."""
    feet = np.array(truth.support)
    figures = {
        "mass": truth.mass_kg,
        "friction": truth.friction_table,
        "finger_friction": truth.friction_finger,
        "friction_radius": mean_distance(feet, np.full(len(feet), 1.0 / len(feet))),
        **dict(zip(CENTRE_OF_MASS, truth.centre_of_mass, strict=True)),
    }
    return report.model_copy(update={"truth": figures})


def report_lines(report: ExplorationReport) -> Iterator[str]:
    """The report, line by line."""
    useful = sum(touch.as_meant for touch in report.touches)
    yield (
        f"{report.object}, scene {report.scene}, seed {report.seed}: {len(report.touches)} touches,"
        f" {useful} as meant"
    )
    told = _COLUMNS if report.truth is not None else _COLUMNS[:-1]
    yield f"  {'':22}" + "".join(f"{name:>10}" for name in told)
    for name in report.parameters:
        unit = _SCALES[UNITS.get(name, "")][2]
        yield f"  {(f'{NAMES[name]} [{unit}]' if unit else NAMES[name]):22}" + "".join(
            f"{cell:>10}" for cell in _cells(report, name)
        )
    yield f"  each repetition by itself; then all {len(report.touches)} touches together"
    for a, b, value in report.correlations:
        yield f"  correlation of {NAMES[a]} and {NAMES[b]}: {value:+.2f}"
    yield f"  the fitted model predicts the forces within {report.rms:.1%} (rms)"
    yield from (f"  given up: {why}" for why in report.given_up)
    yield from (f"  left out: {source}, {why}" for source, why in report.dropped.items())
    yield from (f"  note: {note}" for note in report.notes)
    if report.error:
        yield f"Stopped: {report.error.message} ({'; '.join(report.error.suggestions)})"
    if report.saved:
        yield f"Saved: {report.saved}"
    if report.instead_of:
        yield f"  The robot goes by it instead of: {report.instead_of}"
    for kind, path in report.files.items():
        yield f"{kind.capitalize()}: {path}"


def _cells(report: ExplorationReport, name: str) -> Iterator[str]:
    scale, digits, _ = _SCALES[UNITS.get(name, "")]

    def cell(value: float | None) -> str:
        return "" if value is None else f"{round(scale * value, digits) + 0.0:.{digits}f}"

    row, fitted = report.repeated.get(name), report.parameters[name]
    if row is None:
        yield from ("",) * 5
    else:
        percent = None if name.startswith("com_") else row.percent
        yield cell(row.mean)
        yield cell(row.sd)
        yield "" if percent is None else f"{percent:.1f}"
        yield cell(row.least)
        yield cell(row.most)
    yield cell(fitted.value)
    yield cell(fitted.sd)
    yield cell(fitted.believed)
    if report.truth is not None:
        yield cell(report.truth.get(name))
