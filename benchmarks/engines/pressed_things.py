"""Random things that fingertips press on, that hang over the table's edge, or stand on others.

`Pressed`: boxes, cylinders and prisms, flat ones and taller ones, stand on points of their base; a
sphere presses on the top with a force and is led along by stiff springs, slowly. It drags if it
moves on the object by less than a twentieth of its way, slips if by more, and tips if a foot leaves
the table. How fast the object turns is compared too. The limits are the most that the fingertip
transmits, and the edge of the base for the centre of pressure, pressed, or drawn too.

`Overhanging`: boxes and cylinders, most of them flat, lie so that a part hangs over. By turns one
is left alone, pressed from above, or from below, where it hangs over, drawn by a fingertip over its
centre of mass towards the edge, held by a thumb above and two fingers below where it hangs over,
and lifted. It keeps level, or tips, or the fingertip that draws it slips over it. The limits are
those of the centre of pressure, as a share of half the width, and the force that decides.

`Stack`: two to four boxes, cylinders and prisms, one on another, their centres of mass off the
middle, each put down so that many are near to falling. The limit is half the width of the faces
that meet there, where the slabs of the simulation are a little smaller than the faces. A stack has
fallen if after two and a half seconds one of it leans by more than five degrees or has come down.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from pydrake.geometry import Box, CollisionFilterDeclaration, Cylinder, GeometrySet, Sphere
from pydrake.math import RigidTransform

from benchmarks.engines.agreement import Outcome
from benchmarks.worlds.drake import Fingertip, Springs, Tabletop
from objectmodels import BoxModel, CylinderModel, ObjectModel, PrismModel
from objectmodels.exact.top_drag import TopDrag, top_drag
from objectmodels.geometry.base_shapes import Array, Polygon, hull_polygon
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.mechanics.standing_balance import (
    StackedBody,
    TableEdge,
    TopLoad,
    edge_margins,
    pinch_margin,
    stack_margins,
    touch_limits,
)
from sim.robots.robots import HAND
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, SceneObject, parse_scene
from sim.worlds.drake.drake_bodies import ROUGH, add_slab, filter_slabs, surface

Generator = np.random.Generator
Kind = Literal["alone", "from above", "from below", "drawn", "pinched"]
KINDS: tuple[Kind, ...] = ("alone", "from above", "from below", "drawn", "pinched")

_TABLE = parse_scene("{version: 1, name: table, objects: []}")
_STICTION, _STEP = 1e-5, 1e-3  # slip speed that counts as none [m/s], and the time step [s]
_CLEAR = 1e-4  # of a fingertip from what it will touch [m]


def _springs(stiffness: float) -> Springs:
    """Critically damped; on a light fingertip Drake's friction creeps by a tenth of the way."""
    return Springs(mass=1.0, stiffness=stiffness, damping=2.0 * stiffness**0.5)


_LEADING = _springs(2e4)
_STIFF = _springs(2e5)  # of a hand that holds, which then leans by less than half a degree


def _thing(model: ObjectModel, pose: Pose) -> SceneObject:
    return SceneObject(name="thing", model="box", pose=pose, truth=truth_as_believed(model))


def _press(world: Tabletop, tip: Fingertip, force: float) -> None:
    """Lets a force press a fingertip down [N]."""
    world.apply(tip.body, np.array([0.0, 0.0, -force]))


# Of a fingertip that presses on top.
_WAY, _SPEED = 0.006, 0.01  # of the fingertip [m], [m/s]
_SETTLING, _PRESSING, _SPEEDING = 0.1, 0.2, 0.1  # until it stands, is pressed, and is led [s]
_RIM = 0.009  # between the fingertip and the edge of the top at first [m]
_SLIPS = 0.05  # share of its way
# What tips leaves the table, and then leans as far as the fingertip's friction lets it.
# Feet sink in by 0.05 mm, which may lift those on the other side by some times as much.
_LIFTED = 3e-4  # height of a foot over the table [m]


