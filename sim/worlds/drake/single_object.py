"""An object of a scene alone on the table, without a robot, pushed by forces applied to it.

The contact approximation is the one of `sim.worlds.drake.drake_plant`, lagged, but with a hundredth
of its stiction tolerance: nothing chatters here, and the object creeps by ten micrometres before it
moves instead of a tenth of a millimetre.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.truth.scene_file import Scene, sample_world
from sim.worlds.drake.drake_plant import (
    Standing,
    add_empty_plant,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)
from sim.worlds.drake.drake_world import world_changes


class SingleObjectWorld:
    """An object of a scene alone on the table, in Drake.

    Attributes:
        scene: what is true.
        step_time: of a step, the scene's [s].
        R_WB: orientation in which it stands.
    """

    def __init__(self, scene: Scene, name: str, seed: int) -> None:
        from pydrake.multibody.plant import ExternallyAppliedSpatialForce
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        self.scene = scene = sample_world(scene, seed)
        self.step_time = scene.time_step_s
        builder = DiagramBuilder()
        self._plant, scene_graph = add_empty_plant(builder, self.step_time, stiction=1e-6)
        table = add_table(self._plant, scene)
        item = scene.object(name)
        self._body, solids, feet = add_object(self._plant, name, item.truth)
        self._plant.Finalize()
        X_WB = initial_pose(item)
        self._plant.SetDefaultFloatingBaseBodyPose(self._body, X_WB)
        filter_collisions(scene_graph, robot=[], table=table, solids=solids, feet=feet.geometries)
        self.R_WB = X_WB.rotation().matrix()
        self._push = ExternallyAppliedSpatialForce()
        self._push.body_index = self._body.index()
        self._port = self._plant.get_applied_spatial_force_input_port()
        self._simulator = Simulator(builder.Build())
        self._root = self._simulator.get_mutable_context()
        self._context = self._plant.GetMyMutableContextFromRoot(self._root)
        model = Standing(self._plant, scene_graph, {name: self._body}, {name: feet}, {})
        for change in world_changes(model, self._root, scene, seed):
            change.prepare([name], {name: (self.R_WB, X_WB.translation())})
        self._steps = 0
        # The feet sink in until they carry the weight.
        self._rested = math.ceil(0.1 / self.step_time)
        for _ in range(self._rested):
            self.step(np.zeros(3), np.zeros(3))
        self._settled = self._root.Clone()

    def restart(self) -> Array:
        """Puts it back to rest; returns its pose, quaternion (w, x, y, z) and p_WB [m], (7,)."""
        self._root.SetTimeStateAndParametersFrom(self._settled)
        self._steps = self._rested
        self._simulator.Initialize()
        return self._pose()

    def step(self, point: Array, f_BC_W: Array) -> Array:
        """One step under a force [N] at a point p_BC [m]; returns its pose as `restart` does."""
        from pydrake.multibody.math import SpatialForce

        self._push.p_BoBq_B = point
        self._push.F_Bq_W = SpatialForce(np.zeros(3), f_BC_W)
        self._port.FixValue(self._context, [self._push])
        self._steps += 1
        self._simulator.AdvanceTo(self._steps * self.step_time, interruptible=False)
        return self._pose()

    def _pose(self) -> Array:
        return np.array(self._plant.GetPositions(self._context))


@lru_cache(maxsize=8)
def single_object_world(scene: Scene, name: str, seed: int) -> SingleObjectWorld:
    """The world of one object; the same one again for the same arguments, as it was left."""
    return SingleObjectWorld(scene, name, seed)
