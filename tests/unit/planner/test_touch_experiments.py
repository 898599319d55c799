"""What is proposed to touch, and what each touch is expected to show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel, CylinderModel, ObjectModel, Registry
from objectmodels.identification.measurement_model import Balance
from planner.touch_experiments import Experiment, expected_trials, experiments
from planner.types.robot import RobotLimits
from planner.types.world_state import PlanarPose, SeenObject
from sim import load_scene
from sim.motion.robot_reach import ArmHandReach
from sim.robots.robots import ARM, HAND

MODELS = {model.name: model for model in Registry.built_in()}
LOW = "book"
BROAD = "storage bin"
"""It slides before it tips, however high it is pushed; its upper half is out of bounds."""
ROUND = {"ice tea cup", "jar", "mug", "soup can", "water bottle"}
FACES = ("front", "left", "back", "right")
YAWS = [0.0, 0.35, -2.0]


@pytest.fixture(scope="module")
def arm() -> RobotLimits:
    return ArmHandReach(load_scene("kitchen").cell, ARM, HAND).limits


def seen(model: ObjectModel, yaw: float = 0.0) -> SeenObject:
    return SeenObject(model.name, PlanarPose(0.5, 0.1, yaw), model)


def inward(experiment: Experiment) -> np.ndarray:
    """Direction of the push in B."""
    return np.asarray(experiment.R_WB.T @ np.array(experiment.push.direction_W))


@pytest.mark.parametrize("name", sorted(MODELS))
def test_what_is_proposed_for_the_built_in_objects(name: str, arm: RobotLimits) -> None:
    found = experiments(seen(MODELS[name]), arm)
    kinds = {experiment.kind for experiment in found}
    if name == LOW:
        assert kinds == set()  # the fingertip does not get below 1 cm under its top
        return
    assert kinds >= {"slide", "rub"}
    assert ("tilt" in kinds) == (name != BROAD)
    assert ("off-centre slide" in kinds) == (name not in ROUND)
    assert {experiment.push.face for experiment in found} == set(FACES)
    assert all(e.name == f"{e.kind} at the {e.push.face}" for e in found)


@pytest.mark.parametrize(("room", "beside"), [(0.0015, False), (0.003, True)])
def test_a_narrow_side_is_touched_in_its_middle_only(
    room: float, beside: bool, arm: RobotLimits
) -> None:
    width = 2.0 * (arm.fingertip_radius + room)
    narrow = BoxModel(name="box", size=(width, width, 0.12), mass=0.3, friction=0.3)
    kinds = {experiment.kind for experiment in experiments(seen(narrow), arm)}
    assert "slide" in kinds
    assert ("off-centre slide" in kinds) == beside


def test_a_slide_goes_beyond_what_fingers_give_way_and_not_far(arm: RobotLimits) -> None:
    slides = [e for e in experiments(seen(MODELS["ice tea box"]), arm) if "slide" in e.kind]
    assert slides
    # Friction is felt over a centimetre; the object stays where the next touch expects it.
    assert all(0.008 < e.push.stroke < 0.018 for e in slides)


@pytest.mark.parametrize("name", sorted(set(MODELS) - {LOW}))
def test_where_the_fingertip_touches_and_how_far_it_goes(name: str, arm: RobotLimits) -> None:
    model = MODELS[name]
    for e in experiments(seen(model, 0.35), arm):
        height, u = e.push.p_BC[2], inward(e)
        assert u[2] == 0.0
        assert np.dot(e.push.p_BC, u) < 0.0  # from outside towards the middle
        assert e.push.normal_W == pytest.approx(-np.array(e.push.direction_W))
        assert height >= arm.lowest_height - 1e-9  # rounding
        assert (e.push.fingers, e.push.ends_on) == (1, "stroke")
        assert (e.angle > 0.0, e.raised) == (e.kind == "tilt", 0.010 if e.kind == "rub" else 0.0)
        assert (e.lateral != 0.0) == (e.kind == "off-centre slide")
        if e.kind == "tilt":
            assert height == pytest.approx(model.top - 0.010)
            # Twice the believed deviation of the centre of mass may be against it.
            assert e.angle <= min(np.radians(8.0), 0.4 * model.angle_of_no_return(u, sigmas=2.0))
            # A face that leans by θ recedes by h tan θ; its edge below rises by a hair.
            assert e.push.stroke == pytest.approx(height * np.tan(e.angle), rel=0.1)
        elif e.kind == "rub":
            assert e.push.stroke == 0.0
        else:
            assert e.push.stroke == 0.012


@pytest.mark.parametrize("name", sorted(set(MODELS) - ROUND - {LOW}))
def test_off_centre_slides_are_low_at_one_end_and_as_high_as_is_sure_at_the_other(
    name: str, arm: RobotLimits
) -> None:
    model = MODELS[name]
    off = [e for e in experiments(seen(model), arm) if e.kind == "off-centre slide"]
    for low, high in zip(off[::2], off[1::2], strict=True):
        assert low.push.face == high.push.face
        assert low.lateral == -high.lateral > 0.0
        assert low.push.p_BC[2] == pytest.approx(arm.lowest_height)
        assert arm.lowest_height - 1e-9 <= high.push.p_BC[2] <= 0.5 * model.top
        surely = model.likelihood([high.push.p_BC], [inward(high)], exact=False).slide[0]
        # The lowest one is made whether it is sure or not.
        assert surely > 0.99 or high.push.p_BC[2] == pytest.approx(arm.lowest_height)
    assert name == BROAD or any(e.push.p_BC[2] > 1.5 * arm.lowest_height for e in off)


def test_nothing_is_touched_with_more_than_10_newtons_however_strong_the_hand(
    arm: RobotLimits,
) -> None:
    model = MODELS["ice tea box"]
    for strongest, most in ((30.0, 10.0), (9.5, 9.5)):
        found = experiments(seen(model), replace(arm, max_force=strongest))
        assert {e.push.force_limit for e in found} == {most}


def test_a_tilt_ends_at_two_fifths_of_the_way_to_a_fall(arm: RobotLimits) -> None:
    # It falls from 35 / 100 on; by two deviations it may be 30 / 110.
    tall = BoxModel(
        name="tall", size=(0.07, 0.07, 0.2), mass=0.3, friction=0.6, com=(0.0, 0.0, 0.1),
        com_sd=(0.0025, 0.0025, 0.005),
    )  # fmt: skip
    tilts = [e for e in experiments(seen(tall), arm) if e.kind == "tilt"]
    assert tilts
    for e in tilts:
        assert e.angle == pytest.approx(0.4 * np.arctan2(0.030, 0.110), rel=1e-9)


def test_no_tilt_where_it_cannot_tilt(arm: RobotLimits) -> None:
    tile = BoxModel(
        name="tile", size=(0.15, 0.06, 0.07), mass=0.5, mass_sd=0.02, friction=0.2,
        friction_sd=0.02,
    )  # fmt: skip
    tilts = {e.push.face for e in experiments(seen(tile), arm) if e.kind == "tilt"}
    # μ h is 12 mm: less than half the length, and at the narrow sides less than half the width.
    assert tilts == set()
    # Slippery or not: who does not know proposes it.
    unsure = tile.model_copy(update={"friction": 0.4, "friction_sd": 0.2})
    tilts = {e.push.face for e in experiments(seen(unsure), arm) if e.kind == "tilt"}
    assert tilts == {"left", "right"}


def test_none_beside_a_side_that_is_narrower_than_the_fingertip(arm: RobotLimits) -> None:
    plank = BoxModel(name="plank", size=(0.3, 0.015, 0.1), mass=0.5, friction=0.3)
    assert {e.push.face for e in experiments(seen(plank), arm)} == {"left", "right"}


@pytest.mark.parametrize("width", [0.02, 0.02 + 1e-9])
def test_a_side_as_wide_as_the_fingertip_has_no_ends(width: float, arm: RobotLimits) -> None:
    plank = BoxModel(name="plank", size=(0.3, width, 0.1), mass=0.5, friction=0.3)
    at_front = [e for e in experiments(seen(plank), arm) if e.push.face == "front"]
    assert [e.kind for e in at_front if "slide" in e.kind] == ["slide"]


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("name", sorted(set(MODELS) - {LOW}))
def test_what_is_expected_agrees_with_the_model(name: str, yaw: float, arm: RobotLimits) -> None:
    model = MODELS[name]
    for e in experiments(seen(model, yaw), arm):
        trials = expected_trials(e, model)
        balance = Balance(model, trials)
        predicted = balance.linear_predictions(model.means).predicted
        assert np.isfinite(predicted).all()
        for trial in trials:
            # It presses on the object, in the object's own axes.
            assert np.array(trial.force) @ inward(e) > 0.0
            assert trial.point == e.push.p_BC
            assert trial.source == e.name
        if e.kind == "tilt":
            small, large = predicted
            assert [trial.moved for trial in trials] == ["topple", "topple"]
            assert 0.0 < trials[0].tilt < trials[1].tilt < e.angle
            assert 0.0 < large < small  # the weight's lever shrinks with the tilt
        elif e.kind == "rub":
            assert [trial.moved for trial in trials] == ["slip"]
            assert predicted == pytest.approx(model.finger_friction)
            assert balance.observed == pytest.approx(model.finger_friction)
        else:
            (trial,) = trials
            assert trial.moved == "slide"
            assert predicted == pytest.approx(balance.observed, rel=1e-9, abs=1e-9)
            arm_z = np.cross(np.array(e.push.p_BC) - model.com, inward(e))[2]
            assert trial.turn_rate is not None
            turn, lever = np.sign(np.round([trial.turn_rate, arm_z], 9))
            assert turn == lever


def test_the_object_is_touched_at_the_same_places_however_it_stands(arm: RobotLimits) -> None:
    model = MODELS["cereal box"]

    def places(yaw: float) -> set[tuple[str, tuple[float, ...]]]:
        found = experiments(seen(model, yaw), arm)
        return {(e.kind, tuple(np.round([*e.push.p_BC, *inward(e)], 9) + 0.0)) for e in found}

    def faces(yaw: float) -> dict[str, float]:
        found = experiments(seen(model, yaw), arm)
        return {e.push.face: e.push.p_BC[1] for e in found if e.kind == "slide"}

    for yaw in YAWS:
        assert places(yaw) == places(0.0)
    # A quarter turn to the left: the side that looked left looks at the robot.
    assert faces(0.0)["left"] == pytest.approx(0.096)
    assert faces(np.pi / 2)["front"] == pytest.approx(0.096)


def test_a_round_side_is_touched_where_the_robot_stands(arm: RobotLimits) -> None:
    can = CylinderModel(name="can", radius=0.04, height=0.15, mass=0.4, friction=0.3)
    for yaw in YAWS:
        directions = [e.push.direction_W for e in experiments(seen(can, yaw), arm)]
        assert np.abs(np.round(directions, 9)).max(axis=1) == pytest.approx(1.0)


def test_another_belief_expects_another_turn(arm: RobotLimits) -> None:
    model = MODELS["ice tea box"]
    e = next(e for e in experiments(seen(model), arm) if e.kind == "off-centre slide")
    wide = model.model_copy(update={"friction_radius": 1.5 * model.friction_radius})
    (before,), (after,) = expected_trials(e, model), expected_trials(e, wide)
    assert before.turn_rate is not None
    assert after.turn_rate is not None
    assert 0.0 < after.turn_rate / before.turn_rate < 1.0
    assert replace(after, turn_rate=before.turn_rate) == before
