"""The hand with four fingers: its postures for pushing, grasping, pressing and flipping.

Frames: P is the palm; x is the closing direction, from the fingers' side to the thumb's. D is the
frame of a push (x into the touched face, z up) or a drag (x along it, z up), T the midpoint of the
touching fingertips' centres; E and L as in `sim.robots.lid_path`.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_x, rot_y, rot_z, spatial_cross
from planner.types.robot import Grip
from sim.robots import finger_kinematics as kinematics
from sim.robots.collision_spheres import TABLE_CLEARANCE, distance_to_cylinder, place_spheres
from sim.robots.finger_kinematics import (
    BASES,
    CURLED,
    EFFORT,
    EFFORT_SHARE,
    FINGER_LIMITS,
    FINGERS,
    FLANGE_TO_PALM,
    JOINT_STIFFNESS,
    RESTING,
    STOP_ROOM,
    TIP_RADIUS,
    angles_reaching,
    bent_posture,
    finger_jacobian,
    finger_points,
    force_noise_gain,
    hand_spheres,
    max_tip_force,
    thin_spheres,
    tip_stiffness,
    touching_posture,
    whole_spheres,
)
from sim.robots.hand import Angles, FlipPostureSet, GraspPosture, Posture, PostureSet
from sim.robots.lid_path import LidPath, LidShape

HOLDING: tuple[str, ...] = ("thumb", "index", "middle", "ring")
"""The fingers that hold, in the order of `Grip.contacts`."""

SHARES = np.array([1.0, 1 / 3, 1 / 3, 1 / 3])
"""Of the squeeze that each of them bears: the fingers stand side by side about the thumb."""

FINGER_SPREADS: tuple[float, ...] = (0.04, 0.032, 0.024)
"""Distances between the fingertips of a two-finger push, the largest first [m]."""

NARROWEST, WIDEST = 0.008, 0.100
"""Widths that the hand closes about [m]."""

LARGEST_SKEW = 0.35
"""Largest vertical force per force along the push of a hand that is used.

