"""Random stacks that stand or fall in Drake, beside the margins of what stands on what.

Stacks are two to four boxes, cylinders and prisms, one on another, their centres of mass off the
middle, each put down so that many are near to falling. Those are set apart whose least
margin is within a share of half the width of the faces that meet there, where the slabs of the
simulation are a little smaller than the faces. A stack has fallen if after two and a half seconds
one of it leans by more than five degrees or has come down.

    python -m benchmarks.stacks [--cases 300] [--seed 0] [--band 0.05]
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.banded_cases import agreement_text, banded_options
from objectmodels.geometry.base_shapes import Array, Polygon, hull_polygon
from objectmodels.mechanics.standing_balance import StackedBody, stack_margins
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject, parse_scene
from sim.worlds.drake.drake_bodies import add_slab, filter_slabs
from sim.worlds.drake.drake_plant import (
    add_empty_plant,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

_SECONDS = 2.5  # a tall stack a twentieth beyond its edge has fallen after one
_LEANS = np.cos(np.radians(5.0))
_DOWN = 0.005  # [m]
_STICTION = 1e-4  # as the robot's world has it [m/s]


def random_truth(rng: np.random.Generator) -> Truth:
    """A box, a cylinder or a prism whose centre of mass is off the middle."""
    half, height = rng.uniform(0.02, 0.08, 2), float(rng.uniform(0.03, 0.2))
    common: dict[str, Any] = {
        "mass_kg": float(rng.uniform(0.1, 1.5)),
        "friction_table": float(rng.uniform(0.25, 0.6)),
        "friction_finger": 0.6,
    }
    off = rng.uniform(-0.3, 0.3, 2) * half
    match rng.integers(3):
        case 0:
            shape: dict[str, Any] = {"size_m": (*(2.0 * half).tolist(), height)}
        case 1:
            shape, off = {"radius_m": float(half[0]), "height_m": height}, off * half[0] / half
        case _:
            turns = 2.0 * np.pi * (np.arange(5) + rng.uniform(-0.2, 0.2, 5)) / 5
            corners = half * np.column_stack([np.cos(turns), np.sin(turns)])
            shape = {"corners_m": tuple(map(tuple, corners.tolist())), "height_m": height}
    com = (*off.tolist(), 0.5 * height)
    return Truth(**common, **shape, centre_of_mass_m=com)


def random_stack(rng: np.random.Generator) -> tuple[list[SceneObject], list[int | None]]:
    """Objects from below to above, and on which of them each stands."""
    items: list[SceneObject] = []
    below: list[int | None] = []
    for k in range(int(rng.integers(2, 5))):
        truth, on = random_truth(rng), None
        x = y = z = 0.0
        if k:
            on = k - 1
            lower = items[on]
            room = 0.5 * np.ptp(np.array(lower.truth.upper_points), axis=0)
            x, y = (lower.p_WB[:2] + rng.uniform(-0.9, 0.9, 2) * room / np.sqrt(k)).tolist()
            z = lower.pose.z_m + lower.truth.height
        pose = Pose(x_m=x, y_m=y, z_m=z, yaw_deg=float(rng.uniform(-180.0, 180.0)))
        items.append(SceneObject(name=f"body {k}", model="box", pose=pose, truth=truth))
        below.append(on)
    return items, below


def stacked_body(item: SceneObject, below: int | None) -> StackedBody:
    """An object of a scene as a member of a stack, as it truly is."""

    def face(points: tuple[tuple[float, float], ...]) -> Polygon:
        return Polygon(_in_world(item, hull_polygon(np.array(points)).vertices))

    truth = item.truth
    com = _in_world(item, np.array([truth.centre_of_mass[:2]]))[0]
    base, top = face(truth.support), face(truth.upper_points)
    return StackedBody(truth.mass_kg, 0.0, com, np.zeros((2, 2)), base, top, below)


def _in_world(item: SceneObject, points: Array) -> Array:
    return np.asarray(points @ item.pose.R_WB[:2, :2].T + item.p_WB[:2])


def relative_margin(bodies: list[StackedBody]) -> float:
    """The least margin of a stack, over half the width of the smaller face there."""
    widths = [
        min(body.base.area, np.inf if body.below is None else bodies[body.below].top.area) ** 0.5
        for body in bodies
    ]
    return float((stack_margins(bodies) / (0.5 * np.array(widths))).min())


def has_fallen(scene: Scene, items: list[SceneObject]) -> bool:
    """Return True if a stack falls in Drake."""
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, scene_graph = add_empty_plant(builder, scene.time_step_s, _STICTION)
    table = add_table(plant, scene)
    added = [add_object(plant, item) for item in items]
    slabs = [
        add_slab(plant, item.truth, body) for item, (body, *_) in zip(items, added, strict=True)
    ]
    plant.Finalize()
    for level, (item, (body, *_)) in enumerate(zip(items, added, strict=True)):
        plant.SetDefaultFloatingBaseBodyPose(body, initial_pose(item, level))
    solids = [solid for _, own, _ in added for solid in own]
    feet = [foot for *_, each in added for foot in each.geometries]
    filter_collisions(scene_graph, robot=[], table=table, solids=solids, feet=feet)
    filter_slabs(scene_graph, slabs, [table, *solids, *feet])
    simulator = Simulator(builder.Build())
    context = plant.GetMyContextFromRoot(simulator.get_context())
    for time in np.linspace(0.0, _SECONDS, 6)[1:]:
        simulator.AdvanceTo(time)
        for item, (body, *_) in zip(items, added, strict=True):
            X_WB = plant.EvalBodyPoseInWorld(context, body)
            down = item.p_WB[2] - X_WB.translation()[2]
            if X_WB.rotation().matrix()[2, 2] < _LEANS or down > _DOWN:
                return True
    return False


def main() -> None:
    options = banded_options(__doc__)
    rng = np.random.default_rng(options.seed)
    scene = parse_scene("{version: 1, name: stack, objects: []}")
    judged = agree = stand = 0
    for number in range(options.cases):
        items, below = random_stack(rng)
        margin = relative_margin([stacked_body(*each) for each in zip(items, below, strict=True)])
        if abs(margin) < options.band:
            continue
        falls = has_fallen(scene, items)
        judged, stand = judged + 1, stand + (not falls)
        if falls == (margin < 0.0):
            agree += 1
        else:
            print(f"stack {number}: margin {margin:+.3f} of half the width, falls: {falls}")
    print(f"{stand} stacks stand; {agreement_text(agree, judged, options.cases)}")


if __name__ == "__main__":
    main()
