"""Strokes in MuJoCo: one box on spheres at its base corners, and a fingertip on springs.

Coefficients are those of the pairs that may touch: corners and plane, fingertip and box. Cones are
elliptic, so that friction is the same in all directions.
"""

from __future__ import annotations

import itertools
from typing import Any

import mujoco
import numpy as np

from benchmarks.strokes import (
    DAMPING,
    PERIOD,
    STIFFNESS,
    STRONGEST,
    TIP_MASS,
    Array,
    Rolled,
    Stroke,
)
from objectmodels.mechanics.push_thresholds import GRAVITY
from sim.robots.robots import HAND
from sim.truth.scene_file import Scene

STEP = 2e-3
FOOT = 1e-3
"""Radius of the spheres at the corners [m]."""

_SETTLING, _RESTING = 0.2, 0.3  # before the first stroke and after each [s]
_AWAY = np.array([0.0, 0.0, 2.0])  # where the fingertip waits [m]

WORLD = """
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


class MujocoBench:
    """One box and a fingertip; a `benchmarks.strokes.Bench`.

    Args:
        scene: what is true; it holds one box.

    Raises:
        ValueError: it holds something else.
    """

    def __init__(self, scene: Scene) -> None:
        if len(scene.objects) != 1 or scene.objects[0].truth.size_m is None:
            raise ValueError("MuJoCo gets one box to push")
        self._name = scene.objects[0].name
        self._model = mujoco.MjModel.from_xml_string(_text(scene))
        self._data = mujoco.MjData(self._model)
        self._put(_AWAY)
        self._wait(_SETTLING)

    def keep(self) -> object:
        """See `benchmarks.strokes.Bench`."""
        return self._data.time, self._data.qpos.copy(), self._data.qvel.copy()

    def back(self, state: Any) -> None:
        """See `benchmarks.strokes.Bench`."""
        self._data.time, self._data.qpos[:], self._data.qvel[:] = state
        mujoco.mj_forward(self._model, self._data)

    def poses(self) -> dict[str, Array]:
        """See `benchmarks.strokes.Bench`."""
        p, q = self._data.qpos[:3], self._data.qpos[3:7]
        return {self._name: np.concatenate([q, p])}

    def roll(self, stroke: Stroke, speed: float) -> Rolled:
        """See `benchmarks.strokes.Bench`."""
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
        for _ in range(round(seconds / STEP)):
            mujoco.mj_step(self._model, self._data)


def _text(scene: Scene) -> str:
    """The world as MuJoCo reads it."""
    (item,) = scene.objects
    truth, time = item.truth, 2 * STEP
    assert truth.size_m is not None
    x, y, z = truth.size_m
    inertia = truth.mass_kg / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    corners = [(a - np.copysign(FOOT, a), b - np.copysign(FOOT, b)) for a, b in truth.support]
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    return WORLD.format(
        step=STEP,
        gravity=-GRAVITY,
        x=item.pose.x_m,
        y=item.pose.y_m,
        yaw=item.pose.yaw_deg,
        com=" ".join(map(str, truth.centre_of_mass)),
        mass=truth.mass_kg,
        inertia=" ".join(map(str, inertia.tolist())),
        half=f"{x / 2} {y / 2} {z / 2}",
        middle=z / 2,
        feet="\n      ".join(
            f'<geom name="foot{i}" type="sphere" size="{FOOT}" pos="{a} {b} {FOOT}"/>'
            for i, (a, b) in enumerate(corners)
        ),
        tip_mass=TIP_MASS,
        tip_radius=HAND.tip_radius,
        slides="".join(_SLIDE.format(a=a, axis=axis) for a, axis in axes.items()),
        pairs="\n    ".join(
            _PAIR.format(i=i, mu=truth.friction_table, time=time) for i in range(len(corners))
        ),
        finger=truth.friction_finger,
        time=time,
        springs="".join(_SPRING.format(a=a, k=STIFFNESS, d=DAMPING, f=STRONGEST) for a in axes),
    )
