"""Worlds in MuJoCo: an object alone on a plane, and one box with a fingertip.

In `MujocoWorld` the contacts' impedance does not depend on depth: they then are springs of one
stiffness, in which the object sinks by some 5 µm. They are about as stiff and as quick as the step
allows, since a contact is lifted by its slip times its time constant, which moves load between
corners that slip at different speeds. Elliptic cones with a high ratio of friction to normal
impedance keep the creep small, without iterations against slip (with those it sticks past its
onset, and then breaks away).

A round base stands on 24 spheres of its rim. Before it tips, its load gathers on one of them, and
unloading that one's neighbours takes a tilt that lifts the other side by some sixty times the depth
of a sphere: as fast, at the usual step, as what counts as toppling. So such a base gets shorter
steps, with contacts that are stiffer by the square of that, and is known to rock.

In `MujocoBench` coefficients are those of the pairs that may touch: corners and plane, fingertip
and box.
"""

from __future__ import annotations

import itertools
from typing import Any

import mujoco
import numpy as np

from benchmarks.worlds.pushes import SPHERE, STEP, Array
from benchmarks.worlds.strokes import (
    DAMPING,
    PERIOD,
    STIFFNESS,
    STRONGEST,
    TIP_MASS,
    Rolled,
    Stroke,
)
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.shapes import Box
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene

ROUND_STEP = STEP / 8.0
"""For an object on a round base [s]."""
STROKE_STEP = 2e-3
"""Of strokes [s]."""

_SETTLING, _RESTING = 0.2, 0.3  # before the first stroke and after each [s]
_AWAY = np.array([0.0, 0.0, 2.0])  # where the fingertip waits [m]

_PUSHED = """
<mujoco>
  <option timestep="{step}" gravity="0 0 {gravity}" cone="elliptic" impratio="1000"
    tolerance="0" iterations="50"/>
  <default>
    <geom friction="{friction} 0 0" condim="3" solref="{time} 0.5" solimp="0.5 0.5 0.001"/>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body>
      <freejoint/>
      <inertial pos="{com}" mass="{mass}" diaginertia="{inertia}"/>
      {spheres}
    </body>
  </worldbody>
</mujoco>
"""
_STROKED = """
<mujoco>
  <option timestep="{step}" gravity="0 0 {gravity}" cone="elliptic" impratio="100"
    integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <geom name="table" type="plane" size="2 2 1"/>
    <body name="object" pos="{x} {y} 0" euler="0 0 {yaw}">
      <freejoint/>
      <inertial pos="{com}" mass="{mass}" diaginertia="{inertia}"/>
      <geom name="solid" type="box" size="{half}" pos="0 0 {middle}"/>
      {feet}
    </body>
    <body name="tip" gravcomp="1">
      <inertial pos="0 0 0" mass="{tip_mass}" diaginertia="1e-5 1e-5 1e-5"/>
      {slides}
      <geom name="tip" type="sphere" size="{tip_radius}"/>
    </body>
  </worldbody>
  <contact>
    {pairs}
    <pair geom1="tip" geom2="solid" friction="{finger} {finger} 1e-4 1e-6 1e-6"
      solref="{time} 1" condim="3"/>
  </contact>
  <actuator>{springs}</actuator>
</mujoco>
"""
_PAIR = (
    '<pair geom1="table" geom2="foot{i}" friction="{mu} {mu} 1e-4 1e-6 1e-6" solref="{time} 1"'
    ' condim="3"/>'
)
_SLIDE = '<joint name="{a}" type="slide" axis="{axis}"/>'
_SPRING = '<position joint="{a}" kp="{k}" forcerange="-{f} {f}"/><velocity joint="{a}" kv="{d}"/>'


def is_round(model: ObjectModel) -> bool:
    """Return True for an object that stands on the rim of a round base."""
    return model.footprint.is_round


def step_of(model: ObjectModel) -> float:
    """Length of the steps in which an object is moved [s]."""
    return ROUND_STEP if is_round(model) else STEP


