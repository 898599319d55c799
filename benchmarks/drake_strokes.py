"""Strokes in Drake: an object as in the simulated world, obstacles, and fingertips on springs.

Table, objects, contact approximation and step are those of `sim.worlds.drake.drake_plant`; but all
objects except the one that is pushed stand as if they were glued to the table, which costs a third
of the time. Each fingertip is a sphere on three sliding joints, so that two of them keep their
distance without a hand.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.strokes import (
    DAMPING,
    PERIOD,
    STIFFNESS,
    STRONGEST,
    TIP_MASS,
    Array,
    Rolled,
    Stroke,
    offsets,
)
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_bodies import ROUGH, ContactWatch, surface
from sim.worlds.drake.drake_plant import (
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

if TYPE_CHECKING:
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import ModelInstanceIndex

_STICTION = 1e-4  # as in the simulated world [m/s]
_SETTLING = 0.1  # in which feet sink in [s]
_SHORTEST_REST, _LONGEST_REST = 0.25, 1.5  # after a stroke, until nothing moves [s]
_STILL = 2e-3  # largest speed of what is still [m/s]
_ARM = 0.1  # at which turning counts as speed [m]
_AWAY = np.array([0.0, 0.0, 2.0])  # where fingertips wait [m]


class DrakeBench:
    """The objects of a scene and one or two fingertips; a `benchmarks.strokes.Bench`.

    Args:
        scene: what is true.
        pushed: name of the object that may move.
        fingers: how many fingertips.
    """

    def __init__(self, scene: Scene, pushed: str, fingers: int = 1) -> None:
        from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=scene.time_step_s,
            contact_model="point",
            discrete_contact_approximation="lagged",
            stiction_tolerance=_STICTION,
            use_sampled_output_ports=False,
        )
        self._plant, scene_graph = AddMultibodyPlant(config, builder)
        plant = self._plant
        table = add_table(plant, scene)
        added = {item.name: add_object(plant, item) for item in scene.objects}
        self._tips = {f"tip {k}": add_tip(plant, f"tip {k}") for k in range(fingers)}
        for item in scene.objects:
            if item.name != pushed:
                frame = added[item.name][0].body_frame()
                plant.WeldFrames(plant.world_frame(), frame, initial_pose(item))
        plant.Finalize()
        self._pushed = added[pushed][0]
        plant.SetDefaultFloatingBaseBodyPose(self._pushed, initial_pose(scene.object(pushed)))
        spheres = [
            geometry
            for name in self._tips
            for geometry in plant.GetCollisionGeometriesForBody(plant.GetBodyByName(name))
        ]
        filter_collisions(
            scene_graph,
            robot=spheres,
            table=table,
            solids=[solid for _, solids, _ in added.values() for solid in solids],
            feet=[foot for *_, feet in added.values() for foot in feet.geometries],
        )
        self._bodies = {name: body for name, (body, *_) in added.items()}
        self._simulator = Simulator(builder.Build())
        self._root = self._simulator.get_mutable_context()
        self._context = plant.GetMyMutableContextFromRoot(self._root)
        self._put(np.tile(_AWAY, (fingers, 1)) + offsets(fingers, 0.0))
        self._wait(_SETTLING)

    def keep(self) -> object:
        """See `benchmarks.strokes.Bench`."""
        return self._root.Clone()

    def back(self, state: object) -> None:
        """See `benchmarks.strokes.Bench`."""
        self._root.SetTimeStateAndParametersFrom(state)
        self._simulator.Initialize()

    def roll(self, stroke: Stroke, speed: float) -> Rolled:
        """See `benchmarks.strokes.Bench`."""
        beside = offsets(len(self._tips), stroke.heading)
        path, there = stroke.path(speed)
        watch = ContactWatch(self._plant, self._bodies)
        self._put(path[0] + beside)
        samples: list[tuple[Array, Array, Array]] = []
        touched: set[frozenset[str]] = set()
        for before, now in itertools.pairwise(path):
            self._command(now + beside, (now - before) / PERIOD)
            samples.append(self._sampled(watch, touched))
        self._put(np.tile(_AWAY, (len(beside), 1)) + beside)
        rests = 0
        while rests < round(_LONGEST_REST / PERIOD):
            samples.append(self._sampled(watch, touched))
            rests += 1
            if rests >= round(_SHORTEST_REST / PERIOD) and self._is_still():
                break
        poses, tips, felt = (np.array(column) for column in zip(*samples, strict=True))
        return Rolled(
            poses={name: poses[:, k] for k, name in enumerate(self._bodies)},
            tips={name: tips[:, k] for k, name in enumerate(self._tips)},
            felt={name: felt[:, k] for k, name in enumerate(self._tips)},
            pushing=np.arange(len(poses)) < there.sum(),
            touched=frozenset(touched),
        )

    def poses(self) -> dict[str, Array]:
        """See `benchmarks.strokes.Bench`."""
        return {name: self._pose(name) for name in self._bodies}

    def _sampled(
        self, watch: ContactWatch, touched: set[frozenset[str]]
    ) -> tuple[Array, Array, Array]:
        self._wait(PERIOD)
        watch.note(self._root.get_time(), self._context)
        touched |= {frozenset((e.body_a, e.body_b)) for e in watch.begun}
        poses = np.array([self._pose(name) for name in self._bodies])
        tips = np.array([self._plant.GetPositions(self._context, i) for i in self._tips.values()])
        ports = (self._plant.get_net_actuation_output_port(i) for i in self._tips.values())
        return poses, tips, np.array([port.Eval(self._context) for port in ports])

    def _is_still(self) -> bool:
        V_WB = self._plant.EvalBodySpatialVelocityInWorld(self._context, self._pushed)
        turning = np.linalg.norm(V_WB.rotational()) < _STILL / _ARM
        return bool(turning and np.linalg.norm(V_WB.translational()) < _STILL)

    def _pose(self, name: str) -> Array:
        X_WB = self._plant.EvalBodyPoseInWorld(self._context, self._bodies[name])
        return np.array([*X_WB.rotation().ToQuaternion().wxyz(), *X_WB.translation()])

    def _put(self, places: Array) -> None:
        """Fingertips at places, at rest."""
        for instance, place in zip(self._tips.values(), places, strict=True):
            self._plant.SetPositions(self._context, instance, place)
            self._plant.SetVelocities(self._context, instance, np.zeros(3))
        self._command(places, np.zeros(3))
        self._simulator.Initialize()

    def _command(self, places: Array, velocity: Array) -> None:
        for instance, place in zip(self._tips.values(), places, strict=True):
            port = self._plant.get_desired_state_input_port(instance)
            port.FixValue(self._context, np.concatenate([place, velocity]))

    def _wait(self, seconds: float) -> None:
        self._simulator.AdvanceTo(self._root.get_time() + seconds, interruptible=False)


def add_tip(plant: MultibodyPlant, name: str) -> ModelInstanceIndex:
    """A fingertip that slides along the axes of W."""
    from pydrake.geometry import Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import (
        PdControllerGains,
        PrismaticJoint,
        SpatialInertia,
        UnitInertia,
    )

    instance = plant.AddModelInstance(name)
    solid = UnitInertia.SolidSphere(HAND.tip_radius)
    share = TIP_MASS / 3.0
    frame = plant.world_frame()
    for axis, label in zip(np.eye(3), ("x", "y", "z"), strict=True):
        last = label == "z"
        body = plant.AddRigidBody(
            name if last else f"{name} {label}", instance, SpatialInertia(share, np.zeros(3), solid)
        )
        joint = plant.AddJoint(PrismaticJoint(f"{name} {label}", frame, body.body_frame(), axis))
        actuator = plant.AddJointActuator(f"{name} {label}", joint, STRONGEST)
        actuator.set_controller_gains(PdControllerGains(p=STIFFNESS, d=DAMPING))
        frame = body.body_frame()
    plant.RegisterCollisionGeometry(
        body, RigidTransform(), Sphere(HAND.tip_radius), "tip", surface(ROUGH)
    )
    plant.set_gravity_enabled(instance, False)
    return instance
