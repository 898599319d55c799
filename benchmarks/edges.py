"""Things that hang over a table's edge in Drake, beside the margins of what carries them.

Boxes and cylinders, most of them flat, lie so that a part hangs over. By turns one is

- left alone;
- pressed from above, or from below, where it hangs over;
- drawn by a fingertip over its centre of mass towards the edge;
- held by a thumb above and two fingers below where it hangs over, and lifted.

It keeps level, or tips, or the fingertip that draws it slips over it. Cases are set apart in which
the centre of pressure is within a share of half the width of its limit, or a force within that
share of the one that decides.

    python -m benchmarks.edges [--cases 300] [--seed 0] [--band 0.05]
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchmarks.banded_cases import agreement_text, banded_options
from benchmarks.fingertips import Fingertip
from objectmodels import BoxModel, CylinderModel
from objectmodels.geometry.base_shapes import Array, hull_polygon, is_within
from objectmodels.mechanics.standing_balance import (
    TableEdge,
    TopLoad,
    edge_margins,
    pinch_margin,
    touch_limits,
)
from sim.robots.robots import HAND
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, SceneObject, parse_scene
from sim.worlds.drake.drake_bodies import ROUGH, surface
from sim.worlds.drake.drake_plant import (
    add_empty_plant,
    add_object,
    add_table,
    filter_collisions,
    initial_pose,
)

Kind = Literal["alone", "from above", "from below", "drawn", "pinched"]
KINDS: tuple[Kind, ...] = ("alone", "from above", "from below", "drawn", "pinched")

_SCENE = parse_scene("{version: 1, name: edge, objects: []}")
_EDGE = _SCENE.table.centre_m[0] + 0.5 * _SCENE.table.size_m[0]  # of the table, along x [m]
# Spheres in a row along it, which carry as the edge does.
_RAIL, _APART, _REACH = 0.005, 0.006, 0.16  # radius, distance, and half the length [m]
_SETTLING, _PRESSING, _LED, _WAITING = 0.1, 0.3, 1.2, 0.8  # parts of a run [s]
_WAY, _LIFT = 0.03, 0.015  # of what is drawn, and lifted [m]
_LEANS = np.cos(np.radians(2.5))  # more than the springs of a grasp give way
_SLIPS = 0.004  # of a fingertip over what it draws, a third of that sticks and creeps [m]
_RIM = 0.007  # between a fingertip and the rim of the top [m]
_ROUND = 0.4  # share of cylinders
_STIFF = 2e5  # springs of a hand that holds, which then leans by less than half a degree [N/m]
_STICTION, _STEP = 1e-5, 1e-3  # slip speed that counts as none [m/s], and the time step [s]


@dataclass(frozen=True, eq=False)
class Case:
    """A thing over an edge, and what is done to it.

    Attributes:
        kind: of that.
        model: the thing.
        edge: of the table, where it lies at first.
        point: on its top or below it, shape (2,) [m].
        press: force there, downwards [N].
        way: unit vector along which it is drawn, shape (2,).
        fingers: two fingertips below it, shape (2, 2) [m].
    """

    kind: Kind
    model: BoxModel | CylinderModel
    edge: TableEdge
    point: Array
    press: float
    way: Array
    fingers: Array

    @property
    def half_width(self) -> float:
        """Half of its width [m]."""
        return float(0.5 * hull_polygon(self.model.base.corners).area ** 0.5)

    def prediction(self) -> tuple[str, float]:
        """What becomes of it, and the share by which that is sure."""
        match self.kind:
            case "alone":
                margin = float(edge_margins(self.model, self.edge).min()) / self.half_width
            case "pinched":
                margin = pinch_margin(self.model, self.point, self.press, self.fingers)
                margin /= self.half_width
            case "drawn":
                return self._drawn()
            case _:
                limits = touch_limits(self.model, self.edge, self.point)
                limit = limits[0] if self.press > 0.0 else limits[1]
                margin = limit / abs(self.press) - 1.0
        return "level" if margin > 0.0 else "tips", abs(margin)

    def _drawn(self) -> tuple[str, float]:
        """Where it slips it stays where it is; else it is looked at where it is drawn to."""
        model, load = self.model, self.model.weight + self.press
        goes = model.finger_friction * self.press / (model.friction * load) - 1.0
        if goes < 0.0:
            return "slips", -goes
        ahead = _WAY * float(self.edge.normal @ self.way)
        last = TableEdge(self.edge.normal, self.edge.offset - ahead)
        pressed = (
            TopLoad(self.point, self.press, f * self.way) for f in (0.0, model.friction * load)
        )
        margin = min(float(edge_margins(model, last, each).min()) for each in pressed)
        margin /= self.half_width
        return "level" if margin > 0.0 else "tips", min(abs(margin), goes)


_MARGINS: dict[Kind, tuple[float, float]] = {"alone": (-0.4, 0.5), "drawn": (0.2, 1.2)}
"""Of the table's edge at first, as shares of half the size."""