class BodyInMujoco:
    """The only free body of a world as MuJoCo reads it; a `benchmarks.worlds.pushes.World`."""

    def __init__(self, text: str) -> None:
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        self.rotation = np.empty(9)
        mujoco.mj_forward(self.model, self.data)

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.worlds.pushes.World`."""
        position, velocity = self.data.qpos, self.data.qvel
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        self.data.qfrc_applied[:] = 0.0
        at = position[:3] + self.rotation.reshape(3, 3) @ point
        applied = self.data.qfrc_applied
        mujoco.mj_applyFT(self.model, self.data, force, np.zeros(3), at, 1, applied)
        mujoco.mj_step(self.model, self.data)
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        return self.rotation.reshape(3, 3) @ velocity[3:], velocity[:3].copy()


class MujocoWorld(BodyInMujoco):
    """An object on its base corners in MuJoCo."""

    def __init__(self, model: ObjectModel) -> None:
        step = step_of(model)
        text = _PUSHED.format(
            step=step,
            gravity=-GRAVITY,
            friction=model.friction,
            time=4 * step,
            com=_numbers(model.com),
            mass=model.mass,
            inertia=_numbers((model.mass * np.array(model.gyration)).tolist()),
            spheres="\n      ".join(
                f'<geom type="sphere" size="{SPHERE}" pos="{x} {y} {SPHERE}"/>'
                for x, y in model.footprint.corners.tolist()
            ),
        )
        super().__init__(text)


class MujocoBench:
    """One box and a fingertip; a `benchmarks.worlds.strokes.Bench`.

    Args:
        scene: what is true; it holds one box.

    Raises:
        ValueError: it holds something else.
    """

    def __init__(self, scene: Scene) -> None:
        if len(scene.objects) != 1 or not isinstance(scene.objects[0].truth.shape, Box):
            raise ValueError("MuJoCo gets one box to push")
        self._name = scene.objects[0].name
        self._model = mujoco.MjModel.from_xml_string(_stroked_text(scene))
        self._data = mujoco.MjData(self._model)
        self._put(_AWAY)
        self._wait(_SETTLING)

    def keep(self) -> object:
        """See `benchmarks.worlds.strokes.Bench`."""
        return self._data.time, self._data.qpos.copy(), self._data.qvel.copy()

    def back(self, state: Any) -> None:
        """See `benchmarks.worlds.strokes.Bench`."""
        self._data.time, self._data.qpos[:], self._data.qvel[:] = state
        mujoco.mj_forward(self._model, self._data)

    def poses(self) -> dict[str, Array]:
        """See `benchmarks.worlds.strokes.Bench`."""
        p, q = self._data.qpos[:3], self._data.qpos[3:7]
        return {self._name: np.concatenate([q, p])}

    def roll(self, stroke: Stroke, speed: float) -> Rolled:
        """See `benchmarks.worlds.strokes.Bench`."""
        path, there = stroke.path(speed)
        self._put(path[0])
        samples = []
        for before, now in itertools.pairwise(path):
            self._command(now, (now - before) / PERIOD)
            samples.append(self._sampled())
        self._put(_AWAY)
        samples += [self._sampled() for _ in range(round(_RESTING / PERIOD))]
        poses, tips, felt = (np.array(column) for column in zip(*samples, strict=True))
        # Who touched whom is not asked here: there is nothing else that could be touched.
        return Rolled(
            poses={self._name: poses},
            tips={"tip 0": tips},
            felt={"tip 0": felt},
            pushing=np.arange(len(poses)) < there.sum(),
            touched=frozenset(),
        )

    def _sampled(self) -> tuple[Array, Array, Array]:
        self._wait(PERIOD)
        forces = self._data.qfrc_actuator[6:].copy()
        return self.poses()[self._name], self._data.qpos[7:].copy(), forces

    def _put(self, place: Array) -> None:
        self._data.qpos[7:], self._data.qvel[6:] = place, 0.0
        self._command(place, np.zeros(3))
        mujoco.mj_forward(self._model, self._data)

    def _command(self, place: Array, velocity: Array) -> None:
        self._data.ctrl[:] = np.column_stack([place, velocity]).ravel()

    def _wait(self, seconds: float) -> None:
        for _ in range(round(seconds / STROKE_STEP)):
            mujoco.mj_step(self._model, self._data)


def _stroked_text(scene: Scene) -> str:
    """The box and the fingertip as MuJoCo reads them."""
    (item,) = scene.objects
    truth, time = item.truth, 2 * STROKE_STEP
    x, y, z = truth.shape.extents
    inertia = truth.mass_kg / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    feet = [(a - np.copysign(SPHERE, a), b - np.copysign(SPHERE, b)) for a, b in truth.support]
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    return _STROKED.format(
        step=STROKE_STEP,
        gravity=-GRAVITY,
        x=item.pose.x_m,
        y=item.pose.y_m,
        yaw=item.pose.yaw_deg,
        com=_numbers(truth.centre_of_mass),
        mass=truth.mass_kg,
        inertia=_numbers(inertia.tolist()),
        half=_numbers((x / 2, y / 2, z / 2)),
        middle=z / 2,
        feet="\n      ".join(
            f'<geom name="foot{i}" type="sphere" size="{SPHERE}" pos="{a} {b} {SPHERE}"/>'
            for i, (a, b) in enumerate(feet)
        ),
        tip_mass=TIP_MASS,
        tip_radius=HAND.tip_radius,
        slides="".join(_SLIDE.format(a=a, axis=axis) for a, axis in axes.items()),
        pairs="\n    ".join(
            _PAIR.format(i=i, mu=truth.friction_table, time=time) for i in range(len(feet))
        ),
        finger=truth.friction_finger,
        time=time,
        springs="".join(_SPRING.format(a=a, k=STIFFNESS, d=DAMPING, f=STRONGEST) for a in axes),
    )


def _numbers(values: Any) -> str:
    return " ".join(map(str, values))
