"""What came of many cases, as tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from benchmarks.goals.cases import Done
from benchmarks.goals.drawn_worlds import SETTINGS
from benchmarks.goals.sentences import COMPOUND, setting_of
from benchmarks.goals.wishes import WISHED

D = TypeVar("D")
Columns = dict[str, Callable[[Sequence[D]], object]]


def table(groups: Mapping[str, Sequence[D]], columns: Columns[D]) -> str:
    """A line for each group that has results, with a cell for each column."""
    rows = [["", *columns]]
    rows += [
        [name, *(str(cell(some)) for cell in columns.values())]
        for name, some in groups.items()
        if some
    ]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    lines = (
        "  ".join([name.ljust(widths[0]), *map(str.rjust, cells, widths[1:])])
        for name, *cells in rows
    )
    return "\n".join(lines)


def grouped(results: Iterable[D], key: Callable[[D], str]) -> dict[str, list[D]]:
    """Results by what a key says of them, in the order in which they come, and all together."""
    groups: dict[str, list[D]] = {}
    for done in results:
        groups.setdefault(key(done), []).append(done)
    return groups | {"in all": [done for some in groups.values() for done in some]}


def counters(key: Callable[[D], str | None], values: Iterable[str]) -> Columns[D]:
    """A column for each value: of how many results a key says it."""

    def counter(value: str) -> Callable[[Sequence[D]], object]:
        return lambda some: sum(key(done) == value for done in some)

    return {value: counter(value) for value in values}


def share(part: int, whole: int) -> str:
    """So many of how many, and that in percent."""
    return f"{part} of {whole} {part / whole:.1%}" if whole else "-"


def report(results: Sequence[Done]) -> str:
    """All tables, and a line for everything that went otherwise than it should."""
    parts = (counts(results), refusals(results), times(results), *filter(None, map(amiss, results)))
    return "\n".join(filter(None, parts))


def counts(results: Sequence[Done]) -> str:
    """How many of each kind, and of each setting of hard worlds, were accepted and satisfied."""
    hard = [done for done in results if done.job.suite == "hard"]
    settings = grouped(hard, lambda done: setting_of(done.job))
    groups: dict[str, list[Done]] = {name: settings.get(name, []) for name in SETTINGS}
    return table(grouped(results, lambda done: done.kind) | groups, _COLUMNS)


def _accepted(results: Sequence[Done]) -> str:
    # What a usual world asks beyond the robot's abilities counts neither way.
    able = [done for done in results if not done.lacking or done.job.suite != "roomy"]
    return share(sum(done.accepted for done in able), len(able))


def _satisfied(results: Sequence[Done]) -> str:
    executed = [done for done in results if done.executed]
    return share(sum(done.satisfied for done in executed), len(executed))


def _sensible(results: Sequence[Done]) -> list[Done]:
    return [done for done in results if done.sensible]


_COLUMNS: Columns[Done] = {
    "cases": len,
    "lacking": lambda some: sum(done.lacking for done in some),
    "accepted": _accepted,
    "satisfied": _satisfied,
    "sensible, accepted": lambda some: _accepted(_sensible(some)),
    "sensible, satisfied": lambda some: _satisfied(_sensible(some)),
    "false": lambda some: sum(done.falsely_done for done in some),
    "broken": lambda some: sum(bool(done.broken) for done in some),
}


def refusals(results: Sequence[Done]) -> str:
    """Why sentences were refused, with the first of their numbers."""
    refused = [done for done in results if done.refused]
    groups = grouped(sorted(refused, key=lambda done: done.refused), lambda done: done.refused)
    groups.pop("in all")
    columns: Columns[Done] = {
        "refused": len,
        "numbers": lambda some: ", ".join(str(done.job) for done in some[:12]),
    }
    return table(groups, columns) if groups else ""


def times(results: Sequence[Done]) -> str:
    """Of answers to what was planned only, other steps that are looked for included."""
    timed = [done for done in results if done.seconds]

    def kind(done: Done) -> str:
        several = "compound" if done.kind in COMPOUND else "one action"
        return "several things" if done.kind in WISHED else several

    def percentile(q: int) -> Callable[[Sequence[Done]], object]:
        return lambda some: f"{np.percentile([done.seconds for done in some], q):.2f} s"

    columns: Columns[Done] = {"answers": len}
    columns |= {"median": percentile(50), "95 %": percentile(95), "most": percentile(100)}
    return table(grouped(timed, kind), columns) if timed else ""


def amiss(done: Done) -> str:
    """A line on a case that was accepted and went wrong, or did harm; empty for others."""
    wrong = done.status == "crashed" or done.falsely_done or bool(done.broken)
    if not wrong and (done.satisfied or not done.executed):
        return ""
    truly = {None: "", True: ", truly met", False: ", truly missed"}[done.met]
    broken = f", broken {', '.join(done.broken)}" if done.broken else ""
    label = "" if done.sensible else " (blind)"
    why = f"{done.reason} {done.message.strip()}".strip()
    return f"{done.job} {done.kind}{label} “{done.text}”: {done.status}{truly}{broken}: {why}"