@dataclass(frozen=True)
class Pressed:
    """A fingertip on an object: where it presses, with what force, and which way it is led."""

    model: ObjectModel
    point: Array
    direction: Array
    press: float
    group = "pressed on top"

    @cached_property
    def drag(self) -> TopDrag:
        """What the exact tier says of it."""
        return top_drag(self.model, self.point[None], self.direction[None], self.press)

    def prediction(self) -> tuple[str, float]:
        """See `benchmarks.engines.agreement.Case`."""
        found, base = self.drag, self.model.base
        assert isinstance(base, Polygon)
        size = float(np.hypot(*found.force[0]))
        force = found.force[0] * min(1.0, float(found.grip[0]) / size)
        weight = self.model.weight + self.press
        moment = self.model.weight * np.array(self.model.com[:2]) + self.press * self.point[:2]
        pressed, drawn = moment / weight, (moment + self.point[2] * force) / weight
        margins = [(base.offsets - base.normals @ q).min() for q in (pressed, drawn)]
        edge = float(np.abs(margins).min() / (0.5 * base.area**0.5))
        return str(found.outcome[0]), min(abs(size / float(found.grip[0]) - 1.0), edge)

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        item = _thing(self.model, Pose(x_m=0.5, y_m=0.0, z_m=0.0, yaw_deg=0.0))
        world = Tabletop(_TABLE, [item], step=_STEP, stiction=_STICTION)
        tip = Fingertip(world.plant, "tip", _LEADING, "xy")
        world.finish([tip.solid])
        start = item.p_WB + self.point + [0.0, 0.0, HAND.tip_radius + _CLEAR]
        tip.put(world.context, start)
        support = np.array(item.truth.support)
        standing = np.column_stack((support, np.zeros(len(support)))).T
        elapsed = led = 0.0
        first: tuple[Array, Any] | None = None
        while led < _WAY:
            elapsed += _STEP
            pressed = np.clip((elapsed - _SETTLING) / _PRESSING, 0.0, 1.0)
            since = elapsed - _SETTLING - 1.5 * _PRESSING
            speed = _SPEED * float(np.clip(since / _SPEEDING, 0.0, 1.0))
            led += speed * _STEP
            tip.command(world.context, start + led * self.direction, speed * self.direction)
            _press(world, tip, float(pressed) * self.press)
            world.simulator.AdvanceTo(elapsed, interruptible=False)
            X_WB = world.pose("thing")
            if (X_WB.multiply(standing)[2] > _LIFTED).any():
                return Outcome("tips")
            if since > _SPEEDING and first is None:
                first = (tip.place(world.context), X_WB)
        assert first is not None
        (place, X_WB0), way = first, tip.place(world.context) - first[0]
        slip = X_WB @ (X_WB0.inverse() @ place) - place - way
        travel = float(np.hypot(*way[:2]))
        if np.hypot(*slip[:2]) > _SLIPS * travel:
            return Outcome("slips")
        R = (X_WB0.rotation().transpose() @ X_WB.rotation()).matrix()
        turn = float(np.arctan2(R[1, 0], R[0, 0])) / travel
        if str(self.drag.outcome[0]) != "drags":
            return Outcome("drags")
        return Outcome("drags", {"turn, °/10 cm": np.degrees(turn - self.drag.turn[0]) / 10.0})


def pressed(cases: int, seed: int) -> list[Pressed]:
    """Random objects and fingertips."""
    rng = np.random.default_rng(seed)
    return [_random_pressed(rng) for _ in range(cases)]


def _random_pressed(rng: Generator) -> Pressed:
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
    return Pressed(
        shape(**common, **own, support=tuple(map(tuple, feet)), com=(*com.tolist(), 0.5 * height)),
        np.append(point, height),
        np.array([np.cos(heading), np.sin(heading), 0.0]),
        press,
    )