Loaded along the push, a slanted finger also presses up or down. Pressing down makes the object
heavier on the table, which makes it move in jerks."""

# 1 / lever with which the sensors feel a push or the pressing: 60 makes 1.6 mN·m a noise of 0.1 N.
_COARSEST_FEELING = 60.0

# Fingers straight down, palm towards where they push.
_UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])


@functools.lru_cache(maxsize=16)
def flip_postures(lid: LidShape, wrist: float) -> FlipPostureSet:
    """All postures that flip a lid; `wrist` as of `FourFingerHand`.

    Model: one finger is bent, the others are curled up. The palm leans back from the way in which
    the lid is pushed at first, is turned a little aside, and turns with the lid by some angle while
    that is flipped. Kept are hands whose spheres stay clear of the table, the object and its lid
    all along the way, and whose finger feels and bears the push. None of that depends on where the
    object stands.
    """
    flexions = ((-0.2, 0.9), (0.2, 0.6), (-0.57, 1.1), (0.0, 0.5), (-0.4, 0.7), (0.2, 0.25))
    way = LidPath.from_lid(lid)
    R_EP = _palm_orientations(lid, way)
    postures, spheres, orientations, tips, coarse = [], [], [], [], []
    for finger, flexion in itertools.product(("index", "middle", "ring"), flexions):
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
    lean, side, turn = np.radians(
        _combinations(
            np.arange(0.0 if lid.is_opening else -15.0, 91.0, 15.0),
            np.array([0.0, -25.0, 25.0, -50.0, 50.0]),
            np.array([0.0, 35.0, 70.0]),
        )
    )
    # The tab is drawn towards the hinge in the end; a lid is pushed shut away from it.
    facing = rot_z(np.pi if lid.is_opening else 0.0)
    first = facing @ rot_z(side) @ rot_y(-lean) @ _UPRIGHT
    with_lid = (-1.0 if lid.is_opening else 1.0) * turn[:, None] * way.shares
    return np.asarray(rot_y(with_lid) @ first[:, None])


def _combinations(*values: Array) -> Array:
    """All combinations of values, one row for each kind of them, the last one changing fastest."""
    return np.array([each.ravel() for each in np.meshgrid(*values, indexing="ij")])


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
    # The finger bears more than any lid needs, and feels it better than most pushes.
    return np.asarray((coarse < 40.0) & (bears > 3.0)), coarse


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
        # All but the fingertip keeps 3 mm from the object and its lid.
        left = left[~(on_table | (np.minimum(body, plate) < 0.003)).any(axis=1)]
    clear = np.zeros(len(R_EP), dtype=bool)
    clear[left] = True
    return clear


@dataclass(frozen=True, eq=False)
class FourFingerGrasp(GraspPosture):
    """A grasp of this hand: four fingertips on two parallel sides.

    Model: no finger is spread, so that each moves in its own plane across the palm. The fingertips
    touch at one height along the straight fingers, thumb against the other three, and close along a
    line: a posture is a width. About a round side index and ring finger go on as far as that lies
    back beside the middle finger, and press a little towards each other.

    Attributes:
        shares: of the squeeze that each of `HOLDING` bears, shape (4,).
    """

    shares: Array = field(default_factory=lambda: SHARES)

    @property
    def touching_fingers(self) -> tuple[str, ...]:
        """The fingers that touch."""
        return _touching_fingers(self.shares)

    def posture_at(self, opening: float = 0.0) -> Posture:
        """The hand with its fingertips off each side; the others are curled up."""
        name = f"grip of {1e3 * self.width:.0f} mm"
        x, _, z = self.middle.tolist()
        width = self.width + 2.0 * opening
        return _closed_posture(name, width, x, z, self.touching_fingers, self.press.behind)

    def touch_point(self, finger: str) -> Array:
        """Place at which a finger touches, in P, shape (3,) [m]."""
        tip = finger_points(finger, self.posture_at().angles[finger])[3]
        return np.asarray(tip + TIP_RADIUS * closing_direction(finger))

    @functools.cached_property
    def squeeze_offsets(self) -> Array:
        """Change of the commanded angles per squeeze [rad/N]."""
        beside = {"index": -self.press.inward, "ring": self.press.inward}
        torques = [self._finger_torques(finger, 0.0, beside.get(finger, 0.0)) for finger in FINGERS]
        return np.concatenate(torques) / JOINT_STIFFNESS

    def force_offsets(self, force_P: Array) -> Array:
        """Change of the commanded angles with which both sides together exert a force [rad]."""
        forces = {f: 0.5 * share * force_P for f, share in zip(HOLDING, self.shares, strict=True)}
        torques = [self._finger_jacobians[f].T @ forces[f] for f in FINGERS]
        return np.concatenate(torques) / JOINT_STIFFNESS

    @functools.cached_property
    def _finger_jacobians(self) -> dict[str, Array]:
        angles = self.posture_at().angles
        return {f: finger_jacobian(f, angles[f], self.touch_point(f)) for f in FINGERS}

    def _finger_torques(self, finger: str, along: float, beside: float) -> Array:
        """Torques per squeeze with a tangential load beside it, shape (3,) [m]."""
        load = self.shares[HOLDING.index(finger)] * (
            closing_direction(finger) + np.array([0.0, beside, along])
        )
        return np.asarray(self._finger_jacobians[finger].T @ load)

    def depth_at(self, opening: float, wrist: float) -> float:
        """Room between its middle and what of the hand is beside or before the width [m]."""
        spheres = hand_spheres(self.posture_at(opening), wrist)
        beside = np.abs(spheres[:, 0] - self.middle[0]) - spheres[:, 3]
        # Of what is nearer to the sides than 3 mm.
        inside = spheres[beside < self.width / 2.0 + 0.003]
        return float(self.middle[2] - (inside[:, 2] + inside[:, 3]).max())

    @functools.cached_property
    def stiffness(self) -> float:
        """Moment about the closing direction per angle, the fingertips sticking [N·m/rad]."""
        if len(self.touching_fingers) < 3:
            return 0.0  # it turns about two fingertips
        whole = np.zeros((6, 6))
        angles = self.posture_at().angles
        for finger in self.touching_fingers:
            arm = self.touch_point(finger) - self.middle
            motion = np.hstack([np.eye(3), spatial_cross(np.eye(3), arm[None, :]).T])
            held = tip_stiffness(finger, angles[finger], self.touch_point(finger))
            whole += motion.T @ held @ motion
        return float(1.0 / np.linalg.inv(whole)[3, 3])

    @functools.cached_property
    def largest_squeeze(self) -> float:
        """Largest squeeze, with a tangential load as large beside it [N]."""
        loads = ((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
        each = [self._finger_torques(f, *load) for f, load in itertools.product(FINGERS, loads)]
        return float(EFFORT_SHARE * EFFORT / np.abs(each).max())


def closing_direction(finger: str) -> Array:
    """Direction in which a finger presses, in P, shape (3,)."""
    return np.array([-1.0 if finger == "thumb" else 1.0, 0.0, 0.0])


@functools.lru_cache(maxsize=256)
def best_grasp(
    width: float, *, pinch: bool, wrist: float, depth: float = 0.0
) -> FourFingerGrasp | None:
    """See `Hand.grasp_posture`; thumb and middle finger pinch a knob, past which others go.

    Of all places where the fingertips meet, the one that bears the largest squeeze is taken, with a
    fingertip leading each finger and room for something deep before the palm.
    """
    shares = np.array([1.0, 0.0, 1.0, 0.0]) if pinch else SHARES  # of `HOLDING`
    across, along = np.arange(0.030, 0.0901, 0.005), np.arange(0.165, 0.2051, 0.005)
    found = [_grasp_at(width, x, z, shares) for x, z in itertools.product(across, along)]
    worth = _pinch_worth if pinch else _grasp_worth
    closing = [each for each in found if each is not None]
    if depth > 0.0:
        closing = [each for grip in closing for each in _opened_about(grip, depth, wrist)]
    best = max(closing, key=worth, default=None)
    return None if best is None else replace(best, grip=_planner_grip(best, wrist))


def _grasp_worth(grip: FourFingerGrasp) -> float:
    """The squeeze [N], with what room before the palm and beside the sides is worth of it."""
    # A centimetre before the palm is worth 1 N, one beside the sides 2 N.
    return float(grip.largest_squeeze + 100.0 * grip.middle[2] + 200.0 * grip.opening)


def _pinch_worth(grip: FourFingerGrasp) -> float:
    """A knob stands on something that the fingers must not touch."""
    hanging = [
        finger_points(finger, grip.posture_at(opening).angles[finger])[:, 2].max() - grip.middle[2]
        for finger in grip.touching_fingers
        for opening in (0.0, grip.opening)
    ]
    return _grasp_worth(grip) - 1000.0 * float(max(hanging))  # 1 N for each millimetre


def _touching_fingers(shares: Array) -> tuple[str, ...]:
    return tuple(finger for finger, share in zip(HOLDING, shares, strict=True) if share > 0.0)


def _grasp_at(width: float, x: float, z: float, shares: Array) -> FourFingerGrasp | None:
    """The grip about a width in one place; None if the fingers do not get there."""
    holding = _touching_fingers(shares)
    closed = _finger_angles(width, x, z, holding)
    low, high = np.radians([20.0, 125.0])  # lean of a distal link that leads with its tip
    if closed is None or not all(low < a[1] + 2.0 * a[2] < high for a in closed.values()):
        return None
    # All of the closing is possible where both its ends are. Less than 3 mm off each side does not
    # get around what is seen a little wrongly.
    openings = np.arange(0.020, 0.003 - 1e-9, -0.001)
    opening = next((o for o in openings if _finger_angles(width + 2.0 * o, x, z, holding)), None)
    if opening is None:
        return None
    unknown = Grip(np.zeros((4, 2)), SHARES, 0.0, (0.0, 0.0))
    return FourFingerGrasp(width, np.array([x, 0.0, z]), float(opening), unknown, shares=shares)


def _opened_about(grip: FourFingerGrasp, depth: float, wrist: float) -> Iterator[FourFingerGrasp]:
    """The same, as wide open as leaves room before the palm; none if it never does.

    About something deep, which the palm is close to, it is 6 mm off each side at least.
    """
    if grip.depth_at(0.0, wrist) >= depth:
        openings = np.arange(grip.opening, 0.006 - 1e-9, -0.002).tolist()
        deep = (each for each in openings if grip.depth_at(each, wrist) >= depth)
        yield from (replace(grip, opening=each) for each in itertools.islice(deep, 1))


def _planner_grip(found: FourFingerGrasp, wrist: float) -> Grip:
    """The grip as the planner knows it."""
    x, _, z = found.middle
    contacts = np.array(
        [found.touch_point(finger)[[2, 1]] - [z, 0.0] for finger in found.touching_fingers]
    )
    # Open or closed, whatever needs more.
    around = np.vstack([hand_spheres(found.posture_at(o), wrist) for o in (0.0, found.opening)])
    low, high = (around[:, 0] - around[:, 3]).min(), (around[:, 0] + around[:, 3]).max()
    room = (float(x - found.width / 2.0 - low), float(high - x - found.width / 2.0))
    ahead = float((around[:, 2] + around[:, 3]).max() - z)
    shares = found.shares[found.shares > 0.0]
    return Grip(contacts, shares, found.largest_squeeze, room, ahead, found.stiffness)


@functools.lru_cache(maxsize=4096)
def _finger_angles(
    width: float, x: float, z: float, holding: tuple[str, ...]
) -> dict[str, Angles] | None:
    """Angles of the fingers that hold a width; None where one does not get there."""
    angles = {}
    low, high = FINGER_LIMITS.T
    for finger in holding:
        bent = _bent_finger(finger, width, x, z)
        if bent is None or not ((bent > low + STOP_ROOM) & (bent < high - STOP_ROOM))[1:].all():
            return None
        angles[finger] = bent
    return angles


def _bent_finger(finger: str, width: float, x: float, z: float) -> Angles | None:
    """Angles with which a fingertip touches its side of a width, whatever its stops."""
    side = np.array([x, 0.0, z]) - (width / 2.0 + TIP_RADIUS) * closing_direction(finger)
    return angles_reaching(finger, side)


@functools.lru_cache(maxsize=64)
def _closed_posture(
    name: str, width: float, x: float, z: float, holding: tuple[str, ...], behind: float
) -> Posture:
    """The hand about a width, wherever its fingers get; those that do not hold are curled up."""
    angles = dict.fromkeys(FINGERS, CURLED)
    for finger in holding:
        bent = _bent_finger(finger, width - 2.0 * behind * (finger in ("index", "ring")), x, z)
        assert bent is not None, "a grip is about a width that the fingers reach"
        angles[finger] = bent
    return touching_posture(name, angles, holding)


# Proximal and middle flexion [rad]: fingers stretched back at the base and bent towards the tip
# press clear of the palm, and hooked ones are about as stiff across as along. Those stretched back
# as far as they go reach lowest, but bear little before they come to their stops.
_PUSHING_FLEXIONS: Mapping[str, tuple[float, float]] = {
    "arched": (-0.40, 0.50),
    "arched back": (-0.57, 0.50),
    "arched far back": (-0.65, 0.50),
    "bent back": (-0.57, 0.70),
    "bent far back": (-0.65, 0.70),
    "bent": (-0.40, 0.70),
    "straight": (0.0, 0.50),
    "hooked back": (-0.57, 1.10),
    "hooked far back": (-0.65, 1.10),
    "hooked": (-0.20, 0.90),
    "closed": (-0.40, 1.30),
}


@functools.cache
def one_finger_postures() -> tuple[Posture, ...]:
    """Postures that push with the tip of the index, middle or ring finger."""
    return tuple(
        bent_posture(f"{finger} {name}", {finger: (0.0, *flexion)})
        for finger in ("middle", "index", "ring")
        for name, flexion in _PUSHING_FLEXIONS.items()
    )


@functools.cache
def two_finger_postures(spread: float) -> tuple[Posture, ...]:
    """Postures that push with index and ring, their tips' centres a distance apart [m]."""
    postures = []
    for name, flexion in _PUSHING_FLEXIONS.items():
        length = finger_points("index", (0.0, *flexion))[3, 2] - BASES["index"][2]
        # Abduction by a turns the finger's z towards −y: the tip moves by −length·sin(a).
        inward = float(np.arcsin((BASES["index"][1] - spread / 2.0) / length))
        pushing = {"index": (inward, *flexion), "ring": (-inward, *flexion)}
        postures.append(bent_posture(f"two fingers {name}", pushing))
    return tuple(postures)


