"""Pushes in Drake: the line they hold, the force they feel, the guards that end them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest

from objectmodels import ObjectModel, Registry
from planner.types.actions import Limits, Prediction, Push
from planner.types.plan import Plan
from sim import Trace, load_scene
from sim.simulated_executor import SimulatedExecutor
from sim.truth.scene_file import Pose, Scene
from tests.lone_objects import with_only
from tests.plans import changed_push, push_plan

GRAVITY = 9.81
PERIOD = 0.01  # of a sample of a trace [s]
CLEAR = Limits(clear_of=(("coffee box", 0.02),))


@dataclass(frozen=True)
class Asked:
    """A push through the middle of a face."""

    name: str
    face: str
    height: float
    fingers: int = 2
    stroke: float = 0.20
    force: float = 7.2  # what the planner would allow
    speed: float = 0.05
    ends_on: str = "stroke"


STRAIGHT = Asked("ice tea box", "front", 0.03)
ONE_FINGER = Asked("ice tea box", "front", 0.03, fingers=1)
"""Carried out once by a seed for the tests that look at them."""

NORMALS = {"front": (-1.0, 0.0), "back": (1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}


def _models(scene: Scene) -> dict[str, ObjectModel]:
    registry = Registry.default()
    return {item.name: registry.get(item.model) for item in scene.objects}


def _plan(asked: Asked, scene: Scene) -> Plan:
    model = _models(scene)[asked.name]
    yaw = np.radians(scene.object(asked.name).pose.yaw_deg)
    c, s = np.cos(yaw), np.sin(yaw)
    normal = np.array([*NORMALS[asked.face], 0.0])
    half = np.abs(normal) @ np.array(model.extents) / 2
    p_BC = half * normal + np.array([0.0, 0.0, asked.height])
    inward = np.array([-normal])
    onset = float(model.thresholds(p_BC[None], inward).onset[0])
    normal_W = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ normal
    push = Push.model_validate(
        {
            "object": asked.name,
            "face": asked.face,
            "p_BC": tuple(p_BC.tolist()),
            "normal_W": tuple(normal_W.tolist()),
            "direction_W": tuple((-normal_W).tolist()),
            "force_limit": asked.force,
            "speed": asked.speed,
            "stroke": asked.stroke,
            "fingers": asked.fingers,
            "spread": 0.04 if asked.fingers == 2 else 0.0,
            "ends_on": asked.ends_on,
        }
    )
    prediction = Prediction(
        outcome="slide" if asked.ends_on == "stroke" else "topple",
        onset=onset,
        slide_force=onset,
        topple_force=None,
        critical_height=None,
        critical_height_worst=None,
        probability=1.0,
        stay_on_base_angle=model.angle_of_no_return(-normal),
        tier="exact",
        friction="static",
    )
    return push_plan(push, prediction)


def _carried_out(asked: Asked, *, seed: int = 0) -> Trace:
    scene = with_only(load_scene("kitchen"), asked.name)
    return SimulatedExecutor(scene, seed=seed).execute(_plan(asked, scene), _models(scene))


_carried_out_once = cache(_carried_out)


@pytest.mark.parametrize(
    ("asked", "seed"),
    [
        (STRAIGHT, 0),
        pytest.param(ONE_FINGER, 0, marks=pytest.mark.slow),
        pytest.param(ONE_FINGER, 1, marks=pytest.mark.slow),
        pytest.param(
            Asked("cereal box", "left", 0.03, fingers=1, stroke=0.15), 2, marks=pytest.mark.slow
        ),
    ],
)
def test_a_straight_push_holds_its_line(asked: Asked, seed: int) -> None:
    trace = _carried_out_once(asked, seed=seed)
    assert trace.end == "stroke"
    moved = trace.displacement(asked.name)
    along = moved @ trace.direction
    across = np.linalg.norm(moved[:2] - along * trace.direction[:2])
    # The stroke is measured at fingertips that give way by less than a millimetre.
    assert along == pytest.approx(asked.stroke, abs=0.003)
    assert across < 0.004
    turned = np.degrees(trace.yaw(asked.name))
    assert abs(turned[-1]) < 2.0
    # Pushed beside its centre of friction an object goes straight only at an angle.
    assert np.abs(turned).max() < 10.0
    assert np.degrees(trace.tilt(asked.name).max()) < 1.0


def test_the_fingers_feel_the_friction_that_is_true() -> None:
    scene = load_scene("kitchen")
    truth = scene.object("ice tea box").truth
    trace = _carried_out_once(STRAIGHT, seed=0)
    moving = (trace.phase == "push") & (np.gradient(trace.push_force(), trace.time) < 1e9)
    pushing = np.flatnonzero(moving)[-200:-60]  # while it slides, before it slows down
    felt = trace.push_force()[pushing].mean()
    lift = sum(f[pushing, 2] for f in trace.felt.values()).mean()
    friction = truth.friction_table * (truth.mass_kg * GRAVITY - lift)
    # Joints that flex by a degree and the contact point on the sphere make 3 % together.
    assert felt == pytest.approx(friction, rel=0.04)


@pytest.mark.slow
def test_too_little_force_ends_the_push_where_it_began() -> None:
    asked = Asked("ice tea box", "front", 0.03, stroke=0.10, force=2.0)
    trace = _carried_out(asked)
    assert trace.end == "force"
    assert np.linalg.norm(trace.displacement("ice tea box")) < 0.002
    pushing = trace.phase == "push"
    # Filtered force against the limit: noise of the sensors, and no overshoot to speak of.
    assert np.convolve(trace.push_force()[pushing], np.ones(15) / 15, "valid").max() < 2.2


@pytest.mark.slow
def test_a_push_that_tips_instead_of_sliding_is_stopped_by_what_is_seen() -> None:
    asked = Asked("ice tea box", "front", 0.20, stroke=0.15, force=6.0)
    trace = _carried_out(asked)
    assert trace.end == "tilted"
    assert "tilt" in trace.detail
    # It fell back on its base.
    assert np.degrees(trace.tilt("ice tea box")[-1]) < 1.0
    assert 5.0 < np.degrees(trace.tilt("ice tea box").max()) < 21.0


@pytest.mark.slow
def test_a_topple_that_slides_is_stopped() -> None:
    asked = Asked("coffee box", "front", 0.03, stroke=0.15, ends_on="toppled")
    trace = _carried_out(asked)
    assert trace.end == "slid"
    assert "slides" in trace.detail
    assert trace.displacement("coffee box") @ trace.direction < 0.06


@pytest.mark.slow
def test_nothing_to_touch() -> None:
    scene = with_only(load_scene("kitchen"), "ice tea box")
    far = _plan(Asked("ice tea box", "front", 0.03), scene)
    # The contact is believed 8 cm before the face that is there.
    x, y, z = far.push.p_BC
    moved = changed_push(far, p_BC=(x - 0.08, y, z))
    trace = SimulatedExecutor(scene).execute(moved, _models(scene))
    assert trace.end == "no_touch"
    assert np.linalg.norm(trace.displacement("ice tea box")) < 1e-4


@pytest.mark.slow
def test_the_same_seed_gives_the_same_trace() -> None:
    one, other = (_carried_out_once(ONE_FINGER, seed=seed) for seed in (0, 1))
    same = _carried_out(ONE_FINGER, seed=0)
    np.testing.assert_array_equal(one.poses["ice tea box"], same.poses["ice tea box"])
    np.testing.assert_array_equal(one.push_force(), same.push_force())
    n = min(len(one.time), len(other.time))
    assert np.abs(one.push_force()[:n] - other.push_force()[:n]).max() > 0.0


@pytest.mark.slow
def test_only_the_pushing_fingertips_touch_the_object() -> None:
    trace = _carried_out(Asked("cereal box", "front", 0.03, stroke=0.10, force=3.0))
    touching = {body for event in trace.contacts for body in (event.body_a, event.body_b)} - {
        "cereal box"
    }
    assert touching == {f"{finger}_tip" for finger in trace.tips}


def _errors(trace: Trace, asked: Asked) -> tuple[float, float, float]:
    """Along and across the push [mm], and the turn [°]."""
    along = trace.displacement(asked.name) @ trace.direction
    across = trace.displacement(asked.name)[:2] @ [-trace.direction[1], trace.direction[0]]
    turned = np.degrees(trace.yaw(asked.name)[-1])
    return float(1e3 * (along - asked.stroke)), float(1e3 * across), float(turned)


@pytest.mark.slow
@pytest.mark.parametrize("turn", [-5.0, 4.0])
def test_a_straight_push_squares_the_object_to_the_fingers(turn: float) -> None:
    asked = Asked("ice tea box", "front", 0.03, stroke=0.05)
    scene = with_only(load_scene("kitchen"), asked.name)
    plan = changed_push(_plan(asked, scene), turn=np.radians(turn))
    trace = SimulatedExecutor(scene).execute(plan, _models(scene))
    along, across, turned = _errors(trace, asked)
    assert trace.end == "stroke"
    # The goals for displacements; where the middle swings to is known from the camera alone.
    assert turned == pytest.approx(turn, abs=2.0)
    assert abs(along) < 3.0
    assert abs(across) < 3.0


@pytest.mark.slow
def test_one_finger_keeps_a_round_object_on_its_line() -> None:
    asked = Asked("soup can", "front", 0.03, fingers=1, stroke=0.15)
    scene = with_only(load_scene("counter"), asked.name)
    trace = SimulatedExecutor(scene, seed=1).execute(_plan(asked, scene), _models(scene))
    along, across, turned = _errors(trace, asked)
    assert trace.end == "stroke"
    assert abs(along) < 1.0
    assert abs(across) < 4.0
    assert abs(turned) < 3.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes", [{"until": "touching", "meets": "coffee box"}, {"limits": CLEAR}]
)
def test_a_push_meets_another_object_or_stays_clear_of_it(changes: dict[str, Any]) -> None:
    scene = load_scene("kitchen")
    # The coffee box stands 60 mm behind the ice tea box, both of them straight.
    places = {"ice tea box": (0.45, 0.0), "coffee box": (0.45 + 0.045 + 0.06 + 0.031, 0.0)}
    objects = [
        item.model_copy(update={"pose": Pose(x_m=places[item.name][0], y_m=places[item.name][1])})
        if item.name in places
        else item
        for item in scene.objects
    ]
    scene = scene.model_copy(update={"objects": tuple(objects)})
    asked = Asked("ice tea box", "front", 0.03, stroke=0.12)
    trace = SimulatedExecutor(scene).execute(
        changed_push(_plan(asked, scene), **changes), _models(scene)
    )
    come = 1e3 * trace.displacement("ice tea box")[0]
    met = 1e3 * trace.displacement("coffee box")[0]
    if "until" in changes:
        assert trace.end == "event"
        # What a millimetre of doubt and 50 ms of a filter let it move.
        assert 0.0 < met < 5.0
        assert come == pytest.approx(60.0 + met, abs=1.0)
    else:
        assert trace.end == "too_close"
        assert abs(met) < 0.1
        assert 60.0 - 20.0 - 4.5 < come < 60.0 - 20.0


@pytest.mark.slow
def test_the_felt_force_stays_below_a_limit_that_just_suffices() -> None:
    asked = Asked("ice tea box", "front", 0.03, stroke=0.06)
    scene = with_only(load_scene("kitchen"), asked.name)
    plan = _plan(asked, scene)
    needed = 3.75  # 0.345 of 1.06 kg, and what the fingers press down
    limited = changed_push(plan, force_limit=1.35 * needed)
    trace = SimulatedExecutor(scene).execute(limited, _models(scene))
    assert trace.end == "stroke"
    pushing = trace.phase == "push"
    felt = np.convolve(trace.push_force()[pushing], np.ones(10) / 10, "valid")
    assert felt.max() < limited.push.force_limit
    speed = np.gradient(trace.poses["ice tea box"][pushing, 4], trace.time[pushing])
    # The plan's speed, and what the fingers' springs add while the object starts to slide.
    assert np.convolve(speed, np.ones(10) / 10, "valid").max() < 1.1 * limited.push.speed


def test_the_phases_of_a_push_keep_their_times_and_speeds() -> None:
    trace = _carried_out_once(STRAIGHT, seed=0)
    lasts = {name: PERIOD * (trace.phase == name).sum() for name in set(trace.phase)}
    assert (lasts["look"], lasts["settle"]) == pytest.approx((1.0, 0.5), abs=0.02)
    along = np.mean(list(trace.tips.values()), axis=0) @ trace.direction
    speed = np.convolve(np.gradient(along, trace.time), np.ones(10) / 10, "same")
    touch = speed[trace.phase == "touch"]
    # The hand stops swinging first, then comes slowly enough to stop within a millimetre.
    assert np.abs(touch[30:45]).max() < 0.003
    assert np.median(touch[80:]) == pytest.approx(0.015, rel=0.1)


def test_a_push_slows_down_before_its_end() -> None:
    trace = _carried_out_once(STRAIGHT, seed=0)
    pushing = trace.phase == "push"
    place = trace.poses[STRAIGHT.name][pushing, 4]
    remaining = STRAIGHT.stroke - (place - place[0])
    speed = -np.gradient(remaining, trace.time[pushing])
    braking = (remaining > 0.008) & (remaining < 0.025)
    # It stops within two thirds of a second's way at any speed, and creeps up to the end.
    assert (speed[braking] / remaining[braking]).mean() == pytest.approx(1.5, rel=0.08)
    creeping = (remaining > 0.001) & (remaining < 0.004)
    assert speed[creeping].mean() == pytest.approx(0.008, rel=0.1)
