"""What came of many cases, as tables."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from typing import get_args

import numpy as np

from benchmarks.goals.cases import Done, Stage
from benchmarks.goals.hard_worlds import SETTINGS
from benchmarks.goals.sentences import COMPOUND, EXACT, Kind, setting_of

LEVELS = ((0.95, 0.97), (0.97, 0.99), (0.99, 1.0))
"""Stated probabilities that are looked at together."""

BOUNDS = {
    "displace": {"along": (3.0, "mm"), "across": (3.0, "mm"), "yaw": (2.0, "°")},
    "place": {"off": (5.0, "mm"), "yaw": (2.0, "°")},
    "rotate": {"turn": (1.5, "°"), "drift": (8.0, "mm")},
    "topple": {"side": (45.0, "°")},
    "tilt": {"angle": (2.0, "°"), "back": (2.0, "°"), "drift": (8.0, "mm")},
}
"""Errors of each goal in the order of the table: what is hoped for, and its unit."""

_UNITS = {"mm": 1e3, "°": math.degrees(1.0)}
_SURE = 1.96  # standard deviations of an interval


def report(results: Sequence[Done]) -> str:
    """All tables."""
    parts = (
        counts, settings, truths, clauses, refusals, errors, objects, beyond, reliability, times,
        failures,
    )  # fmt: skip
    return "\n\n".join(filter(None, (part(results) for part in parts)))


def counts(results: Sequence[Done]) -> str:
    """How many of each kind were accepted and satisfied."""
    lines = [f"{'kind':10} {'cases':>6} {'lacking':>8} {'accepted':>18} {'satisfied':>18}"]
    kinds = [kind for kind in get_args(Kind) if any(done.kind == kind for done in results)]
    lines += [_count(kind, [done for done in results if done.kind == kind]) for kind in kinds]
    lines.append(_count("sensible", [done for done in results if done.sensible]))
    return "\n".join([*lines, _count("all", results)])


def settings(results: Sequence[Done]) -> str:
    """Of the sensible cases in hard worlds: what is lacking counts as not accepted here."""
    lines = [f"{'setting':10} {'sensible':>8} {'accepted':>18} {'satisfied':>18}"]
    for setting in SETTINGS:
        hard = [done for done in results if done.job.hard and setting_of(done.job) == setting]
        lines += [_setting(setting, [done for done in hard if done.sensible])] if hard else []
    every = [done for done in results if done.job.hard and done.sensible]
    return "\n".join([*lines, _setting("all", every)]) if every else ""


def _setting(name: str, sensible: Sequence[Done]) -> str:
    accepted = [done for done in sensible if done.accepted]
    return (
        f"{name:10} {len(sensible):>8} {_of(len(accepted), len(sensible)):>18}"
        f" {_satisfied(accepted):>18}"
    )


def _satisfied(accepted: Sequence[Done]) -> str:
    executed = [done for done in accepted if done.job.executed]
    return _of(sum(done.status == "done" for done in executed), len(executed))


def truths(results: Sequence[Done]) -> str:
    """What the judge says of cases that are said to be done, and of goals that were met."""
    done = [each for each in results if each.status == "done"]
    if not done:
        return ""
    stages = _stages(done)
    known = sum(stage.met is not None for stage in stages)
    false = [f"{each.job.seed}-{each.job.number}" for each in done if each.falsely_done]
    broken = [f"{each.job.seed}-{each.job.number} {', '.join(stage.broken)}"
              for each in done for stage in each.stages if stage.met and stage.broken]  # fmt: skip
    lines = [f"steps done: {len(stages)}, of which the judge can tell: {known}"]
    lines.append(f"falsely done: {len(false)} {' '.join(false)}".rstrip())
    lines.append(f"done with a clause broken: {len(broken)} {'; '.join(broken)}".rstrip())
    return "\n".join(lines)


def _count(name: str, results: Sequence[Done]) -> str:
    able = [done for done in results if not done.lacking]
    accepted = [done for done in able if done.accepted]
    lacking = len(results) - len(able)
    return (
        f"{name:10} {len(results):>6} {lacking:>8} {_of(len(accepted), len(able)):>18}"
        f" {_satisfied(accepted):>18}"
    )


def _of(part: int, whole: int) -> str:
    return f"{part} of {whole} {part / whole:6.1%}" if whole else "-"


def clauses(results: Sequence[Done]) -> str:
    """Of what was carried out: how often each clause held."""
    held: defaultdict[str, list[bool]] = defaultdict(list)
    for stage in _stages(results):
        by_clause: defaultdict[str, bool] = defaultdict(lambda: True)
        for clause, ok in stage.clauses:
            by_clause[clause] &= ok
        for clause, ok in by_clause.items():
            held[clause].append(ok)
    if not held:
        return ""
    lines = [f"{'clause':14} {'violated':>18}"]
    for clause, oks in sorted(held.items()):
        lines.append(f"{clause:14} {_of(oks.count(False), len(oks)):>18}")
    upright = held.get("no_topple", [])
    return "\n".join([*lines, f"without toppling held: {_of(upright.count(True), len(upright))}"])


def refusals(results: Sequence[Done]) -> str:
    """Why sentences were refused, and for which of them brute force can look."""
    by_reason: defaultdict[str, list[int]] = defaultdict(list)
    for done in results:
        if done.refused is not None:
            by_reason[done.refused].append(done.job.number)
    lines = [f"{'refused':14} {'cases':>6}  numbers"]
    for reason, numbers in sorted(by_reason.items()):
        lines.append(f"{reason:14} {len(numbers):>6}  {_some(numbers)}")
    lacking = Counter(done.capability or done.message for done in results if done.lacking)
    lines += [f"lacking {count:>3} ×: {message}" for message, count in lacking.most_common()]
    return "\n".join(lines) if len(lines) > 1 else ""


def errors(results: Sequence[Done]) -> str:
    """Final errors of each kind of goal: median and 95th percentile of their sizes."""
    rows: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
    for stage in _stages(results):
        for name, value in stage.errors.items():
            rows[stage.goal, name].append(value)
    if not rows:
        return ""
    lines = [f"{'goal':9} {'error':8} {'n':>4} {'median':>10} {'95 %':>10} {'within':>22}"]
    for goal, bounds in BOUNDS.items():
        for name, (bound, unit) in bounds.items():
            if not (values := rows.get((goal, name))):
                continue
            sizes = _UNITS[unit] * np.abs(values)
            middle, high = np.percentile(sizes, [50, 95])
            inside = _of(int((sizes <= bound).sum()), len(sizes))
            lines.append(
                f"{goal:9} {name:8} {len(sizes):>4} {f'{middle:.2f} {unit}':>10}"
                f" {f'{high:.2f} {unit}':>10} {f'{bound:g} {unit}: {inside}':>22}"
            )
    return "\n".join(lines)


def objects(results: Sequence[Done]) -> str:
    """Of objects that stood alone: median and 95th percentile of what each goal's errors are."""
    alone = [done for done in results if done.job.alone]
    if not alone:
        return ""
    lines = [f"{'object':13} {'goal':9} {'runs':>4} {'accepted':>8} {'satisfied':>9}  errors"]
    names = sorted({done.target for done in alone})
    for kind in EXACT:
        each = [(name, [d for d in alone if (d.target, d.kind) == (name, kind)]) for name in names]
        every = ("all", [done for done in alone if done.kind == kind])
        lines += [_object(name, kind, some) for name, some in (*each, every) if some]
    return "\n".join(lines)