@functools.cache
def pushing_postures(
    fingers: int, spread: float, *, fine: bool = False, wrist: float
) -> PostureSet:
    """See `Hand.pushing_postures`; one finger lets the palm lean to its sides, two do not.

    Model: all postures, tilts along the push, sides and rolls are looked at once. Kept are those
    whose torque sensors feel the push and whose fingers press straight when loaded. For each it is
    known how much force it bears, and where its spheres are about the fingertips: a push turns and
    shifts them, no more.
    """
    sides = np.array([0.0])
    if fingers == 1:
        fine_sides = [0.0, -15.0, 15.0, -30.0, 30.0, -45.0, 45.0, -60.0, 60.0]
        sides = np.radians(fine_sides if fine else [0.0, -30.0, 30.0])
    tilts, rolls = np.radians(np.arange(-60.0, 83.0, 7.5)), np.array([0.0, np.pi])
    tilt, side, roll = _combinations(tilts, sides, rolls)
    # At zero tilt the fingers point down; a positive tilt leans the hand back, behind the push.
    turned = rot_x(side) @ rot_y(-tilt) @ _UPRIGHT @ rot_z(roll)
    postures = one_finger_postures() if fingers == 1 else two_finger_postures(spread)
    which = np.repeat(np.arange(len(postures)), len(turned))
    R_DP = np.tile(turned, (len(postures), 1, 1))
    coarse, skew, bears = np.hstack([pushing_quality(posture, turned) for posture in postures])
    good = np.flatnonzero((coarse < _COARSEST_FEELING) & (skew < LARGEST_SKEW))
    # A finger that is closed gives way across as it presses, which blurs what it feels.
    closed = [any(each.angles[f][2] >= 1.2 for f in each.pushing) for each in postures]
    blurred = np.repeat(closed, len(turned))
    order = good[np.argsort((skew + coarse / 200.0 + 0.2 * blurred)[good], kind="stable")]
    which, R_DP = which[order], R_DP[order]
    spheres = tuple(whole_spheres(posture, wrist) for posture in postures)
    return PostureSet.from_postures(postures, spheres, which, R_DP, bears[order])


