"""Fitting the data files of a real robot, and the report of what was found.

The report tells of each parameter its value with a 95 % interval beside what was believed before,
how the parameters hang together, how well the fitted model predicts the trials that it was fitted
to, and for what stays as believed, which experiment would find it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path

from nlcontrol.learning.learning_reports import FitReport, FittedParameter
from objectmodels import ModelError, ObjectModel, Provenance
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.experiment_design import UNKNOWN
from objectmodels.identification.joint_fit import Fit, fit
from objectmodels.identification.touch_log import FORCE_SHARE, Reading, read_data

TOLD = 0.3
"""Correlations from this size on are told."""

EXPERIMENTS = {
    "mass": "press near the top of two opposite sides until it tilts (topple)",
    "friction": "push it low until it slides (slide), and tilt it for its mass (topple)",
    "finger_friction": "drag the finger along a side until it slips (slip, with nx, ny, nz)",
    "friction_radius": "push it low and off the middle (slide, with turn_deg and travel_m)",
    "com_x": "tilt it over both sides in x (topple)",
    "com_y": "tilt it over both sides in y (topple)",
    "com_z": "hold it tilted at an angle, better at two (topple, with tilt_deg)",
}
"""The experiment that finds each parameter, as the rows of a data file."""

UNITS = {"mass": "kg", "friction_radius": "m", "com_x": "m", "com_y": "m", "com_z": "m"}
"""Units of those that have one."""

NAMES = {
    "mass": "mass",
    "friction": "friction, table",
    "finger_friction": "friction, finger",
    "friction_radius": "friction radius",
    "com_x": "centre of mass, x",
    "com_y": "centre of mass, y",
    "com_z": "centre of mass, z",
}
"""Parameters as people call them."""


def fit_files(
    model: ObjectModel, files: Sequence[Path], parameters: Sequence[str] | None = None
) -> tuple[ObjectModel, FitReport]:
    """The model fitted to data files, with where its figures come from; and the fit's report.

    The files are explained in docs/fitting.md. Without parameters all that the data tell is found.

    Raises:
        ModelError: `unreadable_file`, `bad_data`; `not_identifiable` with the experiments that are
            missing; `no_fit` if the trials contradict each other; what else
            `objectmodels.identification.fit` raises.
    """
    reading = read_data(files, model)
    if not reading.trials:
        raise ModelError(
            "not_identifiable",
            "not identifiable: nothing moved in any trial",
            path=str(files[0]),
            suggestions=reading.unused,
        )
    try:
        found = fit(model, reading.trials, parameters=parameters)
    except ModelError as error:
        # The fit names the trial, as a rule by its row; the file is known here.
        where = ", ".join(map(str, files)) if error.path is None else error.path
        hints = error.suggestions
        if error.code == "no_fit" and parameters is not None:
            hints += ("find more: what is not found is kept as believed, and may be far off",)
        raise ModelError(error.code, error.message, path=where, suggestions=hints) from error
    _require_found(found, reading, files)
    names = ", ".join(file.name for file in files)
    report = _report(model, found, reading, files, asked=parameters is not None)
    method = f"least squares of {{count}} touches by a robot; found: {', '.join(found.found)}"
    fitted = with_provenance(found, before=model, source=f"fitted to {names}", method=method)
    return fitted, report


def _require_found(found: Fit, reading: Reading, files: Sequence[Path]) -> None:
    """Refuses trials that contradict each other so much that the fit says nothing."""
    positive = [name for name in found.found if name not in ("com_x", "com_y")]
    vague = [name for name in positive if found.deviations[name] > UNKNOWN * found.values[name]]
    if not vague:
        return
    worst = sorted(
        zip(found.residuals, reading.trials, strict=True),
        key=lambda pair: -max(map(abs, pair[0])),
    )
    raise ModelError(
        "no_fit",
        f"the trials contradict each other: the fit misses their forces by {found.rms:.0%}, and "
        f"leaves more than half of {' and '.join(NAMES[name] for name in vague)} open",
        path=", ".join(map(str, files)),
        suggestions=(f"look at: {', '.join(trial.source for _, trial in worst[:3])}",),
    )


def with_provenance(found: Fit, *, before: ObjectModel, source: str, method: str) -> ObjectModel:
    """The fitted model, with where its figures come from.

    Args:
        found: the fit.
        before: what was believed, whose provenance holds for what was not found.
        source: of the figures.
        method: by which they were found; `{count}` in it stands for the number of trials used.
    """
    kept = [name for name in UNCERTAIN if name not in found.found]
    count = len(found.residuals) - len(found.dropped)
    method = method.format(count=count)
    if kept:
        method += f"; as believed before ({before.provenance.source}): {', '.join(kept)}"
    today = date.today().isoformat()
    provenance = Provenance(source=source, method=method, trials=max(count, 1), date=today)
    return found.model.model_copy(update={"provenance": provenance})


def _report(
    before: ObjectModel, found: Fit, reading: Reading, files: Sequence[Path], *, asked: bool
) -> FitReport:
    used = [trial for trial in reading.trials if trial.source not in found.dropped]
    left = [name for name in UNCERTAIN if name not in found.found and not asked]
    return FitReport(
        object=before.name,
        files=tuple(map(str, files)),
        trials=dict(Counter(trial.moved for trial in used)),
        assumed=sum(reading.assumed),
        parameters={name: fitted_parameter(name, before, found) for name in found.found},
        correlations=tuple(correlations(found)),
        unidentified={n: EXPERIMENTS[n] for n in left},
        dropped=dict(found.dropped),
        rms=found.rms,
        friction_spread=found.spread,
        noise=found.noise,
        support=found.model.support,
        notes=(*found.notes, *reading.unused),
    )


def fitted_parameter(name: str, before: ObjectModel, found: Fit) -> FittedParameter:
    """A parameter that was found, beside what was believed."""
    k = UNCERTAIN.index(name)
    value, sd = found.values[name], found.deviations[name]
    low, high = found.interval(name)
    return FittedParameter(
        value=value,
        sd=sd,
        percent=None if name in ("com_x", "com_y") else 100.0 * sd / value,
        low=low,
        high=high,
        believed=float(before.means[k]),
        believed_sd=float(before.deviations[k]),
    )


def correlations(found: Fit) -> Iterator[tuple[str, str, float]]:
    """Pairs of parameters that were found, whose errors hang together."""
    for i, a in enumerate(UNCERTAIN):
        for j, b in enumerate(UNCERTAIN[:i]):
            if a in found.found and b in found.found and abs(found.correlation[i, j]) >= TOLD:
                yield b, a, float(found.correlation[i, j])


def report_lines(report: FitReport) -> Iterator[str]:
    """The report as people read it."""
    kinds = ", ".join(
        f"{count} {moved}{'s' * (count > 1)}" for moved, count in report.trials.items()
    )
    names = ", ".join(Path(file).name for file in report.files)
    yield f"{report.object}: {sum(report.trials.values())} trials of {names} ({kinds})"
    yield f"  {'found':18} {'value':>9} {'±':>9} {'%':>6}   {'95 % interval':19} believed before"
    for name, row in report.parameters.items():
        yield f"  {NAMES[name]:18} {_row(name, row)}"
    for a, b, value in report.correlations:
        yield f"  correlation of {NAMES[a]} and {NAMES[b]}: {value:+.2f}"
    yield f"  the fitted model predicts the forces within {report.rms:.1%} (rms)"
    if report.assumed:
        yield f"  the noise of {report.assumed} forces was taken as {FORCE_SHARE:.0%} of each"
    carried = report.support if isinstance(report.support, str) else "its own points"
    yield f"  support: {carried}"
    for source, why in report.dropped.items():
        yield f"  left out: {source}, {why}"
    yield from (f"  note: {note}" for note in report.notes)
    for name, experiment in report.unidentified.items():
        yield f"  to find also {NAMES[name]}: {experiment}"
    if report.saved:
        yield f"Saved: {report.saved}"
    if report.instead_of:
        yield (
            f"  The robot goes by it instead of: {report.instead_of}. "
            f"To go back: nlcontrol objects remove '{report.object}'"
        )
    if report.output:
        yield f"Model: {report.output}"


def _row(name: str, row: FittedParameter) -> str:
    unit = UNITS.get(name, "")
    scale, digits, sign = {"m": (1e3, 1, " mm"), "kg": (1.0, 4, " kg")}.get(unit, (1.0, 4, ""))
    value, sd, low, high, believed, believed_sd = (
        f"{scale * x + 0.0:.{digits}f}"
        for x in (row.value, row.sd, row.low, row.high, row.believed, row.believed_sd)
    )
    percent = "" if row.percent is None else f"{row.percent:.1f}"
    interval = f"{low} … {high}{sign}"
    return f"{value:>9} {sd:>9} {percent:>6}   {interval:19} {believed} ± {believed_sd}{sign}"
