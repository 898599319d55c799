"""How near hand, arm and what is held come to things: as near as promised, and no nearer.

Something is brought nearer until the motion is refused. In the nearest place from which there is a
motion, its distance is what is promised, to the tenth of a millimetre to which places are tried.
Distances are those of the shapes of the hand and of the object itself.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest

from objectmodels import BoxModel, Registry
from objectmodels.geometry.rotations import Array
from planner.types.actions import Action, Aim, Carry, LiftUp, PourOut, SetDown
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.collision_scene import SPARE
from sim.motion.fingertip_path import FingertipPath
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.motion.motion_planner import FlipConfiguration, GraspMotion
from sim.motion.robot_reach import ArmHandReach
from sim.robots.collision_spheres import distance_to_box, place_spheres
from sim.robots.finger_kinematics import LINK_RADIUS, finger_points
from sim.robots.lwr_arm import LwrKinematics
from sim.robots.robots import ARM, HAND
from tests.plans import NOTHING_POURED
from tests.unit.sim.grasp_table import CARTON, MUG, plan, state
from tests.unit.sim.motion import test_flip_motion_search as flips
from tests.unit.sim.motion import test_lid_motion as lids
from tests.unit.sim.motion.test_push_motion_search import _alone, _push

CELL = load_scene("kitchen").cell
REACH = ArmHandReach(CELL, ARM, HAND)
LIFT, DOWN = LiftUp(height=0.12), SetDown()

Found = TypeVar("Found")


def _nearest(
    motion: Callable[[float], Found | ReachAnswer], far: float, near: float, step: float = 5e-5
) -> tuple[float, Found]:
    """The last place, from far to near, in which there is a motion, to a step, and the motion."""
    found = motion(far)
    assert not isinstance(found, ReachAnswer), found
    assert isinstance(motion(near), ReachAnswer)
    while abs(near - far) > step:
        place = 0.5 * (far + near)
        tried = motion(place)
        if isinstance(tried, ReachAnswer):
            near = place
        else:
            far, found = place, tried
    return far, found


# -- of hand and arm from what stands about --------------------------------------------------------


@pytest.mark.parametrize(
    ("kept", "thorough", "fragile", "spare"),
    [
        pytest.param(0.012, False, False, 0.0, id="usual"),
        pytest.param(0.010, False, False, SPARE, id="planned before"),
        pytest.param(0.006, True, False, 0.0, id="thorough"),
        pytest.param(0.030, False, True, 0.0, id="fragile"),
        pytest.param(0.030, True, True, 0.0, id="fragile and thorough"),
    ],
)
def test_the_hand_keeps_its_distance_from_a_wall_behind_it(
    kept: float, thorough: bool, fragile: bool, spare: float
) -> None:
    tea = _alone("ice tea box", 0.5, 0.0).objects["ice tea box"]
    push = _push(tea, 0.0, 0.03, stroke=0.05)
    wall = BoxModel(name="wall", size=(0.01, 0.6, 0.3), mass=1.0, friction=0.4)
    way = FingertipPath.from_push(push, tea, HAND.tip_radius)
    reach = REACH.thorough_reach if thorough else REACH

    def stance(x: float) -> ArmConfiguration | ReachAnswer:
        seen = SeenObject("wall", PlanarPose(x, 0.0), wall, fragile=fragile)
        answer = reach.push_configuration(push, WorldState({tea.name: tea, "wall": seen}), spare)
        return answer if isinstance(answer, ReachAnswer) else answer[0]

    start = float(way.start[0])
    x, found = _nearest(stance, start - 0.25, start)
    # At the start the hand is the farthest back.
    robot = found.robot_spheres(found.joint_angles(way.start))
    robot = robot - np.array([x, 0.0, 0.0, 0.0])
    low, high = np.array([-0.005, -0.3, 0.0]), np.array([0.005, 0.3, 0.3])
    assert kept <= distance_to_box(robot, low, high).min() < kept + 1e-4


class _WeakArm(LwrKinematics):
    """The arm with a twentieth of its strength: it bears less than the fingers do."""

    efforts = ARM.efforts / 20.0


def test_a_push_takes_half_of_the_strength_of_an_arm() -> None:
    reach, seen = ArmHandReach(CELL, _WeakArm(), HAND), _alone("ice tea box", 0.5, 0.1)
    box = seen.objects["ice tea box"]

    def stance(force: float) -> ArmConfiguration | ReachAnswer:
        push = _push(box, 0.0, 0.05, stroke=0.1, force=force)
        answer = reach.push_configuration(push, seen)
        return answer if isinstance(answer, ReachAnswer) else answer[0]

    force, found = _nearest(stance, 4.0, 10.0, 0.05)
    push = _push(box, 0.0, 0.05, stroke=0.1, force=force)
    way, shares = FingertipPath.from_push(push, box, HAND.tip_radius), [0.0]
    for point in way.points_at()[1:]:
        q = found.joint_angles(point)
        R_WP, p_WP = reach.mount.palm_poses(q)
        p_PC = (point + HAND.tip_radius * way.inward - p_WP) @ R_WP
        # Virtual work: a joint bears the work of the force per angle by which it turns.
        nudged = np.array([[q + d * each for each in np.eye(7)] for d in (1e-6, -1e-6)])
        R, p = reach.mount.palm_poses(nudged)
        J = np.subtract(*(p + R @ p_PC)) / 2e-6
        for skew in (-0.35, 0.35):  # up or down, as the most slanted finger presses
            load = force * (way.inward + np.array([0.0, 0.0, skew]))
            shares.append(float((np.abs(J @ load) / reach.mount.arm.efforts).max()))
    assert 0.495 < max(shares) < 0.5  # a step of the force is less than a hundredth of it


# -- of the hand from what it holds, and of that from what stands about ----------------------------


def _held_points(way: GraspMotion, size: tuple[float, float, float]) -> tuple[Array, Array]:
    """Points of the surface of a held box along its way (w, n, 3) [m], and its lean (w,)."""
    steps = np.linspace(-1.0, 1.0, 41)
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    surface = 0.5 * grid[np.abs(grid).max(axis=1) == 1.0] * size + [0.0, 0.0, 0.5 * size[2]]
    legs = [leg for legs in way.legs for leg in legs if not leg.free]
    poses = [leg.poses_at(leg.sample_shares()) for leg in legs]
    R_WB, p_WB = (np.concatenate(each) for each in zip(*poses, strict=True))
    return surface @ np.swapaxes(R_WB, 1, 2) + p_WB[:, None], np.arccos(R_WB[:, 2, 2])


def test_what_is_poured_from_keeps_its_distance_from_what_is_poured_into() -> None:
    pour = PourOut(
        into="mug",
        heading=np.pi / 2.0,
        lip_W=(0.75, 0.238, 0.14),
        angle=2.2,
        rate=0.35,
        wait=1.0,
        prediction=NOTHING_POURED,
    )
    seen = state(PlanarPose(0.75, 0.0, np.pi / 2.0))

    def poured(height: float) -> GraspMotion | ReachAnswer:
        lower = pour.model_copy(update={"lip_W": (0.75, 0.238, height)})
        return REACH.grasp_motion(plan(LIFT, lower, DOWN), seen)

    _, way = _nearest(poured, 0.14, 0.07)
    points, _ = _held_points(way, CARTON.size)
    beside = np.hypot(*(points[..., :2] - [0.75, 0.25]).transpose(2, 0, 1)) - MUG.radius
    over = points[..., 2] - MUG.height
    apart = np.hypot(np.maximum(beside, 0.0), np.maximum(over, 0.0))
    # Asked for are 4 mm; the spheres that stand for the edge there lie 0.7 mm within it.
    assert 0.0032 < apart.min() < 0.0040


def test_what_is_tilted_keeps_off_the_table() -> None:
    seen = state(PlanarPose(0.75, -0.15, np.pi / 2.0), mug=PlanarPose(0.3, 0.5))
    pour = PourOut(
        into="mug",
        heading=np.pi / 2.0,
        lip_W=(0.75, 0.0, 0.14),
        angle=1.0,
        rate=0.35,
        wait=1.0,
        prediction=NOTHING_POURED,
    )

    def tilted(height: float) -> GraspMotion | ReachAnswer:
        lower = pour.model_copy(update={"lip_W": (0.75, 0.0, height)})
        return REACH.grasp_motion(plan(LIFT, lower, DOWN), seen)

    _, way = _nearest(tilted, 0.14, 0.0)
    points, lean = _held_points(way, CARTON.size)
    # Asked for are 2 mm; the spheres that stand for the edge there lie 0.4 mm within it.
    assert 0.0015 < points[lean > 1e-3, :, 2].min() < 0.0020


def test_the_open_hand_keeps_off_what_it_is_about_to_hold() -> None:
    seen = state()

    def held(depth: float) -> GraspMotion | ReachAnswer:
        deep = BoxModel(
            name="carton", size=(0.06, depth, 0.16), mass=0.3, friction=0.3, finger_friction=0.6
        )
        there = {**seen.objects, "carton": replace(seen.objects["carton"], model=deep)}
        return REACH.grasp_motion(plan(LIFT, DOWN), WorldState(there))

    depth, way = _nearest(held, 0.08, 0.24)
    hand = HAND.whole_spheres(way.grip.posture_at(way.grip.opening))
    half = np.array([0.03, 0.5 * depth, 0.08])
    hand_B = place_spheres(hand, way.R_BP, way.p_BP) - np.array([0.0, 0.0, 0.08, 0.0])
    assert 0.002 <= distance_to_box(hand_B, -half, half).min() < 0.0021


# -- of the hand about a lid -----------------------------------------------------------------------


def _fingers_about_knob(seen: WorldState, *steps: Action) -> Array:
    """Points in W of the axes of fingers that hold a jar's knob as low as they may, (n, 3) [m]."""
    asked, rim = lids.plan_of(lids.JAR, *steps), Registry.built_in().get(lids.JAR).top
    assert asked.grasp is not None
    grasp = asked.grasp

    def held(height: float) -> GraspMotion | ReachAnswer:
        """With the knob held at a height above the rim [m]."""
        lower = grasp.model_copy(update={"p_BG": (0.0, 0.0, rim + height)})
        return REACH.grasp_motion(asked.model_copy(update={"actions": (lower, *steps)}), seen)

    _, way = _nearest(held, 0.025, 0.0)
    angles = way.grip.posture_at().angles
    links = [
        np.linspace(start, end, 31)
        for finger in way.grip.touching_fingers
        for start, end in itertools.pairwise(finger_points(finger, angles[finger]))
    ]
    points_B = np.vstack(links) @ way.R_BP.T + way.p_BP
    poses = [leg.poses_at(leg.sample_shares()) for legs in way.legs for leg in legs if not leg.free]
    points = [points_B @ np.swapaxes(R_WB, 1, 2) + p_WB[:, None] for R_WB, p_WB in poses]
    return np.concatenate(points).reshape(-1, 3)


