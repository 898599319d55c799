"""Predicted against simulated volumes of random pours, without a robot.

A box, a cylinder or a prism with a round opening somewhere in its top is tilted by a prescribed
motion over a cylinder that stands on the table: speeding up and slowing down within a fifth of a
second, its lip shaking by a millimetre, and back upright at the end. The simulated liquid runs out
step by step, into the cylinder or beside it (`sim.worlds.drake.contents`). The prediction
knows shapes, contents and aim, and takes the tilting as steady and the lip as still
(`objectmodels.containers.pour_dynamics`). A share of the contents is asked for, by which the
prediction picks the tilt.

    python -m benchmarks.pouring [--cases 120] [--seed 0] [--processes 2]
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from nlcontrol.parallel_tasks import run_all
from objectmodels.containers.pour_dynamics import Catch, angle_for, caught_volume, pour
from objectmodels.geometry.base_shapes import Polygon
from objectmodels.geometry.rotations import Array, axis_rotation
from objectmodels.models.object_parts import Container, Opening, Vessel
from sim.robots.cell_description import RobotMount
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, Scene, SceneObject
from sim.worlds.drake.contents import Liquid
from sim.worlds.drake.drake_plant import Standing, add_object

PROMISED = 0.03
"""Share of the contents by which a prediction may be wrong."""

SHAKING = 1e-3
"""Of the lip while it pours, along each axis [m]."""

RAMP = 0.2
"""Time in which it comes up to the rate, and back to rest [s]."""

AIM = 0.008
"""Standard deviation of the aim [m]."""

KINDS = ("box", "cylinder", "prism")
WALL, SHELL = 0.002, 0.06  # [m], [kg]
SOURCE, TARGET = "jug", "glass"
QUANTITIES = ("poured", "received", "spilled")
_HOME = RobotMount(home_deg=(41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0))
_FRICTION: dict[str, Any] = {"friction_table": 0.4, "friction_finger": 0.6}
_AT = Pose(x_m=0.5, y_m=0.0)
_APART = Pose(x_m=0.5, y_m=0.4)  # of what is poured from, until it is held


class Prescribed:
    """A scene whose objects are put where they are wanted, in a plant that keeps their masses.

    Args:
        scene: what is true.

    Attributes:
        poses: of its objects, R_WB and p_WB [m].
        liquid: in its containers.
    """

    def __init__(self, scene: Scene) -> None:
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        plant, graph = AddMultibodyPlantSceneGraph(builder, scene.time_step_s)
        objects = {item.name: add_object(plant, item) for item in scene.objects}
        plant.Finalize()
        self.scene = scene
        self.root = builder.Build().CreateDefaultContext()
        self.context = plant.GetMyContextFromRoot(self.root)
        self.model = Standing(
            plant,
            graph,
            {name: body for name, (body, _, _) in objects.items()},
            {name: feet for name, (_, _, feet) in objects.items()},
            {},
        )
        self.liquid = Liquid(self.model, self.root, scene)
        self.poses = {
            item.name: (np.eye(3), np.array([item.pose.x_m, item.pose.y_m, 0.0]))
            for item in scene.objects
        }

    def lean(self, name: str, tilt: float, heading: float, lip_W: Array) -> None:
        """Lets an object lean for a control step, its lip at a place; its yaw is 0."""
        axis = np.array([-math.sin(heading), math.cos(heading), 0.0])
        R_WB = axis_rotation(axis, tilt)
        vessel = self.scene.object(name).truth.vessel
        assert vessel is not None
        self.poses[name] = (R_WB, lip_W - R_WB @ vessel.lip_point(heading))
        self.liquid.prepare((), self.poses)


@dataclass(frozen=True)
class Case:
    """A pour: what stands there, and how it is tilted.

    Attributes:
        kind: of shape, one of `KINDS`.
        scene: with both containers.
        heading: direction in which it leans [rad].
        angle: largest tilt [rad].
        rate: of tilting [rad/s].
        wait: at that tilt [s].
        lip_W: where its lip is kept [m].
    """

    kind: str
    scene: Scene
    heading: float
    angle: float
    rate: float
    wait: float
    lip_W: Array

    @property
    def source(self) -> tuple[Vessel, float]:
        """The cavity that is poured from, and its contents [m³]."""
        truth = self.scene.object(SOURCE).truth
        assert truth.vessel is not None
        assert truth.container is not None
        return truth.vessel, truth.container.contents


def random_case(rng: np.random.Generator) -> Case:
    """A pour that would fill the other vessel by any share, more or less well aimed."""
    kind = str(rng.choice(KINDS))
    heading = rng.uniform(-np.pi, np.pi)
    truth = _jug(kind, rng, heading + rng.uniform(-0.4, 0.4))
    vessel = truth.vessel
    container = truth.container
    assert vessel is not None
    assert container is not None
    rate, wait = rng.uniform(0.2, 0.8), rng.uniform(1.0, 4.0)
    wanted = rng.uniform(0.2, 1.0) * container.contents
    motion = {"heading": heading, "rate": rate, "wait": wait}
    angle = angle_for(vessel, container.contents, wanted, **motion)
    radius, height = rng.uniform(0.033, 0.05), rng.uniform(0.07, 0.12)
    glass = Container(
        wall=WALL,
        opening=Opening(radius=radius - WALL),
        contents_l=rng.uniform(0.0, 300.0) * np.pi * (radius - WALL) ** 2 * (height - WALL),
    )
    target = Truth(
        radius_m=radius, height_m=height, mass_kg=SHELL + glass.mass, container=glass, **_FRICTION
    )
    running = pour(vessel, container.contents, angle=angle, **motion)
    fall = rng.uniform(0.02, 0.08)
    ahead = float(running.landing(fall)[0])
    aim = rng.normal(0.0, AIM, 2) - ahead * np.array([math.cos(heading), math.sin(heading)])
    lip_W = np.array([_AT.x_m + aim[0], _AT.y_m + aim[1], height + fall])
    objects = tuple(
        SceneObject(name=name, model="mug", pose=at, truth=true)
        for name, at, true in ((SOURCE, _APART, truth), (TARGET, _AT, target))
    )
    scene = Scene(version=1, name="pouring", robot=_HOME, objects=objects)
    return Case(kind, scene, heading, angle, rate, wait, lip_W)


def _jug(kind: str, rng: np.random.Generator, spout: float) -> Truth:
    """A container whose opening lies in some direction."""
    height = rng.uniform(0.10, 0.22)
    if kind == "box":
        size = rng.uniform(0.05, 0.10, 2)
        shape: dict[str, Any] = {"size_m": (size[0], size[1], height)}
        inside = size.min() / 2.0
    elif kind == "cylinder":
        inside = rng.uniform(0.028, 0.045)
        shape = {"radius_m": inside, "height_m": height}
    else:
        turns = 2.0 * np.pi * (np.arange(5) + rng.uniform(-0.3, 0.3, 5)) / 5.0
        corners = rng.uniform(0.04, 0.06) * np.column_stack([np.cos(turns), np.sin(turns)])
        shape = {"corners_m": tuple(map(tuple, corners.tolist())), "height_m": height}
        inside = float(Polygon.convex(corners).offsets.min())
    room = inside - WALL
    radius = rng.uniform(0.3, 1.0) * room
    middle = (room - radius) * np.array([math.cos(spout), math.sin(spout)])
    container = Container(wall=WALL, opening=Opening(centre=tuple(middle.tolist()), radius=radius))
    empty = Truth(mass_kg=SHELL, container=container, **_FRICTION, **shape)
    assert empty.vessel is not None
    litres = 1e3 * rng.uniform(0.2, 0.8) * empty.vessel.capacity
    full = container.model_copy(update={"contents_l": litres})
    return Truth(mass_kg=SHELL + full.mass, container=full, **_FRICTION, **shape)


def predicted(case: Case) -> dict[str, float]:
    """Volumes that the model says [m³]."""
    vessel, contents = case.source
    target = case.scene.object(TARGET).truth
    assert target.vessel is not None
    assert target.container is not None
    way = {"heading": case.heading, "angle": case.angle, "rate": case.rate, "wait": case.wait}
    running = pour(vessel, contents, **way)
    off = np.array([_AT.x_m, _AT.y_m]) - case.lip_W[:2]
    c, s = math.cos(case.heading), math.sin(case.heading)
    catch = Catch(
        along=c * off[0] + s * off[1],
        across=c * off[1] - s * off[0],
        fall=case.lip_W[2] - target.height,
        radius=target.container.opening.radius,
        free=target.vessel.capacity - target.container.contents,
    )
    result = caught_volume(running, contents, catch)
    return {name: float(volume) for name, volume in result.mean_volumes().items()}


def simulated(case: Case, rng: np.random.Generator) -> dict[str, float]:
    """Volumes that ran in the simulation [m³]."""
    world = Prescribed(case.scene)
    before = dict(world.liquid.contents)
    period = 1.0 / case.scene.control_rate_hz
    times = np.arange(0.0, 2.0 * case.angle / case.rate + case.wait + 2.0 * RAMP, period)
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    for t, tilt in zip(times, motion(case, times), strict=True):
        shaken = SHAKING * np.sin(2.0 * np.pi * 2.0 * t + phase)
        world.lean(SOURCE, float(tilt), case.heading, case.lip_W + shaken)
    after = world.liquid.contents
    return {
        "poured": before[SOURCE] - after[SOURCE],
        "received": after[TARGET] - before[TARGET],
        "spilled": world.liquid.spilled,
    }


def motion(case: Case, times: Array) -> Array:
    """Tilts at the times: there, waiting, and back, each corner of the way rounded [rad]."""
    there = case.angle / case.rate
    back = there + case.wait
    fine = np.linspace(-RAMP / 2.0, RAMP / 2.0, 21)
    # Rounded by the mean over the ramp, which makes the rate rise and fall linearly.
    shifted = times[:, None] - RAMP / 2.0 + fine
    way = np.clip(shifted, 0.0, there) - np.clip(shifted - back, 0.0, there)
    return np.asarray(case.rate * way.mean(axis=1))


@dataclass(frozen=True)
class Result:
    """One case and how far off its prediction was.

    Attributes:
        case: what was poured.
        volumes: simulated [m³].
        off: predicted less simulated, as a share of the contents, by quantity.
    """

    case: Case
    volumes: Mapping[str, float]
    off: Mapping[str, float]


def one(seed: tuple[int, int]) -> Result:
    """A random pour, predicted and simulated.

    Args:
        seed: of the benchmark, and of the case in it.
    """
    rng = np.random.default_rng(seed)
    case = random_case(rng)
    said, ran = predicted(case), simulated(case, rng)
    contents = case.source[1]
    return Result(case, ran, {name: (said[name] - ran[name]) / contents for name in QUANTITIES})


def table(results: list[Result]) -> str:
    """How far off predictions were, in percent of the contents."""
    lines = [
        "| | cases | mean | 95 % below | worst | within 3 % |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    groups = [(q, "all", results) for q in QUANTITIES]
    groups += [("poured", kind, [r for r in results if r.case.kind == kind]) for kind in KINDS]
    for quantity, which, members in groups:
        if not members:
            continue
        off = 100.0 * np.abs([r.off[quantity] for r in members])
        within = (off <= 100.0 * PROMISED).mean()
        lines.append(
            f"| {quantity}, {which} | {len(off)} | {off.mean():.2f} | {np.quantile(off, 0.95):.2f} "
            f"| {off.max():.2f} | {within:.0%} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args()
    start = time.perf_counter()
    cases = [(given.seed, i) for i in range(given.cases)]
    results = list(run_all(one, cases, workers=given.processes))
    print(table(results))
    contents = np.array([r.case.source[1] for r in results])
    shares = {q: np.array([r.volumes[q] for r in results]) / contents for q in QUANTITIES}
    told = ", ".join(f"{q} {100 * share.mean():.0f} %" for q, share in shares.items())
    print(f"\nOn average of the contents: {told}. {time.perf_counter() - start:.0f} s.")


if __name__ == "__main__":
    main()
