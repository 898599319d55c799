"""Random refusals, a few of those that `benchmarks.refusals` draws."""

from __future__ import annotations

import pytest

from benchmarks.refusals import run


@pytest.mark.parametrize("seed", range(6))
def test_a_drawn_refusal_has_no_fault(seed: int) -> None:
    row = run(seed)
    assert row.faults == ()
    assert row == run(seed)
