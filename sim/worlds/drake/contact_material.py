"""How bodies of the simulated world touch each other.

Drake combines two friction coefficients as 2ab/(a+b). Robot and table are given a huge one, so a
pair's coefficient is twice the object's own: half of the true coefficient is written to it, and
each object keeps its own friction against table and fingers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydrake.geometry import ProximityProperties

ROUGH = 1e9  # with this coefficient on one side, a pair has twice the other side's
_STIFFNESS, _DISSIPATION = 1e6, 20.0


def surface(friction: float) -> ProximityProperties:
    """How a body's skin touches others, with its coefficient of friction."""
    from pydrake.geometry import AddContactMaterial, ProximityProperties
    from pydrake.multibody.plant import CoulombFriction

    properties = ProximityProperties()
    AddContactMaterial(
        dissipation=_DISSIPATION,
        point_stiffness=_STIFFNESS,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties
