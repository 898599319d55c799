"""Stability of a grasp between thumb and fingers: the squeeze it needs, and its probability.

Model: point contacts with Coulomb friction on two parallel sides. The part of the weight along the
closing direction, and the moment that it has there, is borne by equally stiff fingers beside the
squeeze, so that the normal loads are known; all of them must press. The rest of the weight lies in
the plane of the sides. The friction of both sides adds up in it as if they were one, and so the
grasp slips as a body on loaded points does: the exact limit of
`objectmodels.mechanics.friction_limit`.

What is not taken in: that the sides lie apart, so that a weight off the middle between them, or off
the contacts along the approach while it presses along the closing direction, twists the friction
of one side against the other's. It is little as long as the width is larger than these offsets.

Frame: G, the middle of the grasp; x along the closing direction (from the fingers' side to the
thumb's), z along the approach, y = z × x. The first contact is the thumb's. Arrays: n loads.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.outcome_probability import (
    NODES,
    SMALLEST_SHARE,
    normal_cdf,
    normal_nodes,
)
from objectmodels.mechanics.push_thresholds import GRAVITY

if TYPE_CHECKING:
    from objectmodels.geometry.pushed_body import PushedBody

STRONGEST = 1e4
"""Squeeze beyond which none is looked for [N]."""

_STEPS = 40  # of a bisection over the squeeze
_LEAST_LOAD = 1e-9  # tangential force, per weight, below which nothing can slip
_LEAST_PRESS = 1e-6  # share of the squeeze with which each contact must press


@dataclass(frozen=True)
class Contacts:
    """Contacts of thumb and fingers; see `planner.types.robot.Grip`.

    Attributes:
        places: along the approach, and along approach × closing, shape (k, 2) [m].
        shares: of the squeeze that each bears, shape (k,); the thumb's, which is 1, comes first.
    """

    places: Array
    shares: Array

    @classmethod
    def from_arrays(cls, places: ArrayLike, shares: ArrayLike) -> Contacts:
        """Checked contacts.

        Raises:
            ModelError: `bad_array` if they do not fit each other.
        """
        p, s = np.asarray(places, dtype=np.float64), np.asarray(shares, dtype=np.float64)
        if p.ndim != 2 or p.shape[1] != 2 or s.shape != p.shape[:1] or len(s) < 3:
            raise ModelError(
                "bad_array",
                f"expected places (k, 2) and shares (k,), found {p.shape} and {s.shape}",
                suggestions=("a thumb and at least two fingers",),
            )
        return cls(p, s)

    @property
    def spread_load(self) -> Array:
        """Normal loads by a unit force along x, and by unit moments about y and z, (k, 3)."""
        side = np.where(np.arange(len(self.shares)) == 0, 1.0, -1.0)
        z, y = self.places.T
        # A contact presses along −side: what the load adds, their pressing more must balance.
        balance = np.stack([side, side * z, -side * y])
        return np.asarray(np.linalg.pinv(balance, rcond=1e-9))


def normal_loads(contacts: Contacts, squeeze: ArrayLike, force: Array, place: Array) -> Array:
    """Normal loads of the contacts, shape (k, n) [N]; negative where one would open.

    Squeezes are (n,) or one number [N]; forces (n, 3) [N] act on what is held at places (n, 3) [m],
    in G.
    """
    F_x = force[:, 0]
    _, y, z = place.T
    # Friction bears the tangential load; shared between the sides it has no moment but about x.
    wrench = np.stack([F_x, z * F_x, -y * F_x])
    shared = np.outer(contacts.shares, np.broadcast_to(squeeze, len(force)))
    return np.asarray(shared + contacts.spread_load @ wrench)


def critical_friction(contacts: Contacts, squeeze: ArrayLike, force: Array, place: Array) -> Array:
    """Coefficient of friction below which it slips, shape (n,); infinite if a contact opens.

    Squeeze, force and place are those of `normal_loads`.
    """
    loads = normal_loads(contacts, squeeze, force, place)
    tangential = np.hypot(force[:, 1], force[:, 2])
    needed = np.zeros(len(force))
    opens = (loads < _LEAST_PRESS * np.max(loads, axis=0)).any(axis=0)
    needed[opens] = np.inf
    (i,) = np.nonzero(~opens & (tangential > _LEAST_LOAD * np.linalg.norm(force, axis=1)))
    if i.size:
        total = loads[:, i].sum(axis=0)
        u = force[i, 1:] / tangential[i, None]  # along y and z
        z, y = contacts.places.T
        d_y, d_z = y[:, None] - place[i, 1], z[:, None] - place[i, 2]
        along, left = d_y * u[:, 0] + d_z * u[:, 1], d_z * u[:, 0] - d_y * u[:, 1]
        ratio = friction_limit(loads[:, i] / total, along, left).ratio
        needed[i] = tangential[i] / (total * ratio)
    return needed


def slip_multiplier(
    contacts: Contacts, squeeze: ArrayLike, friction: ArrayLike, force: Array, place: Array
) -> Array:
    """Friction of a grasp over the friction that it needs, shape (n,); below 1 it slips."""
    with np.errstate(divide="ignore"):
        needed = critical_friction(contacts, squeeze, force, place)
        return np.asarray(np.broadcast_to(friction, needed.shape) / needed)


def squeeze_needed(contacts: Contacts, friction: ArrayLike, force: Array, place: Array) -> Array:
    """Least squeeze that holds each load, shape (n,) [N]; infinite beyond `STRONGEST`.

    The friction of the fingertips is (n,) or one number, force and place are those of
    `normal_loads`. More squeeze never holds less, so that a bisection finds it.
    """
    n = len(force)
    low, high = np.full(n, 1e-3), np.full(n, STRONGEST)
    holds = slip_multiplier(contacts, high, friction, force, place) >= 1.0
    for _ in range(_STEPS):
        middle = np.sqrt(low * high)
        enough = slip_multiplier(contacts, middle, friction, force, place) >= 1.0
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return np.where(holds, high, np.inf)


@dataclass(frozen=True)
class Hold:
    """Belief about a grasp over a motion.

    Attributes:
        needed: least squeeze with everything as believed [N].
        worst: the same in the worst case considered [N].
        probability: that the squeeze asked about holds over the whole motion.
    """

    needed: float
    worst: float
    probability: float


@dataclass(frozen=True)
class Lifted:
    """An object in a hand, through a motion.

    Attributes:
        model: what is believed of it.
        contacts: of the grasp.
        p_BG: middle of the grasp in B, shape (3,) [m].
        R_BG: orientation of G in B, shape (3, 3).
        down_B: directions of the weight in B through the motion, shape (m, 3).
        acceleration: largest one of the hand, in any direction [m/s²].
    """

    model: PushedBody
    contacts: Contacts
    p_BG: Array
    R_BG: Array
    down_B: Array
    acceleration: float = 0.0

    def hold_by(self, squeeze: float, *, sigmas: float = 2.0) -> Hold:
        """Squeeze needed over the motion, and the probability that a given squeeze [N] holds.

        In the worst case mass, friction and centre of mass are `sigmas` standard deviations off.
        """
        model = self.model
        mass, com = np.array([model.mass]), np.array([model.com])
        nominal = self._needed_squeeze(mass, com, np.array([model.finger_friction]))
        signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
        heavy = np.full(len(signs), model.mass + sigmas * model.mass_sd)
        slippery = max(model.finger_friction - sigmas * model.finger_friction_sd, 1e-3)
        off = np.array(model.com) + sigmas * signs * np.array(model.com_sd)
        worst = self._needed_squeeze(heavy, off, np.full(len(signs), slippery))
        return Hold(float(nominal[0]), float(worst.max()), self.hold_probability(squeeze))

    def hold_probability(self, squeeze: float) -> float:
        """Probability that a squeeze holds over the whole motion.

        Mass and centre of mass are averaged over a fixed sequence; given these, it holds if the
        friction is above a critical one, which integrates in closed form.
        """
        model = self.model
        z = normal_nodes(NODES)
        mass = np.maximum(model.mass + model.mass_sd * z[:, 0], SMALLEST_SHARE * model.mass)
        com = np.array(model.com) + np.array(model.com_sd) * z[:, 1:]
        force, place = self._weights_in_grasp(mass, com)
        critical = critical_friction(self.contacts, squeeze, force, place)
        critical = critical.reshape(NODES, -1).max(axis=1)
        mean, sd = model.finger_friction, model.finger_friction_sd
        if sd <= 0.0:
            return float(np.mean(critical <= mean))
        return float(np.mean(normal_cdf((mean - critical) / sd)))

    def _needed_squeeze(self, mass: Array, com: Array, friction: Array) -> Array:
        """Squeeze needed over the whole motion by each of n cases, shape (n,) [N]."""
        force, place = self._weights_in_grasp(mass, com)
        each = np.repeat(friction, len(self.down_B))
        needed = squeeze_needed(self.contacts, each, force, place)
        return np.asarray(needed.reshape(len(mass), -1).max(axis=1))

    def _weights_in_grasp(self, mass: Array, com: Array) -> tuple[Array, Array]:
        """Weights and where they act in G, for n cases and m directions, shapes (n m, 3)."""
        m = len(self.down_B)
        down = self.down_B @ self.R_BG
        place = (com - self.p_BG) @ self.R_BG
        pull = mass * (GRAVITY + self.acceleration)
        force = (pull[:, None, None] * down).reshape(-1, 3)
        return force, np.repeat(place, m, axis=0)