def pushing_quality(posture: Posture, R_DP: Array) -> tuple[Array, Array, Array]:
    """Quality of a push along D's x axis in each orientation, by the hand's worst finger.

    A fingertip that sticks to the face drags along it as the fingers' own stiffness has it; one
    that slips does not. A hand must bear both.

    Args:
        posture: of its fingers.
        R_DP: orientations of the palm, shape (n, 3, 3).

    Returns:
        Noise of the felt push per noise of a torque sensor [1/m], the vertical force per force
        along the push while the fingertip sticks to the face, and the force that each finger bears
        [N]; all of shape (n,).
    """
    into_face, up = R_DP[:, 0], R_DP[:, 2]  # D's x and z axes in P
    coarse, skew, bears = np.zeros(len(R_DP)), np.zeros(len(R_DP)), np.full(len(R_DP), np.inf)
    for finger, tip in zip(posture.pushing, posture.tips, strict=True):
        angles, p_PC = posture.angles[finger], tip + TIP_RADIUS * into_face
        stiffness = tip_stiffness(finger, angles, p_PC)
        force = (R_DP @ stiffness @ into_face[..., None])[..., 0]
        drag = force[:, 2] / force[:, 0]
        coarse = np.maximum(coarse, force_noise_gain(finger, angles, p_PC, into_face))
        skew = np.maximum(skew, np.abs(drag))
        for load in (into_face, into_face + drag[:, None] * up):
            bears = np.minimum(bears, max_tip_force(finger, angles, p_PC, load))
    return coarse, skew, bears


