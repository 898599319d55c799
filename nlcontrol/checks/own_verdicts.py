"""The verdict of a result is the robot's own; an observer's is told beside it.

Model: the same checks are made on every account that the robot's own senses allow
(`nlcontrol.checks.own_accounts`). A clause held if it holds on at least `SURE` of them, did not if
it holds on no more than the rest, and cannot be told in between. Noise only ever adds to what is a
largest value or a length, so a draw lies above the truth there; the mirror images of the draws
about their mean lie below it, and what is told has to be so for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.checks.frame_checks import check
from nlcontrol.checks.own_accounts import Knowledge, own_accounts
from nlcontrol.checks.verdicts import NOT_PERCEIVED, Check, Observed, Verdict, holds
from objectmodels.errors import ModelError
from sim.control.pose_tracks import CALM, WILD

if TYPE_CHECKING:
    from grammar.frames.command import Frame
    from sim.traces.trace import Trace

SURE = 0.975
"""Share of the accounts on which a clause holds that is told as held."""

_DIGITS = 9  # of what is told, in SI: the last ones depend on the machine's threads


def verdicts(frame: Frame, trace: Trace, known: Knowledge) -> tuple[Check, ...]:
    """The robot's own verdict on each clause, with the observer's where there is one.

    Args: as of `own_accounts.own_accounts`.

    Raises:
        ControlError: `uncheckable` if a clause has no check.
    """
    own = tuple(told.verdict() for told in told_clauses(frame, trace, known))
    if not trace.is_observed:
        return own
    true = check(frame, trace, known.models, known.table, defaults=known.defaults)
    if own and len(own) == len(true):
        return tuple(
            mine.model_copy(update={"observed": Observed(measured=seen.measured, ok=seen.ok)})
            for mine, seen in zip(own, true, strict=True)
        )
    return tuple(_untold(seen, Observed(measured=seen.measured, ok=seen.ok)) for seen in true)


def told_clauses(frame: Frame, trace: Trace, known: Knowledge) -> tuple[ToldClause, ...]:
    """What the robot's senses tell of each clause; nothing if it did not see the object at first.

    Args: as of `own_accounts.own_accounts`.
    """
    accounts = own_accounts(frame, trace, known)
    if accounts is None:
        return ()
    shown = accounts.draws[-1].poses.keys()
    believed = {name: model for name, model in known.models.items() if name in shown}
    doubts = {"unsure": accounts.unsure, "unseen": accounts.unseen}
    made = []
    for draw in accounts.draws:
        try:
            made.append(
                check(frame, draw, believed, known.table, defaults=known.defaults, **doubts)
            )
        except ModelError:
            made.append(())  # objects may stand in no draw as they cannot in truth
    *drawn, mean = made
    columns = [
        [checks[i] if len(checks) == len(mean) else None for checks in drawn]
        for i in range(len(mean))
    ]
    return tuple(
        ToldClause(each, column, accounts.hidden and _depends(column[CALM], column[WILD]))
        for each, column in zip(mean, columns, strict=True)
    )


@dataclass(frozen=True, eq=False)
class ToldClause:
    """What the robot's senses tell of one clause.

    Attributes:
        mean: its check on the mean of all accounts.
        drawn: its checks on each; None where an account does not tell.
        hidden: it depends on what the robot neither saw nor felt.
    """

    mean: Check
    drawn: Sequence[Check | None]
    hidden: bool

    def verdict(self) -> Check:
        """The robot's own verdict."""
        return _untold(self.mean) if self.hidden else _verdict(self.mean, self.drawn)


def _depends(calm: Sequence[Check | None], wild: Sequence[Check | None]) -> bool:
    """Whether a clause is told otherwise by accounts that differ in what was hidden alone."""
    told = [[one.measured for one in each if one is not None] for each in (calm, wild)]
    if not all(told) or any(isinstance(value, str) for each in told for value in each):
        return set(map(str, told[0])) != set(map(str, told[1]))
    apart = abs(float(np.median(told[0])) - float(np.median(told[1])))  # type: ignore[arg-type]
    # 1e-9: rounding of values that are the same, in SI.
    return apart > 2.0 * float(np.std(told[0])) + 1e-9  # type: ignore[arg-type]


def _untold(check: Check, observed: Observed | None = None) -> Check:
    """A clause of which the robot perceived too little."""
    return check.model_copy(
        update={
            "measured": NOT_PERCEIVED,
            "verdict": "unknown",
            "ok": False,
            "why": "not_perceived",
            "observed": observed,
        }
    )


def _verdict(mean: Check, drawn: Sequence[Check | None]) -> Check:
    """One clause, from its checks on the mean of all accounts and on each."""
    told = [
        one
        for one in drawn
        if one is not None and one.verdict != "unknown" and one.quantity == mean.quantity
    ]
    # Nine tenths of the accounts must tell a quantity at all.
    if mean.verdict == "unknown" or len(told) < 0.9 * len(drawn):
        return _untold(mean)
    held = [float(np.mean([one.ok for one in told]))]
    low = high = None
    may_hold = False
    if isinstance(mean.measured, float) and isinstance(mean.expected, float):
        expected = mean.expected
        values = np.array([one.measured for one in told], float)
        asked = np.array([one.expected for one in told], float)
        mirrored = 2.0 * mean.measured - values
        is_size = values.min() >= 0.0
        if mean.relation != "about" and is_size:
            mirrored = np.maximum(mirrored, 0.0)
        pairs = zip(asked, mirrored, strict=True)
        allowed = mean.tolerance or 0.0
        held.append(float(np.mean([holds(mean.relation, a, m, allowed) for a, m in pairs])))
        # Two standard deviations of a normal distribution.
        ranges = [np.quantile(some, (0.023, 0.977)) for some in (values, mirrored)]
        low, high = float(min(r[0] for r in ranges)), float(max(r[1] for r in ranges))
        # A size that is 0 may seem to be there by three standard deviations.
        if is_size and mean.measured < 3.0 * float(values.std()):
            low = min(low, 0.0)
        low, high = round(low, _DIGITS), round(high, _DIGITS)
        mean = mean.model_copy(update={"measured": round(mean.measured, _DIGITS)})
        # Few of the draws lie within a narrow band, also where nothing speaks against it.
        best = {"about": min(max(expected, low), high), "at_most": low, "at_least": high}
        may_hold = holds(mean.relation, expected, best[mean.relation], allowed)
    verdict: Verdict = "unknown"
    if min(held) >= SURE:
        verdict = "held"
    elif max(held) <= 1.0 - SURE and not may_hold:
        verdict = "not_held"
    why = "too_near" if verdict == "unknown" else None
    return mean.model_copy(
        update={"verdict": verdict, "ok": verdict == "held", "low": low, "high": high, "why": why}
    )