def _point_inside(rng: Generator, base: Polygon, rim: float) -> Array:
    """A point of a polygon, so far from its edges where it is wide enough [m]."""
    while True:
        point = rng.uniform(-base.size, base.size, 2)
        rim *= 0.98
        if base.contains(point[None], -rim):
            return point


# Of what hangs over the edge.
_EDGE = _TABLE.table.centre_m[0] + 0.5 * _TABLE.table.size_m[0]  # of the table, along x [m]
# Spheres in a row along it, which carry as the edge does.
_RAIL, _APART, _REACH = 0.005, 0.006, 0.16  # radius, distance, and half the length [m]
_SQUEEZING, _LED, _WAITING = 0.3, 1.2, 0.8  # parts of a run after settling [s]
_DRAWN, _LIFT = 0.03, 0.015  # way of what is drawn, and lifted [m]
_LEANS = np.cos(np.radians(2.5))  # more than the springs of a grasp give way
_SLIPS_OVER = 0.004  # of a fingertip over what it draws, a third of that sticks and creeps [m]
_TIP_RIM = 0.007  # between a fingertip and the rim of the top [m]
_ROUND = 0.4  # share of cylinders
# Of the table's edge at first, as shares of half the size.
_MARGINS: dict[Kind, tuple[float, float]] = {"alone": (-0.4, 0.5), "drawn": (0.2, 1.2)}


@dataclass(frozen=True, eq=False)
class Overhanging:
    """A thing over an edge, and what is done to it.

    Attributes:
        group: what is done.
        model: the thing.
        edge: of the table, where it lies at first.
        point: on its top or below it, shape (2,) [m].
        press: force there, downwards [N].
        way: unit vector along which it is drawn, shape (2,).
        fingers: two fingertips below it, shape (2, 2) [m].
    """

    group: Kind
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
        """See `benchmarks.engines.agreement.Case`."""
        match self.group:
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
        return "level" if margin > 0.0 else "tips", margin

    def _drawn(self) -> tuple[str, float]:
        """Where it slips it stays where it is; else it is looked at where it is drawn to."""
        model, load = self.model, self.model.weight + self.press
        goes = model.finger_friction * self.press / (model.friction * load) - 1.0
        if goes < 0.0:
            return "slips", -goes
        ahead = _DRAWN * float(self.edge.normal @ self.way)
        margin = self._least_margin(self.edge.offset - ahead, model.friction * load)
        margin /= self.half_width
        return "level" if margin > 0.0 else "tips", min(abs(margin), goes)

    def _least_margin(self, offset: float, force: float) -> float:
        """The least margin with the edge at an offset, pressed, and drawn by a force too [m]."""
        edge = TableEdge(self.edge.normal, offset)
        loads = (TopLoad(self.point, self.press, along * self.way) for along in (0.0, force))
        return min(float(edge_margins(self.model, edge, each).min()) for each in loads)

    def tips_at_first(self) -> bool:
        """Return True if it tips, or nearly, before it is drawn anywhere."""
        load = self.model.weight + self.press
        force = min(self.model.friction * load, self.model.finger_friction * self.press)
        return self._least_margin(self.edge.offset, force) < 0.1 * self.half_width

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        return Outcome(_OverEdge(self).outcome())


def overhanging(cases: int, seed: int) -> list[Overhanging]:
    """Things over an edge, many of them near to tipping."""
    rng = np.random.default_rng(seed)
    made: list[Overhanging] = []
    while len(made) < cases:
        case = _random_overhanging(KINDS[len(made) % len(KINDS)], rng)
        if case is not None:
            made.append(case)
    return made


def _random_flat_model(rng: Generator) -> BoxModel | CylinderModel:
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


def _random_overhanging(kind: Kind, rng: Generator) -> Overhanging | None:
    """A case; None if there is no room for a fingertip, or it tips before it is drawn."""
    model = _random_flat_model(rng)
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
    if kind != "alone" and not hull_polygon(model.outline).contains(touched, -_TIP_RIM):
        return None
    case = Overhanging(kind, model, edge, point, press, way, fingers)
    return None if kind == "drawn" and case.tips_at_first() else case


