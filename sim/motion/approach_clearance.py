"""Which hands touch the object that they are to push with nothing but their fingertips.

Model: the hand stands before the face, then at it. Seen from the object that is the same wherever
the object stands, so it is found once for each contact, told apart to a nanometre, and kept.

Frames: B is the object, D the frame of the push, T as in `sim.hands.hand_model`.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.collision.collision_scene import Obstacle
from sim.collision.collision_spheres import sphere_parts
from sim.hands.hand_model import Hand, PostureSet
from sim.rotations import Array, rot_z, yaw_of

FACE_CLEARANCE = 0.0005
"""Least distance of all but the fingertips from the pushed face [m]."""

_DIGITS = 9  # of places [m] and headings [rad]
_CONTACTS = 2048  # that are kept, some 10 kB each at most
_ROUNDING = 1e-9  # so that none is left out that touches [m]
_UNKNOWN, _HIT, _CLEAR = -1, 0, 1


@dataclass(frozen=True)
class Approach:
    """The approach to a contact, seen from the pushed object.

    Attributes:
        hand: that pushes.
        fingers: how many fingertips do.
        spread: distance between two of them [m].
        fine: whether the palm may lean by small angles and large ones.
        pressing: whether it comes from above to press.
        outline: the object's corners in B, one after the other [m].
        height, radius: of the object; see `Obstacle` [m].
        points: of T in B before the face and at it, one after the other [m].
        heading: of D in B [rad].
    """

    hand: Hand
    fingers: int
    spread: float
    fine: bool
    pressing: bool
    outline: tuple[float, ...]
    height: float
    radius: float
    points: tuple[float, ...]
    heading: float

    @classmethod
    def to_object(
        cls, pushed: Obstacle, points: Array, R_WD: Array, hand: Hand, fingers: int, spread: float,
        *, fine: bool, pressing: bool = False,
    ) -> Approach:  # fmt: skip
        """The approach along two points of T in W, shape (2, 3) [m], with D at R_WD."""
        return cls(
            hand=hand,
            fingers=fingers,
            spread=spread,
            fine=fine,
            pressing=pressing,
            outline=tuple(pushed.outline.ravel().tolist()),
            height=pushed.height,
            radius=pushed.radius,
            points=_rounded((points - pushed.p_WB) @ pushed.R_WB),
            heading=_rounded(yaw_of(pushed.R_WB.T @ R_WD))[0],
        )

    def clear_hands(self, hands: PostureSet) -> NDArray[np.bool_]:
        """Which of some hands do not hit the object, shape (n,)."""
        known = _known_hands(self)
        new = known[hands.number] == _UNKNOWN
        if new.any():
            some = hands[new]
            known[some.number] = _CLEAR
            # What stays behind the face's plane cannot hit what is beyond it.
            if not self.pressing:
                some = some[some.fronts >= self._room_ahead]
            known[some.number] = _HIT
            for part in sphere_parts(some.spheres.shape[1] - self.fingers):
                some = some[self._are_clear(some, part)]
            known[some.number] = _CLEAR
        return np.asarray(known[hands.number] == _CLEAR)

    def _are_clear(self, hands: PostureSet, part: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Which of some hands do not hit the object with a part of their spheres, shape (n,)."""
        robot = hands.spheres_along(np.eye(3)[None], np.zeros((1, 3)), part)[:, 0]
        points, R_BD = np.reshape(self.points, (2, 3)), rot_z([self.heading, self.heading])
        return self._object.is_clear_along(robot, R_BD, points, FACE_CLEARANCE)

    @property
    def _room_ahead(self) -> float:
        """Distance ahead of T up to which nothing comes too near to the object [m]."""
        inward = np.array([np.cos(self.heading), np.sin(self.heading)])
        face = -self.radius if self.radius else float((self._object.outline @ inward).min())
        ahead = np.reshape(self.points, (2, 3))[:, :2] @ inward
        return face - float(ahead.max()) - FACE_CLEARANCE - _ROUNDING

    @functools.cached_property
    def _object(self) -> Obstacle:
        outline = np.reshape(self.outline, (-1, 2))
        return Obstacle.at_origin(outline, self.height, self.radius)


def _rounded(array: Array) -> tuple[float, ...]:
    return tuple(np.round(array, _DIGITS).ravel().tolist())


@functools.lru_cache(maxsize=_CONTACTS)
def _known_hands(approach: Approach) -> NDArray[np.int8]:
    """What is known of each of all hands by now."""
    hand = approach.hand
    if approach.pressing:
        return np.full(len(hand.pressing_postures()), _UNKNOWN, dtype=np.int8)
    every = hand.pushing_postures(approach.fingers, approach.spread, fine=approach.fine)
    return np.full(len(every), _UNKNOWN, dtype=np.int8)