def test_fingers_about_a_knob_keep_off_the_jar_below_it() -> None:
    x, y, z = _fingers_about_knob(lids.state_of(lids.JAR), LiftUp(height=0.04)).T
    at, radius, height = lids.AT[lids.JAR], 0.042, 0.11
    beside = np.hypot(x - at[0], y - at[1]) - radius
    apart = np.hypot(np.maximum(beside, 0.0), z - height).min() - LINK_RADIUS
    # The motion is looked at in spheres 10 mm apart, between which a finger is a little nearer.
    assert 0.0022 < apart < 0.0024


def test_fingers_that_put_a_lid_aside_keep_off_the_table() -> None:
    seen = lids.state_of(lids.JAR, (0.4, -0.1, 0.0))
    carry = Carry(to=Aim(x=0.25, y=-0.1))
    points = _fingers_about_knob(seen, LiftUp(height=0.04), carry, DOWN)
    assert 0.0015 <= points[:, 2].min() - LINK_RADIUS < 0.0016


def test_a_hand_that_waits_beside_a_cup_keeps_off_it_to_flip_its_lid() -> None:
    asked, seen = flips.plan_of(0.0, flips.OPEN), flips.state_of(0.4, 0.2, 0.0)
    (step,) = asked.steps
    usual = REACH.flip_configuration(step, flips.CUP, seen)  # type: ignore[arg-type]
    assert not isinstance(usual, ReachAnswer)
    stance = usual[0]

    def home(nearer: float) -> Array:
        """Arm angles before the lid, with the fingertip nearer to it [m] than where it begins."""
        return stance.joint_angles(stance.hands.path.points[0] - [nearer, 0.0, 0.0], 0.0)

    def flipped(nearer: float) -> FlipConfiguration | ReachAnswer:
        waits = {"home_deg": tuple(np.degrees(home(nearer)).tolist())}
        cell = CELL.model_copy(update={"robot": CELL.robot.model_copy(update=waits)})
        found = ArmHandReach(cell, ARM, HAND).flip_configuration(step, flips.CUP, seen)  # type: ignore[arg-type]
        return found if isinstance(found, ReachAnswer) else found[0]

    nearer, found = _nearest(flipped, 0.02, 0.05)
    x, y, z, radius = np.moveaxis(found.stance.robot_spheres(home(nearer)), -1, 0)
    beside = np.hypot(x - 0.4, y - 0.2) - 0.035  # the cup's radius at its rim
    apart = np.hypot(np.maximum(beside, 0.0), np.maximum(z - 0.12, 0.0)) - radius
    assert 0.002 <= apart.min() < 0.0021
