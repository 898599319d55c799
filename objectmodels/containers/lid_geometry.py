"""Places of lids on their objects, closed and open.

A closed lid lies on the object's top: a flip lid is a disc of `THICKNESS` with a tab, a lift-off
lid a disc with a knob, a screw cap a cylinder. The hinge of a flip lid lies on the rim at the
height of the top, across B's z axis; the lid's lower side turns about it.

Frame: B, at the centre of the base, z up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Array, Base, Disc, Polygon
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.object_parts import FlipLid, Lid, LiftOffLid, ScrewCap
from objectmodels.models.upright_solids import CylinderModel

THICKNESS = 0.003
"""Of a flip lid and its tab [m]."""

TAB_WIDTH = 0.02
"""Of a flip lid's tab, along the hinge [m]."""

GRIP = 0.7
"""Where a fingertip meets a tab, as a share of its length from the rim."""


@dataclass(frozen=True, eq=False)
class Hinge:
    """A flip lid on its object.

    Attributes:
        p_BH: middle of the hinge, shape (3,) [m].
        out: unit direction from it to the tab, shape (3,).
        reach: from the hinge to the rim under the tab [m].
    """

    p_BH: Array
    out: Array
    reach: float

    def lid_direction(self, angle: ArrayLike) -> Array:
        """Unit direction in which an open lid points, shape (..., 3)."""
        t = np.asarray(angle, dtype=np.float64)[..., None]
        return np.asarray(np.cos(t) * self.out + np.sin(t) * _UP)

    def opening_direction(self, angle: ArrayLike) -> Array:
        """Unit direction off its lower side, in which it opens, shape (..., 3)."""
        return self.lid_direction(np.asarray(angle, dtype=np.float64) + np.pi / 2.0)

    def lid_point(self, angle: ArrayLike, distance: float, above: float = 0.0) -> Array:
        """Point of the lid in B at an angle (...) [rad], shape (..., 3) [m].

        It lies at a distance from the hinge and so far above the lid's lower side [m].
        """
        return np.asarray(
            self.p_BH + distance * self.lid_direction(angle) + above * self.opening_direction(angle)
        )

    def centre_of_mass(self, angle: ArrayLike) -> Array:
        """Centre of mass of the lid in B, shape (..., 3) [m]."""
        return self.lid_point(angle, 0.5 * self.reach, 0.5 * THICKNESS)


_UP = np.array([0.0, 0.0, 1.0])


def lid_rim(model: ObjectModel) -> Base:
    """Outline of the object's top."""
    if isinstance(model, CylinderModel):
        return Disc(model.radius)
    return Polygon.convex(model.outline)


def lid_hinge(lid: FlipLid, rim: Base, top: float) -> Hinge:
    """Hinge of a flip lid on an object of this rim, in B, and height of the top [m]."""
    out = np.array([np.cos(lid.tab_heading), np.sin(lid.tab_heading)])
    back, front = rim.extent(np.array([-out, out])).tolist()
    p_BH = np.array([*(-back * out), top])
    return Hinge(p_BH, np.array([*out, 0.0]), back + front)


def grip_distance(lid: FlipLid, hinge: Hinge) -> float:
    """From the hinge to where a fingertip meets the tab [m]."""
    return hinge.reach + GRIP * lid.tab


def lid_height(lid: Lid) -> float:
    """Height of a closed lid above the object's top [m]."""
    if isinstance(lid, FlipLid):
        return THICKNESS
    return lid.height + (lid.knob_height if isinstance(lid, LiftOffLid) else 0.0)


def lid_rise(model: ObjectModel, opened: float) -> float:
    """Height of the object's lid above its top, 0 without a lid [m].

    The angle by which it is opened [rad] matters for a flip lid only.
    """
    if model.lid is None:
        return 0.0
    up = 0.0
    if isinstance(model.lid, FlipLid):
        reach = lid_hinge(model.lid, lid_rim(model), model.top).reach + model.lid.tab
        up = reach * float(np.sin(np.clip(opened, 0.0, 0.5 * np.pi)))
    return lid_height(model.lid) + up


def is_off(lid: LiftOffLid | ScrewCap, opened: float) -> bool:
    """Return True if a lid is off, by its opening [m] or turn [rad] as seen."""
    # A camera sees the whole turn of a cap a little wrongly.
    return opened > (lid.travel if isinstance(lid, LiftOffLid) else 0.97 * math.tau * lid.turns)


def lid_name(name: str) -> str:
    """Name of the lid of an object."""
    return f"{name} lid"


def detached_lid(model: ObjectModel, name: str) -> CylinderModel | None:
    """A lid that is off as an object of its own, as wide all the way up; None of one that stays on.

    Its B is at the middle of the lid's lower side. It is called after the object that has this name
    in the scene.
    """
    lid = model.lid
    if lid is None or isinstance(lid, FlipLid):
        return None
    return CylinderModel(
        name=lid_name(name),
        mass=lid.mass,
        radius=lid.radius,
        height=lid_height(lid),
        friction=model.friction,
        finger_friction=model.finger_friction,
    )


def lid_centre(lid: Lid, rim: Base, top: float) -> Array:
    """Centre of mass of a closed lid in B, shape (3,) [m]; a knob weighs nothing."""
    if isinstance(lid, FlipLid):
        return lid_hinge(lid, rim, top).centre_of_mass(0.0)
    return np.array([0.0, 0.0, top + 0.5 * lid.height])