class _OverEdge(Tabletop):
    """A case in Drake."""

    def __init__(self, case: Overhanging) -> None:
        self._case, n = case, case.edge.normal
        yaw = -np.degrees(np.arctan2(n[1], n[0]))
        self._R = np.array([[n[0], n[1]], [-n[1], n[0]]])
        self._at = np.array([_EDGE - case.edge.offset, 0.0, 0.0])
        item = _thing(case.model, Pose(x_m=self._at[0], y_m=0.0, z_m=0.0, yaw_deg=float(yaw)))
        super().__init__(_TABLE, [item], step=_STEP, stiction=_STICTION)
        # A rail that carries, level with the table's top, and what of the thing rubs on it as its
        # feet do on the table.
        rail = [
            self.plant.RegisterCollisionGeometry(
                self.plant.world_body(),
                RigidTransform(np.array([_EDGE, y, -_RAIL])),
                Sphere(_RAIL),
                f"rail {i}",
                surface(ROUGH),
            )
            for i, y in enumerate(np.arange(-_REACH, _REACH, _APART))
        ]
        model = case.model
        sole = self.plant.RegisterCollisionGeometry(
            self.bodies["thing"],
            RigidTransform(np.array([0.0, 0.0, 0.5 * model.top])),
            Box(*model.size) if isinstance(model, BoxModel) else Cylinder(model.radius, model.top),
            "sole",
            surface(0.5 * model.friction),
        )
        self._tips = self._added_fingertips()
        fingertips = [tip.solid for tip in self._tips]
        self.finish(fingertips)
        apart, others = CollisionFilterDeclaration(), [self.table, *self.solids, *self.standing]
        apart.ExcludeBetween(GeometrySet(fingertips), GeometrySet(self.table))
        apart.ExcludeBetween(GeometrySet([*rail, sole]), GeometrySet([*others, *fingertips]))
        self.scene_graph.collision_filter_manager().Apply(apart)
        off = HAND.tip_radius + _CLEAR
        above = case.model.top + off
        heights = [above if case.press > 0.0 else -off, -off, -off]
        self._starts = [
            self._at + np.append(self._R @ point, height)
            for point, height in zip([case.point, *case.fingers], heights, strict=True)
        ]
        for tip, start in zip(self._tips, self._starts, strict=False):
            tip.put(self.context, start)

    def _added_fingertips(self) -> list[Fingertip]:
        """The thumb first; where it only presses nothing holds it along the top."""
        match self._case.group:
            case "alone":
                return []
            case "drawn":
                return [Fingertip(self.plant, "thumb", _LEADING, "xy")]
            case "pinched":
                led = {"thumb": "xy", "one": "xyz", "other": "xyz"}
                return [Fingertip(self.plant, name, _STIFF, axes) for name, axes in led.items()]
        return [Fingertip(self.plant, "thumb", _LEADING, "")]

    def outcome(self) -> str:
        """What becomes of it."""
        case, elapsed = self._case, 0.0
        motion = np.zeros(3)
        if case.group == "drawn":
            motion = np.append(_DRAWN * (self._R @ case.way), 0.0)
        elif case.group == "pinched":
            motion = np.array([0.0, 0.0, _LIFT])
        while elapsed < _SETTLING + _SQUEEZING + _LED + _WAITING:
            elapsed += _STEP
            pressed = float(np.clip((elapsed - _SETTLING) / _SQUEEZING, 0.0, 1.0))
            share = float(np.clip((elapsed - _SETTLING - 1.2 * _SQUEEZING) / _LED, 0.0, 1.0))
            led = share**2 * (3.0 - 2.0 * share) * motion
            for tip, start in zip(self._tips, self._starts, strict=False):
                tip.command(self.context, start + led, np.zeros(3))
            if self._tips:
                _press(self, self._tips[0], pressed * case.press)
            self.simulator.AdvanceTo(elapsed, interruptible=False)
            X_WB = self.pose("thing")
            if X_WB.rotation().matrix()[2, 2] < _LEANS:
                return "tips"
            if case.group == "drawn":
                over = self._tips[0].place(self.context) - self._starts[0]
                over -= X_WB.translation() - self._at
                if np.hypot(*over[:2]) > _SLIPS_OVER:
                    return "slips"
        return "level"


