"""What hangs over a table's edge, by levers."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.mechanics.standing_balance import (
    TableEdge,
    TopLoad,
    edge_margins,
    largest_overhang,
    lying_probability,
    pinch_margin,
    touch_limits,
)

ROUNDED = 1e-12  # sums and quotients of a few lengths and forces
OFF = np.array([1.0, 0.0])  # the table

BOOK = BoxModel(
    name="book", size=(0.2, 0.3, 0.02), mass=0.5, friction=0.3, finger_friction=0.6,
    com=(0.01, 0.0, 0.01),
)  # fmt: skip


def pressed(x: float, force: float, along: float = 0.0) -> TopLoad:
    return TopLoad(np.array([x, 0.0]), force, along * OFF)


def test_it_hangs_over_as_far_as_its_centre_of_mass_is_from_its_side() -> None:
    assert largest_overhang(BOOK, OFF) == pytest.approx(0.09, abs=ROUNDED)
    assert largest_overhang(BOOK, -OFF, spare=0.02) == pytest.approx(0.09, abs=ROUNDED)
    for offset, lies in ((0.011, True), (0.009, False)):
        assert (edge_margins(BOOK, TableEdge(OFF, offset)).min() > 0.0) == lies


def test_a_fingertip_at_the_limit_brings_the_pressure_to_the_edge_and_one_below_to_the_far_side(
) -> None:  # fmt: skip
    edge, at = TableEdge(OFF, 0.03), np.array([0.06, 0.0])
    down, up = touch_limits(BOOK, edge, at)
    # Levers: G 2 cm = N 3 cm about the table's edge, G 11 cm = U 16 cm about the far side.
    assert down == pytest.approx(BOOK.weight * 2.0 / 3.0, abs=ROUNDED)
    assert up == pytest.approx(BOOK.weight * 11.0 / 16.0, abs=ROUNDED)
    assert edge_margins(BOOK, edge, pressed(0.06, down))[-1] == pytest.approx(0.0, abs=ROUNDED)
    assert edge_margins(BOOK, edge, pressed(0.06, -up)).min() == pytest.approx(0.0, abs=ROUNDED)
    assert touch_limits(BOOK, edge, np.array([0.02, 0.0]))[0] == np.inf
    assert touch_limits(BOOK, TableEdge(OFF, 0.0), at) == (0.0, 0.0)


def test_drawing_towards_the_edge_takes_from_the_margin_by_its_height() -> None:
    edge, N, F = TableEdge(OFF, 0.05), 5.0, 2.0
    lost = edge_margins(BOOK, edge, pressed(0.01, N)) - edge_margins(
        BOOK, edge, pressed(0.01, N, F)
    )
    assert lost[-1] == pytest.approx(0.02 * F / (BOOK.weight + N), abs=ROUNDED)


def test_the_probability_counts_the_centre_of_mass_and_the_edge() -> None:
    unsure = BOOK.model_copy(update={"com_sd": (0.003, 0.003, 0.0)})
    edge = TableEdge(OFF, 0.016)
    told = lying_probability(unsure, edge, edge_sd=0.004)
    rng = np.random.default_rng(0)
    x, d = rng.normal(0.01, 0.003, 100_000), rng.normal(0.016, 0.004, 100_000)
    # Of so many draws a standard deviation is 0.001.
    assert told == pytest.approx(float((x < d).mean()), abs=0.004)
    assert lying_probability(BOOK, edge) == pytest.approx(1.0)


def test_a_pinch_holds_level_between_two_forces_of_the_thumb() -> None:
    """A centre of mass L beyond the fingers, a thumb a behind them: |G L − N a| ≤ h μ_f N."""
    fingers = np.array([[0.06, -0.1], [0.06, 0.1]])
    thumb, G, L, a, friction = np.array([0.08, 0.0]), BOOK.weight, 0.05, 0.02, 0.02 * 0.6
    for press in (G * L / (a + friction), G * L / (a - friction)):
        at_limit = pinch_margin(BOOK, thumb, press, fingers)
        assert at_limit == pytest.approx(0.0, abs=ROUNDED)
    between = G * L / a
    assert pinch_margin(BOOK, thumb, between, fingers) > 0.005
    beside = pinch_margin(BOOK, thumb, between, fingers + np.array([0.0, 0.13]))
    # The pressure is then 3 cm beyond the end of the line of the fingers.
    assert beside == pytest.approx(0.02 * 0.6 * between / (G + between) - 0.03, abs=ROUNDED)
