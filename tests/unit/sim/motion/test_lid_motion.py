"""Lids that come off, held by a knob or a rim: what the hand closes about, and its way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.models.object_parts import LiftOffLid, ScrewCap
from planner.types.actions import Action, Aim, Carry, Grasp, LiftUp, PutOn, SetDown, TurnCap
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.motion.held_object_path import HeldObject
from sim.motion.robot_reach import ArmHandReach
from sim.robots.finger_kinematics import finger_points
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import load_scene
from tests.plans import EASY_TURN, hand_plan
from tests.unit.sim.grasp_table import held_segments

JAR, BOTTLE = "jar", "water bottle"
AT = {JAR: (0.25, -0.32), BOTTLE: (0.80, 0.40)}
TURN = TurnCap(angle=math.tau, torque_limit=0.1, prediction=EASY_TURN)


def state_of(name: str, lid_at: tuple[float, float, float] | None = None) -> WorldState:
    seen = SeenObject(
        name, PlanarPose(*AT[name], 0.2), Registry.built_in().get(name), lid=0.0, lid_at=lid_at
    )
    return WorldState({name: seen})


def plan_of(name: str, *steps: Action, yaw: float = 0.0) -> Plan:
    model = Registry.built_in().get(name)
    lid = model.lid
    assert isinstance(lid, LiftOffLid | ScrewCap)
    if isinstance(lid, LiftOffLid):
        radius, z = lid.knob_radius, model.top + lid.height + 0.017
    else:
        radius, z = lid.radius, model.top + 0.0155
    grasp = Grasp(
        part="lid",
        p_BG=(0.0, 0.0, z),
        closing_W=(math.cos(yaw), math.sin(yaw), 0.0),
        approach_W=(0.0, 0.0, -1.0),
        width=2.0 * radius,
        squeeze=6.0,
        needed=3.0,
        strongest=10.0,
    )
    return hand_plan(name, grasp, *steps, speed=0.12, task="open")


def aside_of(name: str) -> tuple[Action, ...]:
    x, y = AT[name]
    to = Aim(x=x, y=y + (0.13 if y < 0.0 else -0.13))
    return LiftUp(height=0.04, hold=0.0), Carry(to=to), SetDown()


@pytest.mark.parametrize("width", [0.02, 0.024, 0.03, 0.05])
def test_a_pinch_does_not_hang_below_its_fingertips(width: float) -> None:
    grip = HAND.grasp_posture(width, pinch=True)
    assert grip is not None
    assert grip.touching_fingers == ("thumb", "middle")
    for opening in (0.0, grip.opening):
        angles = grip.posture_at(opening).angles
        for finger in grip.touching_fingers:
            z = finger_points(finger, angles[finger])[:, 2]
            assert z.max() - grip.middle[2] < 0.002


def test_a_lid_is_an_object_of_its_own() -> None:
    handled = HeldObject.from_plan(plan_of(JAR, *aside_of(JAR)), state_of(JAR))
    assert handled.held.name == "jar lid"
    assert handled.name == JAR
    assert handled.height == handled.seat == pytest.approx(0.11)
    # In B the knob is held 17 mm over the disc, in the lid's own frame that is 25 mm up.
    assert handled.grasp.p_BG == pytest.approx((0.0, 0.0, 0.025))
    assert handled.grasped_obstacle.radius == pytest.approx(0.012)
    aside = HeldObject.from_plan(plan_of(JAR, *aside_of(JAR)), state_of(JAR, (0.4, 0.1, 0.0)))
    assert aside.height == 0.0
    assert aside.held.pose.p_WB == pytest.approx([0.4, 0.1, 0.0])


def test_a_cap_rises_on_its_thread_and_is_gripped_anew() -> None:
    handled = HeldObject.from_plan(plan_of(BOTTLE, TURN), state_of(BOTTLE))
    _, turning, back = held_segments(handled, np.array([0.0, 0.0, 0.05]))
    held, free = [[leg for leg in turning if leg.free is so] for so in (False, True)]
    assert sum(leg.turn for leg in held) == pytest.approx(math.tau)
    assert len(free) == len(held) - 1
    assert [leg.turn for leg in free] == pytest.approx([-held[0].turn] * len(free))
    assert held[-1].end[2] - held[0].start[2] == pytest.approx(handled.pitch)
    assert back  # the hand lets go at the end


def test_a_lid_is_put_onto_its_rim() -> None:
    x, y = AT[JAR]
    steps = (LiftUp(height=0.15), Carry(to=Aim(x=x, y=y)), PutOn(onto=JAR, press=2.0))
    handled = HeldObject.from_plan(plan_of(JAR, *steps), state_of(JAR, (x + 0.1, y + 0.1, 0.0)))
    *_, on, _ = held_segments(handled, np.array([0.0, 0.0, 0.05]))
    assert on[-1].end == pytest.approx([x, y, 0.11])


@pytest.mark.parametrize("name", [JAR, BOTTLE])
def test_the_arm_reaches_lids_that_stand_away_from_below_it(name: str) -> None:
    reach = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
    steps = aside_of(name) if name == JAR else (TURN, *aside_of(name))
    found = [
        reach.reach_plan(plan_of(name, *steps, yaw=math.radians(yaw)), state_of(name))
        for yaw in range(0, 360, 60)
    ]
    assert any(answer.ok for answer in found)
