"""Fingertips that press on top of random things and are led along, beside what is predicted.

Boxes, cylinders and prisms, flat ones and taller ones, stand on points of their base; in Drake a
sphere presses on the top with the force and is led along by stiff springs, slowly. It drags if it
moves on the object by less than a twentieth of its way, slips if by more, and tips if a foot leaves
the table. How fast the object turns is compared too. Cases are set apart in which the force along
the face lies within a share of the most that the fingertip transmits, or the centre of pressure
- pressed, or drawn too - within that share of half the base's width of its edge.

    python -m benchmarks.pressing [--cases 300] [--seed 0] [--band 0.05]
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.banded_cases import agreement_text, banded_options
from benchmarks.fingertips import Fingertip
from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel
from objectmodels.exact.top_drag import TopDrag, top_drag
from objectmodels.geometry.base_shapes import Array, Polygon, hull_polygon, is_within
from objectmodels.mechanics.push_thresholds import GRAVITY
from sim.robots.robots import HAND
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject, parse_scene
from sim.worlds.drake.drake_plant import (
    add_empty_plant,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

_WAY, _SPEED = 0.006, 0.01  # of the fingertip [m], [m/s]
_SETTLING, _PRESSING, _SPEEDING = 0.1, 0.2, 0.1  # until it stands, is pressed, and is led [s]
_RIM = 0.009  # between the fingertip and the edge of the top at first [m]
_SLIPS = 0.05  # share of its way
# What tips leaves the table, and then leans as far as the fingertip's friction lets it.
# Feet sink in by 0.05 mm, which may lift those on the other side by some times as much.
_LIFTED = 3e-4  # height of a foot over the table [m]
_STICTION, _STEP = 1e-5, 1e-3  # slip speed that counts as none [m/s], and the time step [s]


@dataclass(frozen=True)
class Case:
    """A fingertip on an object: where it presses, with what force, and which way it is led."""

    model: ObjectModel
    point: Array
    direction: Array
    press: float

    @property
    def prediction(self) -> TopDrag:
        """What the exact tier says of it."""
        return top_drag(self.model, self.point[None], self.direction[None], self.press)

    def is_near_a_limit(self, band: float) -> bool:
        """Return True if a share less or more of friction or of the base may decide."""
        found, base = self.prediction, self.model.base
        assert isinstance(base, Polygon)
        size = float(np.hypot(*found.force[0]))
        force = found.force[0] * min(1.0, float(found.grip[0]) / size)
        weight = self.model.weight + self.press
        moment = self.model.weight * np.array(self.model.com[:2]) + self.press * self.point[:2]
        pressed, drawn = moment / weight, (moment + self.point[2] * force) / weight
        margins = [(base.offsets - base.normals @ q).min() for q in (pressed, drawn)]
        near_edge = np.abs(margins).min() < band * 0.5 * base.area**0.5
        return abs(size / float(found.grip[0]) - 1.0) < band or bool(near_edge)


def random_case(rng: np.random.Generator) -> Case:
    """A random object and fingertip."""
    half, height = rng.uniform(0.03, 0.12, 2), float(rng.uniform(0.008, 0.07))
    drawn_in = float(rng.uniform(0.35, 1.0))
    mass, friction = float(rng.uniform(0.1, 1.2)), float(rng.uniform(0.15, 0.5))
    common: dict[str, Any] = {
        "name": "thing",
        "mass": mass,
        "friction": friction,
        "finger_friction": float(rng.uniform(0.8, 3.5)) * friction,
    }
    angles = np.sort(2.0 * np.pi * (np.arange(6) + rng.uniform(-0.3, 0.3, 6)) / 6.0)
    corners = np.column_stack((np.cos(angles), np.sin(angles))) * half
    match rng.integers(3):
        case 0:
            shape: Any = BoxModel
            own: dict[str, Any] = {"size": (*(2.0 * half).tolist(), height)}
            outline = Polygon.rectangle(*(2.0 * half))
        case 1:
            shape, own = CylinderModel, {"radius": float(half[0]), "height": height}
            outline = hull_polygon(corners / half * half[0])
        case _:
            shape, own = PrismModel, {"corners": tuple(map(tuple, corners)), "height": height}
            outline = hull_polygon(corners)
    feet = drawn_in * outline.corners
    inside = hull_polygon(feet)
    com = _point_inside(rng, inside, 0.3 * inside.size)
    point = _point_inside(rng, outline, _RIM)
    heading = float(rng.uniform(-np.pi, np.pi))
    # About what an object needs over whose centre of mass a fingertip of twice the friction is.
    press = GRAVITY * mass * float(np.exp(rng.uniform(-1.2, 1.5)))
    return Case(
        shape(**common, **own, support=tuple(map(tuple, feet)), com=(*com.tolist(), 0.5 * height)),
        np.append(point, height),
        np.array([np.cos(heading), np.sin(heading), 0.0]),
        press,
    )


def _point_inside(rng: np.random.Generator, base: Polygon, rim: float) -> Array:
    """A point of a polygon, so far from its edges where it is wide enough [m]."""
    while True:
        point = rng.uniform(-base.size, base.size, 2)
        rim *= 0.98
        if is_within(base, point[None], -rim):
            return point


def outcome_in_drake(case: Case, scene: Scene) -> tuple[str, float]:
    """The class of what becomes of a case in Drake, and the turn per travel [rad/m]."""
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    plant, scene_graph = add_empty_plant(builder, _STEP, _STICTION)
    table = add_table(plant, scene)
    truth = truth_as_believed(case.model)
    pose = Pose(x_m=0.5, y_m=0.0, z_m=0.0, yaw_deg=0.0)
    item = SceneObject(name="thing", model="box", pose=pose, truth=truth)
    body, solids, feet = add_object(plant, item)
    tip = Fingertip(plant, "tip")
    plant.Finalize()
    plant.SetDefaultFloatingBaseBodyPose(body, initial_pose(item))
    filter_collisions(
        scene_graph, robot=[tip.solid], table=table, solids=solids, feet=feet.geometries
    )
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    start = item.p_WB + case.point + [0.0, 0.0, HAND.tip_radius + 1e-4]
    tip.put(context, start)
    port = plant.get_applied_spatial_force_input_port()
    standing = np.column_stack((truth.support, np.zeros(len(truth.support)))).T
    elapsed = led = 0.0
    first: tuple[Array, Any] | None = None
    while led < _WAY:
        elapsed += _STEP
        pressed = np.clip((elapsed - _SETTLING) / _PRESSING, 0.0, 1.0)
        since = elapsed - _SETTLING - 1.5 * _PRESSING
        speed = _SPEED * float(np.clip(since / _SPEEDING, 0.0, 1.0))
        led += speed * _STEP
        tip.command(context, start + led * case.direction, speed * case.direction)
        port.FixValue(context, [tip.pressing(float(pressed) * case.press)])
        simulator.AdvanceTo(elapsed, interruptible=False)
        X_WB = plant.EvalBodyPoseInWorld(context, body)
        if (X_WB.multiply(standing)[2] > _LIFTED).any():
            return "tips", 0.0
        if since > _SPEEDING and first is None:
            first = (tip.place(context), X_WB)
    assert first is not None
    (place, X_WB0), way = first, tip.place(context) - first[0]
    slip = X_WB @ (X_WB0.inverse() @ place) - place - way
    R = (X_WB0.rotation().transpose() @ X_WB.rotation()).matrix()
    travel = float(np.hypot(*way[:2]))
    slips = np.hypot(*slip[:2]) > _SLIPS * travel
    return "slips" if slips else "drags", float(np.arctan2(R[1, 0], R[0, 0])) / travel


def main() -> None:
    options = banded_options(__doc__)
    rng = np.random.default_rng(options.seed)
    scene = parse_scene("{version: 1, name: pressing, objects: []}")
    seen: Counter[tuple[str, str]] = Counter()
    off: list[float] = []
    for number in range(options.cases):
        case = random_case(rng)
        if case.is_near_a_limit(options.band):
            continue
        prediction = case.prediction
        predicted, (found, turn) = str(prediction.outcome[0]), outcome_in_drake(case, scene)
        seen[predicted, found] += 1
        if predicted != found:
            print(f"case {number}: {predicted} predicted, {found} in Drake")
        elif found == "drags":
            off.append(abs(turn - float(prediction.turn[0])))
    judged = sum(seen.values())
    agree = sum(count for (predicted, found), count in seen.items() if predicted == found)
    print(", ".join(f"{count} {predicted}/{found}" for (predicted, found), count in seen.items()))
    worst = np.degrees(np.percentile(off, 95)) / 10.0 if off else np.nan
    print(f"turn of what drags: 95 % within {worst:.1f}° in 10 cm of what is predicted at first")
    print(agreement_text(agree, judged, options.cases))


if __name__ == "__main__":
    main()
