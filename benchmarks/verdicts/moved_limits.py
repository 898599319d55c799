"""Verdicts on limits that are moved near to what truly happened.

Of clauses that are carried out as asked nearly all hold, and by a wide margin; how a verdict does
near its limit shows where the limit is moved there: by up to `REACH` of what the robot cannot tell,
to either side of the truth. Some half of the clauses fail then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from nlcontrol.checks.own_verdicts import ToldClause
from nlcontrol.checks.verdicts import Check, holds

REACH = 4.0
"""Of half the range [low, high] by which a limit is moved at most."""

Row = dict[str, Any]


def moved_limits(
    told: ToldClause, true: Check, times: int, rng: np.random.Generator
) -> Iterator[Row]:
    """Verdicts on limits near the truth, as rows.

    Args:
        told: what the robot's senses tell of a clause.
        true: an observer's check of the same clause.
        times: how many limits.
        rng: of the limits.
    """
    own = told.verdict()
    if own.low is None or own.high is None or not isinstance(true.measured, float):
        return
    half = max(0.5 * (own.high - own.low), 1e-6)
    for u in rng.uniform(-REACH, REACH, times):
        # A value asked “about” has two limits; the nearer one is at its tolerance.
        side = 0.0 if true.relation != "about" else (own.tolerance or 0.0) * rng.choice([-1, 1])
        limit = true.measured + side + u * half
        if limit < 0.0 <= true.measured:
            continue
        ok = holds(true.relation, limit, true.measured, true.tolerance or 0.0)
        moved = replace(
            told,
            mean=_asked(told.mean, limit),
            drawn=[None if one is None else _asked(one, limit) for one in told.drawn],
        ).verdict()
        yield {"quantity": own.quantity, "ok": ok, "verdict": moved.verdict}


def _asked(check: Check, limit: float) -> Check:
    if check.verdict == "unknown" or not isinstance(check.measured, float):
        return check
    ok = holds(check.relation, limit, check.measured, check.tolerance or 0.0)
    verdict = "held" if ok else "not_held"
    return check.model_copy(update={"expected": limit, "ok": ok, "verdict": verdict})
