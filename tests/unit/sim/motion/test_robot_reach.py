"""The hand's reach: what it accepts is free and within limits by Drake's own geometry."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import pytest

from objectmodels import Registry
from planner.types.actions import Push
from planner.types.robot import ReachAnswer
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim import load_scene
from sim.motion.fingertip_path import FingertipPath
from sim.motion.inverse_kinematics import ArmConfiguration, UnreachableError
from sim.motion.robot_reach import ArmHandReach
from sim.robots.collision_spheres import distance_to_box
from sim.robots.finger_kinematics import FINGER_JOINTS, FINGERS
from sim.robots.four_finger_hand import FourFingerHand
from sim.robots.hand import PostureSet
from sim.robots.lwr_arm import FLANGE
from sim.robots.robots import ARM, HAND
from sim.truth.scene_file import Scene

FACES = {"front": (-1.0, 0.0), "back": (1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("kitchen")


@pytest.fixture(scope="module")
def reach(scene: Scene) -> ArmHandReach:
    return ArmHandReach(scene.cell, ARM, HAND)


def _believed(scene: Scene) -> WorldState:
    registry = Registry.default()
    return WorldState(
        {
            item.name: SeenObject(
                item.name,
                PlanarPose(item.pose.x_m, item.pose.y_m, np.radians(item.pose.yaw_deg)),
                registry.get(item.model),
            )
            for item in scene.objects
        }
    )


def _push(
    state: WorldState, name: str, face: str, height: float, *, fingers: int = 2, stroke: float = 0.1
) -> Push:
    seen = state.objects[name]
    normal = np.array([*FACES[face], 0.0])
    half = np.abs(normal) @ np.array(seen.model.extents) / 2
    p_BC = half * normal + np.array([0.0, 0.0, height])
    normal_W = seen.pose.R_WB @ normal
    return Push(
        object=name,
        face=face,
        p_BC=tuple(p_BC.tolist()),
        normal_W=tuple(normal_W.tolist()),
        direction_W=tuple((-normal_W).tolist()),
        force_limit=5.0,
        speed=0.05,
        stroke=stroke,
        fingers=fingers,
        spread=0.04 if fingers == 2 else 0.0,
        ends_on="stroke",
    )


def _stance(reach: ArmHandReach, push: Push, state: WorldState) -> ArmConfiguration:
    answer = reach.push_configuration(push, state)
    assert not isinstance(answer, ReachAnswer), answer
    return answer[0]


CASES = [
    ("ice tea box", "front", 0.029, 2),
    ("ice tea box", "right", 0.029, 2),
    ("ice tea box", "front", 0.21, 2),
    ("cereal box", "front", 0.03, 2),
    ("cereal box", "left", 0.03, 1),
    ("coffee box", "back", 0.033, 2),
]


@pytest.mark.parametrize(("name", "face", "height", "fingers"), CASES)
def test_the_way_is_free_by_drakes_own_distances(
    reach: ArmHandReach, scene: Scene, name: str, face: str, height: float, fingers: int
) -> None:
    from pydrake.systems.framework import DiagramBuilder

    from sim.worlds.drake.drake_plant import add_plant

    state = _believed(scene)
    push = _push(state, name, face, height, fingers=fingers)
    stance = _stance(reach, push, state)
    way = FingertipPath.from_push(push, state.objects[name], HAND.tip_radius)
    builder = DiagramBuilder()
    model = add_plant(builder, scene)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant_context = model.plant.GetMyMutableContextFromRoot(context)
    for finger in FINGERS:
        a, b, c = stance.posture.angles[finger]
        for joint, angle in zip(FINGER_JOINTS, (a, b, c, c), strict=True):
            model.plant.GetJointByName(f"{finger}_{joint}").set_angle(plant_context, angle)
    smallest = np.inf
    for q in _poses(reach, stance, way):
        model.plant.SetPositions(plant_context, model.arm, q)
        query = model.scene_graph.get_query_output_port().Eval(
            model.scene_graph.GetMyContextFromRoot(context)
        )
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(0.05):
            names = {_body(model, query, pair.id_A), _body(model, query, pair.id_B)}
            # What stands on the table touches it, and a filter keeps the robot from itself.
            if names <= {"world", *scene.names}:
                continue
            smallest = min(smallest, pair.distance)
    # Clearances asked are 5 mm from the table and 12 mm from objects; the spheres are larger than
    # the shapes, so Drake sees at least that, less the millimetre by which objects differ from
    # where they are believed.
    assert 0.003 < smallest < 0.05


def _poses(
    reach: ArmHandReach, stance: ArmConfiguration, way: FingertipPath
) -> Iterator[np.ndarray]:
    above = np.array([*way.start[:2], stance.lift])
    legs = [reach.mount.home, *stance.via, stance.joint_angles(above)]
    for start, end in itertools.pairwise(legs):
        for t in np.linspace(0.0, 1.0, 60):
            yield start + t * (end - start)
    for t in np.linspace(0.0, 1.0, 40):
        yield stance.joint_angles(above + t * (way.start - above))


def _body(model: object, query: object, geometry: object) -> str:
    inspector = query.inspector()  # type: ignore[attr-defined]
    frame = inspector.GetFrameId(geometry)
    return str(model.plant.GetBodyFromFrameId(frame).name())  # type: ignore[attr-defined]


def test_the_tips_go_where_the_push_says(reach: ArmHandReach, scene: Scene) -> None:
    state = _believed(scene)
    push = _push(state, "ice tea box", "front", 0.029)
    stance, way = (
        _stance(reach, push, state),
        FingertipPath.from_push(push, state.objects["ice tea box"], HAND.tip_radius),
    )
    for point in way.points_at():
        R_WP, p_WP = reach.mount.palm_poses(stance.joint_angles(point))
        middle = R_WP @ stance.posture.tips.mean(axis=0) + p_WP
        np.testing.assert_allclose(middle, point, atol=1e-7)  # as the inverse kinematics
    with pytest.raises(UnreachableError):
        stance.joint_angles(np.array([3.0, 0.0, 0.1]))


class _PushingHand(FourFingerHand):
    """The hand before anyone has worked out how it presses."""

    def pressing_postures(self) -> PostureSet:
        raise AssertionError("what takes long is not worked out")


def test_who_pushes_does_not_work_out_how_to_press(scene: Scene) -> None:
    reach = ArmHandReach(scene.cell, ARM, _PushingHand(FLANGE))
    state = _believed(scene)
    assert reach.reach(_push(state, "ice tea box", "front", 0.05), state).ok
    with pytest.raises(AssertionError):
        _ = reach.max_press


def test_too_low_is_refused(reach: ArmHandReach, scene: Scene) -> None:
    state = _believed(scene)
    answer = reach.reach(_push(state, "ice tea box", "front", 0.01), state)
    assert (answer.ok, answer.reason) == (False, "table")


def test_a_wall_of_boxes_is_an_obstacle(reach: ArmHandReach, scene: Scene) -> None:
    state = _believed(scene)
    tea = state.objects["ice tea box"]
    wall = {
        f"wall {i}": SeenObject(f"wall {i}", PlanarPose(0.33, y), tea.model)
        for i, y in enumerate((-0.1, 0.0, 0.1))
    }
    crowded = WorldState({"ice tea box": tea, **wall})
    answer = reach.reach(_push(crowded, "ice tea box", "front", 0.029), crowded)
    assert not answer.ok
    assert answer.reason in {"obstacle", "approach"}


def test_far_away_is_out_of_reach(reach: ArmHandReach, scene: Scene) -> None:
    state = _believed(scene)
    far = SeenObject("ice tea box", PlanarPose(2.5, 0.0), state.objects["ice tea box"].model)
    alone = WorldState({"ice tea box": far})
    answer = reach.reach(_push(alone, "ice tea box", "front", 0.03), alone)
    assert (answer.ok, answer.reason) == (False, "kinematics")


def test_the_work_of_an_answer_is_the_same_each_time(reach: ArmHandReach, scene: Scene) -> None:
    state = _believed(scene)
    push = _push(state, "ice tea box", "front", 0.029)
    usual = [reach.reach(push, state).work for _ in range(2)]
    hidden = push.model_copy(update={"force_limit": 1e3})  # more than any hand bears
    thorough = [reach.reach(hidden, state, "thorough").work for _ in range(2)]
    assert usual[0] == usual[1] > 1
    assert thorough[0] == thorough[1] > usual[0]


def test_distance_to_a_box_against_sampled_points() -> None:
    rng = np.random.default_rng(0)
    low, high = np.array([-0.1, -0.2, 0.0]), np.array([0.1, 0.2, 0.3])
    grid = np.stack(
        np.meshgrid(*[np.linspace(a, b, 41) for a, b in zip(low, high, strict=True)]), axis=-1
    ).reshape(-1, 3)
    for centre in rng.uniform(-0.6, 0.6, (30, 3)):
        found = float(distance_to_box(np.array([*centre, 0.05]), low, high))
        if np.all((centre > low) & (centre < high)):
            assert found == pytest.approx(-min(*(centre - low), *(high - centre)) - 0.05)
        else:
            nearest = np.linalg.norm(grid - centre, axis=1).min()
            # The grid's nearest point is at most half a cell's diagonal farther.
            assert nearest - 0.05 - 0.0075 <= found <= nearest - 0.05 + 1e-12


def test_spheres_cover_the_collision_shapes() -> None:
    """Points of the URDF's shapes lie within the spheres that stand for them."""
    from pydrake.geometry import Role
    from pydrake.systems.framework import DiagramBuilder

    from sim.robots.hand import Mount
    from sim.worlds.drake.drake_plant import add_plant

    scene = load_scene("kitchen")
    model = add_plant(DiagramBuilder(), scene)
    inspector = model.scene_graph.model_inspector()
    context = model.plant.CreateDefaultContext()
    q = np.radians(scene.robot.home_deg)
    model.plant.SetPositions(context, model.arm, q)
    posture = _stance(
        ArmHandReach(scene.cell, ARM, HAND),
        _push(_believed(scene), "ice tea box", "front", 0.029),
        _believed(scene),
    ).posture
    for finger in FINGERS:
        a, b, c = posture.angles[finger]
        for joint, angle in zip(FINGER_JOINTS, (a, b, c, c), strict=True):
            model.plant.GetJointByName(f"{finger}_{joint}").set_angle(context, angle)
    mount = Mount.from_cell(scene.robot, ARM, HAND)
    R_WP, p_WP = mount.palm_poses(q)
    hand = HAND.spheres(posture)
    arm = ARM.spheres(q)
    centres = np.vstack([hand[:, :3] @ R_WP.T + p_WP, arm[:, :3] @ mount.R_WA.T + mount.p_WA])
    radii = np.concatenate([hand[:, 3], arm[:, 3]])
    uncovered = []
    # The base and the links up to the elbow stay near the mount, far from everything.
    spared = {"arm_base", "arm_link_1", "arm_link_2", "arm_link_3"}
    for instance in (model.arm, model.hand):
        for index in model.plant.GetBodyIndices(instance):
            body = model.plant.get_body(index)
            tip = body.name().removesuffix("_tip") in posture.pushing
            if body.name() in spared or tip:
                continue
            X_WB = body.EvalPoseInWorld(context)
            for geometry in inspector.GetGeometries(
                model.plant.GetBodyFrameIdOrThrow(index), Role.kProximity
            ):
                shape, X_BG = inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry)
                for p in _inside(shape):
                    p_W = X_WB.multiply(X_BG.multiply(p))
                    depth = (np.linalg.norm(centres - p_W, axis=1) - radii).min()
                    if depth > 0.002:  # bulges between spheres, far below the clearances
                        uncovered.append((body.name(), round(float(depth), 4)))
    assert not uncovered


def _inside(shape: object) -> list[np.ndarray]:
    """Points of a shape: its axis for capsules and spheres, a grid for boxes."""
    from pydrake.geometry import Box, Capsule, Sphere

    if isinstance(shape, Sphere):
        return [np.zeros(3)]
    if isinstance(shape, Capsule):
        z = np.linspace(-0.5, 0.5, 9) * shape.length()
        return [np.array([0.0, 0.0, value]) for value in z]
    assert isinstance(shape, Box)
    axes = [np.linspace(-0.5, 0.5, 7) * length for length in shape.size()]
    return list(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3))
