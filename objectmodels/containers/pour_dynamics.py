"""Pouring: how fast a leaning vessel runs out, where the stream lands, and how much is caught.

Model: the vessel's liquid is at rest (`objectmodels.models.object_parts`), so what runs out depends
on the head h, the height of the surface above the lip. Each piece of the rim under the surface is a
weir, which passes ⅔ c √(2g) d^1.5 per metre at its own depth d: all round where the opening lies
level, only forwards where it stands upright (then it is the circular weir); never more than the
full hole, c π r² √(2gh). It leaves with the critical speed √(⅔ g h), level, or along the wall where
that slopes down (tilts beyond 90°), and falls as a thin thread without drag.

Not modelled: sloshing, air that has to get in past the liquid, a stream that clings to the wall.

A volume is caught if the thread passes through the other vessel's round opening and there is still
room. Contents and aim are uncertain (normal); they are drawn at fixed, equally likely nodes, so the
answers are the same every time.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import Vessel

_NODES = np.polynomial.legendre.leggauss(12)
_X: Array = 0.5 * (_NODES[0] + 1.0)
_W: Array = 0.5 * _NODES[1]

_TILTING, _WAITING, _BACK = 80, 40, 30  # steps of time of a pour
_CONTENTS, _AIMS = 7, 15  # nodes of the contents, and of the aim along each axis
_ANGLES = 24  # among which the one for a volume is interpolated
_TINY = 1e-12


def outflow_rate(head: ArrayLike, tilt: ArrayLike, radius: float) -> Array:
    """Flow out of a round opening of a radius [m], shape (...) [m³/s].

    Heads are heights of the surface above the lip [m], no flow below 0; tilts are in [rad].
    """
    wanted = np.maximum(np.asarray(head, float), 0.0), np.sin(np.asarray(tilt, float))
    h, sin = np.broadcast_arrays(*wanted)
    drop = np.maximum(radius * sin, _TINY)
    wet = np.arccos(np.clip(1.0 - h / drop, -1.0, 1.0))
    phi = wet[..., None] * _X
    depth = np.maximum(h[..., None] - drop[..., None] * (1.0 - np.cos(phi)), 0.0)
    forwards = 1.0 + sin[..., None] * (np.cos(phi) - 1.0)
    rim = 2.0 * radius * wet * (_W * forwards * depth**1.5).sum(axis=-1)
    fall = np.sqrt(2.0 * GRAVITY)
    hole = np.pi * radius**2 * np.sqrt(h)
    # Share c of the ideal flow over a weir or through a hole with a sharp edge.
    return np.asarray(0.6 * fall * np.minimum(2.0 / 3.0 * rim, hole))


def exit_velocity(head: ArrayLike, tilt: ArrayLike) -> tuple[Array, Array]:
    """Velocity with which the stream leaves the lip: along the heading, and downwards [m/s]."""
    speed: Array = np.sqrt(2.0 / 3.0 * GRAVITY * np.maximum(np.asarray(head, float), 0.0))
    slope: Array = np.maximum(np.asarray(tilt, float) - np.pi / 2.0, 0.0)
    return speed * np.cos(slope), speed * np.sin(slope)


def fall_time(down: ArrayLike, fall: ArrayLike) -> Array:
    """Time to fall by a height from a speed downwards; 0 if there is nowhere to fall [s]."""
    speed, height = np.asarray(down, float), np.maximum(np.asarray(fall, float), 0.0)
    return np.asarray((np.sqrt(speed * speed + 2.0 * GRAVITY * height) - speed) / GRAVITY)


def landing_distance(head: ArrayLike, tilt: ArrayLike, fall: ArrayLike) -> Array:
    """Distance along the heading from the lip to where the stream lands [m].

    It has a head above the lip [m] at a tilt [rad], and a height of the lip to fall [m].
    """
    ahead, down = exit_velocity(head, tilt)
    return np.asarray(ahead * fall_time(down, fall))


def tilt_for(vessel: Vessel, volume: ArrayLike, out: ArrayLike, heading: ArrayLike) -> Array:
    """Least tilt towards a heading [rad] at which `out` of a volume [m³] runs out in the end [rad].

    The last of it drips through a narrow opening for long; `angle_for` gives it a time.
    """
    left = np.maximum(np.asarray(volume, float) - np.asarray(out, float), 0.0)
    return vessel.tilt_holding(left, heading)


@dataclass(frozen=True)
class Pour:
    """Outflow of a vessel over time, each case a row of samples.

    Attributes:
        time: shape (..., m) [s].
        tilt: [rad].
        poured: volume that has run out until then [m³].
        head: of the surface above the lip; never below 0 [m].
    """

    time: Array
    tilt: Array
    poured: Array
    head: Array

    @property
    def total_volume(self) -> Array:
        """Volume that ran out, shape (...) [m³]."""
        return np.asarray(self.poured[..., -1])

    @property
    def volume_steps(self) -> Array:
        """Volume that ran out before each sample, since the one before, shape (..., m) [m³]."""
        return np.diff(self.poured, axis=-1, prepend=0.0)

    @property
    def start_time(self) -> Array:
        """Time of the first outflow, the end if there is none, shape (...) [s]."""
        return self._time_beyond(0.0)

    @property
    def end_time(self) -> Array:
        """Time when all but a hundredth has run out, shape (...) [s]."""
        return self._time_beyond(0.99)

    def _time_beyond(self, share: float) -> Array:
        beyond = self.poured > share * self.total_volume[..., None]
        first = np.where(beyond.any(axis=-1), beyond.argmax(axis=-1), self.time.shape[-1] - 1)
        return np.take_along_axis(self.time, first[..., None], axis=-1)[..., 0]

    def landing(self, fall: ArrayLike) -> tuple[Array, Array]:
        """Mean and standard deviation, over the volume, of the distance where it lands, (...) [m].

        The lip lies at a height `fall` above that, shape (...) [m].
        """
        ahead = self.landing_distances(fall)
        weight = self.volume_steps / np.maximum(self.total_volume, _TINY)[..., None]
        mean = (weight * ahead).sum(axis=-1)
        spread = (weight * np.square(ahead - mean[..., None])).sum(axis=-1)
        return mean, np.sqrt(spread)

    def landing_distances(self, fall: ArrayLike) -> Array:
        """Distance ahead of the lip at which each part lands, shape (..., m) [m]."""
        # A part has the head and the tilt at the start of its step.
        head, tilt = (
            np.concatenate([x[..., :1], x[..., :-1]], axis=-1) for x in (self.head, self.tilt)
        )
        return landing_distance(head, tilt, np.asarray(fall, float)[..., None])


def simulate_pour(
    vessel: Vessel, volume: ArrayLike, heading: ArrayLike, time: ArrayLike, tilt: ArrayLike
) -> Pour:
    """Outflow during a motion.

    Args:
        vessel: that is tilted.
        volume: in it at the start, shape (...) [m³].
        heading: direction in B in which it leans, shape (...) [rad].
        time: samples of the motion, shape (..., m) [s].
        tilt: at these times, shape (..., m) [rad].
    """
    time, tilt = np.broadcast_arrays(np.asarray(time, float), np.asarray(tilt, float))
    volume, heading, _ = np.broadcast_arrays(
        np.asarray(volume, float), np.asarray(heading, float), time[..., 0]
    )
    time, tilt = (np.broadcast_to(x, (*volume.shape, x.shape[-1])) for x in (time, tilt))
    brim, strips = vessel.brim(tilt, heading[..., None]), vessel.strips(heading)
    left, heads, change = [volume], [np.zeros_like(volume)], np.zeros_like(volume)
    for i in range(time.shape[-1]):
        now = left[-1]
        if (now > brim[..., i]).any():
            # It goes on changing much as it did from the last sample to this one.
            near = heads[-1] + change
            head = vessel.liquid_head(now, tilt[..., i], heading, strips, near=near)
            heads.append(np.maximum(head, 0.0))
        else:
            heads.append(np.zeros_like(now))
        change = heads[-1] - heads[-2]
        if i + 1 < time.shape[-1]:
            flow = outflow_rate(heads[-1], tilt[..., i], vessel.opening.radius)
            most = np.maximum(now - brim[..., i], 0.0)
            left.append(now - np.minimum(flow * (time[..., i + 1] - time[..., i]), most))
    poured = volume[..., None] - np.stack(left, axis=-1)
    return Pour(time, tilt, poured, np.stack(heads[1:], axis=-1))


def pour(
    vessel: Vessel,
    volume: ArrayLike,
    *,
    heading: ArrayLike,
    angle: ArrayLike,
    rate: ArrayLike,
    wait: ArrayLike,
) -> Pour:
    """Outflow of a vessel that is tilted at a steady rate, kept so, and tilted back.

    Args:
        vessel: that is tilted.
        volume: in it, shape (...) [m³].
        heading: direction in B in which it leans [rad].
        angle: largest tilt [rad].
        rate: of tilting, there and back [rad/s].
        wait: how long it is kept at that [s].
    """
    volume, heading, angle, rate, wait = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (volume, heading, angle, rate, wait))
    )
    start = np.minimum(vessel.spill_angle(volume, heading), angle)
    way = (angle - start)[..., None]
    there = start[..., None] + way * np.linspace(0.0, 1.0, _TILTING + 1)
    back = angle[..., None] - way * np.linspace(0.0, 1.0, _BACK + 1)[1:]
    waiting = wait[..., None] * np.linspace(0.0, 1.0, _WAITING + 1)[1:] ** 2  # slower and slower
    turned = (angle / rate)[..., None] + wait[..., None]
    time = [there / rate[..., None], (angle / rate)[..., None] + waiting]
    time.append(turned + (angle[..., None] - back) / rate[..., None])
    tilt = [there, np.broadcast_to(angle[..., None], waiting.shape), back]
    path = np.concatenate(time, axis=-1), np.concatenate(tilt, axis=-1)
    return simulate_pour(vessel, volume, heading, *path)


def angle_for(
    vessel: Vessel, volume: float, out: float, *, heading: float, rate: float, wait: float
) -> float:
    """Tilt to which a pour must go so that a wanted volume runs out within its time [rad].

    Args:
        vessel: that is tilted.
        volume: in it [m³].
        out: what is to run out; if that is more than can be, the largest tilt is the answer [m³].
        heading: as in `pour`.
        rate: see there.
        wait: see there.
    """
    least = float(tilt_for(vessel, volume, out, heading))
    # Tilt at which a pour ends at the latest [rad].
    angles = np.linspace(least, max(np.radians(130.0), least), _ANGLES)
    total = pour(vessel, volume, heading=heading, angle=angles, rate=rate, wait=wait).total_volume
    return float(np.interp(out, np.maximum.accumulate(total), angles))


@dataclass(frozen=True)
class Catch:
    """The opening that the stream is to fall through, as it lies from the lip.

    Attributes:
        along, across: horizontally from the lip to its middle, along the heading and to the left
            of that [m].
        fall: height of the lip above it [m].
        radius: of the opening [m].
        free: volume that still fits in below it [m³].
        sd: standard deviation of where the stream lands, along each axis [m].
    """

    along: float
    across: float
    fall: float
    radius: float
    free: float
    sd: float = 0.0


@dataclass(frozen=True)
class Poured:
    """Result of a pour, over equally likely cases of contents and aim, shape (..., k).

    Attributes:
        contents: that there were [m³].
        poured: volume that runs out [m³].
        received: what of it the other vessel keeps [m³].
    """

    contents: Array
    poured: Array
    received: Array

    @property
    def spilled(self) -> Array:
        """Volume that runs out and is not kept [m³]."""
        return self.poured - self.received

    @property
    def left(self) -> Array:
        """Volume that stays in the vessel [m³]."""
        return self.contents - self.poured

    def mean_volumes(self) -> dict[str, Array]:
        """Means of poured, received, spilled and left, shape (...) each [m³]."""
        names = ("poured", "received", "spilled", "left")
        return {name: getattr(self, name).mean(axis=-1) for name in names}

    def probability(self, *, received: ArrayLike = 0.0, spilled: ArrayLike = np.inf) -> Array:
        """Probability of receiving at least, and spilling at most, given volumes, shape (...)."""
        enough = self.received >= np.asarray(received, float)[..., None]
        return np.asarray((enough & (self.spilled <= np.asarray(spilled)[..., None])).mean(axis=-1))


def caught_volume(running: Pour, contents: ArrayLike, catch: Catch) -> Poured:
    """Volumes that the opening below catches of a pour, over the cases of an uncertain aim.

    There were `contents` in the vessel, shape (...) like the pour's cases [m³].
    """
    error = catch.sd * _normal_nodes(_AIMS) if catch.sd > 0.0 else np.zeros(1)
    along, across = (x.ravel() for x in np.meshgrid(error, error))
    ahead = running.landing_distances(catch.fall)[..., None] - catch.along + along
    inside = ahead**2 + (across - catch.across) ** 2 < catch.radius**2
    into = (running.volume_steps[..., None] * inside).sum(axis=-2) * (catch.fall > 0.0)
    received = np.minimum(into, catch.free)
    contents, poured = (
        np.broadcast_to(np.asarray(x, float)[..., None], received.shape)
        for x in (contents, running.total_volume)
    )
    return Poured(contents, poured, received)


@dataclass(frozen=True)
class UncertainPour:
    """Pour out of a vessel whose contents are uncertain.

    Attributes:
        contents: equally likely volumes in it, the believed one in their middle, shape (k,) [m³].
        running: the pour for each of them, shape (..., k).
    """

    contents: Array
    running: Pour

    @classmethod
    def from_belief(
        cls,
        vessel: Vessel,
        contents: float,
        contents_sd: float,
        *,
        heading: ArrayLike,
        angle: ArrayLike,
        rate: ArrayLike,
        wait: ArrayLike,
    ) -> UncertainPour:
        """The pour of a motion as of `pour`, one case for each, shape (...).

        Args:
            vessel: that is tilted.
            contents: believed to be in it [m³].
            contents_sd: standard deviation of the contents [m³].
            heading: as in `pour`.
            angle: see there.
            rate: see there.
            wait: see there.
        """
        nodes = _normal_nodes(_CONTENTS) if contents_sd > 0.0 else np.zeros(1)
        volume = np.clip(contents + contents_sd * nodes, 0.0, vessel.capacity)
        motion = {"heading": heading, "angle": angle, "rate": rate, "wait": wait}
        cases = {name: np.asarray(value, float)[..., None] for name, value in motion.items()}
        return cls(volume, pour(vessel, volume, **cases))

    @property
    def nominal_pour(self) -> Pour:
        """The pour of the believed contents, shape (...)."""
        middle = len(self.contents) // 2
        return Pour(*(each[..., middle, :] for each in vars(self.running).values()))

    def caught_by(self, catch: Catch) -> Poured:
        """Result over all cases of contents and aim, with an opening below."""
        contents = np.broadcast_to(self.contents, self.running.total_volume.shape)
        result = caught_volume(self.running, contents, catch)
        return Poured(*(each.reshape(*each.shape[:-2], -1) for each in vars(result).values()))


def _normal_nodes(count: int) -> Array:
    """Equally likely values of a standard normal number."""
    normal = NormalDist()
    return np.array([normal.inv_cdf((i + 0.5) / count) for i in range(count)])
