"""Random pushes of random objects, and how their onset is found in a simulated world.

An object stands alone on a plane on small spheres at the corners of its base. A force at a point of
its side, of fixed direction, grows quickly to `NEAR` of the onset that the exact tier says, then
slowly through it. After every step a world is asked for two speeds: the largest in-plane speed of a
base corner, `slip`, and the largest upward speed of one, `lift`. An object that slides has slip
only. One that topples turns about an edge or a corner of its base, an axis in the plane of the
base, so that its corners have lift only, whatever its middle does.

Past the onset the force that is not balanced grows evenly, so the speed grows with the square of
time: v ∝ (t − t0)². The onset is the force at t0, where the straight line through √v over the last
part of its way is zero. That takes out the ramp's delay. Creep below the onset is too slow to
enter the line: it is below 1e-5 m/s but for a corner near the centre of rotation. If there are both
slip and lift at the end, as when a toppling object starts to slide as well, the class is that of
the one that started first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from objectmodels import BoxModel, PrismModel
from objectmodels.geometry.base_shapes import Support
from objectmodels.models.object_model import ObjectModel
from sim.face_experiment import onset_time

Array = NDArray[np.float64]
Stands = Literal["corners", "weighted", "evenly"]

STEP = 1e-3
"""Of both engines, but for MuJoCo's round bases [s]."""
SPHERE = 1e-3
"""Radius of the spheres at the base corners [m]; friction acts at their lowest points."""
SETTLING = 0.1
"""Time to sink in by the few micrometres at which contact carries the weight [s]."""
QUICK, NEAR = 0.3, 0.8
"""The force grows to `NEAR` of the expected onset in `QUICK` [s] ..."""
SLOW, FAR = 1.5, 1.25
"""... and to `FAR` of it in `SLOW` [s] more."""
SLIPS = 3e-4
"""Slip that counts as sliding [m/s]; engines let normal forces grow with slip, so it is small."""
LIFTS = 1e-3
"""Lift that counts as toppling [m/s]; slender objects rock on their contacts."""
COUNTS = 2e-4
"""Slip or lift that had a start [m/s], once the other has ended the roll-out; rocking has none."""
HEAVIEST = 20.0
"""Pushes with a larger onset are left out, as a share of the weight."""
PRISMS = 0.3
"""Share of prisms among the objects; the others are boxes."""


@dataclass(frozen=True)
class Push:
    """A push, and what the exact tier says of it.

    Attributes:
        number: which of the random pushes of a seed.
        model: the object.
        point: contact point in B [m].
        direction: unit direction of the force.
        outcome: class at the onset.
        onset: force at which it starts to move [N].
        apart: distance of the slide and the topple threshold, as a share of the onset.
    """

    number: int
    model: ObjectModel
    point: Array
    direction: Array
    outcome: str
    onset: float
    apart: float


@dataclass(frozen=True)
class Seen:
    """What a world did.

    Attributes:
        outcome: `slide`, `topple`, or `none` if nothing moved up to `FAR`.
        onset: force at which it started to move, the ramp's delay taken out [N].
        noticed: force at which the motion exceeded its bound [N].
        slip, lift: speeds of the base corners at that time [m/s].
    """

    outcome: str
    onset: float
    noticed: float
    slip: float
    lift: float


class World(Protocol):
    """An object that stands on a plane in an engine."""

    def step(self, point: Array, force: Array) -> tuple[Array, Array]:
        """One step under a force [N] in world axes at a point of the object in B.

        Returns:
            Angular velocity [rad/s] and velocity of B's origin [m/s], in world axes.
        """
        ...


def random_push(seed: int, number: int, stands: Stands = "corners") -> Push:
    """The push of that number; it depends on nothing else.

    Args:
        seed: of all pushes.
        number: of this one.
        stands: on corners that bear alike, on corners of random weights, or evenly.
    """
    rng = np.random.default_rng((seed, number))
    while True:
        push = _push_of(_random_model(rng, stands), number, rng)
        if push is not None:
            return push


