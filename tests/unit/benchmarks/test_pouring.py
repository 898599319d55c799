"""Pours of the benchmark: predicted within what is promised, and the motion is what it says."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.engines.agreement import error_table, run_case
from benchmarks.engines.hand_work import RAMP, pours


@pytest.mark.slow
def test_predictions_keep_the_promise() -> None:
    cases = pours(3, 3)
    trials = [run_case(case, band=0.0, rolls_close=False) for case in cases]
    assert all(trial.is_right for trial in trials)
    assert "| prism, poured, % | 3 |" in error_table(trials)
    for case in cases:
        volumes = case.run_volumes()
        assert volumes["poured"] > 0.1 * case.source[1]
        assert volumes["received"] + volumes["spilled"] == pytest.approx(volumes["poured"])


def test_the_motion_goes_there_and_back() -> None:
    (case,) = pours(1, 0)
    there = case.angle / case.rate
    times = np.arange(0.0, 2.0 * there + case.wait + 2.0 * RAMP, 0.001)
    tilt = case.tilts(times)
    assert tilt[0] == tilt[-1] == 0.0
    assert tilt.max() == pytest.approx(case.angle)
    rates = np.diff(tilt) / 0.001
    assert np.abs(rates).max() == pytest.approx(case.rate, rel=1e-3)
    # It comes up to the rate within the ramp, in steps of a twentieth.
    assert np.abs(np.diff(rates)).max() < 0.1 * case.rate
