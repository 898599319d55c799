"""The robot finds the parameters of an object by touching it.

Repetition after repetition the hand tilts, slides and rubs the object; every touch updates what is
believed, so that the next one is planned with it, and at the end all trials are fitted together.
With a precision asked for, the experiment that tells most is done next, until all asked parameters
are known so well; as these may be few touches, what was believed before then counts in the fit.

The report is the paper's Table I for this run: each repetition by itself gives an estimate in
closed form, and their mean, standard deviation, least and largest value are told, beside the joint
fit of all trials. What is true an observer adds to it after everything (`exploringreport`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.errors import ControlError, error, executor_failures_raised
from nlcontrol.learning.learning_reports import ExplorationReport, TouchMade
from nlcontrol.learning.lessons import SPREAD, apply_lesson
from nlcontrol.learning.log_fitting import correlations, fitted_parameter, with_provenance
from objectmodels.errors import ModelError
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification.belief_update import initial_belief as guessed
from objectmodels.identification.experiment_design import (
    Candidate,
    is_precise_enough,
    parameter_precisions,
    rank_candidates,
)
from objectmodels.identification.joint_fit import (
    Estimates,
    Fit,
    estimates_from_trials,
    fit,
    repetition_table,
)
from objectmodels.identification.measurement_model import with_belief
from planner.touch_experiments import Experiment, Kind, expected_trials
from sim.supervision import Monitor, Progress, Stopped
from sim.traces.trace import Trace, join_traces

if TYPE_CHECKING:
    from objectmodels import ObjectModel
    from objectmodels.identification import Trial
    from planner.types.world_state import SeenObject, WorldState
    from sim.exploration.exploration_run import Explorer, Touched, TouchExecutor


CENTRE_OF_MASS = ("com_x", "com_y", "com_z")

NEEDS: Mapping[str, tuple[Kind, ...]] = {
    "mass": ("tilt",),
    "friction": ("tilt", "slide"),
    "friction_radius": ("tilt", "slide", "off-centre slide"),
    "finger_friction": ("rub",),
    **dict.fromkeys(CENTRE_OF_MASS, ("tilt",)),
}
"""Kinds of experiments that tell each parameter."""

TRIALS = 10
"""Repetitions, if nothing else is said."""


_ELSEWHERE = "move it where the hand reaches more of its sides, and explore it there"
_BELIEVING = "what was believed before counts as measured, since the touches are few"

Told = Callable[["Touched", "ObjectModel"], None]
"""Told of each touch, and of what is believed after it."""


@dataclass(frozen=True)
class Exploration:
    """Findings of an exploration.

    Attributes:
        model: with what was found.
        report: of it.
        touches: what was felt and seen.
    """

    model: ObjectModel
    report: ExplorationReport
    touches: tuple[Touched, ...]

    @property
    def trace(self) -> Trace | None:
        """Everything that happened."""
        return touch_trace(self.touches)


class ExplorationStopped(Stopped):
    """Raised where an exploration was told to stop.

    Args:
        trace: of the touches.
        findings: makes those of the touches so far, what was believed before counting too; raises
            `not_explorable` if they tell nothing.
    """

    def __init__(self, trace: Trace | None, findings: Callable[[], Exploration]) -> None:
        super().__init__(trace)
        self.findings = findings


def touch_trace(touches: Sequence[Touched]) -> Trace | None:
    """Everything that happened in some touches; None if nothing did."""
    traces = [t.recording.trace for t in touches if t.recording.trace is not None]
    return join_traces(traces) if traces else None


def explore(
    executor: TouchExecutor,
    models: dict[str, ObjectModel],
    name: str,
    *,
    parameters: Sequence[str] = UNCERTAIN,
    repetitions: int = TRIALS,
    precision: float | None = None,
    guess: float | None = None,
    progress: Progress | None = None,
    told: Told | None = None,
) -> Exploration:
    """Touches an object until its parameters are known, and learns them.

    Args:
        executor: the robot.
        models: what is believed of every object; changed by what is learned.
        name: of the object in the cell.
        parameters: what to find, names of `UNCERTAIN`.
        repetitions: of the experiments; with a precision the most of them.
        precision: relative standard deviation at which to stop; of the centre of mass, as a share
            of the base's size. Nothing is measured beyond it.
        guess: take mass and frictions as no more than guessed, off by such a factor, instead of
            trusting them as the knowledge base does.
        progress: told what the hand does.
        told: told of each touch.

    Raises:
        ExplorationStopped: that was asked for; what the touches so far have taught is kept.
        ControlError: `not_explorable` if the object cannot be touched so that it shows anything.
    """
    from sim.exploration.exploration_run import Explorer

    before = _standing(executor.look(models), name)
    start = before.model if guess is None else guessed(before.model, guess)
    models[name] = start

    def learn(touched: Touched) -> None:
        model = models[name]
        for trial in touched.trials:
            try:
                model = apply_lesson(model, trial).model
            except ModelError:
                continue
        models[name] = model
        if told is not None:
            told(touched, models[name])

    explorer = Explorer(
        name, executor, lambda: executor.look(models), learn=learn, progress=progress
    )
    kinds = kinds_for(parameters)
    _require_reach(explorer, kinds)
    asked = {}
    if precision is not None:
        asked = precisions_asked(before.model, parameters, precision)
        _require_ignorance(models[name], asked, f"the {name} is known to {precision:.0%} already")

    def findings(early: bool) -> Exploration:
        prior = early or precision is not None
        return _findings(executor, explorer, before.model, start, parameters, prior, early)

    try:
        _touch_repeatedly(models, explorer, kinds, asked, repetitions, Monitor.of(progress))
    except Stopped:
        trace = touch_trace(explorer.touches)
        raise ExplorationStopped(trace, partial(findings, early=True)) from None
    found = findings(early=False)
    models[name] = found.model
    return found


def _require_reach(explorer: Explorer, kinds: Sequence[Kind]) -> None:
    if not explorer.possible(kinds):
        message = f"no side of the {explorer.name} is high and wide enough for a fingertip"
        raise error("not_explorable", message, suggestions=("weigh it by lifting it",))


def _require_ignorance(believed: ObjectModel, asked: Mapping[str, float], said: str) -> None:
    if is_precise_enough(believed, asked, spread=SPREAD):
        hints = ("ask for more precision, or give none",)
        raise error("not_explorable", f"what was asked about {said}", suggestions=hints)


def _findings(
    executor: TouchExecutor,
    explorer: Explorer,
    before: ObjectModel,
    start: ObjectModel,
    parameters: Sequence[str],
    prior: bool,
    early: bool,
) -> Exploration:
    """The model fitted to all touches, and the report of it."""
    trials = [trial for touched in explorer.touches for trial in touched.trials]
    found = _fit_all(start, trials, explorer, prior=prior)
    cut = f"stopped after {len(explorer.touches)} touches; " if early else ""
    model = with_provenance(
        found,
        before=found.model,
        source="explored by touching in simulation "
        f"(scene {executor.cell.name}, seed {executor.seed})",
        method=f"{cut}tilted, slid and rubbed by a finger; joint fit of {{count}} balances "
        "of forces",
    )
    report = _report(executor, explorer.name, before, found, explorer, trials, parameters)
    return Exploration(model, report, tuple(explorer.touches))


def precisions_asked(
    model: ObjectModel, parameters: Sequence[str], precision: float
) -> dict[str, float]:
    """Standard deviations that a precision asks for: relative, of the centre of mass in metres."""
    lengths = dict.fromkeys(CENTRE_OF_MASS, model.base.size) | {"com_z": model.top}
    return {name: precision * lengths.get(name, 1.0) for name in parameters}


def _standing(state: WorldState, name: str) -> SeenObject:
    """The object as it is seen, if it stands on its base."""
    seen = state.objects[name]
    if seen.lies_on != "bottom":
        raise error(
            "not_explorable",
            f"the {name} lies on its {seen.lies_on} face; what touches tell there does not hold "
            "for its base",
            suggestions=("stand it upright first",),
        )
    return seen


def kinds_for(parameters: Sequence[str]) -> tuple[Kind, ...]:
    """Kinds of experiments that the parameters need, in the paper's order."""
    needed = {kind for name in parameters for kind in NEEDS[name]}
    order: tuple[Kind, ...] = ("tilt", "slide", "off-centre slide", "rub")
    return tuple(kind for kind in order if kind in needed)


