"""Pours of the benchmark: predicted within what is promised, and the motion is what it says."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.pouring import PROMISED, RAMP, motion, one, random_case, table


@pytest.mark.slow
def test_predictions_keep_the_promise() -> None:
    results = [one((3, i)) for i in range(3)]
    for result in results:
        assert max(abs(off) for off in result.off.values()) <= PROMISED
        assert result.volumes["poured"] > 0.1 * result.case.source[1]
        both = result.volumes["received"] + result.volumes["spilled"]
        assert both == pytest.approx(result.volumes["poured"])
    assert "| poured, all | 3 |" in table(results)


def test_the_motion_goes_there_and_back() -> None:
    case = random_case(np.random.default_rng(0))
    there = case.angle / case.rate
    times = np.arange(0.0, 2.0 * there + case.wait + 2.0 * RAMP, 0.001)
    tilt = motion(case, times)
    assert tilt[0] == tilt[-1] == 0.0
    assert tilt.max() == pytest.approx(case.angle)
    rates = np.diff(tilt) / 0.001
    assert np.abs(rates).max() == pytest.approx(case.rate, rel=1e-3)
    # It comes up to the rate within the ramp, in steps of a twentieth.
    assert np.abs(np.diff(rates)).max() < 0.1 * case.rate
