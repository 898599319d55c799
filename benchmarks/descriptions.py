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

import numpy as np
from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlantConfig,
)
from pydrake.systems.framework import DiagramBuilder

from benchmarks.drake_push import BodyInDrake
from benchmarks.mujoco_push import BodyInMujoco
from benchmarks.pushes import STEP, Push, Stands, World, random_push, roll_out
from objectmodels.descriptions.description_reading import (
    Format,
    description_texts,
    write_description,
)
from objectmodels.models.object_model import ObjectModel

FORMATS: tuple[Format, ...] = ("mjcf", "sdf", "urdf")
_BAND = 0.05
_SETTLING = 0.5  # slender objects rock a while on many feet [s]


class DescribedInMujoco(BodyInMujoco):
    """The object of an MJCF text on a plane."""

    def __init__(self, model: ObjectModel) -> None:
        (text,) = description_texts(model, "mjcf").values()
        plane = '<worldbody>\n    <geom type="plane" size="1 1 1" friction="1 0 0"/>'
        super().__init__(text.replace("<worldbody>", plane))


class DescribedInDrake(BodyInDrake):
    """The object of an SDF or URDF file on a plane."""

    def __init__(self, model: ObjectModel, form: Format) -> None:
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=STEP, discrete_contact_approximation="sap")
        plant, _ = AddMultibodyPlant(config, builder)
        with tempfile.TemporaryDirectory() as folder:
            first, *_ = write_description(model, form, Path(folder))
            (instance,) = Parser(plant).AddModels(str(first))
        (index,) = plant.GetBodyIndices(instance)
        hard = ProximityProperties()
        # Drake takes 2ab/(a + b) of two coefficients, so the table has that of the feet.
        friction = CoulombFriction(model.friction, model.friction)
        AddContactMaterial(point_stiffness=1e12, friction=friction, properties=hard)
        hard.AddProperty("material", "relaxation_time", 0.0)
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), "table", hard
        )
        super().__init__(builder, plant, plant.get_body(index))
        while self.steps < _SETTLING / STEP:
            self.step(np.zeros(3), np.zeros(3))


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
