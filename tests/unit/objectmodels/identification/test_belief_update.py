"""Guess, touch, update; and the choice of the next touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import ModelError, ObjectModel
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification import (
    Candidate,
    Trial,
    belief_after_trial,
    fit,
    initial_belief,
    is_precise_enough,
    parameter_precisions,
    rank_candidates,
    update_belief,
)
from tests.unit.objectmodels.identification.touching import (
    BELIEF,
    SIDES,
    TRUTH,
    everything,
    slide,
    slip,
    tilt,
    touched,
)

SEEDS = 50


def off_by_two(rng: np.random.Generator, com_sd: float) -> tuple[ObjectModel, ObjectModel]:
    """An object whose centre of mass is not quite known, and a guess off by a factor of two."""
    x, y = rng.normal(0.0, com_sd, 2).tolist()
    truth = TRUTH.model_copy(update={"com": (x, y, 0.115)})
    mass, friction = rng.choice([0.5, 2.0], 2) * (truth.mass, truth.friction)
    belief = truth.model_copy(
        update={"mass": float(mass), "friction": float(friction), "com": (0.0, 0.0, 0.115),
                "com_sd": (com_sd, com_sd, 0.02)}
    )  # fmt: skip
    return truth, initial_belief(belief)


@pytest.mark.parametrize(
    ("com_sd", "sides", "exact"),
    [(0.001, ["front"], False), (0.001, ["front"], True), (0.003, ["front", "back"], False)],
    ids=["one tilt", "one tilt, exact", "opposite tilts"],
)
@pytest.mark.slow
def test_few_touches_mend_a_guess_off_by_two(com_sd: float, sides: list[str], exact: bool) -> None:
    """One side tells the mass by as much as it is known where that is: 1 mm for 2 %."""
    mended = 0
    for seed in range(SEEDS):
        truth, belief = off_by_two(np.random.default_rng(seed), com_sd)
        plan = [*(tilt(side) for side in sides), slide()]
        for trial in touched(truth, plan, seed=seed, exact=exact):
            belief = belief_after_trial(belief, trial, exact=exact)
        errors = [belief.mass / truth.mass - 1.0, belief.friction / truth.friction - 1.0]
        mended += max(map(abs, errors)) < 0.05
    assert mended >= 0.9 * SEEDS


def test_the_belief_is_as_sure_as_it_is_right() -> None:
    off = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        belief: ObjectModel = BELIEF.model_copy(update={"mass_sd": 0.15, "friction_sd": 0.025})
        x = belief.means + belief.deviations * rng.normal(size=7) * np.array([1, 1, 1, 0, 1, 1, 1])
        mass, friction, finger, radius, *com = x.tolist()
        truth = belief.model_copy(
            update={"mass": mass, "friction": friction, "finger_friction": finger,
                    "friction_radius": radius, "com": tuple(com)}
        )  # fmt: skip
        for trial in touched(truth, [tilt(), slide(turn=False), slip()], seed=seed):
            belief = belief_after_trial(belief, trial, exact=False)
        off.append((belief.means - truth.means) / belief.deviations)
    spread = np.sqrt(np.mean(np.square(off), axis=0))[[0, 1, 2]]
    # 200 runs tell a standard deviation to 5 %; normal in the logarithm is not normal.
    np.testing.assert_allclose(spread, 1.0, atol=0.2)


def test_one_after_the_other_is_all_together() -> None:
    trials = touched(TRUTH, everything(1), seed=4)
    belief = initial_belief(BELIEF)
    for trial in trials:
        belief = belief_after_trial(belief, trial, exact=False)
    whole = update_belief(initial_belief(BELIEF), trials, exact=False).model
    # Each step is linearised where it ends, so a hair of difference is left.
    np.testing.assert_allclose(belief.means, whole.means, rtol=0.005, atol=1e-4)
    np.testing.assert_allclose(belief.deviations, whole.deviations, rtol=0.05)
    joint = fit(initial_belief(BELIEF), trials, prior=True, exact=False)
    np.testing.assert_allclose(list(joint.values.values()), whole.means, rtol=0.005, atol=1e-4)


def test_a_surprise_is_counted_in_standard_deviations() -> None:
    belief = initial_belief(BELIEF)
    usual = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        x = belief.mass * 2.0 ** rng.standard_normal()
        truth = belief.model_copy(update={"mass": x})
        usual.append(
            update_belief(belief, touched(truth, [tilt()], seed=seed), exact=False).surprise
        )
    assert np.sqrt(np.mean(np.square(usual))) == pytest.approx(1.0, abs=0.2)  # 100 draws: 7 %


def test_what_contradicts_the_belief_is_known_for_it() -> None:
    belief = update_belief(
        initial_belief(BELIEF), touched(TRUTH, everything(), seed=0), exact=False
    ).model
    (usual,) = touched(TRUTH, [slide()], seed=1)
    x, y, z = usual.force
    assert not update_belief(belief, [usual], exact=False).is_contradiction
    for factor in (0.5, 2.0):
        odd = replace(usual, force=(factor * x, factor * y, factor * z))
        for exact in (False, True):
            assert update_belief(belief, [odd], exact=exact).is_contradiction


def test_the_spread_of_friction_stays_however_often_it_slides() -> None:
    believed: ObjectModel = BELIEF.model_copy(update={"mass": TRUTH.mass, "mass_sd": 0.001})
    for trial in touched(TRUTH, 60 * [slide(turn=False)], seed=2, spread=0.18):
        believed = belief_after_trial(believed, trial, exact=False, spread=0.18)
    assert believed.friction_sd / believed.friction == pytest.approx(0.18, rel=0.05)
    mean_sd = parameter_precisions(believed, ["friction"], spread=0.18)["friction"]
    assert mean_sd == pytest.approx(0.18 / np.sqrt(60), rel=0.15)
    assert believed.friction == pytest.approx(TRUTH.friction, rel=3.0 * mean_sd)


def test_what_is_certain_stays() -> None:
    certain = BELIEF.model_copy(update={"com_sd": (0.0, 0.0, 0.0)})
    assert belief_after_trial(certain, touched(TRUTH, [tilt()])[0]).com == certain.com


def test_a_guess_is_off_by_its_factor() -> None:
    guessed = initial_belief(BELIEF, 2.0, ("mass",))
    assert guessed.mass_sd / guessed.mass == pytest.approx(np.log(2.0))
    assert guessed.friction_sd == pytest.approx(BELIEF.friction_sd)
    for factor, name in ((0.5, "mass"), (2.0, "com_x")):
        with pytest.raises(ModelError) as caught:
            initial_belief(BELIEF, factor, (name,))
        assert caught.value.code == "bad_value"


CANDIDATES = [
    *(Candidate(f"tilt {side}", (tilt(side),)) for side in SIDES),
    Candidate("lean", (tilt(angle=0.15),)),
    Candidate("slide", (slide(turn=False),)),
    Candidate("off-centre", (slide(0.03),)),
    Candidate("rub", (slip(),)),
]


@pytest.mark.parametrize(
    ("wanted", "known", "first"),
    [
        ("finger_friction", [], {"rub"}),
        ("friction_radius", [], {"off-centre"}),
        ("mass", [], {f"tilt {side}" for side in SIDES}),
        ("mass", [tilt("front")], {"tilt back"}),
        ("com_y", [tilt("right")], {"tilt left"}),
        ("com_z", [tilt(side) for side in SIDES], {"lean"}),
        ("friction", [tilt("front"), tilt("back")], {"slide", "off-centre"}),
    ],
)
def test_the_experiment_that_tells_most_comes_first(
    wanted: str, known: list[Trial], first: set[str]
) -> None:
    belief = initial_belief(BELIEF)
    for trial in touched(TRUTH, known, seed=0) if known else []:
        belief = belief_after_trial(belief, trial, exact=False)
    assert rank_candidates(belief, CANDIDATES, [wanted])[0].candidate.name in first


def test_what_is_foreseen_is_what_comes() -> None:
    belief = initial_belief(BELIEF)
    worth = rank_candidates(belief, [Candidate("tilt", (tilt(),))], ["mass"])[0]
    # Foreseen where the belief is, so for a signal of another size.
    after = belief_after_trial(belief, touched(belief, [tilt()])[0], exact=False)
    assert worth.precisions["mass"] == pytest.approx(parameter_precisions(after)["mass"], rel=1e-3)


def test_precise_enough_is_worth_nothing_and_costs_count() -> None:
    belief = initial_belief(BELIEF)
    slack = dict.fromkeys(UNCERTAIN, 10.0)
    assert all(worth.gain == 0.0 for worth in rank_candidates(belief, CANDIDATES, slack))
    dear = [replace(c, cost=100.0 if c.name == "tilt front" else 1.0) for c in CANDIDATES]
    assert rank_candidates(belief, dear, ["mass"])[-1].candidate.name != "tilt back"
    assert rank_candidates(belief, dear[:2], ["mass"])[0].candidate.name == "tilt back"


def test_touching_by_the_ranking_reaches_the_precision_asked() -> None:
    asked = {"mass": 0.01, "friction": 0.02, "friction_radius": 0.05, "com_x": 0.002,
             "com_z": 0.01, "finger_friction": 0.05}  # fmt: skip
    belief, rng = initial_belief(BELIEF), np.random.default_rng(0)
    assert not is_precise_enough(belief, asked)
    for _ in range(15):
        best = rank_candidates(belief, CANDIDATES, asked)[0]
        seed = int(rng.integers(1000))
        belief = update_belief(
            belief, touched(TRUTH, best.candidate.trials, seed=seed), exact=False
        ).model
        if is_precise_enough(belief, asked):
            break
    assert is_precise_enough(belief, asked)
    for name, precision in asked.items():
        error = dict(zip(UNCERTAIN, belief.means - TRUTH.means, strict=True))[name]
        size = 1.0 if name.startswith("com") else dict(
            zip(UNCERTAIN, TRUTH.means, strict=True))[name]  # fmt: skip
        assert abs(error) < 3.0 * precision * size


def test_nonsense_is_refused() -> None:
    with pytest.raises(ModelError) as caught:
        rank_candidates(BELIEF, [], ["mass"])
    assert caught.value.code == "no_candidates"
    with pytest.raises(ModelError, match="weigth"):
        rank_candidates(BELIEF, CANDIDATES, ["weigth"])
    with pytest.raises(ModelError, match="cost"):
        rank_candidates(BELIEF, [Candidate("c", (tilt(),), cost=0.0)], ["mass"])
