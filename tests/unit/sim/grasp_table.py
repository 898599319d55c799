"""A carton and a mug on a table, and plans for a hand, made by hand."""

from __future__ import annotations

import numpy as np

from objectmodels.geometry.rotations import Array
from objectmodels.models.kinds import BoxModel, CylinderModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import Container, Opening
from objectmodels.models.shapes import Box, Cylinder
from planner.types.actions import Action, Grasp
from planner.types.plan import Plan
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState
from sim.motion.held_object_path import HeldObject, HeldSegment, free_segments, step_segments
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene
from tests.plans import hand_plan

CARTON = BoxModel(
    name="carton",
    size=(0.06, 0.08, 0.16),
    mass=0.34,
    friction=0.35,
    finger_friction=0.6,
    com=(0.0, 0.0, 0.05),
    container=Container(
        wall=0.001,
        opening=Opening(centre=(0.014, 0.0), radius=0.014),
        contents_l=0.3,
    ),
)
MUG = CylinderModel(
    name="mug", radius=0.04, height=0.082, mass=0.118, friction=0.3, finger_friction=0.6
)
MODELS: dict[str, ObjectModel] = {"carton": CARTON, "mug": MUG}


CARTON_AT, MUG_AT = PlanarPose(0.75, 0.0, -np.pi / 2.0), PlanarPose(0.75, 0.25)


def state(
    carton: PlanarPose = CARTON_AT,
    mug: PlanarPose = MUG_AT,
    held: Held | None = None,
) -> WorldState:
    """What the robot believes of the table."""
    seen = {
        "carton": SeenObject("carton", carton, CARTON),
        "mug": SeenObject("mug", mug, MUG),
    }
    return WorldState(seen, held=held)


def scene(
    mug: tuple[float, float] = (0.75, 0.25), *, mass: float = 0.34, friction: float = 0.6
) -> Scene:
    """The same table as it really is; the carton's contents are a solid here."""
    carton = Truth(
        shape=Box(size=(0.06, 0.08, 0.16)),
        mass_kg=mass,
        friction_table=0.33,
        friction_finger=friction,
        centre_of_mass_m=(0.0, 0.0, 0.05),
    )
    round_one = Truth(
        shape=Cylinder(radius=0.04, height=0.082),
        mass_kg=0.118,
        friction_table=0.3,
        friction_finger=0.6,
    )
    objects = (
        SceneObject(
            name="carton", model="carton", pose=Pose(x_m=0.75, y_m=0.0, yaw_deg=-90.0), truth=carton
        ),
        SceneObject(name="mug", model="mug", pose=Pose(x_m=mug[0], y_m=mug[1]), truth=round_one),
    )
    return load_scene("kitchen").model_copy(update={"objects": objects})


def grasp(*, height: float = 0.08, squeeze: float = 8.0, width: float = 0.06) -> Grasp:
    """Of the carton from the robot's side, the thumb towards the mug."""
    return Grasp(
        p_BG=(0.0, 0.0, height),
        closing_W=(0.0, 1.0, 0.0),
        approach_W=(1.0, 0.0, 0.0),
        width=width,
        squeeze=squeeze,
        needed=4.0,
        strongest=12.0,
    )


def plan(*steps: Action, held: bool = False, of: Grasp | None = None) -> Plan:
    """Some steps with the carton."""
    return hand_plan("carton", of or grasp(), *steps, held=held, speed=0.2)


def held_segments(handled: HeldObject, off: Array) -> tuple[tuple[HeldSegment, ...], ...]:
    """The legs of a plan, of the approach first and of the way back last."""
    steps = step_segments(handled)
    before, after = free_segments(handled, off, steps)
    return (before, *steps, after)
