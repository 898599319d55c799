"""In which hands a fingertip flips a lid: postures, orientations of the palm, and how it turns.

Model: one finger is bent, the others are curled up. The palm leans back from the way in which the
lid is pushed at first, is turned a little aside, and turns with the lid by some angle while that is
flipped. Kept are hands whose spheres stay clear of the table, the object and its lid all along the
way, and whose finger feels and bears the push. None of that depends on where the object stands.

Frames: E and L as in `sim.paths.lid_arc_path`, P the palm.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np
from numpy.typing import NDArray

from sim.collision.collision_scene import TABLE_CLEARANCE
from sim.collision.collision_spheres import distance_to_cylinder, place_spheres
from sim.hands.four_finger.hand_kinematics import TIP_RADIUS, force_noise_gain, max_tip_force
from sim.hands.four_finger.hand_posture import bent_posture, hand_spheres, whole_spheres
from sim.hands.hand_model import FlipPostureSet, Posture
from sim.paths.lid_arc_path import LidPath, LidShape
from sim.rotations import Array, rot_y, rot_z

_CLEARANCE = 0.003  # of all but the fingertip from the object and its lid [m]
_FLEXIONS = ((-0.2, 0.9), (0.2, 0.6), (-0.57, 1.1), (0.0, 0.5), (-0.4, 0.7), (0.2, 0.25))
_LEANS = {
    True: np.radians(np.arange(0.0, 91.0, 15.0)),
    False: np.radians(np.arange(-15.0, 91.0, 15.0)),
}
_SIDES = np.radians([0.0, -25.0, 25.0, -50.0, 50.0])
_TURNS = np.radians([0.0, 35.0, 70.0])

# Fingers straight down, palm towards where they push.
_UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])

_COARSEST_FEELING = 40.0  # 1 / lever with which the sensors feel the push [1/m]
_BEARS = 3.0  # force that the finger bears, more than any lid needs [N]


@functools.lru_cache(maxsize=16)
def flip_postures(lid: LidShape, wrist: float) -> FlipPostureSet:
    """All postures that flip a lid; `wrist` as of `FourFingerHand`."""
    way = LidPath.from_lid(lid)
    R_EP = _palm_orientations(lid, way)
    postures, spheres, orientations, tips, coarse = [], [], [], [], []
    for finger, flexion in itertools.product(("index", "middle", "ring"), _FLEXIONS):
        name = f"{finger} bent by {flexion[0]:.2f} and {flexion[1]:.2f}"
        posture = bent_posture(name, {finger: (0.0, *flexion)})
        good, felt = _felt_pushes(posture, lid, way, R_EP)
        good[good] = _is_clear(hand_spheres(posture, wrist), posture.tips[0], lid, way, R_EP[good])
        postures += [posture] * int(good.sum())
        spheres += [whole_spheres(posture, wrist)] * int(good.sum())
        orientations.append(R_EP[good])
        tips.append(np.tile(posture.tips[0], (int(good.sum()), 1)))
        coarse.append(felt[good])
    order = np.argsort(np.concatenate(coarse), kind="stable")
    every = FlipPostureSet(
        way, tuple(postures), tuple(spheres), np.concatenate(orientations), np.concatenate(tips)
    )
    return every[order]


def _palm_orientations(lid: LidShape, way: LidPath) -> Array:
    """Orientations of the palm along the way, shape (n, w, 3, 3)."""
    lean, side, turn = (
        a.ravel() for a in np.meshgrid(_LEANS[lid.is_opening], _SIDES, _TURNS, indexing="ij")
    )
    # The tab is drawn towards the hinge in the end; a lid is pushed shut away from it.
    facing = rot_z(np.pi if lid.is_opening else 0.0)
    first = facing @ rot_z(side) @ rot_y(-lean) @ _UPRIGHT
    with_lid = (-1.0 if lid.is_opening else 1.0) * turn[:, None] * way.shares
    return np.asarray(rot_y(with_lid) @ first[:, None])


def _felt_pushes(
    posture: Posture, lid: LidShape, way: LidPath, R_EP: Array
) -> tuple[NDArray[np.bool_], Array]:
    """Which orientations feel and bear the push all along the arc, and how coarsely; (n,) each."""
    (finger,) = posture.pushing
    into = lid.lid_normals(way.angles[way.touching])
    into_P = np.einsum("nwji,wj->nwi", R_EP[:, way.touching], into)
    p_PC = posture.tips[0] + TIP_RADIUS * into_P
    coarse = force_noise_gain(finger, posture.angles[finger], p_PC, into_P).max(axis=1)
    bears = max_tip_force(finger, posture.angles[finger], p_PC, into_P).min(axis=1)
    return np.asarray((coarse < _COARSEST_FEELING) & (bears > _BEARS)), coarse


def _is_clear(
    spheres: Array, tip: Array, lid: LidShape, way: LidPath, R_EP: Array
) -> NDArray[np.bool_]:
    """Which orientations keep all but the fingertip off table, object and lid, shape (n,)."""
    about = spheres - np.append(tip, 0.0)
    left = np.arange(len(R_EP))
    for w, (point, angle) in enumerate(zip(way.points, way.angles, strict=True)):
        robot = place_spheres(about, R_EP[left, w], point)
        x, y, z, r = np.moveaxis(robot, -1, 0)
        on_table = z + lid.height - r < TABLE_CLEARANCE
        upright = np.stack([x - lid.length / 2.0, y, z + lid.height, r], axis=-1)
        body = distance_to_cylinder(upright, lid.half_width, lid.height)
        plate = lid.distance_to_lid(robot, np.full(len(left), angle))
        left = left[~(on_table | (np.minimum(body, plate) < _CLEARANCE)).any(axis=1)]
    clear = np.zeros(len(R_EP), dtype=bool)
    clear[left] = True
    return clear
