"""The way of a fingertip that flips a lid about its hinge, and back.

Model: the lid is a plate of known thickness with its hinge on its lower side, at the rim. To open
it the fingertip goes under the tab and stays below the plate; to close it it comes from behind and
stays above it, pressing inside the rim where the object stands below. It touches the plate at a
constant distance from the hinge.

Frames: W is the world. E stands at the hinge: z up, x level from the hinge to the tab. L is E
turned with the lid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from objectmodels.containers import lids
from objectmodels.containers.lids import GRIP, TAB_WIDTH, THICKNESS
from objectmodels.geometry.rotations import Array, rot_y, rot_z
from objectmodels.models.object_parts import FlipLid
from planner.types.actions import FlipOver
from planner.types.world_state import SeenObject
from sim.robots.collision_spheres import distance_to_box, place_spheres


@dataclass(frozen=True)
class LidShape:
    """A lid as it matters to the hand; equal for equal lids.

    Attributes:
        length: from the hinge to the opposite rim [m].
        half_width: of the plate [m].
        tab: how far the tab stands out [m].
        height: of the hinge above the table [m].
        start, end: angles of the lid at the ends of the way [rad].
        tip_radius: of the fingertip [m].
    """

    length: float
    half_width: float
    tab: float
    height: float
    start: float
    end: float
    tip_radius: float

    @property
    def is_opening(self) -> bool:
        """True if the lid is opened."""
        return self.end > self.start

    @property
    def touch_lever(self) -> float:
        """Distance from the hinge at which the lid is touched [m]."""
        return self.length + GRIP * self.tab

    def tip_centres(self, angles: Array, off: Array | float = 0.0) -> Array:
        """Centres of the fingertip at angles of the lid, in E, shape (n, 3) [m].

        Args:
            angles: shape (n,) [rad].
            off: distance from the lid [m].
        """
        across = -(self.tip_radius + off) if self.is_opening else self.tip_radius + THICKNESS + off
        c, s = np.cos(angles), np.sin(angles)
        x, z = self.touch_lever * c - across * s, self.touch_lever * s + across * c
        return np.stack([x, np.zeros_like(x), z], axis=-1)

    def lid_normals(self, angles: Array) -> Array:
        """Directions from the fingertip into the lid, in E, shape (n, 3)."""
        into = 1.0 if self.is_opening else -1.0
        c, s = np.cos(angles), np.sin(angles)
        return into * np.stack([-s, np.zeros_like(s), c], axis=-1)

    def angle_at_tip(self, tip: Array) -> float:
        """Angle of a lid that touches a fingertip at a point in E [rad]."""
        x, _, z = tip
        across = -self.tip_radius if self.is_opening else self.tip_radius + THICKNESS
        beyond = float(np.arcsin(np.clip(across / max(float(np.hypot(x, z)), 1e-9), -1.0, 1.0)))
        return float(np.arctan2(z, x)) - beyond

    def distance_to_lid(self, robot: Array, angle: Array) -> Array:
        """Signed distance of spheres in E from the plate and its tab, shape (..., k) [m].

        Args:
            robot: shape (..., k, 4).
            angle: of the lid, shape (...) [rad].
        """
        # A lid opens about −y.
        in_L = place_spheres(robot, rot_y(angle), np.zeros(3))
        plate = distance_to_box(
            in_L,
            np.array([0.0, -self.half_width, 0.0]),
            np.array([self.length, self.half_width, THICKNESS]),
        )
        half = TAB_WIDTH / 2.0
        tab = distance_to_box(
            in_L,
            np.array([0.0, -half, 0.0]),
            np.array([self.length + self.tab, half, THICKNESS]),
        )
        return np.minimum(plate, tab)


@dataclass(frozen=True, eq=False)
class LidPath:
    """Path of the fingertip in E: before the lid, along the arc, off it and back.

    Attributes:
        points: p_ET, shape (w, 3) [m].
        shares: of the arc by which the palm has turned, shape (w,).
        angles: of the lid meanwhile, shape (w,) [rad].
        touching: which points are those of the arc.
    """

    points: Array
    shares: Array
    angles: Array
    touching: slice

    @classmethod
    def from_lid(cls, lid: LidShape) -> LidPath:
        """The way on which a lid is opened or closed."""
        points = 8  # of the arc
        standoff = 0.045  # how far from the lid the fingertip begins [m]
        arc = np.linspace(lid.start, lid.end, points)
        first, last = arc[:1], arc[-1:]
        # Before it touches the fingertip is 4 mm from the lid, and goes 25 mm off it at the end.
        near, ahead = lid.tip_centres(first, 0.004), np.array([standoff, 0.0, 0.0])
        before = near + ahead if lid.is_opening else lid.tip_centres(first, standoff)
        off = lid.tip_centres(last, 0.025)
        back = np.array([0.5, 1.0])[:, None] * (before - off) + off
        return cls(
            np.vstack([before, near, lid.tip_centres(arc), off, back]),
            np.concatenate([[0.0, 0.0], np.linspace(0.0, 1.0, points), [1.0, 0.5, 0.0]]),
            np.concatenate([[lid.start] * 2, arc, [lid.end] * 3]),
            slice(2, 2 + points),
        )


def lid_shape(step: FlipOver, target: SeenObject, tip_radius: float) -> LidShape:
    """The lid of an object that is seen, for a fingertip of a radius [m]."""
    lid, hinge = _lid_and_hinge(target)
    rim = target.model.rim
    across = np.array([-hinge.out[1], hinge.out[0]])
    return LidShape(
        length=round(hinge.reach, 5),
        half_width=round(float(rim.extent(across[None])[0]), 5),
        tab=lid.tab,
        height=target.model.top,
        start=_round_angle(step.start),
        end=_round_angle(step.end),
        tip_radius=tip_radius,
    )


def hinge_pose(target: SeenObject) -> tuple[Array, Array]:
    """R_WE, shape (3, 3), and p_WE of the hinge of an object's lid, shape (3,) [m]."""
    lid, hinge = _lid_and_hinge(target)
    R_WE = target.pose.R_WB @ rot_z(lid.tab_heading)
    return R_WE, target.pose.p_WB + target.pose.R_WB @ hinge.p_BH


def _lid_and_hinge(target: SeenObject) -> tuple[FlipLid, lids.Hinge]:
    """Of an object that has a flip lid."""
    lid = target.model.lid
    assert isinstance(lid, FlipLid), "only a flip lid is flipped over"
    return lid, lids.lid_hinge(lid, target.model.rim, target.model.top)


def _round_angle(angle: float) -> float:
    """To 5°, so that lids seen a little differently are equal [rad]."""
    return float(np.radians(5.0 * round(np.degrees(angle) / 5.0)))