def _touch_repeatedly(
    models: Mapping[str, ObjectModel],
    explorer: Explorer,
    kinds: Sequence[Kind],
    asked: Mapping[str, float],
    repetitions: int,
    monitor: Monitor,
) -> None:
    """Makes all repetitions, or what tells most until everything asked is known."""
    with executor_failures_raised():
        if asked:
            _until(models, explorer, kinds, asked, most=repetitions * (len(kinds) + 1))
        else:
            for repetition in range(repetitions):
                explorer.repeat(kinds, repetition)
    monitor.stop.check()


def _until(
    models: Mapping[str, ObjectModel],
    explorer: Explorer,
    kinds: Sequence[Kind],
    asked: Mapping[str, float],
    most: int,
) -> None:
    """Does what tells most, until everything asked is known."""
    name = explorer.name
    for _ in range(most):
        model = models[name]
        if is_precise_enough(model, asked, spread=SPREAD):
            return
        offered = explorer.possible(kinds)
        if not offered:
            return
        candidates = [
            Candidate(f"{i} {e.name}", expected_trials(e, model), _cost(e, explorer))
            for i, e in enumerate(offered)
        ]
        best = rank_candidates(model, candidates, asked, spread=SPREAD)[0].candidate
        chosen = offered[candidates.index(best)]
        done = sum(t.experiment.kind == chosen.kind for t in explorer.touches)
        repetition = done // 2 if chosen.kind == "tilt" else done
        explorer.touch(chosen.kind, chosen.push.face, repetition, chosen.lateral)


