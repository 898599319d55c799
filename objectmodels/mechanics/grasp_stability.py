"""Stability of a grasp between thumb and fingers: the squeeze it needs, and its probability.

Model: point contacts with Coulomb friction on two parallel sides. The part of the weight along the
closing direction, and the moment that it has there, is borne by equally stiff fingers beside the
squeeze, so that the normal loads are known; all of them must press. The rest of the weight lies in
the plane of the sides. The friction of both sides adds up in it as if they were one, and so the
grasp slips as a body on loaded points does: the exact limit of
`objectmodels.mechanics.friction_limit`. Where fingertips touch a round side beside its middle, a
part of the friction keeps them from sliding off (`objectmodels.geometry.side_faces`).

What is not taken in: that the sides lie apart, so that a weight off the middle between them, or off
the contacts along the approach while it presses along the closing direction, twists the friction
of one side against the other's. It is little as long as the width is larger than these offsets.

Frame: G, the middle of the grasp; x along the closing direction (from the fingers' side to the
thumb's), z along the approach, y = z × x. The first contact is the thumb's. Arrays: n loads.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.side_faces import FLAT, SidePress
from objectmodels.mechanics.friction_limit import friction_limit
from objectmodels.mechanics.outcome_probability import (
    NODES,
    SMALLEST_SHARE,
    normal_cdf,
    normal_nodes,
)
from objectmodels.mechanics.push_thresholds import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from objectmodels.geometry.pushed_body import PushedBody

STRONGEST = 1e4
"""Squeeze beyond which none is looked for [N]."""

_STEPS = 40  # of a bisection over the squeeze
_LEAST_LOAD = 1e-9  # tangential force, per weight, below which nothing can slip


@dataclass(frozen=True)
class Contacts:
    """Contacts of thumb and fingers; see `planner.types.robot.Grip`.

    Attributes:
        places: along the approach, and along approach × closing, shape (k, 2) [m].
        shares: of the squeeze that each bears, shape (k,); the thumb's, which is 1, comes first.
        press: of the outer ones.
    """

    places: Array
    shares: Array
    press: SidePress = FLAT

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


@dataclass(frozen=True)
class GraspLoads:
    """Loads on grasps of k contacts each, n of them, each at a grasp of its own.

    Attributes:
        shares: of the squeeze that each contact bears, shape (k, n).
        across: normal loads that the loads themselves bring, shape (k, n) [N].
        along, left: places of the contacts along the tangential load, and their distances to the
            left of its line of action, shape (k, n) [m].
        tangential: load in the plane of the sides, shape (n,) [N].
        size: the whole load, shape (n,) [N].
        press: force of the outer contacts along their normal, around the side and along its axis,
            per normal load, shape (3, n).
    """

    shares: Array
    across: Array
    along: Array
    left: Array
    tangential: Array
    size: Array
    press: Array

    @classmethod
    def on_contacts(cls, contacts: Contacts, force: Array, place: Array) -> GraspLoads:
        """Loads on one grasp.

        Args:
            contacts: of the grasp.
            force: on what is held, in G, shape (n, 3) [N].
            place: where it acts, in G, shape (n, 3) [m].
        """
        F_x, press = force[:, 0], contacts.press
        _, y, z = place.T
        # Friction bears the tangential load; shared between the sides it has no moment but about x.
        wrench = np.stack([F_x, z * F_x, -y * F_x])
        tangential = np.hypot(force[:, 1], force[:, 2])
        with np.errstate(divide="ignore", invalid="ignore"):
            u = force[:, 1:] / tangential[:, None]  # along y and z
        z_k, y_k = contacts.places.T
        d_y, d_z = y_k[:, None] - y, z_k[:, None] - z
        return cls(
            np.repeat(contacts.shares[:, None], len(force), axis=1),
            np.asarray(contacts.spread_load @ wrench),
            d_y * u[:, 0] + d_z * u[:, 1],
            d_z * u[:, 0] - d_y * u[:, 1],
            tangential,
            np.linalg.norm(force, axis=1),
            np.tile([[press.normal], [press.around], [press.axial]], len(force)),
        )

    @classmethod
    def join(cls, parts: Sequence[GraspLoads]) -> GraspLoads:
        """All loads of several, in their order; all of k contacts."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(np.concatenate(each, axis=-1) for each in columns))

    def normal_loads(self, squeeze: Array | float) -> Array:
        """Normal loads of the contacts, shape (k, n) [N]; negative where one would open.

        Args:
            squeeze: shape (n,) or one number [N].
        """
        return np.asarray(self.shares * squeeze + self.across)

    def critical_friction(self, squeeze: Array | float) -> Array:
        """Coefficient of friction below which it slips, shape (n,); infinite if a contact opens.

        Args:
            squeeze: shape (n,) or one number [N].
        """
        loads = self.normal_loads(squeeze)
        needed = np.zeros(len(self.size))
        opens = self._opens(loads)
        needed[opens] = np.inf
        (i,) = np.nonzero(~opens & (self.tangential > _LEAST_LOAD * self.size))
        if i.size:
            total = loads[:, i].sum(axis=0)
            ratio = friction_limit(loads[:, i] / total, self.along[:, i], self.left[:, i]).ratio
            needed[i] = self.tangential[i] / (total * ratio)
        # At one of the outer contacts the load adds to what it presses along the axis.
        normal, around, axial = self.press
        return np.asarray(np.hypot(around, axial + needed) / normal)

    def _opens(self, loads: Array) -> NDArray[np.bool_]:
        """Return True where a contact of normal loads (k, n) opens, shape (n,)."""
        # Share of the squeeze with which each contact must press.
        return np.asarray((loads < 1e-6 * np.max(loads, axis=0)).any(axis=0))

    def are_held(self, squeeze: Array, friction: Array) -> NDArray[np.bool_]:
        """Return True where squeezes (n,) [N] with friction coefficients (n,) hold, shape (n,).

        As `slip_multiplier` ≥ 1, without its value.
        """
        loads = self.normal_loads(squeeze)
        normal, around, axial = self.press
        # The part of the friction that what they press around and along the side leaves.
        left = np.sqrt(np.maximum((friction * normal) ** 2 - around**2, 0.0)) - axial
        held = ~self._opens(loads) & (friction * normal >= around) & (left >= 0.0)
        (i,) = np.nonzero(held & (self.tangential > _LEAST_LOAD * self.size))
        if i.size:
            total = loads[:, i].sum(axis=0)
            with np.errstate(divide="ignore"):
                needed = self.tangential[i] / (total * left[i])
            limit = friction_limit(loads[:, i] / total, self.along[:, i], self.left[:, i], needed)
            held[i] = limit.ratio >= needed
        return np.asarray(held)

    def slip_multiplier(self, squeeze: Array | float, friction: Array | float) -> Array:
        """Friction of a grasp over the friction that it needs, shape (n,); below 1 it slips."""
        with np.errstate(divide="ignore"):
            needed = self.critical_friction(squeeze)
            return np.asarray(np.broadcast_to(friction, needed.shape) / needed)

    def squeeze_needed(
        self, friction: Array | float, group: NDArray[np.intp] | None = None
    ) -> Array:
        """Least squeezes that hold all loads of each group, shape (groups,) [N].

        Infinite beyond `STRONGEST`. More squeeze never holds less, so that a bisection finds it; a
        load that surely needs less than another one of its group is not looked at any further.

        Args:
            friction: of the fingertips, shape (n,) or one number.
            group: number of the group of each load, shape (n,); each by itself if not given.
        """
        n = len(self.size)
        group = np.arange(n) if group is None else group
        mu = np.broadcast_to(friction, n)
        low, high = np.full(n, 1e-3), np.full(n, STRONGEST)
        holds = self.are_held(high, mu)
        least, found = np.zeros(group.max() + 1), np.zeros(group.max() + 1)
        least[group[~holds]] = np.inf
        for _ in range(_STEPS):
            (i,) = np.nonzero(high > least[group])
            if not i.size:
                break
            middle = np.sqrt(low[i] * high[i])
            enough = self._chosen(i).are_held(middle, mu[i])
            low[i], high[i] = np.where(enough, low[i], middle), np.where(enough, middle, high[i])
            np.maximum.at(least, group[i], low[i])
        np.maximum.at(found, group, np.where(holds, high, np.inf))
        return found

    def _chosen(self, i: NDArray[np.intp]) -> GraspLoads:
        """Some of the loads."""
        return GraspLoads(*(each[..., i] for each in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Lifted:
    """An object in a hand, through a motion; what is found of the same is kept.

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

    @functools.cached_property
    def _content(self) -> tuple[object, ...]:
        arrays = self.contacts.places, self.contacts.shares, self.p_BG, self.R_BG, self.down_B
        parts = (each.tobytes() for each in arrays)
        return self.model, self.contacts.press, self.acceleration, *parts

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Lifted) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    def hold_probability(self, squeeze: float) -> float:
        """Probability that a squeeze holds over the whole motion.

        Mass and centre of mass are averaged over a fixed sequence; given these, it holds if the
        friction is above a critical one, which integrates in closed form.
        """
        return _hold_probability(self, squeeze)

    def friction_needed(self) -> float:
        """Coefficient at the fingers below which no squeeze holds it, as it is believed to be."""
        loads = self.loads(np.array([self.model.mass]), np.array([self.model.com]))
        return float(loads.critical_friction(STRONGEST).max())

    def loads(self, mass: Array, com: Array) -> GraspLoads:
        """Weights of n cases through the m directions, a load each, n m in all.

        Args:
            mass: shape (n,) [kg].
            com: centres of mass in B, shape (n, 3) [m].
        """
        m = len(self.down_B)
        down = self.down_B @ self.R_BG
        place = (com - self.p_BG) @ self.R_BG
        pull = mass * (GRAVITY + self.acceleration)
        force = (pull[:, None, None] * down).reshape(-1, 3)
        return GraspLoads.on_contacts(self.contacts, force, np.repeat(place, m, axis=0))


@functools.lru_cache(maxsize=1024)
def _hold_probability(lifted: Lifted, squeeze: float) -> float:
    model = lifted.model
    z = normal_nodes(NODES)
    mass = np.maximum(model.mass + model.mass_sd * z[:, 0], SMALLEST_SHARE * model.mass)
    com = np.array(model.com) + np.array(model.com_sd) * z[:, 1:]
    critical = lifted.loads(mass, com).critical_friction(squeeze).reshape(NODES, -1).max(axis=1)
    mean, sd = model.finger_friction, model.finger_friction_sd
    if sd <= 0.0:
        return float(np.mean(critical <= mean))
    return float(np.mean(normal_cdf((mean - critical) / sd)))


@functools.lru_cache(maxsize=64)  # the same are asked for in one plan after the other
def least_squeezes(grasps: tuple[Lifted, ...]) -> tuple[Array, Array]:
    """Least squeezes that hold through each motion, as believed and at worst, each (n,) [N].

    All grasps are searched together, which takes hardly longer than one. The worst case is two
    standard deviations off in mass, friction and centre of mass.

    Args:
        grasps: n objects in a hand.
    """
    found = np.zeros(2 * len(grasps))
    for k in {len(each.contacts.shares) for each in grasps}:
        parts, friction, group = [], [], []
        for i, each in enumerate(grasps):
            if len(each.contacts.shares) != k:
                continue
            for row, (loads, mu) in enumerate(_believed_and_worst(each)):
                parts.append(loads)
                friction.append(np.full(len(loads.size), mu))
                group.append(np.full(len(loads.size), row * len(grasps) + i))
        squeezes = GraspLoads.join(parts).squeeze_needed(
            np.concatenate(friction), np.concatenate(group)
        )
        found[: len(squeezes)] = np.maximum(found[: len(squeezes)], squeezes)
    found.setflags(write=False)
    believed, worst = found.reshape(2, -1)
    return believed, worst


def _believed_and_worst(lifted: Lifted) -> list[tuple[GraspLoads, float]]:
    """Loads with everything as believed, and at their worst, each with the fingers' friction."""
    model, sigmas = lifted.model, 2.0
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    heavy = np.full(len(signs), model.mass + sigmas * model.mass_sd)
    off = np.array(model.com) + sigmas * signs * np.array(model.com_sd)
    slippery = max(model.finger_friction - sigmas * model.finger_friction_sd, 1e-3)
    nominal = lifted.loads(np.array([model.mass]), np.array([model.com]))
    return [(nominal, model.finger_friction), (lifted.loads(heavy, off), slippery)]
