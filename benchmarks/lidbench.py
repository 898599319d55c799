"""An object with a lid alone on a table in Drake, and what opens it: a fingertip, a pull, a turn.

The fingertip is a sphere on springs that goes where it is told and does not turn; pulls and turns
are forces on the lid itself. The lids are those of the simulated world
(`sim.worlds.drake.contents`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from benchmarks.drake_strokes import add_tip
from objectmodels.containers.lids import (
    THICKNESS,
    grip_distance,
    lid_hinge,
)
from objectmodels.geometry.rotations import Array
from objectmodels.models.object_parts import FlipLid
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene, SceneObject
from sim.worlds.drake.contents import Lids
from sim.worlds.drake.drake_bodies import add_lid, filter_lids
from sim.worlds.drake.drake_plant import (
    Standing,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

if TYPE_CHECKING:
    from pydrake.multibody.plant import MultibodyPlant

PERIOD = 0.01
"""Of a control step [s]."""

SPEED = 0.03
"""Of the fingertip [m/s]."""

_STICTION = 1e-4  # as in the simulated world [m/s]
_BELOW = 0.004  # how far under the tab the fingertip starts [m]
_SETTLING = 0.2  # [s]
_PULL, _TURN = 1.0, 0.02  # how fast a pull and a torque grow [N/s], [N·m/s]
_GIVEN_WAY = 0.002, np.radians(3.0)  # movement of an object that has come along [m], [rad]


class Opened(NamedTuple):
    """What became of a lid and its object.

    Attributes:
        lid: how far it was opened, as in `sim.traces.trace.Trace.lids`.
        tilt: largest tilt of the object [rad].
        shift: largest displacement of it [m].
        turn: of it about the vertical [rad].
        force: largest force or torque that was applied [N], [N·m].
    """

    lid: float
    tilt: float
    shift: float
    turn: float
    force: float

    @property
    def came_along(self) -> bool:
        """Whether the object moved."""
        far, much = _GIVEN_WAY
        return bool(self.shift > far or self.tilted or abs(self.turn) > much)

    @property
    def tilted(self) -> bool:
        """Whether it tilted."""
        return bool(self.tilt > _GIVEN_WAY[1])


@dataclass(frozen=True)
class _Start:
    R_WB: Array
    p_WB: Array


class LidBench:
    """A scene with one object that has a lid.

    Args:
        scene: with the object.
    """

    def __init__(self, scene: Scene) -> None:
        from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        (self._item,) = scene.objects
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=scene.time_step_s,
            contact_model="point",
            discrete_contact_approximation="lagged",
            stiction_tolerance=_STICTION,
            use_sampled_output_ports=False,
        )
        self._plant, scene_graph = AddMultibodyPlant(config, builder)
        self._model = _furnished(self._plant, scene_graph, scene, self._item)
        self._simulator = Simulator(builder.Build())
        self._root = self._simulator.get_mutable_context()
        self._context = self._plant.GetMyMutableContextFromRoot(self._root)
        self._tip = self._plant.GetModelInstanceByName("tip")
        self._lids = Lids(self._model, self._root)
        self._time = 0.0
        self._put(np.array([0.0, 0.0, 1.0]))
        self.wait(_SETTLING)
        self._start = _Start(*self._pose())

    @property
    def lid(self) -> float:
        """How far the lid is open now."""
        return self._lids.lid_openings()[self._item.name]

    def flip(self, end: float, start: float = 0.0) -> Opened:
        """Moves a flip lid by its tab from one angle to another [rad]."""
        lid = self._item.truth.lid
        assert isinstance(lid, FlipLid)
        hinge = lid_hinge(lid, self._item.truth.rim, self._item.truth.height)
        lever = grip_distance(lid, hinge)
        opens = end > start
        above = -HAND.tip_radius if opens else HAND.tip_radius + THICKNESS
        off = -_BELOW if opens else _BELOW
        steps = int(abs(end - start) * lever / (SPEED * PERIOD))
        angles = np.linspace(start, end, steps)
        way = [hinge.lid_point(start, lever, above + off * s) for s in np.linspace(1.0, 0.0, 20)]
        way += list(hinge.lid_point(angles, lever, above))
        way_W = [self._start.p_WB + self._start.R_WB @ p for p in way]
        self._put(way_W[0])
        seen = [self._along(before, now) for before, now in itertools.pairwise(way_W)]
        self._put(np.array([0.0, 0.0, 1.0]))
        return self._opened([(tilt, shift) for tilt, shift, _ in seen], max(f for *_, f in seen))

    def push_lid(self, torque: float, seconds: float = 1.0) -> float:
        """How far a constant torque about a flip lid's hinge opens it in some time [rad]."""
        (each,) = self._model.lids.values()
        axis = each.joint.revolute_axis()
        for _ in range(round(seconds / PERIOD)):
            R_WB, _ = self._pose()
            self._apply(np.zeros(3), torque * (R_WB @ axis))
            self.wait(PERIOD)
        self._apply(np.zeros(3), np.zeros(3))
        return self.lid

    def pull(self, most: float) -> Opened:
        """Pulls the lid up by a force that grows until it is off or the object comes along [N]."""
        return self._grown(np.array([0.0, 0.0, 1.0]), np.zeros(3), _PULL, most)

    def raise_lid(self, force: float, height: float) -> None:
        """Pulls the lid up by a constant force [N] until it is so far from its seat [m]."""
        self._apply(np.array([0.0, 0.0, force]), np.zeros(3))
        while self.lid < height:
            self.wait(PERIOD)
        self._apply(np.zeros(3), np.zeros(3))

    def turn(self, most: float) -> Opened:
        """Turns the cap by a torque that grows until it or the object gives way [N·m]."""
        return self._grown(np.zeros(3), np.array([0.0, 0.0, 1.0]), _TURN, most)

    def _grown(self, force: Array, torque: Array, rate: float, most: float) -> Opened:
        seen, size = [], 0.0
        far, much = _GIVEN_WAY
        while size < most:
            size += rate * PERIOD
            self._apply(size * force, size * torque)
            self.wait(PERIOD)
            seen.append(self._moved())
            limit = far if force.any() else much
            if self.lid > limit or self._opened(seen, size).came_along:
                break
        self._apply(np.zeros(3), np.zeros(3))
        return self._opened(seen, size)

    def _opened(self, seen: list[tuple[float, float]], force: float) -> Opened:
        tilts, shifts = zip(*seen, strict=True)
        R = self._start.R_WB.T @ self._pose()[0]
        turn = float(np.arctan2(R[1, 0], R[0, 0]))
        return Opened(self.lid, max(tilts), max(shifts), turn, force)

    def _along(self, before: Array, now: Array) -> tuple[float, float, float]:
        """A step of the fingertip; tilt and shift of the object and the fingertip's force."""
        self._command(now, (now - before) / PERIOD)
        self.wait(PERIOD)
        torques = self._plant.get_net_actuation_output_port(self._tip).Eval(self._context)
        return *self._moved(), float(np.linalg.norm(torques))

    def _moved(self) -> tuple[float, float]:
        R_WB, p_WB = self._pose()
        tilt = float(np.arccos(np.clip(R_WB[2, 2], -1.0, 1.0)))
        return tilt, float(np.linalg.norm(p_WB - self._start.p_WB))

    def _pose(self) -> tuple[Array, Array]:
        X_WB = self._plant.EvalBodyPoseInWorld(self._context, self._model.bodies[self._item.name])
        return X_WB.rotation().matrix(), X_WB.translation()

    def _apply(self, force: Array, torque: Array) -> None:
        from pydrake.multibody.math import SpatialForce
        from pydrake.multibody.plant import ExternallyAppliedSpatialForce

        (each,) = self._model.lids.values()
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = each.body.index()
        applied.F_Bq_W = SpatialForce(torque, force)
        self._plant.get_applied_spatial_force_input_port().FixValue(self._context, [applied])

    def _put(self, place: Array) -> None:
        self._plant.SetPositions(self._context, self._tip, place)
        self._plant.SetVelocities(self._context, self._tip, np.zeros(3))
        self._command(place, np.zeros(3))

    def _command(self, place: Array, velocity: Array) -> None:
        port = self._plant.get_desired_state_input_port(self._tip)
        port.FixValue(self._context, np.concatenate([place, velocity]))

    def wait(self, seconds: float) -> None:
        """Lets time pass [s]."""
        for _ in range(round(seconds / PERIOD)):
            self._lids.prepare([], {})
            self._time += PERIOD
            self._simulator.AdvanceTo(self._time, interruptible=False)


def _furnished(
    plant: MultibodyPlant, scene_graph: object, scene: Scene, item: SceneObject
) -> Standing:
    """Table, object, lid and fingertip, finalised."""
    table = add_table(plant, scene)
    bare = item.model_copy(update={"truth": item.truth.without_lid})
    body, solids, feet = add_object(plant, bare)
    lid = add_lid(plant, item, body, solids[0])
    assert lid is not None
    if item.fixed:
        plant.WeldFrames(plant.world_frame(), body.body_frame(), initial_pose(item))
    tip = add_tip(plant, "tip")
    plant.Finalize()
    if not item.fixed:
        plant.SetDefaultFloatingBaseBodyPose(body, initial_pose(item))
    spheres = [
        geometry
        for index in plant.GetBodyIndices(tip)
        for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index))
    ]
    standing = feet.geometries
    filter_collisions(scene_graph, robot=spheres, table=table, solids=solids, feet=standing)
    filter_lids(scene_graph, [lid], robot=spheres, table=table, feet=standing)
    name = item.name
    return Standing(plant, scene_graph, {name: body}, {name: feet}, {name: lid})