def _object(name: str, kind: str, results: Sequence[Done]) -> str:
    accepted = [done for done in results if done.accepted]
    satisfied = sum(done.status == "done" for done in accepted)
    told = []
    for error, (bound, unit) in BOUNDS[kind].items():
        values = [s.errors[error] for s in _stages(accepted) if error in s.errors]
        sizes = _UNITS[unit] * np.abs(values)
        if error == "side":
            told.append(f"side right {_of(int((sizes <= bound).sum()), len(accepted))}")
        elif values:
            middle, high = np.percentile(sizes, [50, 95])
            told.append(f"{error} {middle:.2f}, {high:.2f} {unit}")
    shown = f"{name:13} {kind:9} {len(results):>4} {len(accepted):>8} {satisfied:>9}"
    return f"{shown}  {'; '.join(told)}".rstrip()


def beyond(results: Sequence[Done]) -> str:
    """Of objects that stood alone: the errors beyond what is hoped for."""
    return "\n".join(
        f"case {done.job.seed}-{done.job.number} {name} {_UNITS[unit] * error:.1f} {unit}: "
        f"“{done.text}”"
        for done in results
        if done.job.alone
        for stage in done.stages
        for name, error in stage.errors.items()
        for bound, unit in (BOUNDS[stage.goal][name],)
        if abs(_UNITS[unit] * error) > bound
    )