def random_model(rng: np.random.Generator) -> BoxModel | CylinderModel:
    """A box or a cylinder, its centre of mass off the middle."""
    half, height = rng.uniform(0.04, 0.12, 2), float(rng.uniform(0.01, 0.05))
    shape: Any = BoxModel
    own: dict[str, Any] = {"size": (*(2.0 * half).tolist(), height)}
    if rng.random() < _ROUND:
        shape, own = CylinderModel, {"radius": float(half[0]), "height": height}
    com = rng.uniform(-0.25, 0.25, 2) * half.min()
    friction = float(rng.uniform(0.15, 0.5))
    thing: BoxModel | CylinderModel = shape(
        name="thing",
        mass=float(rng.uniform(0.1, 1.2)),
        friction=friction,
        finger_friction=float(rng.uniform(0.8, 3.5)) * friction,
        com=(*com.tolist(), 0.5 * height),
        **own,
    )
    return thing


def random_case(kind: Kind, rng: np.random.Generator) -> Case:
    """A thing over an edge, many of them near to tipping."""
    while True:
        case = _drawn_case(kind, rng)
        if case is not None:
            return case


def _drawn_case(kind: Kind, rng: np.random.Generator) -> Case | None:
    """A case; None if there is no room for a fingertip."""
    model = random_model(rng)
    heading, half = float(rng.uniform(-np.pi, np.pi)), 0.5 * model.footprint.size
    n = np.array([np.cos(heading), np.sin(heading)])
    aside, com = np.array([-n[1], n[0]]), np.array(model.com[:2])
    least, most = _MARGINS.get(kind, (0.06, 0.5))
    edge = TableEdge(n, float(n @ com) + half * float(rng.uniform(least, most)))
    beyond = com + (edge.offset - float(n @ com) + float(rng.uniform(0.008, 0.04))) * n
    point, fingers, way = com, np.zeros((2, 2)), n
    press = model.weight * float(np.exp(rng.uniform(-1.2, 1.5)))
    match kind:
        case "from above" | "from below":
            point = beyond + float(rng.uniform(-0.03, 0.03)) * aside
            down, up = touch_limits(model, edge, point)
            size = float(np.exp(rng.uniform(-1.0, 1.0)))
            press = size * down if kind == "from above" else -size * up
        case "drawn":
            turn = float(rng.uniform(-1.0, 1.0))
            way = np.cos(turn) * n + np.sin(turn) * aside
        case "pinched":
            apart = float(rng.uniform(0.01, 0.025)) * aside
            fingers = np.array([beyond - apart, beyond + apart])
            outwards, share = float(rng.uniform(-0.004, 0.015)), float(rng.uniform(-0.4, 0.4))
            point = beyond + outwards * n + share * apart
            lever = float(n @ (beyond - com))
            even = lever / max(0.3 * model.top, outwards + model.top * model.finger_friction)
            press = model.weight * even * float(np.exp(rng.uniform(-1.0, 1.5)))
    touched = np.vstack([point, fingers]) if kind == "pinched" else point[None]
    if kind != "alone" and not is_within(hull_polygon(model.outline), touched, -_RIM):
        return None
    case = Case(kind, model, edge, point, press, way, fingers)
    return None if kind == "drawn" and _tips_at_first(case) else case


def _tips_at_first(case: Case) -> bool:
    """Return True if a thing that is drawn tips, or nearly, before it has gone anywhere."""
    model, load = case.model, case.model.weight + case.press
    force = min(model.friction * load, model.finger_friction * case.press)
    loads = (TopLoad(case.point, case.press, along * case.way) for along in (0.0, force))
    margins = [float(edge_margins(model, case.edge, each).min()) for each in loads]
    return min(margins) < 0.1 * case.half_width


def _add_rail(plant: Any) -> list[Any]:
    """Adds a row of spheres along the table's edge, level with its top, that carry a sole."""
    from pydrake.geometry import Sphere
    from pydrake.math import RigidTransform

    return [
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(np.array([_EDGE, y, -_RAIL])), Sphere(_RAIL),
            f"rail {i}", surface(ROUGH),
        )
        for i, y in enumerate(np.arange(-_REACH, _REACH, _APART))
    ]  # fmt: skip


def _add_sole(plant: Any, body: Any, model: BoxModel | CylinderModel) -> Any:
    """Adds what of a thing rubs on the rail as its feet do on the table."""
    from pydrake.geometry import Box, Cylinder
    from pydrake.math import RigidTransform

    shape = Box(*model.size) if isinstance(model, BoxModel) else Cylinder(model.radius, model.top)
    X_BS, rubs = (
        RigidTransform(np.array([0.0, 0.0, 0.5 * model.top])),
        surface(0.5 * model.friction),
    )
    return plant.RegisterCollisionGeometry(body, X_BS, shape, "sole", rubs)


