"""Outcome maps: the paper's Fig. 7 in numbers."""

from __future__ import annotations

import numpy as np
import pytest

import objectmodels.mechanics.outcome_map as outcome_map_module
from objectmodels import ModelError, Registry
from objectmodels.mechanics.outcome_map import OutcomeMap, outcome_map

TEA = Registry.built_in().get("ice tea box")
FRONT = TEA.faces()[2]


def chart(**options: object) -> OutcomeMap:
    return outcome_map(TEA, FRONT, **options)  # type: ignore[arg-type]


def test_the_paper_s_map_slides_below_and_topples_above_the_critical_height() -> None:
    m = chart(turning=False, band=0.0)
    np.testing.assert_array_equal(m.outcome == "slide", m.height < 0.045 / 0.378)
    np.testing.assert_array_equal(m.outcome == "topple", m.height > 0.045 / 0.378)
    # Sliding takes μ m g everywhere, toppling m g b / h: less, the higher.
    below = m.height < 0.119
    np.testing.assert_allclose(m.force[below], 0.378 * TEA.weight, rtol=1e-12)
    np.testing.assert_allclose(m.force[~below], TEA.weight * 0.045 / m.height[~below], rtol=1e-12)


def test_a_map_ends_5_mm_from_the_border_of_the_face() -> None:
    m = chart(turning=False)
    assert np.abs(m.lateral).max() == pytest.approx(0.5 * FRONT.width - 0.005, abs=1e-9)
    assert (m.height.min(), m.height.max()) == pytest.approx((0.005, TEA.top - 0.005), abs=1e-9)


def test_off_the_middle_it_turns_and_slides_by_less() -> None:
    m = chart()
    row = np.isclose(m.height, m.height.min())
    order = np.argsort(np.abs(m.lateral[row]))
    forces = m.force[row][order]
    assert (np.diff(forces) <= 1e-9).all()
    assert forces[-1] < 0.7 * forces[0]
    straight = chart(turning=False)
    assert (m.force <= straight.force * (1 + 1e-9)).all()


def test_the_band_is_what_it_says() -> None:
    m = chart(band=0.1)
    near = np.abs(m.slide - m.topple) <= 0.1 * m.force
    np.testing.assert_array_equal(m.outcome == "undecided", near)
    assert 0 < near.sum() < chart(band=0.3).outcome.tolist().count("undecided")


def test_a_level_asks_for_probability_instead() -> None:
    m = chart(turning=False, level=0.9)
    sure = np.maximum(m.likelihood.slide, m.likelihood.topple) >= 0.9
    np.testing.assert_array_equal(m.outcome == "undecided", ~sure)
    np.testing.assert_array_equal(m.is_safe("slide", 0.9), (m.outcome == "slide"))


def test_a_map_tells_by_what_its_probabilities_are() -> None:
    """Few contacts have the exact tier's each; many, on even pressure, are in between."""
    few, many = chart(level=0.9, spacing=0.06), chart(level=0.9, spacing=0.01)
    assert few.likelihood.method == "exact tier"
    assert many.likelihood.method.startswith("exact tier, interpolated between ")
    for m in (few, many):
        assert f"probabilities: {m.likelihood.method}" in m._repr_html_()
    assert "probabilities" not in chart(spacing=0.02)._repr_html_()  # by the band alone


def test_what_is_interpolated_is_near_the_exact_tier(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outcome_map_module, "MOST_DRAWN", 4_000)
    m = chart(spacing=0.015)
    assert "interpolated" in m.likelihood.method
    exact = m.model.likelihood(m.points, m.directions, exact=True)
    for name in ("none", "slide", "topple"):
        off = np.abs(getattr(m.likelihood, name) - getattr(exact, name))
        # A probability rises from 0 to 1 between two rows at worst; the closed form is off by 0.4.
        assert off.max() < 0.2
        assert off.mean() < 0.02
    total = m.likelihood.none + m.likelihood.slide + m.likelihood.topple
    np.testing.assert_allclose(total, 1.0, rtol=1e-12)  # rounding alone


def test_safe_regions_shrink_as_more_is_asked() -> None:
    m = chart()
    sizes = [int(m.is_safe("slide", p).sum()) for p in (0.5, 0.8, 0.95, 0.999)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > sizes[-1] > 0
    with pytest.raises(ModelError, match="slide or topple"):
        m.is_safe("lift", 0.9)


def test_contacts_are_spread_as_asked_and_stay_on_the_face() -> None:
    fine, coarse = chart(spacing=0.005), chart(spacing=0.02)
    assert len(fine.force) > 10 * len(coarse.force) / 1.5
    for m in (fine, coarse):
        assert FRONT.contains(m.lateral, m.height).all()
        assert (m.lateral == 0.0).any()  # the middle is where two fingers push


@pytest.mark.slow
def test_large_maps_ask_the_exact_tier_at_the_border_only() -> None:
    fine, coarse = chart(spacing=0.0015), chart(spacing=0.0135)
    # At places of both, near the border, the answer is the same.
    same = 0
    for i in range(len(coarse.force)):
        off = np.hypot(fine.lateral - coarse.lateral[i], fine.height - coarse.height[i])
        k = int(off.argmin())
        if off[k] < 1e-9 and abs(coarse.slide[i] / coarse.topple[i] - 1) < 0.1:
            assert fine.slide[k] == pytest.approx(coarse.slide[i], rel=1e-6)
            same += 1
    assert len(fine.force) > 5000
    assert same >= 1


@pytest.mark.parametrize(
    "options",
    [
        {"spacing": 0.0},
        {"spacing": float("nan")},
        {"spacing": 1e-5},
        {"band": 1.0},
        {"level": 0.2},
        {"direction": [-1.0, 0.0, 0.0]},
        {"direction": [1.0, 0.0]},
        {"direction": [0.0, 0.0, 0.0]},
    ],
)
def test_nonsense_is_refused(options: dict[str, object]) -> None:
    with pytest.raises(ModelError):
        chart(**options)