def _cost(experiment: Experiment, explorer: Explorer) -> float:
    """More for what was done before: of equals, sides take turns."""
    done = [t.experiment for t in explorer.touches]
    # A touch costs a tenth more for each time that it was made before.
    return 1.0 + 0.1 * sum(
        (e.kind, e.push.face) == (experiment.kind, experiment.push.face) for e in done
    )


def _fit_all(
    model: ObjectModel, trials: Sequence[Trial], explorer: Explorer, *, prior: bool
) -> Fit:
    """The joint fit; with few touches what was believed before counts too."""
    name = explorer.name
    if not trials:
        raise _not_explorable(f"no touch of the {name} showed anything", explorer)
    try:
        found = fit(model, trials, prior=prior)
        return replace(found, notes=(*found.notes, _BELIEVING)) if prior else found
    except ModelError as raised:
        message = f"the touches of the {name} do not tell its parameters: {raised.message}"
        raise _not_explorable(message, explorer, *raised.suggestions) from raised


def _not_explorable(message: str, explorer: Explorer, *hints: str) -> ControlError:
    return error("not_explorable", message, suggestions=(*hints, *explorer.given_up, _ELSEWHERE))


def _report(
    executor: TouchExecutor,
    name: str,
    before: ObjectModel,
    found: Fit,
    explorer: Explorer,
    trials: Sequence[Trial],
    parameters: Sequence[str],
) -> ExplorationReport:
    lines = repetition_table(_by_repetition(before, trials))
    repeated = {name: line for name, line in lines.items() if name in found.found}
    missing = [p for p in parameters if p not in found.found]
    notes = [note for note in found.notes if not _about_others(note, missing)]
    return ExplorationReport(
        object=name,
        scene=executor.cell.name,
        seed=executor.seed,
        touches=tuple(map(_touch_made, explorer.touches)),
        repeated=repeated,
        parameters={p: fitted_parameter(p, before, found) for p in found.found},
        correlations=tuple(correlations(found)),
        friction_spread=found.spread,
        rms=found.rms,
        support=found.model.support,
        given_up=explorer.given_up,
        dropped=dict(found.dropped),
        notes=tuple(notes),
    )


def _by_repetition(model: ObjectModel, trials: Sequence[Trial]) -> list[Estimates]:
    """Estimates of each repetition by itself; one whose trials make no sense has none."""
    numbers = sorted({trial.repetition for trial in trials})
    found = []
    for number in numbers:
        try:
            found.append(
                estimates_from_trials(model, [t for t in trials if t.repetition == number])
            )
        except ModelError:
            continue
    return found


def _about_others(note: str, missing: Sequence[str]) -> bool:
    """True of a note that says that a parameter that nobody asked for was kept."""
    return " is kept as believed" in note and note.split(" ", maxsplit=1)[0] not in missing


def _touch_made(touched: Touched) -> TouchMade:
    force = None
    if touched.trials:
        force = math.sqrt(sum(f * f for f in touched.trials[0].force))
    return TouchMade(
        experiment=touched.experiment.name,
        outcome=touched.recording.detail,
        as_meant=touched.as_meant,
        force=force,
    )


# What would be believed once parameters were found out: as now on average, and known better.


def expected_belief(model: ObjectModel, parameters: Sequence[str], precision: float) -> ObjectModel:
    """The model with some parameters known to a precision.

    Args:
        model: what is believed now.
        parameters: that are found out, names of `UNCERTAIN`.
        precision: relative standard deviation; of the centre of mass, as a share of the base's
            size.
    """
    known, asked = parameter_precisions(model), precisions_asked(model, parameters, precision)
    shares = [
        min(1.0, asked.get(name, np.inf) / known[name]) if known[name] > 0.0 else 1.0
        for name in UNCERTAIN
    ]
    return with_belief(model, np.outer(shares, shares) * model.covariance)
