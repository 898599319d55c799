"""An object alone on a plane in MuJoCo: a free body on spheres at its base corners.

The contacts' impedance does not depend on depth: they then are springs of one stiffness, in which
the object sinks by some 5 µm. They are about as stiff and as quick as the step allows, since a
contact is lifted by its slip times its time constant, which moves load between corners that slip at
different speeds. Elliptic cones with a high ratio of friction to normal impedance keep the creep
small, without iterations against slip (with those it sticks past its onset, and then breaks away).

A round base stands on 24 spheres of its rim. Before it tips, its load gathers on one of them, and
unloading that one's neighbours takes a tilt that lifts the other side by some sixty times the depth
of a sphere: as fast, at the usual step, as what counts as toppling. So such a base gets shorter
steps, with contacts that are stiffer by the square of that, and is known to rock.
"""

from __future__ import annotations

import mujoco
import numpy as np

from benchmarks.pushes import SPHERE, STEP, Array
from objectmodels.geometry.base_shapes import Disc
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_model import ObjectModel

WORLD = """
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


ROUND_STEP = STEP / 8.0
"""For an object on a round base [s]."""


def is_round(model: ObjectModel) -> bool:
    """Return True for an object that stands on the rim of a round base."""
    return isinstance(model.footprint, Disc)


def step_of(model: ObjectModel) -> float:
    """Length of the steps in which an object is moved [s]."""
    return ROUND_STEP if is_round(model) else STEP


def world_text(model: ObjectModel) -> str:
    """The world as MuJoCo reads it."""
    step = step_of(model)
    spheres = "\n      ".join(
        f'<geom type="sphere" size="{SPHERE}" pos="{x} {y} {SPHERE}"/>'
        for x, y in model.footprint.corners.tolist()
    )
    inertia = model.mass * np.array(model.gyration)
    return WORLD.format(
        step=step,
        gravity=-GRAVITY,
        friction=model.friction,
        time=4 * step,
        com=" ".join(map(str, model.com)),
        mass=model.mass,
        inertia=" ".join(map(str, inertia.tolist())),
        spheres=spheres,
    )


class BodyInMujoco:
    """The only free body of a world as MuJoCo reads it; a `benchmarks.pushes.World`."""

    def __init__(self, text: str) -> None:
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        self.rotation = np.empty(9)
        mujoco.mj_forward(self.model, self.data)

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """See `benchmarks.pushes.World`."""
        position, velocity = self.data.qpos, self.data.qvel
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        self.data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(
            self.model,
            self.data,
            force,
            np.zeros(3),
            position[:3] + self.rotation.reshape(3, 3) @ point,
            1,
            self.data.qfrc_applied,
        )
        mujoco.mj_step(self.model, self.data)
        mujoco.mju_quat2Mat(self.rotation, position[3:7])
        return self.rotation.reshape(3, 3) @ velocity[3:], velocity[:3].copy()


class MujocoWorld(BodyInMujoco):
    """An object on its base corners in MuJoCo."""

    def __init__(self, model: ObjectModel) -> None:
        super().__init__(world_text(model))
