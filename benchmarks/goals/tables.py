"""What came of many cases, as tables."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from typing import get_args

import numpy as np

from benchmarks.goals.cases import Done, Stage
from benchmarks.goals.hard_worlds import SETTINGS
from benchmarks.goals.sentences import COMPOUND, Kind, setting_of


def report(results: Sequence[Done]) -> str:
    """All tables."""
    parts = (counts, settings, truths, refusals, times, failures)
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
