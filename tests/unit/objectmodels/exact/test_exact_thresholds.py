"""The exact tier: springs, the friction limit, and where it must be the closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import BoxModel, CylinderModel, ModelError, Polygon, Registry
from objectmodels.exact import exact_thresholds
from objectmodels.exact.exact_thresholds import ExactThresholds, exact_codes
from objectmodels.exact.slide_search import CERTAIN
from objectmodels.exact.support_springs import Springs
from objectmodels.mechanics.friction_limit import friction_limit

CORNERS = Polygon.rectangle(0.09, 0.12).vertices
BOX = BoxModel(
    name="b", size=(0.09, 0.12, 0.2), mass=1.0, friction=0.4, com=(0.01, -0.01, 0.09),
    support="corners",
)  # fmt: skip


def loads(points: np.ndarray, weights: np.ndarray, q: np.ndarray) -> np.ndarray:
    guess = np.ones((len(points), q.shape[1]), dtype=bool)
    return Springs(points, weights).loads(q, np.zeros_like(q), guess)[0]


@given(st.integers(0, 2**32 - 1), st.integers(3, 9))
def test_springs_balance_press_and_are_linear_where_loaded(seed: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.05, 0.05, (k, 2))
    area = np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-3)
    if area < 2:
        return
    weights = rng.uniform(0.2, 3.0, k)
    q = (rng.dirichlet(np.ones(k), 20) @ points).T
    found = loads(points, weights, q)
    assert (found >= 0.0).all()
    np.testing.assert_allclose(found.sum(axis=0), 1.0, atol=1e-9)
    np.testing.assert_allclose(points.T @ found, q, atol=1e-10)  # of a base of 0.1 m
    for j in range(q.shape[1]):
        on = found[:, j] > 1e-9
        rows = np.column_stack((np.ones(on.sum()), points[on]))
        depth = found[on, j] / weights[on]
        plane, *_ = np.linalg.lstsq(rows, depth, rcond=None)
        np.testing.assert_allclose(rows @ plane, depth, atol=1e-6)
        if on.sum() >= 3 and np.linalg.matrix_rank(rows, tol=1e-3) == 3:
            lifted = np.column_stack((np.ones(k), points)) @ plane
            assert (lifted[~on] <= 1e-6).all()


def test_four_equal_loads_hold_a_pure_moment_by_their_distance() -> None:
    """A push far to the side is a moment: s · arm = μ Σ N_i r_i."""
    found = friction_limit(np.full((4, 1), 0.25), CORNERS[:, :1].copy(), CORNERS[:, 1:] - 1e4)
    assert found.ratio.item() * 1e4 == pytest.approx(0.075, rel=1e-4)  # of an arm of 10 km


def test_straight_through_the_centre_all_friction_resists() -> None:
    found = friction_limit(np.full((4, 1), 0.25), CORNERS[:, :1].copy(), CORNERS[:, 1:].copy())
    assert found.ratio.item() == pytest.approx(1.0, rel=1e-12)
    assert (found.turn.item(), found.across.item()) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_the_centre_of_rotation_may_be_a_point_that_carries() -> None:
    """A heavily loaded point stays, the light ones go around it."""
    n = np.array([[0.94], [0.02], [0.02], [0.02]])
    left = CORNERS[:, 1:] - 0.3
    found = friction_limit(n, CORNERS[:, :1].copy(), left)
    slip = found.slip_velocities(CORNERS[:, :1], left)
    np.testing.assert_allclose(np.hypot(*slip)[0], 0.0, atol=1e-12)
    assert np.hypot(found.along_i, found.across_i).max() <= 1.0 + 1e-12
    others = np.hypot(*(CORNERS - CORNERS[0]).T)
    assert found.ratio.item() == pytest.approx((n[:, 0] * others).sum() / abs(left[0, 0]), rel=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_bounds_meet_at_the_limit(seed: int) -> None:
    """No motion dissipates less, and the forces found balance a push of just that size."""
    rng = np.random.default_rng(seed)
    n = rng.dirichlet(np.ones(4), 5).T
    turn = rng.uniform(0, 2 * np.pi)
    c, s = np.cos(turn), np.sin(turn)
    along = (CORNERS @ [c, s])[:, None] * np.ones(5)
    left = (CORNERS @ [-s, c])[:, None] - rng.normal(scale=0.08, size=5)
    found = friction_limit(n, along, left)
    assert (found.residual <= 1e-9).all()
    for _ in range(40):
        beta, omega = rng.normal(size=5), rng.normal(scale=30.0, size=5)
        upper = (n * np.hypot(1.0 - omega * left, beta + omega * along)).sum(axis=0)
        assert (upper >= found.ratio * (1 - 1e-9)).all()
    np.testing.assert_allclose((n * found.along_i).sum(axis=0), found.ratio, rtol=1e-8)
    np.testing.assert_allclose((n * found.across_i).sum(axis=0), 0.0, atol=1e-9)
    moment = (n * (along * found.across_i - left * found.along_i)).sum(axis=0)
    np.testing.assert_allclose(moment, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["ice tea box", "water bottle", "ice tea cup"])
def test_classes_alone_are_those_of_the_thresholds(name: str) -> None:
    model, rng = Registry.built_in().get(name), np.random.default_rng(0)
    p = np.array(model.extents) * rng.uniform([-0.5, -0.5, 0.4], [0.5, 0.5, 1.0], (60, 3))
    u = rng.normal(size=(60, 3)) * [1.0, 1.0, 0.3]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    codes = model.thresholds(p, u, exact=True).code
    assert {1, 2} <= {*codes.tolist()}
    np.testing.assert_array_equal(exact_codes(model, p, u), codes)


@given(st.integers(0, 2**32 - 1))
def test_a_coarse_limit_lies_on_the_side_of_the_precise_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = rng.dirichlet(np.ones(20), 30).T
    along, left = rng.normal(scale=0.05, size=(2, 20, 30))
    precise = friction_limit(n, along, left).ratio
    compared = precise * rng.choice([0.5, 0.99, 0.9999, 1.0001, 1.01, 2.0], 30)
    coarse = friction_limit(n, along, left, compared).ratio
    np.testing.assert_array_equal(coarse > compared, precise > compared)
    assert (coarse >= precise * (1 - 1e-9)).all()  # a motion dissipates no less than the least


@pytest.mark.parametrize("name", ["ice tea box", "cereal box", "mug", "tea tin", "soup can"])
def test_without_turning_the_closed_form_is_exact(name: str) -> None:
    """Level pushes through the vertical line of the centre of mass."""
    model = Registry.built_in().get(name)
    h = np.linspace(0.02, 0.95, 12) * model.top
    turns = np.linspace(0, 2 * np.pi, 12)
    u = np.column_stack((np.cos(turns), np.sin(turns), 0 * turns))
    p = np.array([*model.com[:2], 0.0]) - 0.02 * u + h[:, None] * np.array([0, 0, 1])
    fast, exact = model.thresholds(p, u), model.thresholds(p, u, exact=True)
    np.testing.assert_allclose(exact.onset, fast.onset, rtol=1e-8)
    np.testing.assert_array_equal(exact.outcome, fast.outcome)


def test_where_it_topples_first_the_slide_threshold_lies_beyond() -> None:
    rng = np.random.default_rng(0)
    p = np.array(BOX.size) * rng.uniform([-0.5, -0.5, 0.3], [0.5, 0.5, 1.0], (300, 3))
    u = rng.normal(size=(300, 3)) * [1, 1, 0.3]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    t = BOX.thresholds(p, u, exact=True)
    topples = t.outcome == "topple"
    assert topples.sum() > 30
    assert (t.slide[topples] >= t.topple[topples] * (1 - 1e-8)).all()
    np.testing.assert_array_equal(t.onset, np.minimum(t.slide, t.topple))


def test_the_bounds_bracket_the_onset_and_meet_for_three_feet() -> None:
    rng = np.random.default_rng(1)
    p = np.array(BOX.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (200, 3))
    u = rng.normal(size=(200, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    feet = ((0.04, 0.0), (-0.04, 0.05), (-0.04, -0.05))
    shape = BOX.model_dump(include={"name", "size", "mass", "friction", "com"})
    for box in (BOX, BoxModel(**shape, support=feet)):
        t = box.thresholds(p, u, exact=True)
        assert isinstance(t, ExactThresholds)
        moves = np.isfinite(t.onset)
        assert (t.pessimistic[moves] <= t.onset[moves] * (1 + 1e-7)).all()
        assert (t.onset[moves] <= t.optimistic[moves] * (1 + 1e-7)).all()
        np.testing.assert_array_equal(np.isinf(t.optimistic), ~moves)
        spread = t.optimistic[moves] / t.pessimistic[moves]
        if box is BOX:
            assert spread.max() > 1.05  # how it stands matters for four feet
        else:
            assert spread.max() < 1.0 + 1e-6  # three feet leave no choice


@pytest.mark.parametrize("name", ["ice tea box", "coffee box"])
def test_an_evenly_pressed_base_may_bear_on_one_spot(name: str) -> None:
    """Straight through it, that resists as all of it; any push that passes it by turns it."""
    model, rng = Registry.built_in().get(name), np.random.default_rng(2)
    p = np.array(model.extents) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (60, 3))
    u = rng.normal(size=(60, 3))
    u[:20, 2] = 0.0
    p[:20, :2] = np.array(model.com[:2]) - 0.01 * u[:20, :2]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    t = model.thresholds(p, u, exact=True)
    # On the line through the spot the loads do not matter, but for their limit's precision.
    np.testing.assert_allclose(t.pessimistic[:20], t.onset[:20], rtol=1e-8)
    assert (t.pessimistic[20:] == 0.0).all()
    assert (t.onset <= t.optimistic).all()


def test_bounds_that_contradict_the_onset_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    t = BOX.thresholds([[-0.045, 0.03, 0.02]], [[1.0, 0.0, 0.0]], exact=True)
    wrong = {"worst_case_onset": 1.01, "best_case_onset": 0.99}
    for name, share in wrong.items():
        monkeypatch.setattr(exact_thresholds, name, lambda t, share=share: share * t.onset)
    for bound in ("pessimistic", "optimistic"):
        with pytest.raises(ModelError) as caught:
            getattr(t, bound)
        assert caught.value.code == "not_solved"


FEET = (
    # The third foot lifts as the fourth one lands, so that two bear all of it for a moment.
    ((0.11, 0.11, 0.15), 0.8835682962785806, (-0.009235, 0.03337, 0.05),
     ((0.009419, 0.031414), (-0.014536, 0.047105), (-0.049958, 0.023596), (0.033901, 0.022779)),
     (0.029555858664459138, 0.05029345857221625, 0.14115045040279184),
     (-0.10192367219548534, 0.9726412775015083, -0.20875945570541563), 0.80252692),
    # The centre of mass is a third of a millimetre inside of the feet.
    ((0.2, 0.2, 0.2), 0.2369972164644483, (-0.019164004234449337, -0.00740411843451534, 0.05),
     ((0.006980498437310745, -0.018639867640461917), (-0.02216568025828135, -0.006034864136077268),
      (0.005623828900900976, 0.04745444187531632), (0.015049593502393904, -0.027664279557881446)),
     (0.07099248308288392, 0.12372799402662771, 0.1), (0.1, -0.1, -1.0), 3.74965189),
    # It nearly slides just before it topples.
    ((0.17372396634808868, 0.1398403103287184, 0.28957590287865376), 0.8892789864684202,
     (0.007159842106354354, 0.007816298584778864, 0.09842826410446483),
     ((0.054411206886897656, -0.06851590420273206), (0.053481135809557656, 0.053407657542019746),
      (-0.026863638504931335, 0.05864313999254364), (0.034598500477650604, -0.0166658906361081),
      (-0.0824651848779317, 0.0050463999922311376), (-0.022119325817836655, 0.04158652879762158),
      (-0.06311935290146137, 0.03617299320375167), (-0.017687939931829683, -0.01881583381831633),
      (0.038282739997203774, -0.04015007750150479)),
     (-0.0776647498326012, -0.05907041424725309, 0.01244985876365038),
     (0.7466281572793997, -0.3563967613957411, -0.5617185622927152), 14.69362531),
)  # fmt: skip
"""Size, friction, centre of mass, feet, contact, direction, and the force at which it topples."""


@pytest.mark.parametrize(("size", "mu", "com", "feet", "p", "u", "topples"), FEET)
def test_feet_that_lift_and_land_make_no_slide(
    size: tuple[float, ...], mu: float, com: tuple[float, ...], feet: tuple[tuple[float, ...], ...],
    p: tuple[float, ...], u: tuple[float, ...], topples: float,
) -> None:  # fmt: skip
    stated = {"size": size, "friction": mu, "com": com, "support": feet}
    box = BoxModel.model_validate({"name": "b", "mass": 1.0, **stated})
    t = box.thresholds([p], [np.array(u) / np.linalg.norm(u)], exact=True)
    assert t.outcome.item() == "topple"
    assert t.onset.item() == pytest.approx(topples, rel=1e-8)  # of eight digits
    assert t.residual.item() <= CERTAIN
    assert t.pessimistic.item() <= t.onset.item() * (1 + 1e-9)
    assert t.onset.item() <= t.optimistic.item() * (1 + 1e-9)


def test_answers_on_random_feet_are_certain_and_within_their_bounds() -> None:
    """2,000 pushes; an answer that is not certain would be an error."""
    for number in range(40):
        rng = np.random.default_rng((7, number))
        k = int(rng.integers(3, 13))
        feet = rng.uniform(-0.06, 0.06, (k, 2))
        com = (*(rng.dirichlet(np.full(k, rng.choice([0.2, 1.0, 5.0]))) @ feet), 0.1)
        points = np.column_stack((feet, rng.uniform(0.2, 3.0, k)))
        stated = {"friction": rng.uniform(0.1, 1.2), "com": com, "support": points}
        shape = {"name": "b", "size": (0.12, 0.12, 0.2), "mass": 1.0}
        box = BoxModel.model_validate(shape | stated)
        p = np.array(box.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (50, 3))
        u = rng.normal(size=(50, 3)) * [1.0, 1.0, rng.choice([0.3, 1.0, 5.0])]
        t = box.thresholds(p, u / np.linalg.norm(u, axis=1, keepdims=True), exact=True)
        assert (t.residual <= CERTAIN).all()
        if number % 8 == 0:  # the bounds take longer
            moves = np.isfinite(t.onset)
            assert (t.pessimistic[moves] <= t.onset[moves] * (1 + 1e-6)).all()
            assert (t.onset[moves] <= t.optimistic[moves] * (1 + 1e-6)).all()


RIM = (
    (0.45547623113915764, 0.9704958401824909, (1.17782335e-03, 5.44157292e-05),
     (-0.01552506, -0.0285521, 0.09039922), (0.44625848, 0.8379379, -0.31418695)),
    (0.2715815408149435, 1.410941260785249, (-0.00027255, 0.00156868),
     (-0.00744581, 0.03163558, 0.13533947), (0.24971041, -0.92882467, 0.27373243)),
    (0.25862363145184836, 0.6894515324086551, (-6.58975001e-05, -1.74421337e-04),
     (0.00807811, 0.03148006, 0.12410252), (-0.23633208, -0.88078273, 0.41032783)),
)  # fmt: skip
"""Friction, share of the friction radius, centre of mass, contact and direction."""


@pytest.mark.parametrize(("mu", "share", "com", "p", "u"), RIM)
def test_near_tipping_one_point_of_a_rim_bears_nearly_all(
    mu: float, share: float, com: tuple[float, float], p: tuple[float, ...], u: tuple[float, ...]
) -> None:
    """There forces that nearly balance say little of the limit."""
    bottle = Registry.built_in().get("water bottle")
    drawn = {"friction": mu, "com": (*com, 0.09), "friction_radius": share * bottle.friction_radius}
    t = bottle.model_copy(update=drawn).thresholds(
        [p], [np.array(u) / np.linalg.norm(u)], exact=True
    )
    assert t.residual.item() <= CERTAIN
    assert t.outcome.item() == "slide"
    assert 0.98 < (t.slide / t.topple).item() < 1.0


def test_the_pessimistic_bound_holds_between_the_points_of_a_rim_and_the_rim() -> None:
    """There the load rests on no three of the points, and it slides before it tips."""
    can = CylinderModel(
        name="c", radius=0.069446, height=0.1111, mass=0.9701, friction=0.6454,
        com=(-0.0005974, -0.0031876, 0.06885), support="corners",
    )  # fmt: skip
    u = np.array([[-0.0520235, -0.0862475, 0.99491453]])
    p = [[-0.049514, -0.048694, 0.103374]]
    t = can.thresholds(p, u / np.linalg.norm(u), exact=True)
    assert t.slide.item() < t.topple.item()
    assert 0.99 < (t.pessimistic / t.onset).item() <= 1.0


def test_what_is_not_certain_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_thresholds, "CERTAIN", 1e-18)
    with pytest.raises(ModelError) as caught:
        BOX.thresholds([[-0.045, 0.03, 0.02]], [[1.0, 0.0, 0.0]], exact=True)
    assert caught.value.code == "not_solved"


def test_a_lightly_off_centre_can_spins_before_it_tips() -> None:
    """Near tipping a round base stands on one point, which resists no turning."""
    can = CylinderModel(
        name="c", radius=0.03, height=0.2, mass=1.0, friction=0.8, support="corners"
    )
    p, u = [[-0.028, 0.01, 0.15]], [[1.0, 0.0, 0.0]]
    assert can.thresholds(p, u).outcome.item() == "topple"
    exact = can.thresholds(p, u, exact=True)
    assert exact.outcome.item() == "slide"
    assert 0.9 < exact.slide.item() / exact.topple.item() < 1.0
    assert can.thresholds(p, u, exact="border").outcome.item() == "slide"


def test_equal_questions_get_equal_answers_whatever_stands_beside_them() -> None:
    rng = np.random.default_rng(3)
    p = np.array(BOX.size) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (50, 3))
    u = rng.normal(size=(50, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    together = BOX.thresholds(p, u, exact=True)
    singly = [
        BOX.thresholds(p[i : i + 1], u[i : i + 1], exact=True).slide.item() for i in range(50)
    ]
    np.testing.assert_allclose(together.slide, singly, rtol=1e-9)  # the limit's own precision


@pytest.mark.parametrize("exact", [False, True])
def test_the_centre_of_rotation_stands_still(exact: bool) -> None:
    p, u = [[-0.045, 0.03, 0.02], [-0.045, -0.01, 0.05]], [[1.0, 0.0, 0.0]] * 2
    t = BOX.thresholds(p, u, exact=exact)
    centre, twist = t.centre_of_rotation, t.twist
    # Pushed left of the centre of mass it turns right, about a point to the right of it.
    assert twist[0, 2] < 0.0
    assert centre[0, 1] < BOX.com[1]
    still = twist[0, 3:5] + twist[0, 2] * np.array([-centre[0, 1], centre[0, 0]])
    np.testing.assert_allclose(still, 0.0, atol=1e-9)
    assert np.isinf(centre[1]).all()  # straight through the centre of mass