@functools.cache
def pressing_postures(wrist: float) -> PostureSet:
    """See `Hand.pressing_postures`; `wrist` as of `FourFingerHand`.

    Model: one finger pokes down, more or less slanted, the palm turned anywhere about the vertical.
    Kept are hands that are clear of the plane on which they press, whose torque sensors feel the
    pressing, and whose finger bears it, with the friction along the plane and without.
    """
    heading, lean, side = np.radians(
        _combinations(
            np.arange(0.0, 360.0, 30.0), np.arange(-45.0, 46.0, 15.0), np.array([0.0, -30.0, 30.0])
        )
    )
    R_DP = rot_z(heading) @ rot_x(side) @ rot_y(-lean) @ _UPRIGHT
    postures = one_finger_postures()
    spheres = tuple(whole_spheres(posture, wrist) for posture in postures)
    every = PostureSet.from_postures(
        postures,
        spheres,
        np.repeat(np.arange(len(postures)), len(R_DP)),
        np.tile(R_DP, (len(postures), 1, 1)),
        np.concatenate([_strength(posture, R_DP) for posture in postures]),
    )
    clear = every.lowest_points > 0.004 - TIP_RADIUS
    good = every[np.flatnonzero(clear & (every.strength > 0.0))]
    best = good[np.argsort(-good.strength.round(1), kind="stable")]
    return replace(best, number=np.arange(len(best)))


