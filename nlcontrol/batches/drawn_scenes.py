"""Scenes drawn by seed: which objects stand where, and how they really are.

Each scene holds one to six of the registry's objects that the hand can push. Their true parameters
lie evenly within bounds around what the built-in models say (`MASS`, `FRICTION`, …). They stand
anywhere in `STANDING`, turned by any angle, at least `GAP` apart, so that a hand gets between them;
one for which no place is found is left out. The first object is the one that will be spoken of: it
stands in `REACHED`. Of the others some are fragile.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from nlcontrol.batches.rows import DrawnScene
from objectmodels import ObjectModel, Registry
from planner.problem.footprints import footprint, overlaps
from planner.types.world_state import PlanarPose, SeenObject
from sim.motion.robot_reach import lowest_contact
from sim.robots.cell_description import Vision
from sim.robots.robots import HAND
from sim.truth.object_truth import GREY, Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject, built_in_scenes, load_scene

Generator = np.random.Generator

MASS, FRICTION, FINGER_FRICTION = 0.20, 0.20, 0.15
"""Largest relative difference of truth and model."""
CENTRE_OF_MASS = 0.003
"""Largest difference of truth and model along each axis of B [m]."""
MOST = 6
"""Objects in a scene."""
STANDING = ((0.40, 0.70), (-0.35, 0.35))
"""Where objects stand: least and largest x and y [m]."""
REACHED = ((0.42, 0.68), (-0.28, 0.28))
"""Where the object stands that is spoken of: the arm gets around it [m]."""
GAP = 0.08
"""Least room between two objects: a hand is some 10 cm deep, its fingers are slimmer [m]."""
FRAGILE = 0.25
"""Share of the objects not spoken of that are fragile."""

_HANDLED = frozenset({"ice tea", "ice tea cup", "jar", "storage bin"})


def draw_scene(recipe: DrawnScene) -> Scene:
    """Draws the scene of a recipe, which depends on the recipe alone.

    Raises:
        ModelError: `unknown_object`.
    """
    among = pushable_models()
    if recipe.object is not None:
        among = (Registry.built_in().find_one(recipe.object),)
    rng = np.random.default_rng(recipe.seed)
    name = f"{recipe.draw}-{recipe.seed}"
    return draw_scene_with(name, rng, among, alone=recipe.draw == "alone")


def draw_scene_with(
    name: str,
    rng: Generator,
    among: Sequence[ObjectModel],
    *,
    alone: bool,
) -> Scene:
    """Draws a scene from a generator.

    Args:
        name: of the scene.
        rng: the generator.
        among: models, one of which is that of the first object.
        alone: whether that is the only one.
    """
    first = among[int(rng.integers(len(among)))]
    others = [model for model in pushable_models() if model.name != first.name]
    count = 0 if alone else int(rng.integers(MOST))
    chosen = [others[index] for index in rng.permutation(len(others))[:count].tolist()]
    objects: list[SceneObject] = []
    standing: list[SeenObject] = []
    for model in (first, *chosen):
        spans = STANDING if standing else REACHED
        truth, fragile = draw_truth(model, rng), bool(standing) and bool(rng.random() < FRAGILE)
        pose = free_place(model, spans, standing, rng)
        if pose is None:
            continue
        standing.append(SeenObject(model.name, pose, model))
        where = Pose(x_m=pose.x, y_m=pose.y, yaw_deg=float(np.degrees(pose.yaw)))
        objects.append(
            SceneObject(name=model.name, model=model.name, pose=where, truth=truth, fragile=fragile)
        )
    return scene_of(name, objects, Vision())


@cache
def pushable_models() -> tuple[ObjectModel, ...]:
    """Built-in models that are high enough for a fingertip.

    Those that are there to be opened and poured, or to be put into, are left out, so that figures
    of pushing stay comparable.
    """
    models = (model for model in Registry.built_in() if model.name not in _HANDLED)
    # An object must be 10 mm higher than the lowest contact.
    return tuple(model for model in models if model.top > lowest_contact(HAND) + 0.01)


def scene_of(name: str, objects: Sequence[SceneObject], vision: Vision) -> Scene:
    """A scene with the default scene's robot."""
    return Scene(version=1, name=name, vision=vision, objects=tuple(objects))


def free_place(
    model: ObjectModel,
    spans: tuple[tuple[float, float], ...],
    standing: Sequence[SeenObject],
    rng: Generator,
    apart: float = GAP,
) -> PlanarPose | None:
    """A free place for one more object; None if none is found.

    Args:
        model: of the object.
        spans: least and largest x and y [m].
        standing: the others.
        rng: to draw from.
        apart: least distance from the others [m].
    """
    # 200 places are tried for an object before it is left out.
    for _ in range(200):
        x, y = (float(rng.uniform(*span)) for span in spans)
        quarters = int(rng.integers(4))
        yaw = np.radians(90.0 * quarters + 45.0 * float(rng.uniform(-1.0, 1.0)))
        pose = PlanarPose(x, y, float(np.arctan2(np.sin(yaw), np.cos(yaw))))
        covered = footprint(SeenObject(model.name, pose, model))
        if not any(overlaps(covered, footprint(other), apart) for other in standing):
            return pose
    return None


def draw_truth(model: ObjectModel, rng: Generator) -> Truth:
    """Draws how an object of a model really is, within the bounds."""
    mass, friction, finger, *shift = rng.uniform(-1.0, 1.0, 6).tolist()
    changed = truth_as_believed(model, _colours().get(model.name, GREY)).model_copy(
        update={
            "mass_kg": model.mass * (1.0 + MASS * mass),
            "friction_table": model.friction * (1.0 + FRICTION * friction),
            "friction_finger": model.finger_friction * (1.0 + FINGER_FRICTION * finger),
        }
    )
    return changed.with_shift([CENTRE_OF_MASS * s for s in shift])


@cache
def _colours() -> dict[str, tuple[float, float, float]]:
    scenes = (load_scene(name) for name in built_in_scenes())
    return {item.model: item.truth.colour for each in scenes for item in each.objects}