def reliability(results: Sequence[Done]) -> str:
    """How often plans succeeded, by the probability that they stated."""
    lines = [f"{'stated':>12} {'plans':>6} {'mean':>7} {'observed':>9} {'95 % interval':>16}"]
    for low, high in LEVELS:
        last = high == 1.0
        stages = [
            stage
            for stage in _stages(results)
            if stage.probability is not None
            and low <= stage.probability
            and (last or stage.probability < high)
        ]
        if not stages:
            continue
        good = sum(stage.status == "done" for stage in stages)
        mean = float(np.mean([stage.probability for stage in stages]))
        a, b = wilson(good, len(stages))
        lines.append(
            f"{f'{low:.2f}–{high:.2f}':>12} {len(stages):>6} {mean:>7.3f}"
            f" {good / len(stages):>9.3f} {f'{a:.3f}–{b:.3f}':>16}"
        )
    return "\n".join(lines) if len(lines) > 1 else ""


def wilson(good: int, count: int) -> tuple[float, float]:
    """Wilson's interval of a probability, of which `good` of `count` trials are known, at 95 %."""
    z2 = _SURE**2
    middle = (good + z2 / 2.0) / (count + z2)
    half = _SURE * math.sqrt(good * (count - good) / count + z2 / 4.0) / (count + z2)
    return middle - half, middle + half


def times(results: Sequence[Done]) -> str:
    """Of planning with the arm's kinematics, and of executions.

    The first two are of one plan each; whole answers, other steps that are looked for included, are
    those of sentences that were planned only.
    """
    planning = [1e3 * stage.planning for stage in _stages(results) if stage.planned]
    one = [1e3 * d.answering for d in results if d.answering and d.kind not in COMPOUND]
    whole = [1e3 * d.answering for d in results if d.answering and d.kind in COMPOUND]
    refusing = [1e3 * s.planning for s in _stages(results) if s.reason and not s.planned]
    ratios = [done.wall / done.simulated for done in results if done.simulated]
    rows = (
        ("first plan", planning, "ms"),
        ("refusal", refusing, "ms"),
        ("one action", one, "ms"),
        ("compound", whole, "ms"),
        ("execution", ratios, "wall s per simulated s"),
    )
    lines = [f"{'time':12} {'n':>5} {'median':>9} {'95 %':>9} {'most':>9}"]
    for name, values, unit in rows:
        if values:
            shown = "".join(f" {x:>9.3g}" for x in np.percentile(values, [50, 95, 100]))
            lines.append(f"{name:12} {len(values):>5}{shown} {unit}")
    return "\n".join(lines) if len(lines) > 1 else ""


def failures(results: Sequence[Done]) -> str:
    """The accepted cases that were not satisfied, and those that crashed."""
    return "\n".join(
        f"case {done.job.number} {done.status}: “{done.text}”: {done.message.strip()}"
        for done in results
        if done.status == "crashed" or (done.accepted and done.status not in ("done", "planned"))
    )


def _stages(results: Iterable[Done]) -> list[Stage]:
    return [stage for done in results for stage in done.stages]


def _some(numbers: Sequence[int], most: int = 12) -> str:
    shown = ", ".join(map(str, sorted(numbers)[:most]))
    return shown if len(numbers) <= most else f"{shown}, …"