def _strength(posture: Posture, R_DP: Array) -> Array:
    """Pressing force that the finger bears in each orientation [N]; 0 where it feels it badly."""
    (finger,), (tip,) = posture.pushing, posture.tips
    angles, down_D = posture.angles[finger], np.array([0.0, 0.0, -1.0])
    down = down_D @ R_DP
    p_PC = tip + TIP_RADIUS * down
    bears = np.full(len(R_DP), np.inf)
    # Of what it presses a finger bears half along the drag, more than most things take.
    for along in (0.0, 0.5):
        load = (down_D + along * np.array([1.0, 0.0, 0.0])) @ R_DP
        bears = np.minimum(bears, max_tip_force(finger, angles, p_PC, load))
    coarse = force_noise_gain(finger, angles, p_PC, down)
    return np.where(coarse < _COARSEST_FEELING, bears, 0.0)


@dataclass(frozen=True)
class FourFingerHand:
    """The four-finger hand on some arm; see `sim.robots.hand.Hand`.

    Attributes:
        wrist: distance from the arm's wrist to its flange, which the hand's spheres cover [m].
    """

    wrist: float

    fingers = kinematics.FINGERS
    joint_names = kinematics.JOINT_NAMES
    grasp_fingers = HOLDING
    tip_radius = kinematics.TIP_RADIUS
    finger_spreads = FINGER_SPREADS
    force_skew = LARGEST_SKEW
    grasp_widths = (NARROWEST, WIDEST)
    # The palm is turned by π on the flange.
    R_FP = np.diag([-1.0, -1.0, 1.0])
    p_FP = np.array([0.0, 0.0, FLANGE_TO_PALM])
    palm_link = "palm"
    model_file = resources.files("sim") / "robots" / "builtin" / "four_finger_hand.urdf"
    resting = RESTING

    closing_direction = staticmethod(closing_direction)
    tip_centre = staticmethod(kinematics.tip_centre)
    tip_force = staticmethod(kinematics.tip_force)
    tip_stiffness = staticmethod(kinematics.tip_stiffness)
    force_noise_gain = staticmethod(kinematics.force_noise_gain)
    is_at_stop = staticmethod(kinematics.is_at_stop)

    def model_joints(self, finger: str) -> tuple[str, ...]:
        """Names of a finger's four joints; the distal one follows the middle one."""
        return tuple(f"{finger}_{joint}" for joint in kinematics.FINGER_JOINTS)

    def model_angles(self, angles: Angles) -> Angles:
        """Angles of a finger's four joints [rad]."""
        return (*angles, angles[-1])

    def pushing_postures(self, fingers: int, spread: float, *, fine: bool = False) -> PostureSet:
        """Postures whose fingers bear and feel the push."""
        return pushing_postures(fingers, spread, fine=fine, wrist=self.wrist)

    def pressing_postures(self) -> PostureSet:
        """Postures whose finger bears and feels the pressing while it drags."""
        return pressing_postures(self.wrist)

    def grasp_posture(
        self, width: float, *, pinch: bool = False, depth: float = 0.0
    ) -> FourFingerGrasp | None:
        """The grasp about a width; by thumb and middle finger alone about a knob."""
        if not NARROWEST <= width <= WIDEST:
            return None
        return best_grasp(round(width, 4), pinch=pinch, wrist=self.wrist, depth=depth)

    def flip_postures(self, lid: LidShape) -> FlipPostureSet:
        """Postures whose finger bears and feels the lid."""
        return flip_postures(lid, self.wrist)

    def spheres(self, posture: Posture) -> Array:
        """Spheres with room about the fingers, without the pushing tips."""
        return hand_spheres(posture, self.wrist)

    def whole_spheres(self, posture: Posture) -> Array:
        """The same with the pushing tips, which come last."""
        return whole_spheres(posture, self.wrist)

    def thin_spheres(self, posture: Posture) -> Array:
        """Spheres of the fingers as thin as they are."""
        return thin_spheres(posture, self.wrist)
