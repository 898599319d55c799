"""Pushes of an object alone on a plane, by a force that grows slowly: onset and class.

- Random pushes of random objects on their corners, in Drake and in MuJoCo.
- The same of objects as other simulators read them: MJCF in MuJoCo, SDF and URDF in Drake. They
  are described by the files of `objectmodels.descriptions` with the settings that stand there.
- Whole faces of the kitchen's boxes in the simulated world, for what the robot believes and for
  the true parameters, which show what prediction and simulation differ by in themselves.
"""

from __future__ import annotations

import logging
import math
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from itertools import count, islice
from pathlib import Path

import numpy as np
from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.systems.framework import DiagramBuilder

from benchmarks.engines.agreement import Outcome
from benchmarks.worlds.drake import BodyInDrake, DrakeWorld
from benchmarks.worlds.pushes import STEP, Push, Stands, World, random_push, roll_out
from nlcontrol.outcome_maps.face_experiment import contacts_of
from nlcontrol.references.object_names import face_of
from nlcontrol.session.controller import Controller
from objectmodels import BoxModel, ObjectModel
from objectmodels.descriptions.description_reading import (
    Format,
    description_texts,
    write_description,
)
from objectmodels.mechanics.outcome_map import outcome_map
from sim.face_experiment import Contact, TouchResult, touch
from sim.simulated_executor import simulation
from sim.truth.scene_file import Scene

WITHOUT_MUJOCO = "MuJoCo is left out: it is not installed; pip install '.[dev]' brings it."
HAS_MUJOCO = find_spec("mujoco") is not None

_BAND = 0.05
_SPACING = 0.01  # between contacts of a face [m]
_SETTLING = 0.5  # slender objects rock a while on many feet [s]


def silence_drake() -> None:
    """Drops Drake's note that half spaces do not touch deformable bodies."""
    logging.getLogger("drake").setLevel(logging.ERROR)


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


def _in_mujoco(model: ObjectModel) -> World:
    from benchmarks.worlds.mujoco import MujocoWorld

    return MujocoWorld(model)


def _described_in_mujoco(model: ObjectModel) -> World:
    """The object of an MJCF text on a plane."""
    from benchmarks.worlds.mujoco import BodyInMujoco

    (text,) = description_texts(model, "mjcf").values()
    plane = '<worldbody>\n    <geom type="plane" size="1 1 1" friction="1 0 0"/>'
    return BodyInMujoco(text.replace("<worldbody>", plane))


WORLDS: dict[str, Callable[[ObjectModel], World]] = {
    "Drake": DrakeWorld,
    "MuJoCo": _in_mujoco,
    "mjcf": _described_in_mujoco,
    "sdf": lambda model: DescribedInDrake(model, "sdf"),
    "urdf": lambda model: DescribedInDrake(model, "urdf"),
}
"""An object alone on a plane, by engine, and by the format in which an engine reads it."""


@dataclass(frozen=True)
class PushCase:
    """A push in one of `WORLDS`."""

    group: str
    push: Push

    def prediction(self) -> tuple[str, float]:
        """See `benchmarks.engines.agreement.Case`."""
        return self.push.outcome, self.push.apart

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        seen = roll_out(WORLDS[self.group](self.push.model), self.push)
        details = f"noticed at {seen.noticed:.6g} N, slip {seen.slip:.2e} m/s, lift {seen.lift:.2e}"
        return Outcome(seen.outcome, {"onset": seen.onset / self.push.onset - 1.0}, details)


def pushes(cases: int, seed: int) -> list[PushCase]:
    """So many random pushes in each engine."""
    return _in_worlds(("Drake", "MuJoCo"), (random_push(seed, k) for k in range(cases)))


def described(cases: int, seed: int, stands: Stands = "corners") -> list[PushCase]:
    """The first pushes of a seed whose thresholds lie apart, in all formats."""
    return _in_worlds(("mjcf", "sdf", "urdf"), islice(clear_pushes(seed, stands), cases))


def clear_pushes(seed: int, stands: Stands) -> Iterator[Push]:
    """The pushes of a seed whose thresholds lie apart."""
    every = (random_push(seed, number, stands) for number in count())
    return (push for push in every if push.apart > _BAND)


def _in_worlds(names: Iterable[str], drawn: Iterable[Push]) -> list[PushCase]:
    installed = [name for name in names if HAS_MUJOCO or name not in ("MuJoCo", "mjcf")]
    made = list(drawn)
    return [PushCase(name, push) for name in installed for push in made]


@dataclass(frozen=True)
class FaceCase:
    """A push at a contact of a face.

    Attributes:
        group: object, and by what parameters it is predicted.
        scene: as it is.
        contact: where and which way.
        predicted: class.
        apart: distance of both thresholds, as a share of the force.
        force: that is predicted [N].
    """

    group: str
    scene: Scene = field(repr=False)
    contact: Contact
    predicted: str
    apart: float
    force: float

    def prediction(self) -> tuple[str, float]:
        """See `benchmarks.engines.agreement.Case`."""
        return self.predicted, self.apart

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        result = _touched(_Place(self.contact, self.scene))
        if result.force is None or not math.isfinite(self.force):
            return Outcome(result.outcome, details=result.detail)
        return Outcome(result.outcome, {"force": self.force / result.force - 1.0})


@dataclass(frozen=True)
class _Place:
    contact: Contact
    scene: Scene = field(compare=False)


@lru_cache(maxsize=2)
def _touched(place: _Place) -> TouchResult:
    """What the simulated world does; the next case is the same push by other parameters."""
    return touch(place.scene, place.contact)


def true_model(controller: Controller, name: str) -> ObjectModel:
    """The belief about an object with the scene's true parameters in it; its shape is right."""
    truth = simulation(controller.executor).truth(name)
    belief = controller.models[name]
    stated = belief.model_dump(exclude={"friction_radius", "friction_radius_sd", "correlations"})
    changes = {
        "mass": truth.mass_kg,
        "friction": truth.friction_table,
        "com": truth.centre_of_mass,
        "support": [list(point) for point in truth.support],
    }
    return type(belief).model_validate(stated | changes)


def faces(cases: int, _: int) -> list[FaceCase]:
    """Contacts of the front faces of the kitchen's boxes, the first so many of each."""
    controller = Controller("kitchen")
    scene = simulation(controller.executor).scene
    made = []
    for name, belief in controller.models.items():
        if not isinstance(belief, BoxModel):
            continue
        models = {"believed": belief, "true": true_model(controller, name)}
        charts = {
            how: outcome_map(model, face_of(model, "front"), spacing=_SPACING)
            for how, model in models.items()
        }
        for k, contact in enumerate(contacts_of(charts["believed"], name, "front")[:cases]):
            for how, chart in charts.items():
                slide, topple = float(chart.slide[k]), float(chart.topple[k])
                force = min(slide, topple)
                predicted, apart = "none", math.inf
                if math.isfinite(force):
                    predicted = "slide" if slide < topple else "topple"
                    apart = abs(slide - topple) / force
                made.append(FaceCase(f"{name}, {how}", scene, contact, predicted, apart, force))
    return made
