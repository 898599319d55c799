"""The simulated world as a Drake diagram: robot, table and objects.

Model: point contact, but for slabs, lagged approximation; with "sap" a sliding fingertip chatters
(2.3 N of standard deviation in a push of 3.6 N, against 0.07 N). Objects are boxes, cylinders and
prisms that touch the table with small spheres at their support points (a solid yields one contact
point only); the solid itself touches everything but the table. An open box has five solids, its
floor and walls. What stands on another object stands on that one's slab
(`sim.worlds.drake.drake_bodies`), what hangs over the table's edge on its rim
(`sim.worlds.drake.drake_bodies`).
Lids are bodies of their own (`sim.worlds.drake.drake_bodies`), what a holder keeps is welded to the
table. How bodies touch is in `sim.worlds.drake.drake_bodies`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.geometry.solids import ConvexHull, Cuboid, UprightCylinder
from objectmodels.models.shapes import Shape as TrueShape
from sim.robots.arm import ArmKinematics
from sim.robots.hand import Hand
from sim.robots.robots import ARM, HAND
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene, SceneObject
from sim.worlds.drake.drake_bodies import (
    ROUGH,
    STANDS_OUT,
    LidBody,
    add_lid,
    add_rims,
    add_slab,
    add_sole,
    filter_lids,
    filter_rims,
    filter_slabs,
    surface,
)

if TYPE_CHECKING:
    from pydrake.geometry import GeometryId, SceneGraph, Shape
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import ModelInstanceIndex, RigidBody, SpatialInertia
    from pydrake.systems.framework import DiagramBuilder


@dataclass(frozen=True)
class Feet:
    """The spheres on which an object stands, or lies on a side.

    Attributes:
        geometries: k of them.
        p_B: their centres in B, shape (k, 3) [m].
    """

    geometries: list[GeometryId]
    p_B: Array


@dataclass(frozen=True)
class Standing:
    """A finalised plant in its builder, and the objects of a scene and their lids in it."""

    plant: MultibodyPlant
    scene_graph: SceneGraph
    bodies: Mapping[str, RigidBody]
    feet: Mapping[str, Feet]
    lids: Mapping[str, LidBody]


@dataclass(frozen=True)
class Plant(Standing):
    """The same with the robot."""

    arm: ModelInstanceIndex
    hand: ModelInstanceIndex


def add_empty_plant(
    builder: DiagramBuilder, time_step: float, stiction: float
) -> tuple[MultibodyPlant, SceneGraph]:
    """Adds a plant of a time step [s] in which what slips up to a speed sticks [m/s]."""
    from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig

    config = MultibodyPlantConfig(
        time_step=time_step,
        contact_model="hydroelastic_with_fallback",
        discrete_contact_approximation="lagged",
        stiction_tolerance=stiction,
        use_sampled_output_ports=False,
    )
    plant, scene_graph = AddMultibodyPlant(config, builder)
    return plant, scene_graph


def add_plant(
    builder: DiagramBuilder, scene: Scene, arm: ArmKinematics = ARM, hand: Hand = HAND
) -> Plant:
    """Adds robot, table and objects of a scene to a diagram."""
    plant, scene_graph = add_empty_plant(builder, scene.time_step_s, stiction=1e-4)
    robot_models = _add_robot(plant, scene, arm, hand)
    table = add_table(plant, scene)
    solids: list[GeometryId] = []
    feet: dict[str, Feet] = {}
    bodies = {}
    lids = {}
    for item in scene.objects:
        body, own, feet[item.name] = add_object(plant, item.name, item.truth.without_lid)
        bodies[item.name] = body
        solids += own
        lid = add_lid(plant, item, body, own[0])
        if lid is not None:
            lids[item.name] = lid
        if item.fixed:
            _hold(plant, item, body)
    slabs = [add_slab(plant, item.truth, bodies[item.name]) for item in scene.objects]
    rims = add_rims(plant, scene.table)
    soles = [add_sole(plant, item.truth, bodies[item.name]) for item in scene.objects]
    plant.Finalize()
    for item in scene.objects:
        if not item.fixed:
            X_WB = initial_pose(item, scene.level(item))
            plant.SetDefaultFloatingBaseBodyPose(bodies[item.name], X_WB)
    robot = [
        geometry
        for instance in robot_models
        for index in plant.GetBodyIndices(instance)
        for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index))
    ]
    standing = [foot for each in feet.values() for foot in each.geometries]
    filter_collisions(scene_graph, robot=robot, table=table, solids=solids, feet=standing)
    filter_lids(scene_graph, lids.values(), robot=robot, table=table, feet=standing)
    of_lids = [geometry for each in lids.values() for geometry in (*each.solids, *each.feet)]
    solid_ones = [*robot, table, *solids, *standing, *of_lids]
    filter_slabs(scene_graph, slabs, solid_ones)
    filter_rims(scene_graph, rims, soles, [*solid_ones, *slabs])
    return Plant(plant, scene_graph, bodies, feet, lids, *robot_models)


def _add_robot(
    plant: MultibodyPlant, scene: Scene, arm: ArmKinematics, hand: Hand
) -> tuple[ModelInstanceIndex, ModelInstanceIndex]:
    """Adds the arm on its base and the hand on its flange; returns their models."""
    from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
    from pydrake.multibody.parsing import Parser

    parser = Parser(plant)
    (arm_model,) = parser.AddModelsFromString(arm.model_file.read_text("utf-8"), "urdf")
    (hand_model,) = parser.AddModelsFromString(hand.model_file.read_text("utf-8"), "urdf")
    X_WA = RigidTransform(
        RollPitchYaw(np.radians(scene.robot.base_rpy_deg)), np.array(scene.robot.base_m)
    )
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(arm.base_link), X_WA)
    X_FP = RigidTransform(RotationMatrix(hand.R_FP), hand.p_FP)
    flange, palm = plant.GetFrameByName(arm.flange_link), plant.GetFrameByName(hand.palm_link)
    plant.WeldFrames(flange, palm, X_FP)
    # Gravity compensation of the arm and hand is taken as perfect.
    for instance in (arm_model, hand_model):
        plant.set_gravity_enabled(instance, False)
    return arm_model, hand_model


def add_table(plant: MultibodyPlant, scene: Scene) -> GeometryId:
    """Adds the table top, fixed to the world."""
    from pydrake.geometry import Box
    from pydrake.math import RigidTransform

    table = scene.table
    shape = Box(*table.size_m, table.thickness_m)
    X_WT = RigidTransform(np.array([*table.centre_m, -table.thickness_m / 2]))
    world = plant.world_body()
    plant.RegisterVisualGeometry(world, X_WT, shape, "table", np.array([0.62, 0.52, 0.42, 1.0]))
    return plant.RegisterCollisionGeometry(world, X_WT, shape, "table", surface(ROUGH))


def add_object(
    plant: MultibodyPlant, name: str, truth: Truth
) -> tuple[RigidBody, list[GeometryId], Feet]:
    """Adds an object; returns its body, its solids and the spheres on which it stands or lies."""
    from pydrake.geometry import Sphere
    from pydrake.math import RigidTransform

    body = plant.AddRigidBody(name, plant.AddModelInstance(name), inertia(truth))
    # A container is a shell through which one sees what is inside. Its floor, seen so, must
    # not lie in the plane of the table top.
    opacity, off_table = (1.0, 0.0) if truth.container is None else (0.35, 5e-4)
    X_BV = RigidTransform(np.array([0.0, 0.0, off_table]))
    colour = np.array([*truth.colour, opacity])
    skin = surface(truth.friction_finger / 2)
    solids = []
    for k, (shape, X_BG) in enumerate(_geometries(truth.shape)):
        part = f"wall_{k - 1}" if k else "solid"
        plant.RegisterVisualGeometry(body, X_BV @ X_BG, shape, part, colour)
        solids.append(plant.RegisterCollisionGeometry(body, X_BG, shape, part, skin))
    r = 1e-4  # of the spheres
    base = [(*_drawn_in(point, r), r) for point in truth.support]
    top = [(*_drawn_in(point, r), truth.shape.top - r) for point in truth.shape.crown]
    feet = [
        plant.RegisterCollisionGeometry(
            body,
            RigidTransform(np.array(p)),
            Sphere(r),
            f"foot_{i}",
            surface(truth.friction_table / 2),
        )
        for i, p in enumerate(base + top)
    ]
    return body, solids, Feet(feet, np.array(base + top))


def _hold(plant: MultibodyPlant, item: SceneObject, body: RigidBody) -> None:
    """Keeps an object where it stands, and draws what does so."""
    from pydrake.geometry import Box, Cylinder
    from pydrake.math import RigidTransform

    plant.WeldFrames(plant.world_frame(), body.body_frame(), initial_pose(item))
    thickness, height, colour = 0.008, 0.03, np.array([0.35, 0.37, 0.40, 1.0])
    outline, rim = np.array(item.truth.shape.silhouette), item.truth.shape.rim
    x, y = np.ptp(outline, axis=0) + 2.0 * thickness
    shape = Cylinder(rim.size + thickness, height) if rim.is_round else Box(x, y, height)
    X_BH = RigidTransform(np.array([*outline.mean(axis=0), height / 2]))
    plant.RegisterVisualGeometry(body, X_BH, shape, "holder", colour)


def _drawn_in(point: tuple[float, float], r: float) -> tuple[float, float]:
    """A corner moved inwards by a radius along each axis, so that a sphere there stays inside."""
    x, y = point
    return x - r * float(np.sign(x)), y - r * float(np.sign(y))


class _DrakeGeometry:
    """A solid in Drake, and where its own frame is in B."""

    def cuboid(self, solid: Cuboid) -> tuple[Shape, RigidTransform]:
        from pydrake.geometry import Box
        from pydrake.math import RigidTransform

        return Box(*solid.size), RigidTransform(solid.middle)

    def cylinder(self, solid: UprightCylinder) -> tuple[Shape, RigidTransform]:
        from pydrake.geometry import Cylinder
        from pydrake.math import RigidTransform

        return Cylinder(solid.radius, solid.length), RigidTransform(solid.middle)

    def hull(self, solid: ConvexHull) -> tuple[Shape, RigidTransform]:
        from pydrake.geometry import Convex
        from pydrake.math import RigidTransform

        return Convex(solid.vertices.T, "hull"), RigidTransform()


def _geometries(shape: TrueShape) -> list[tuple[Shape, RigidTransform]]:
    """The solids of a shape, and where they are in B."""
    return [solid.accept(_DrakeGeometry()) for solid in shape.solids]


def inertia(truth: Truth) -> SpatialInertia:
    """Mass spread evenly over the solids, about the true centre of mass."""
    from pydrake.multibody.tree import CalcSpatialInertia, SpatialInertia

    (first, X_BG), *others = _geometries(truth.shape)
    solid = CalcSpatialInertia(first, 1.0)
    for shape, X_BH in others:
        p_HG = X_BG.translation() - X_BH.translation()
        solid += CalcSpatialInertia(shape, 1.0).Shift(p_HG)
    G_GGcm = solid.get_unit_inertia().ShiftToCenterOfMass(solid.get_com())
    p_BBcm = np.array(truth.centre_of_mass)
    return SpatialInertia(truth.mass_kg, p_BBcm, G_GGcm.ShiftFromCenterOfMass(p_BBcm))


def filter_collisions(
    scene_graph: SceneGraph,
    *,
    robot: list[GeometryId],
    table: GeometryId,
    solids: list[GeometryId],
    feet: list[GeometryId],
) -> None:
    """Feet touch the table only, solids everything but the table, the robot not itself."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    pairs = CollisionFilterDeclaration()
    pairs.ExcludeBetween(GeometrySet(solids), GeometrySet(table))
    pairs.ExcludeBetween(GeometrySet(feet), GeometrySet(robot))
    pairs.ExcludeBetween(GeometrySet(feet), GeometrySet(solids))
    pairs.ExcludeWithin(GeometrySet(feet))
    pairs.ExcludeWithin(GeometrySet(robot))
    scene_graph.collision_filter_manager().Apply(pairs)


def pose_row(X: RigidTransform) -> Array:
    """A pose as a row of a trace: quaternion (w, x, y, z) and position, shape (7,)."""
    return np.append(X.rotation().ToQuaternion().wxyz(), X.translation())


def initial_pose(item: SceneObject, level: int = 0) -> RigidTransform:
    """Pose X_WB in which an object is at the start, with so many slabs below its own."""
    from pydrake.math import RigidTransform, RotationMatrix

    slabs = np.array([0.0, 0.0, 2.0 * STANDS_OUT * level])
    return RigidTransform(RotationMatrix(item.pose.R_WB), item.p_WB + slabs)
