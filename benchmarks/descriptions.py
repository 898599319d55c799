"""Models as other simulators read them, pushed there: MJCF in MuJoCo, SDF and URDF in Drake.

    python -m benchmarks.descriptions [--pushes 60] [--seed 0] [--stands weighted]

Random pushes of the random objects of `benchmarks.pushes`, which are described by the files of
`objectmodels.descriptions` with the settings that stand there. It prints, by format, how often the
class is that of the exact tier among pushes whose two thresholds lie more than 5 % apart, and how
far the onsets differ.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import get_args

import mujoco
import numpy as np
from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlantConfig,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from benchmarks.pushes import STEP, Array, Push, Stands, World, random_push, roll_out
from objectmodels.descriptions.description_files import Format, description_texts, write_description
from objectmodels.models.object_model import ObjectModel

FORMATS: tuple[Format, ...] = ("mjcf", "sdf", "urdf")
_BAND = 0.05
_SETTLING = 0.5  # slender objects rock a while on many feet [s]


class DescribedInMujoco:
    """The object of an MJCF text on a plane; a `benchmarks.pushes.World`."""

    def __init__(self, model: ObjectModel) -> None:
        (text,) = description_texts(model, "mjcf").values()
        plane = '<worldbody>\n    <geom type="plane" size="1 1 1" friction="1 0 0"/>'
        self.model = mujoco.MjModel.from_xml_string(text.replace("<worldbody>", plane))
        self.data = mujoco.MjData(self.model)
        self.rotation = np.empty(9)
        mujoco.mj_forward(self.model, self.data)

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.pushes.World`."""
        position, velocity, applied = self.data.qpos, self.data.qvel, self.data.qfrc_applied
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        applied[:] = 0.0
        at = position[:3] + self.rotation.reshape(3, 3) @ point
        mujoco.mj_applyFT(self.model, self.data, force, np.zeros(3), at, 1, applied)
        mujoco.mj_step(self.model, self.data)
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        return self.rotation.reshape(3, 3) @ velocity[3:], velocity[:3].copy()


class DescribedInDrake:
    """The object of an SDF or URDF file on a plane; a `benchmarks.pushes.World`."""

    def __init__(self, model: ObjectModel, form: Format) -> None:
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=STEP, discrete_contact_approximation="sap")
        self.plant, _ = AddMultibodyPlant(config, builder)
        with tempfile.TemporaryDirectory() as folder:
            first, *_ = write_description(model, form, Path(folder))
            (instance,) = Parser(self.plant).AddModels(str(first))
        (index,) = self.plant.GetBodyIndices(instance)
        self.body = self.plant.get_body(index)
        hard = ProximityProperties()
        # Drake takes 2ab/(a + b) of two coefficients, so the table has that of the feet.
        AddContactMaterial(
            point_stiffness=1e12,
            friction=CoulombFriction(model.friction, model.friction),
            properties=hard,
        )
        hard.AddProperty("material", "relaxation_time", 0.0)
        self.plant.RegisterCollisionGeometry(
            self.plant.world_body(), RigidTransform(), HalfSpace(), "table", hard
        )
        self.plant.Finalize()
        self.simulator = Simulator(builder.Build())
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.push = ExternallyAppliedSpatialForce()
        self.push.body_index = index
        self.applied = self.plant.get_applied_spatial_force_input_port()
        self.steps = 0
        while self.steps < _SETTLING / STEP:
            self.step(np.zeros(3), np.zeros(3))

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.pushes.World`."""
        self.push.p_BoBq_B = point
        self.push.F_Bq_W = SpatialForce(np.zeros(3), force)
        self.applied.FixValue(self.context, [self.push])
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * STEP, interruptible=False)
        velocity = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
        return velocity.rotational(), velocity.translational()


def described_world(model: ObjectModel, form: Format) -> World:
    """The object in an engine, as it is described by a format."""
    return DescribedInMujoco(model) if form == "mjcf" else DescribedInDrake(model, form)


def clear_pushes(seed: int, count: int, stands: Stands) -> list[Push]:
    """The first pushes of a seed whose thresholds lie apart."""
    found: list[Push] = []
    number = 0
    while len(found) < count:
        push = random_push(seed, number, stands)
        number += 1
        if push.apart > _BAND:
            found.append(push)
    return found


def main() -> None:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pushes", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--stands", choices=get_args(Stands), default="corners")
    args = parser.parse_args()
    pushes = clear_pushes(args.seed, args.pushes, args.stands)
    for form in FORMATS:
        right, off = 0, []
        for push in pushes:
            seen = roll_out(described_world(push.model, form), push)
            right += seen.outcome == push.outcome
            off.append(abs(seen.onset / push.onset - 1.0) if np.isfinite(seen.onset) else np.inf)
        middle, most = np.percentile(off, [50, 95])
        print(
            f"{form:5} {right} of {len(pushes)} classes; onset off by "
            f"{100 * middle:.1f} % (median), {100 * most:.1f} % (95th)"
        )


if __name__ == "__main__":
    main()
