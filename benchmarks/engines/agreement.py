"""Cases that are predicted and rolled out, and tables of how well both agree.

A case says what becomes of it and by what share of a limit that is sure. Cases within a band about
the limit count apart: there either answer is right.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, Protocol

import numpy as np

from nlcontrol.parallel_tasks import run_all


class Outcome(NamedTuple):
    """What became of a case in an engine.

    Attributes:
        seen: its class; None if it could not be carried out.
        errors: of predicted figures, by name.
        details: what else there is to say.
    """

    seen: str | None
    errors: Mapping[str, float] = {}
    details: str = ""


class Case(Protocol):
    """Something that is predicted and can be rolled out."""

    @property
    def group(self) -> str:
        """The row of the tables in which it counts."""
        ...

    def prediction(self) -> tuple[str, float]:
        """Its class, and how far it is from the limit, of either sign, as a share of that."""
        ...

    def roll_out(self) -> Outcome:
        """What becomes of it."""
        ...


class Suite(NamedTuple):
    """A kind of cases.

    Attributes:
        draw: so many cases of a seed.
        cases: how many, if that is not said.
        band: share of the limit within which cases count apart.
        rolls_close: whether those are rolled out too.
        edges: of the rows of a table by the share of the limit, if it has one.
        begin: called in each process before the first case.
    """

    draw: Callable[[int, int], Sequence[Case]]
    cases: int = 300
    band: float = 0.05
    rolls_close: bool = False
    edges: tuple[float, ...] = ()
    begin: Callable[[], object] | None = None


class Trial(NamedTuple):
    """A case, what was predicted and what became of it.

    Attributes:
        case: which.
        predicted: class.
        margin: distance from the limit, as a share of it.
        close: whether it lies within the band.
        outcome: what became of it; None if it was not rolled out.
    """

    case: Case
    predicted: str
    margin: float
    close: bool
    outcome: Outcome | None

    @property
    def seen(self) -> str | None:
        """The class that it had in the engine."""
        return self.outcome and self.outcome.seen

    @property
    def counts(self) -> bool:
        """Whether the classes are compared."""
        return not self.close and self.seen is not None

    @property
    def is_right(self) -> bool:
        """Whether the engine saw the predicted class."""
        return self.seen == self.predicted

    def __str__(self) -> str:
        details = f"; {self.outcome.details}" if self.outcome and self.outcome.details else ""
        return (
            f"{self.case.group}: {self.predicted} predicted by {abs(self.margin):.2f}, "
            f"{self.seen} seen{details}"
        )


def run_case(case: Case, band: float, rolls_close: bool) -> Trial:
    """Predicts a case and rolls it out."""
    predicted, margin = case.prediction()
    close = abs(margin) < band
    outcome = None if close and not rolls_close else case.roll_out()
    return Trial(case, predicted, margin, close, outcome)


def run_cases(suite: Suite, cases: Sequence[Case], band: float, workers: int) -> Iterable[Trial]:
    """All cases in their order, in processes of this machine."""
    run = partial(run_case, band=band, rolls_close=suite.rolls_close)
    return run_all(run, cases, workers=workers, initializer=suite.begin)


def class_table(trials: Sequence[Trial]) -> str:
    """How often the class is as predicted, by group."""
    lines = [
        "| | cases | in the band | right of the others | predicted/seen |",
        "|---|--:|--:|--:|---|",
    ]
    for group, members in _groups(trials):
        counted = [each for each in members if each.counts]
        right = sum(each.is_right for each in counted)
        pairs = Counter(f"{each.predicted}/{each.seen}" for each in counted)
        lines.append(
            f"| {group} | {len(members)} | {sum(each.close for each in members)} "
            f"| {right} of {len(counted)}, {right / max(len(counted), 1):.1%} "
            f"| {', '.join(f'{count} {pair}' for pair, count in pairs.most_common())} |"
        )
    return "\n".join(lines)


def error_table(trials: Sequence[Trial]) -> str:
    """How far off predicted figures are, by group; nothing if there are none."""
    lines = []
    for group, members in _groups(trials):
        outcomes = [each.outcome for each in members if each.outcome]
        for name in dict.fromkeys(name for each in outcomes for name in each.errors):
            errors = np.array([each.errors[name] for each in outcomes if name in each.errors])
            sizes = np.abs(errors)
            median, high = np.percentile(sizes, [50, 95], method="higher")
            lines.append(
                f"| {group}, {name} | {len(errors)} | {sizes.mean():.4g} | {median:.4g} "
                f"| {high:.4g} | {errors[np.argmax(sizes)]:+.4g} |"
            )
    head = [
        "| error of | cases | mean | median | 95 % below | worst |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    return "\n".join(head + lines) if lines else ""


def margin_table(trials: Sequence[Trial], edges: Sequence[float]) -> str:
    """What became of the cases, by the share of the limit that they have."""
    shares = [1.0 + each.margin for each in trials]
    classes = sorted({each.seen or "-" for each in trials})
    heads = "".join(f" {name} |" for name in classes)
    lines = [f"| of the limit | cases |{heads}", "|---|--:|" + "--:|" * len(classes)]
    for low, high in itertools.pairwise(edges):
        seen = Counter(
            each.seen or "-"
            for each, share in zip(trials, shares, strict=True)
            if low <= share < high
        )
        counts = "".join(f" {seen[name]} |" for name in classes)
        lines.append(f"| {low:.1f} to {high:.1f} | {seen.total()} |{counts}")
    return "\n".join(lines)


def _groups(trials: Sequence[Trial]) -> list[tuple[str, Sequence[Trial]]]:
    """Trials by their group, and all of them if there are several groups."""
    names = dict.fromkeys(each.case.group for each in trials)
    groups: list[tuple[str, Sequence[Trial]]] = [
        (name, [each for each in trials if each.case.group == name]) for name in names
    ]
    return groups if len(groups) == 1 else [*groups, ("all", trials)]


def worst(trials: Iterable[Trial], count: int = 5) -> str:
    """The trials that agree least, wrong classes first, with all that it takes to repeat them."""

    def badness(trial: Trial) -> tuple[bool, float]:
        errors: Any = trial.outcome.errors.values() if trial.outcome else ()
        return trial.counts and not trial.is_right, max(map(abs, errors), default=0.0)

    ordered = sorted(trials, key=badness, reverse=True)
    return "\n".join(f"{each}\n  {each.case}" for each in ordered[:count])