def _keep_apart(scene_graph: Any, *pairs: tuple[list[Any], list[Any]]) -> None:
    """Of each pair nothing of the one touches anything of the other."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    apart = CollisionFilterDeclaration()
    for one, other in pairs:
        apart.ExcludeBetween(GeometrySet(one), GeometrySet(other))
    scene_graph.collision_filter_manager().Apply(apart)


class _Run:
    """A case in Drake."""

    def __init__(self, case: Case) -> None:
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        self._case, n = case, case.edge.normal
        builder = DiagramBuilder()
        self._plant, scene_graph = add_empty_plant(builder, _STEP, _STICTION)
        table = add_table(self._plant, _SCENE)
        yaw = -np.degrees(np.arctan2(n[1], n[0]))
        self._R = np.array([[n[0], n[1]], [-n[1], n[0]]])
        self._at = np.array([_EDGE - case.edge.offset, 0.0, 0.0])
        pose = Pose(x_m=self._at[0], y_m=0.0, z_m=0.0, yaw_deg=float(yaw))
        item = SceneObject(
            name="thing", model="box", pose=pose, truth=truth_as_believed(case.model)
        )
        self._body, solids, feet = add_object(self._plant, item)
        rail = _add_rail(self._plant)
        sole = _add_sole(self._plant, self._body, case.model)
        self._tips = self._added_fingertips()
        self._plant.Finalize()
        self._plant.SetDefaultFloatingBaseBodyPose(self._body, initial_pose(item))
        fingertips, others = [tip.solid for tip in self._tips], [table, *solids, *feet.geometries]
        filter_collisions(
            scene_graph, robot=fingertips, table=table, solids=solids, feet=feet.geometries
        )
        _keep_apart(scene_graph, (fingertips, [table]), ([*rail, sole], [*others, *fingertips]))
        self._simulator = Simulator(builder.Build())
        context = self._simulator.get_mutable_context()
        self._context = self._plant.GetMyMutableContextFromRoot(context)
        self._starts = self._places()
        for tip, start in zip(self._tips, self._starts, strict=True):
            tip.put(self._context, start)

    def _added_fingertips(self) -> list[Fingertip]:
        """The thumb first; where it only presses nothing holds it along the top."""
        match self._case.kind:
            case "alone":
                return []
            case "drawn":
                return [Fingertip(self._plant, "thumb")]
            case "pinched":
                springs = {"thumb": "xy", "one": "xyz", "other": "xyz"}
                return [Fingertip(self._plant, *each, _STIFF) for each in springs.items()]
        return [Fingertip(self._plant, "thumb", "")]

    def _places(self) -> list[Array]:
        """Where the fingertips touch it at first."""
        case, off = self._case, HAND.tip_radius + 1e-4
        below = -off
        above = case.model.top + off
        heights = [above if case.press > 0.0 else below, below, below]
        points = np.vstack([case.point, case.fingers])[: len(self._tips)]
        return [
            self._at + np.append(self._R @ point, height)
            for point, height in zip(points, heights, strict=False)
        ]

    def outcome(self) -> str:
        """What becomes of it."""
        case, plant, context = self._case, self._plant, self._context
        port, elapsed = plant.get_applied_spatial_force_input_port(), 0.0
        whole = _SETTLING + _PRESSING + _LED + _WAITING
        while elapsed < whole:
            elapsed += _STEP
            pressed = float(np.clip((elapsed - _SETTLING) / _PRESSING, 0.0, 1.0))
            share = float(np.clip((elapsed - _SETTLING - 1.2 * _PRESSING) / _LED, 0.0, 1.0))
            led = share**2 * (3.0 - 2.0 * share) * self._motion()
            for tip, start in zip(self._tips, self._starts, strict=True):
                tip.command(context, start + led, np.zeros(3))
            if self._tips:
                port.FixValue(context, [self._tips[0].pressing(pressed * case.press)])
            self._simulator.AdvanceTo(elapsed, interruptible=False)
            X_WB = plant.EvalBodyPoseInWorld(context, self._body)
            if X_WB.rotation().matrix()[2, 2] < _LEANS:
                return "tips"
            if case.kind == "drawn" and self._slip(X_WB) > _SLIPS:
                return "slips"
        return "level"

    def _motion(self) -> Array:
        """Of the fingertips."""
        match self._case.kind:
            case "drawn":
                return np.append(_WAY * (self._R @ self._case.way), 0.0)
            case "pinched":
                return np.array([0.0, 0.0, _LIFT])
        return np.zeros(3)

    def _slip(self, X_WB: Any) -> float:
        """Way of the fingertip over the thing."""
        off = self._tips[0].place(self._context) - self._starts[0]
        return float(np.hypot(*(off - (X_WB.translation() - self._at))[:2]))


def main() -> None:
    options = banded_options(__doc__)
    rng = np.random.default_rng(options.seed)
    seen: Counter[tuple[str, str, str]] = Counter()
    for number in range(options.cases):
        case = random_case(KINDS[number % len(KINDS)], rng)
        predicted, sure = case.prediction()
        if sure < options.band:
            continue
        found = _Run(case).outcome()
        seen[case.kind, predicted, found] += 1
        if predicted != found:
            print(
                f"case {number}, {case.kind}: {predicted} predicted by {sure:.2f}, {found} in Drake"
            )
    for (kind, predicted, found), count in sorted(seen.items()):
        print(f"{kind}: {count} {predicted}/{found}")
    judged = sum(seen.values())
    agree = sum(count for (_, predicted, found), count in seen.items() if predicted == found)
    print(agreement_text(agree, judged, options.cases))


if __name__ == "__main__":
    main()
