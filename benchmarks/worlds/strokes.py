"""Random strokes of a fingertip without a robot, for searching by roll-outs.

Model: one fingertip, or two side by side, moves through the air to a point before an object,
straight along the table, and back. It goes wherever it is told at an even speed, held by stiff
springs; between strokes it is simply put elsewhere. What engines roll them out: see `Bench`.

Frames: W is the world, B the object; a stroke is told in W.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from objectmodels import ObjectModel
from sim.robots.robots import HAND

Array = NDArray[np.float64]
Generator = np.random.Generator

PERIOD = 0.01
"""Time between two samples [s]."""
BEFORE = 0.01
"""Distance before the face from which a fingertip comes [m]."""
STIFFNESS, DAMPING = 2000.0, 40.0
"""Of the springs that hold the fingertips [N/m, N·s/m]."""
TIP_MASS = 0.05
STRONGEST = float(HAND.pushing_postures(1, 0.0).strength.max())
"""Of a fingertip along each axis [N]."""

_LOWEST = 0.012  # of the fingertip's centre; lower it would touch the table [m]
_LONGEST = 0.30  # stroke [m]
_OBLIQUE = np.radians(25.0)  # from the face's normal

# By how much a stroke is varied, standard deviations.
_TURN, _ASIDE, _UP, _LONGER = np.radians(5.0), 0.006, 0.010, 0.12


@dataclass(frozen=True)
class Stroke:
    """A straight way of the fingertips' midpoint, its centre in W.

    Attributes:
        start, end: where it goes, shape (3,) [m].
        heading: of the normal into the face [rad]; two fingertips stand across it.
        object: that is pushed.
    """

    start: Array
    end: Array
    heading: float
    object: str

    @property
    def direction(self) -> Array:
        """Unit vector from start to end."""
        way = self.end - self.start
        return np.asarray(way / np.linalg.norm(way))

    def path(self, speed: float) -> tuple[Array, NDArray[np.bool_]]:
        """There, and back at twice the speed, shape (n, 3) [m], and whether it is there, (n,)."""
        length = float(np.linalg.norm(self.end - self.start))
        n = max(2, round(length / (speed * PERIOD)))
        there = np.linspace(0.0, 1.0, n)
        share = np.concatenate([there, there[::-2]])
        return self.start + share[:, None] * (self.end - self.start), np.arange(len(share)) < n

    def varied(self, rng: Generator) -> Stroke:
        """Nearly the same."""
        turn = float(rng.normal(0.0, _TURN))
        c, s = np.cos(turn), np.sin(turn)
        aside, up = rng.normal(0.0, _ASIDE), rng.normal(0.0, _UP)
        way = self.end - self.start
        across = np.array([-way[1], way[0], 0.0]) / np.linalg.norm(way)
        way = way * (1.0 + rng.normal(0.0, _LONGER))
        start = self.start + aside * across
        start[2] = max(start[2] + up, _LOWEST)
        turned = np.array([c * way[0] - s * way[1], s * way[0] + c * way[1], 0.0])
        return replace(self, start=start, end=start + turned)


@dataclass(frozen=True)
class Rolled:
    """What a stroke did, sampled n times at `PERIOD`.

    Attributes:
        poses: per object, quaternions (w, x, y, z) and p_WB [m], shape (n, 7).
        tips: per fingertip, its centre in W, shape (n, 3) [m].
        felt: per fingertip, its force on what it touches in W, shape (n, 3) [N].
        pushing: whether the fingertips are on their way there, shape (n,).
        touched: pairs of bodies that touched.
    """

    poses: dict[str, Array]
    tips: dict[str, Array]
    felt: dict[str, Array]
    pushing: NDArray[np.bool_]
    touched: frozenset[frozenset[str]]


class Bench(Protocol):
    """An engine in which strokes are rolled out, each from where the last one left things."""

    def keep(self) -> object:
        """The state of things now, for `back`."""
        ...

    def back(self, state: object) -> None:
        """Puts everything back."""
        ...

    def poses(self) -> dict[str, Array]:
        """Where the objects are now, quaternion (w, x, y, z) and p_WB, shape (7,) each."""
        ...

    def roll(self, stroke: Stroke, speed: float) -> Rolled:
        """Rolls out a stroke at a speed [m/s]."""
        ...


def random_stroke(name: str, model: ObjectModel, pose: Array, rng: Generator) -> Stroke:
    """Anywhere on the sides of an object, any way into them, of any length.

    Args:
        name: of the object.
        model: its shape.
        pose: quaternion (w, x, y, z) and p_WB [m], shape (7,); it stands upright.
        rng: to draw from.
    """
    faces = model.faces(rng.uniform(-np.pi, np.pi, 8))
    face = faces[int(rng.integers(len(faces)))]
    lateral = float(rng.uniform(-0.5, 0.5)) * face.width
    height = float(rng.uniform(_LOWEST, max(model.top, _LOWEST + 1e-3)))
    slant = float(rng.uniform(-_OBLIQUE, _OBLIQUE))
    length = float(rng.uniform(0.0, _LONGEST))
    return at(name, face.points_at(lateral, height), pose, slant=slant, length=length)


def towards(
    name: str, model: ObjectModel, pose: Array, heading: float, length: float, rng: Generator
) -> Stroke:
    """Along a heading in W [rad] through about the middle of the face that it meets."""
    yaw = heading_of(pose)
    faces = model.faces([heading - yaw])
    into = np.array([np.cos(heading - yaw), np.sin(heading - yaw), 0.0])
    face = min(faces, key=lambda each: float(np.array(each.normal) @ into))
    lateral = float(np.clip(rng.normal(0.0, 0.15), -0.5, 0.5)) * face.width
    height = float(rng.uniform(_LOWEST, max(model.top, _LOWEST + 1e-3)))
    place = face.points_at(lateral, height)
    inward = float(np.arctan2(-place[1][1], -place[1][0]))
    slant = float(np.arctan2(np.sin(heading - yaw - inward), np.cos(heading - yaw - inward)))
    return at(name, place, pose, slant=slant, length=length)


def at(
    name: str, place: tuple[Array, Array], pose: Array, *, slant: float, length: float
) -> Stroke:
    """At a place of an object, so far after the touch [m]; slant is the angle off the normal."""
    p_BC, normal = place
    yaw = heading_of(pose)
    c, s = np.cos(yaw), np.sin(yaw)
    R_WB = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    outward = R_WB @ normal
    heading = float(np.arctan2(-outward[1], -outward[0]))
    direction = np.array([np.cos(heading + slant), np.sin(heading + slant), 0.0])
    touch = pose[4:] + R_WB @ p_BC + HAND.tip_radius * outward
    # Where the base stood may be a little below the table's plane: feet sink in.
    touch[2] = max(float(touch[2]), _LOWEST)
    return Stroke(touch - BEFORE * direction, touch + length * direction, heading, name)


def heading_of(pose: Array) -> float:
    """Heading of B's x axis [rad]."""
    w, x, y, z = pose[:4]
    return float(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y**2 + z**2)))


def upright(pose: Array) -> bool:
    """Whether an object stands on its base."""
    _, x, y, _ = pose[:4]
    return bool(1.0 - 2.0 * (x**2 + y**2) > np.cos(np.radians(3.0)))


def offsets(fingers: int, heading: float) -> Array:
    """Places of the fingertips from their midpoint in W, shape (fingers, 3) [m]."""
    across = np.array([-np.sin(heading), np.cos(heading), 0.0])
    sides = (
        np.array([0.0]) if fingers == 1 else 0.5 * HAND.finger_spreads[0] * np.array([-1.0, 1.0])
    )
    return np.asarray(sides[:, None] * across)