def _random_model(rng: np.random.Generator, stands: Stands) -> ObjectModel:
    """A box or a prism with its centre of mass off the middle."""
    height, half = float(rng.uniform(0.05, 0.30)), rng.uniform(0.02, 0.07, 2)
    mass, friction = float(rng.uniform(0.1, 2.0)), float(rng.uniform(0.2, 0.6))
    prism = rng.random() < PRISMS
    k = int(rng.integers(3, 8)) if prism else 4
    # Less than half a turn lies between neighbours, so that they enclose the origin.
    angles = 2 * np.pi * (np.arange(k) + rng.uniform(-0.2, 0.2, k)) / k
    corners = half * np.column_stack((np.cos(angles), np.sin(angles)))
    if not prism:
        corners = half * [[1, 1], [-1, 1], [-1, -1], [1, -1]]
    x, y = (0.8 * rng.dirichlet(np.ones(k)) @ corners).tolist()
    com = (x, y, float(rng.uniform(0.25, 0.75)) * height)
    support: Support = "uniform" if stands == "evenly" else "corners"
    if stands == "weighted":
        weights = rng.uniform(0.2, 1.0, k)
        support = tuple(map(tuple, np.column_stack((corners, weights)).tolist()))
    if prism:
        return PrismModel(
            name="prism", corners=corners.tolist(), height=height, mass=mass, friction=friction,
            com=com, support=support,
        )  # fmt: skip
    size = (2.0 * float(half[0]), 2.0 * float(half[1]), height)
    return BoxModel(name="box", size=size, mass=mass, friction=friction, com=com, support=support)


def _push_of(model: ObjectModel, number: int, rng: np.random.Generator) -> Push | None:
    """An oblique push at a random place of a side; None if its onset is too high."""
    faces = [face for face in model.faces() if abs(face.normal[2]) < 0.5]
    face = faces[rng.integers(len(faces))]
    tangent, up = np.array(face.tangent), np.array([0.0, 0.0, 1.0])
    point = np.array(face.centre) + rng.uniform(-0.5, 0.5) * face.width * tangent
    point += rng.uniform(-0.45, 0.45) * face.height * up
    u = -np.array(face.normal) + rng.normal(0.0, 0.5) * tangent + rng.normal(0.0, 0.3) * up
    u /= np.linalg.norm(u)
    exact = model.thresholds(point[None], u[None], exact=True)
    onset = exact.onset.item()
    if not onset < HEAVIEST * model.weight:
        return None
    slide, topple = exact.slide.item(), exact.topple.item()
    apart = (topple - slide) / onset if slide < topple else _spare_friction(model, point, u)
    return Push(number, model, point, u, exact.outcome.item(), onset, apart)


def _spare_friction(model: ObjectModel, point: Array, u: Array) -> float:
    """Friction beyond what it needs to topple before it slides, as a share of that need.

    There are no loads beyond toppling, so no slide threshold; but it would grow with friction. The
    ellipsoid's threshold will not do here: with the load on one edge it says far too much.
    """
    enough, little = 1.0, 0.0
    while enough - little > 1e-3 * enough:
        share = 0.5 * (enough + little)
        less = model.model_copy(update={"friction": share * model.friction})
        slides = less.thresholds(point[None], u[None], exact=True).outcome.item() == "slide"
        enough, little = (enough, share) if slides else (share, little)
        if enough < 1e-3:
            return np.inf
    return 1.0 / enough - 1.0


def share_at(time: float) -> float:
    """The force as a share of the expected onset, at a time after settling [s]."""
    time = max(time, 0.0)
    if time < QUICK:
        return NEAR * time / QUICK
    return NEAR + (FAR - NEAR) * (time - QUICK) / SLOW


def roll_out(world: World, push: Push, step: float = STEP, *, rocks: bool = False) -> Seen:
    """Settles the object, then pushes it until it moves; the world's steps are so long [s].

    One that `rocks` before it tips topples only if its lift alone comes to the bound.
    """
    least = {"slide": COUNTS, "topple": LIFTS if rocks else COUNTS}
    for _ in range(round(SETTLING / step)):
        world.step(push.point, np.zeros(3))
    corners = push.model.footprint.corners
    slips: list[float] = []
    lifts: list[float] = []
    for i in range(round((QUICK + SLOW) / step)):
        time = i * step
        angular, velocity = world.step(push.point, share_at(time) * push.onset * push.direction)
        slip, lift = corner_speeds(corners, angular, velocity)
        slips.append(slip)
        lifts.append(lift)
        if slip >= SLIPS or lift >= LIFTS:
            both = {"slide": slips, "topple": lifts}
            times = step * np.arange(len(slips))
            starts = {k: onset_time(times, v) for k, v in both.items() if v[-1] >= least[k]}
            outcome = min(starts, key=lambda key: starts[key])
            onset = share_at(starts[outcome]) * push.onset
            return Seen(outcome, onset, share_at(time) * push.onset, slip, lift)
    return Seen("none", np.inf, np.inf, slips[-1], lifts[-1])


def corner_speeds(corners: Array, angular: Array, velocity: Array) -> tuple[float, float]:
    """Largest in-plane and largest upward speed of base corners [m/s]."""
    (x, y), (wx, wy, wz), (vx, vy, vz) = corners.T, angular, velocity
    slip = np.hypot(vx - wz * y, vy + wz * x).max()
    lift = (vz + wx * y - wy * x).max()
    return float(slip), float(lift)