# Of stacks.
_SECONDS = 2.5  # a tall stack a twentieth beyond its edge has fallen after one
_FALLEN_LEAN = np.cos(np.radians(5.0))
_DOWN = 0.005  # [m]


@dataclass(frozen=True)
class Stack:
    """Objects from below to above, each on the one before."""

    items: list[SceneObject]
    group = "stacks"

    def prediction(self) -> tuple[str, float]:
        """The least margin, over half the width of the smaller face there."""
        bodies = [
            _stacked_body(item, number - 1 if number else None)
            for number, item in enumerate(self.items)
        ]
        areas = [
            min(body.base.area, np.inf if body.below is None else bodies[body.below].top.area)
            for body in bodies
        ]
        margin = float((stack_margins(bodies) / (0.5 * np.array(areas) ** 0.5)).min())
        return "falls" if margin < 0.0 else "stands", margin

    def roll_out(self) -> Outcome:
        """See `benchmarks.engines.agreement.Case`."""
        world = Tabletop(_TABLE, self.items)
        slabs = [add_slab(world.plant, item.truth, world.bodies[item.name]) for item in self.items]
        world.finish(stacked=True)
        filter_slabs(world.scene_graph, slabs, [world.table, *world.solids, *world.standing])
        for time in np.linspace(0.0, _SECONDS, 6)[1:]:
            world.simulator.AdvanceTo(time)
            for item in self.items:
                X_WB = world.pose(item.name)
                down = item.p_WB[2] - X_WB.translation()[2]
                if X_WB.rotation().matrix()[2, 2] < _FALLEN_LEAN or down > _DOWN:
                    return Outcome("falls")
        return Outcome("stands")


def stacks(cases: int, seed: int) -> list[Stack]:
    """Random stacks."""
    rng = np.random.default_rng(seed)
    return [_random_stack(rng) for _ in range(cases)]


def _random_stack(rng: Generator) -> Stack:
    items: list[SceneObject] = []
    for k in range(int(rng.integers(2, 5))):
        truth = _random_truth(rng)
        x = y = z = 0.0
        if k:
            lower = items[k - 1]
            room = 0.5 * np.ptp(np.array(lower.truth.shape.crown), axis=0)
            x, y = (lower.p_WB[:2] + rng.uniform(-0.9, 0.9, 2) * room / np.sqrt(k)).tolist()
            z = lower.pose.z_m + lower.truth.shape.top
        pose = Pose(x_m=x, y_m=y, z_m=z, yaw_deg=float(rng.uniform(-180.0, 180.0)))
        items.append(SceneObject(name=f"body {k}", model="box", pose=pose, truth=truth))
    return Stack(items)


def _random_truth(rng: Generator) -> Truth:
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
    return Truth.model_validate(common | shape | {"centre_of_mass_m": com})


def _stacked_body(item: SceneObject, below: int | None) -> StackedBody:
    """An object of a scene as a member of a stack, as it truly is."""

    def in_world(points: Any) -> Array:
        return np.asarray(np.array(points) @ item.pose.R_WB[:2, :2].T + item.p_WB[:2])

    truth = item.truth
    com = in_world([truth.centre_of_mass[:2]])[0]
    base, top = (
        Polygon(in_world(hull_polygon(np.array(points)).vertices))
        for points in (truth.support, truth.shape.crown)
    )
    return StackedBody(truth.mass_kg, 0.0, com, np.zeros((2, 2)), base, top, below)
