"""Were refusals right? Some of a run are looked into by `benchmarks.goals.refusal_judge`."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.goals.cases import Done, Watched
from benchmarks.goals.refusal_judge import Refusal, Verdict, judge_refusal, second_search
from benchmarks.goals.sentences import beliefs_of, said
from benchmarks.goals.worlds import Job
from benchmarks.record import Kept, carried_out


class Doubt(NamedTuple):
    """A refusal to be looked into.

    Attributes:
        case: which case was refused.
        reason: its class.
        tries: roll-outs in each round of the search.
    """

    case: Job
    reason: str
    tries: int


class Confirmation(Kept[Doubt]):
    """What brute force found.

    Attributes:
        verdict: on the refusal.
        text: the sentence.
        refusal: what the robot said.
        found: what was found, or not.
    """

    verdict: Verdict
    text: str
    refusal: str
    found: str


def confirmed(
    results: Sequence[Done],
    most: int,
    *,
    executor: Executor | None,
    workers: int | None,
    record: Path | None,
    tries: int,
) -> str:
    """Looks into refusals, spread over the classes, and tells about them.

    Args:
        results: among which there are refusals.
        most: how many of them.
        executor: where; processes of this machine if not given.
        workers: how many.
        record: of the results; what is found is kept beside it.
        tries: roll-outs in each round of a search.
    """
    doubts = [Doubt(done.job, why, tries) for done, why in _sample(results, most)]
    beside = record and record.with_name(f"{record.stem}.confirmed{record.suffix}")
    found = carried_out(
        confirm,
        doubts,
        Confirmation,
        executor=executor,
        workers=workers,
        record=beside,
        told=_tell,
    )
    refused = sum(done.refused is not None for done in results)
    told = list(found.values())
    return f"{table(told)}\n{wrong_share(told, refused, len(results))}"


def _tell(found: Confirmation) -> None:
    case = found.job.case
    print(f"{case.seed}-{case.number} {found.job.reason} {found.verdict}", file=sys.stderr)


def _sample(results: Sequence[Done], most: int) -> list[tuple[Done, str]]:
    """The first of each class, then the second of each, and so on."""
    refused = [(done, done.refused) for done in results if done.refused is not None]
    met: Counter[str] = Counter()
    ranks = []
    for _, reason in refused:
        ranks.append(met[reason])
        met[reason] += 1
    order = sorted(range(len(refused)), key=lambda k: (ranks[k], k))
    return [refused[k] for k in order[:most]]


def table(found: Sequence[Confirmation]) -> str:
    """A line per class, and all about those that were not confirmed."""
    lines = [
        f"{'refused as':14} {'confirmed':>10} {'unlikely':>9} {'not':>5} {'not looked for':>15}"
        "  numbers"
    ]
    for reason in dict.fromkeys(each.job.reason for each in found):
        some = [each for each in found if each.job.reason == reason]
        counts = Counter(each.verdict for each in some)
        numbers = ", ".join(str(each.job.case.number) for each in some)
        lines.append(
            f"{reason:14} {counts['confirmed']:>10} {counts['unlikely']:>9}"
            f" {counts['unconfirmed']:>5} {counts['not looked for']:>15}  {numbers}"
        )
    for each in found:
        if each.verdict != "confirmed":
            case = each.job.case
            lines.append(
                f"{case.seed}-{case.number} {each.verdict}: “{each.text}”: {each.refusal}"
                f"\n  found: {each.found}"
            )
    return "\n".join(lines)


def wrong_share(found: Sequence[Confirmation], refused: int, cases: int) -> str:
    """Which share of all cases was wrongly refused, by those that were looked into.

    Args:
        found: about some refusals.
        refused: how many there were.
        cases: of which these were refused.
    """
    looked = sum(each.verdict != "not looked for" for each in found)
    wrong = sum(each.verdict == "unconfirmed" for each in found)
    share = wrong / max(looked, 1) * refused / max(cases, 1)
    return (
        f"wrongly refused: {wrong} of {looked} that were looked into, of {refused} refused of"
        f" {cases} cases: {share:.1%} of all cases"
    )


def confirm(doubt: Doubt) -> Confirmation:
    """Looks into one refusal."""
    scene, sentence = said(doubt.case)
    registry, seed = beliefs_of(doubt.case), doubt.case.seed
    robot, fresh = (Watched(scene, registry=registry, seed=seed) for _ in range(2))
    result = robot.say(sentence.text, plan_only=not doubt.case.executed)
    finding = judge_refusal(
        robot,
        Refusal(sentence.target, doubt.reason, doubt.tries),
        np.random.default_rng((seed, doubt.case.number, doubt.tries)),
        lambda: second_search(fresh, fresh.command(sentence.text)),
    )
    return Confirmation(
        job=doubt,
        verdict=finding.verdict,
        text=sentence.text,
        refusal=result.error.message if result.error else "",
        found=finding.found,
    )
