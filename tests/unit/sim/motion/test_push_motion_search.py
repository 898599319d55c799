"""The search for stances in crowded scenes: clear of everything, strong enough, always the same."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel, Registry
from objectmodels.geometry.rotations import rot_z
from objectmodels.mechanics.push_motion import best_turn
from planner.problem.directions import face_name
from planner.refusals.blocked import reach_sentence
from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.collision_scene import (
    FRAGILE_CLEARANCE,
    LEAST_CLEARANCE,
    OBJECT_CLEARANCE,
    SPARE,
    Obstacle,
)
from sim.motion.fingertip_path import BACK, FingertipPath
from sim.motion.inverse_kinematics import ArmConfiguration
from sim.motion.roadmap import interpolate_joints
from sim.motion.robot_reach import ArmHandReach, reachability_map
from sim.robots.finger_kinematics import (
    EFFORT,
    FINGER_LIMITS,
    FINGERS,
    JOINT_STIFFNESS,
    TIP_RADIUS,
    finger_jacobian,
    hand_spheres,
)
from sim.robots.four_finger_hand import pushing_postures
from sim.robots.robots import ARM, HAND

REGISTRY = Registry.built_in()
REACH = ArmHandReach(load_scene("kitchen").cell, ARM, HAND)
PLACES = [(0.42, -0.3), (0.42, 0.3), (0.66, -0.28), (0.68, 0.3), (0.72, 0.02), (0.38, 0.0)]


def _crowd(seed: int, *, fragile: bool = False) -> tuple[Push, WorldState]:
    """Six objects, and a push of the first of them."""
    rng = np.random.default_rng(seed)
    models = [model for model in REGISTRY if model.name != "book"]
    chosen = rng.permutation(len(models))[: len(PLACES)]
    objects = {}
    for k, (x, y) in zip(chosen, PLACES, strict=True):
        pose = PlanarPose(x + rng.uniform(-0.02, 0.02), y, rng.uniform(-3.0, 3.0))
        objects[models[k].name] = SeenObject(models[k].name, pose, models[k], fragile=fragile)
    target = next(iter(objects.values()))
    return _push(target, rng.uniform(-np.pi, np.pi), 0.03, stroke=rng.uniform(0.05, 0.15)), (
        WorldState(objects)
    )


def _push(
    seen: SeenObject, heading: float, height: float, *, stroke: float, force: float = 4.0
) -> Push:
    faces = seen.model.faces(np.array([heading - seen.pose.yaw]))
    inward = np.array([np.cos(heading), np.sin(heading), 0.0])
    face = min(faces, key=lambda f: float(seen.pose.R_WB @ np.array(f.normal) @ inward))
    point, normal = face.points_at(0.0, height)
    n_x, n_y, _ = (seen.pose.R_WB @ normal).tolist()
    return Push(
        object=seen.name,
        face=face_name(np.array([n_x, n_y, 0.0]))[0],
        p_BC=tuple(point.tolist()),
        normal_W=(n_x, n_y, 0.0),
        direction_W=(-n_x, -n_y, 0.0),
        force_limit=force,
        speed=0.05,
        stroke=stroke,
        fingers=1,
        spread=0.0,
        ends_on="stroke",
    )


def _alone(name: str, x: float, y: float) -> WorldState:
    return WorldState({name: SeenObject(name, PlanarPose(x, y), REGISTRY.get(name))})


def _robot(stance: ArmConfiguration, q: np.ndarray, *, tips: bool) -> np.ndarray:
    hand = HAND.whole_spheres(stance.posture) if tips else HAND.spheres(stance.posture)
    return stance.mount.robot_spheres(hand, q)


def _transit(stance: ArmConfiguration, way: FingertipPath) -> np.ndarray:
    above = np.array([*way.start[:2], stance.lift])
    legs = [REACH.mount.home, *stance.via, stance.joint_angles(above)]
    down = [stance.joint_angles(above + t * (way.start - above)) for t in np.linspace(0.0, 1.0, 20)]
    return np.vstack([*(interpolate_joints(a, b) for a, b in itertools.pairwise(legs)), down])


SEEDS = range(12)


@pytest.mark.parametrize("fragile", [False, True])
def test_hand_and_arm_keep_clear_of_a_crowd_all_the_way(fragile: bool) -> None:
    reached = 0
    for seed in SEEDS:
        push, state = _crowd(seed, fragile=fragile)
        answer = REACH.push_configuration(push, state)
        if isinstance(answer, ReachAnswer):
            continue
        reached += 1
        stance, way = (
            answer[0],
            FingertipPath.from_push(push, state.objects[push.object], HAND.tip_radius),
        )
        transit = _robot(stance, _transit(stance, way), tips=True)
        # Between the poses that were looked at a sphere moves by less than 2 mm towards an object.
        assert (transit[..., 2] - transit[..., 3]).min() > 0.005 - 0.002
        for t in np.linspace(0.0, 1.0, 21):
            moved = t * (way.end - way.touch)
            robot = _robot(stance, stance.joint_angles(way.touch + moved), tips=False)
            for name, seen in state.objects.items():
                obstacle = Obstacle.from_seen(seen, 0.0)
                if name == push.object:
                    assert (
                        obstacle.after_motion(np.zeros(3), moved, 0.0).distance_to(robot).min()
                        > 0.0
                    )
                    assert obstacle.distance_to(transit).min() > OBJECT_CLEARANCE - 0.002
                    continue
                clearance = FRAGILE_CLEARANCE if fragile else OBJECT_CLEARANCE
                # A stroke is looked at every 25 mm; see below.
                assert obstacle.distance_to(robot).min() > clearance - 0.0025
                assert obstacle.distance_to(transit).min() > clearance - 0.002
    assert reached >= (4 if fragile else 8)


def test_what_stands_halfway_beside_the_stroke_is_in_the_way() -> None:
    tea = _alone("ice tea box", 0.45, 0.0).objects["ice tea box"]
    push = _push(tea, 0.0, 0.1, stroke=0.2)
    x, y, z = push.p_BC
    push = push.model_copy(update={"p_BC": (x, y + 0.03, z)})
    way = FingertipPath.from_push(push, tea, HAND.tip_radius)
    thin = BoxModel(name="post", size=(0.01, 0.01, 0.25), mass=0.1, friction=0.4)
    for off in (0.02, 0.03, 0.04, 0.05, 0.06):
        # Beside the box's way, but maybe not beside the hand's: it is wider behind than in front.
        post = SeenObject("post", PlanarPose(float(way.touch[0]) + 0.09, 0.045 + off), thin)
        answer = REACH.push_configuration(push, WorldState({tea.name: tea, "post": post}))
        if isinstance(answer, ReachAnswer):
            assert answer.blocker == "post"
            continue
        for t in np.linspace(0.0, 1.0, 41):
            q = answer[0].joint_angles(way.touch + t * (way.end - way.touch))
            distance = Obstacle.from_seen(post, 0.0).distance_to(_robot(answer[0], q, tips=True))
            # Looked at every 25 mm: 12.5 mm off its nearest, a sphere of 22 mm that keeps 34 mm
            # from a post comes as near as (34² − 12.5²)^½ = 31.6 mm.
            assert distance.min() > OBJECT_CLEARANCE - 0.0025


@pytest.mark.slow
def test_what_was_just_reached_is_reached_from_the_next_look() -> None:
    state = _alone("ice tea box", 0.5, 0.0)
    tea = state.objects["ice tea box"]
    push = _push(tea, 0.0, 0.03, stroke=0.05)
    wall = BoxModel(name="wall", size=(0.01, 0.6, 0.3), mass=1.0, friction=0.4)
    behind = float(FingertipPath.from_push(push, tea, HAND.tip_radius).start[0])

    def stance(nearer: float, spare: float) -> object:
        seen = SeenObject("wall", PlanarPose(behind - 0.2 + nearer, 0.0), wall)
        return REACH.push_configuration(push, WorldState({tea.name: tea, "wall": seen}), spare)

    def reached(nearer: float, spare: float = 0.0) -> bool:
        return not isinstance(stance(nearer, spare), ReachAnswer)

    # The nearest place of the wall from which the hand still gets there, to half a millimetre.
    nearer = max(at for at in np.arange(0.0, 0.2, 0.0005).tolist() if reached(at))
    noise = 0.001  # between two looks
    assert not reached(nearer + noise)
    assert reached(nearer + noise, SPARE)


@pytest.mark.parametrize("fragile", [False, True])
def test_what_looks_thoroughly_keeps_clear_too(fragile: bool) -> None:
    thorough = REACH.thorough_reach
    least = FRAGILE_CLEARANCE if fragile else LEAST_CLEARANCE
    for seed in SEEDS[:6]:
        push, state = _crowd(seed, fragile=fragile)
        answer = thorough.push_configuration(push, state)
        if isinstance(answer, ReachAnswer):
            assert isinstance(REACH.push_configuration(push, state), ReachAnswer)
            continue
        stance, way = (
            answer[0],
            FingertipPath.from_push(push, state.objects[push.object], HAND.tip_radius),
        )
        transit = _robot(stance, _transit(stance, way), tips=True)
        for name, seen in state.objects.items():
            if name == push.object:
                continue
            obstacle = Obstacle.from_seen(seen, 0.0)
            # As in the test of a crowd above.
            assert obstacle.distance_to(transit).min() > least - 0.002
            for t in np.linspace(0.0, 1.0, 21):
                q = stance.joint_angles(way.touch + t * (way.end - way.touch))
                robot = _robot(stance, q, tips=False)
                assert obstacle.distance_to(robot).min() > least - 0.0025


@pytest.mark.slow
def test_what_looks_thoroughly_gets_past_what_is_nearer() -> None:
    state = _alone("ice tea box", 0.5, 0.0)
    tea = state.objects["ice tea box"]
    push = _push(tea, 0.0, 0.03, stroke=0.05)
    wall = BoxModel(name="wall", size=(0.01, 0.6, 0.3), mass=1.0, friction=0.4)
    behind = float(FingertipPath.from_push(push, tea, HAND.tip_radius).start[0])

    def nearest(reach: ArmHandReach) -> float:
        at = np.arange(0.0, 0.2, 0.001)
        seen = [SeenObject("wall", PlanarPose(behind - 0.2 + x, 0.0), wall) for x in at]
        states = [WorldState({tea.name: tea, "wall": each}) for each in seen]
        got = [x for x, s in zip(at, states, strict=True) if reach.reach(push, s).ok]
        return float(max(got))

    # As much as it may pass nearer, but for the millimetre between two walls.
    nearer = nearest(REACH.thorough_reach) - nearest(REACH)
    assert nearer > OBJECT_CLEARANCE - LEAST_CLEARANCE - 0.0015


def test_a_strong_push_is_refused_with_what_the_hands_there_bear() -> None:
    state = _alone("ice tea box", 0.5, 0.1)
    gentle = _push(state.objects["ice tea box"], 0.0, 0.05, stroke=0.1)
    most = REACH.limits.max_force
    assert REACH.reach(gentle, state).ok
    refused = REACH.reach(gentle.model_copy(update={"force_limit": most + 1.0}), state)
    assert (refused.ok, refused.reason) == (False, "torque")
    assert 0.0 < refused.numbers["strength"] <= most < refused.numbers["force"]


def test_the_hand_that_is_chosen_bears_the_force() -> None:
    state = _alone("ice tea box", 0.5, 0.1)
    for force in (2.0, 8.0, 14.0, 20.0):
        push = _push(state.objects["ice tea box"], 0.0, 0.08, stroke=0.1, force=force)
        answer = REACH.push_configuration(push, state)
        assert not isinstance(answer, ReachAnswer), answer
        stance, way = (
            answer[0],
            FingertipPath.from_push(push, state.objects["ice tea box"], HAND.tip_radius),
        )
        (finger,) = stance.posture.pushing
        angles = np.array(stance.posture.angles[finger])
        load = force * stance.R_WP.T @ way.inward
        p_PC = stance.posture.tips[0] + TIP_RADIUS * stance.R_WP.T @ way.inward
        torque = finger_jacobian(finger, stance.posture.angles[finger], p_PC).T @ load
        assert np.abs(torque).max() < EFFORT
        loaded = angles - torque / JOINT_STIFFNESS
        assert (loaded > FINGER_LIMITS[:, 0]).all()
        assert (loaded < FINGER_LIMITS[:, 1]).all()
        assert answer[1].numbers["strength"] >= force


def test_the_largest_force_is_that_of_the_strongest_hand() -> None:
    assert REACH.limits.max_force == HAND.pushing_postures(1, 0.0).strength.max()
    assert REACH.limits.max_force > 10.0  # what the joints' 2 N·m were always said to bear


def test_answers_do_not_depend_on_what_was_asked_before() -> None:
    cases = [_crowd(seed) for seed in range(4)]

    def plain(push: Push, state: WorldState) -> tuple[object, ...]:
        answer = REACH.push_configuration(push, state)
        if isinstance(answer, ReachAnswer):
            return (answer, REACH.estimate_reach(push, state))
        stance = answer[0]
        way = [q.tobytes() for q in (stance.R_WP, *stance.via)]
        told = (stance.posture.name, stance.elbow, stance.branch, stance.lift, way)
        return (*told, answer[1], REACH.estimate_reach(push, state))

    first = [plain(*case) for case in cases]
    pushing_postures.cache_clear()
    hand_spheres.cache_clear()
    reachability_map.cache_clear()
    again = [plain(*case) for case in reversed(cases)][::-1]
    assert first == again


def test_a_wall_around_the_object_is_named() -> None:
    state = _alone("soup can", 0.55, 0.0)
    tall = replace(_alone("cereal box", 0.0, 0.0).objects["cereal box"], name="wall")
    ring = {
        f"wall {k}": replace(
            tall,
            name=f"wall {k}",
            pose=PlanarPose(0.55 + 0.13 * np.cos(phi), 0.13 * np.sin(phi), phi),
        )
        for k, phi in enumerate(np.arange(4) * np.pi / 2)
    }
    crowd = WorldState({**state.objects, **ring})
    answer = REACH.reach(_push(state.objects["soup can"], 0.0, 0.03, stroke=0.02), crowd)
    assert not answer.ok
    assert answer.reason == "obstacle"
    assert answer.blocker in ring
    assert str(answer.blocker) in reach_sentence(answer)


def test_the_map_knows_near_from_far() -> None:
    near, far = _alone("ice tea box", 0.5, 0.1), _alone("ice tea box", 2.0, 0.0)
    push = _push(near.objects["ice tea box"], 0.0, 0.05, stroke=0.1)
    assert REACH.estimate_reach(push, near) > 0.35  # more is no better
    assert REACH.estimate_reach(push, far) == 0.0


def test_every_finger_of_a_posture_is_there() -> None:
    for posture in (
        *HAND.pushing_postures(1, 0.0).postures,
        *HAND.pushing_postures(2, 0.04).postures,
    ):
        assert set(posture.angles) == set(FINGERS)
        for angles in posture.angles.values():
            inside = (np.array(angles) - FINGER_LIMITS[:, 0], FINGER_LIMITS[:, 1] - angles)
            assert np.min(inside) > 0.0 or angles[2] == 0.0


def test_what_was_pushed_is_not_taken_along_on_the_way_back() -> None:
    # High on a round tin beside a box, hands that reach over the tin fit best.
    tin = _seen("tea tin", 0.628, 0.242, -1.85)
    state = WorldState({"tea tin": tin, "sugar box": _seen("sugar box", 0.742, 0.102, 0.78)})
    two = {"fingers": 2, "spread": 0.024}
    push = _push(tin, math.pi / 2, 0.09, stroke=0.1, force=1.0)
    found = 0
    for each in (push, push.model_copy(update=two)):
        answer = REACH.push_configuration(each, state)
        if isinstance(answer, ReachAnswer):
            continue
        found += 1
        way = REACH.fingertip_path(each, state)
        end = Obstacle.from_seen(tin, 0.0).after_motion(way.touch, way.end, 0.0)
        off = way.end - BACK * way.inward
        back = off + np.linspace(0.0, 1.0, 40)[:, None] * (way.start - off)
        q = np.array([answer[0].joint_angles(at) for at in back])
        assert end.distance_to(answer[0].robot_spheres(q)).min() > 0.0
    assert found


def test_a_hand_gets_off_a_face_that_it_has_turned() -> None:
    box = _seen("sugar box", 0.55, 0.0, 0.0)
    turn, found, rng = math.radians(45.0), 0, np.random.default_rng(3)
    for face in box.model.faces():
        swing = best_turn(box.model, face, turn, 0.05)
        if swing is None:
            continue
        pushed = _push(box, math.atan2(-face.normal[1], -face.normal[0]), 0.05, stroke=0.0)
        direction = tuple((box.pose.R_WB @ np.array(swing.direction)).tolist())
        as_turned = {"p_BC": swing.point, "direction_W": direction, "stroke": swing.stroke}
        push = pushed.model_copy(update={**as_turned, "ends_on": "turned", "turn": turn})
        for _ in range(8):
            beside = rng.uniform(-np.pi, np.pi)
            x, y = box.pose.p_WB[:2] + 0.17 * np.array([np.cos(beside), np.sin(beside)])
            tall = _seen("cereal box", float(x), float(y), beside)
            state = WorldState({"sugar box": box, "cereal box": tall})
            answer = REACH.push_configuration(push, state)
            if isinstance(answer, ReachAnswer):
                continue
            found += 1
            way = REACH.fingertip_path(push, state)
            turned = Obstacle.from_seen(box, 0.0).after_motion(way.touch, way.end, turn)
            off = way.end - BACK * rot_z(turn) @ way.inward
            # Where it is looked at; between these places it may be nearer.
            for share in (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0):
                at = off + share * (way.start - off)
                q = answer[0].joint_angles(at, turned=(1.0 - share) * turn)
                robot = answer[0].robot_spheres(q)
                assert turned.distance_to(robot).min() > 0.0
                assert Obstacle.from_seen(tall, 0.0).distance_to(robot).min() > OBJECT_CLEARANCE
    assert found > 4


def _seen(name: str, x: float, y: float, yaw: float) -> SeenObject:
    return SeenObject(name, PlanarPose(x, y, yaw), REGISTRY.get(name))
