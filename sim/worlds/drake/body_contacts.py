"""Contacts of bodies: their material, and the events in which they begin to touch.

Drake combines two friction coefficients as 2ab/(a+b). Robot and table are given a huge one, so a
pair's coefficient is twice the object's own: half of the true coefficient is written to it, and
each object keeps its own friction against table and fingers.

Bodies touch where their shapes overlap, as in the plant's own point contact. Asking for the shapes
costs a twentieth of asking the plant for its contacts, since no forces are solved for.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from sim.worlds.ports import BodyContact

if TYPE_CHECKING:
    from pydrake.geometry import ProximityProperties
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.systems.framework import Context

ROUGH = 1e9  # with this coefficient on one side, a pair has twice the other side's
_STIFFNESS, _DISSIPATION = 1e6, 20.0


def surface(friction: float) -> ProximityProperties:
    """Contact material of a body with a coefficient of friction."""
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


APART = 1.0
"""The robot touches an object anew if it did not for so long; less is one touch that chatters [s].
"""

_SEPARATED = 0.1
"""Two bodies that were apart for less are taken as having touched all the time [s]."""

_TABLE = "table"


class ContactWatch:
    """Touches of bodies, told when they begin.

    Args:
        plant: whose bodies they are; its world is the table.
        objects: names of the bodies that are objects; the others are the robot's.
        lids: names of the objects to whom bodies of other names belong. What touches a lid touches
            its object; a lid that lies on its object or on the table is not told.

    Attributes:
        begun: touches that began at the time noted last; objects standing on the table are not
            told.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        objects: Collection[str],
        lids: Mapping[str, str] | None = None,
    ) -> None:
        from pydrake.multibody.tree import BodyIndex

        self._shapes = plant.get_geometry_query_input_port()
        self._bodies = {
            geometry: plant.get_body(BodyIndex(i)).name() if i else _TABLE
            for i in range(plant.num_bodies())
            for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(BodyIndex(i)))
        }
        self._objects = frozenset(objects)
        self._owner = {name: name for name in objects} | dict(lids or {})
        self._untold = frozenset(self._standing())
        self.begun: list[BodyContact] = []
        self._touching: dict[tuple[str, str], float] = {}
        self._by_robot: dict[str, float] = {}

    def note(self, time: float, context: Context) -> list[str]:
        """Takes in contacts at a time [s]; returns objects that the robot began to touch."""
        self.begun, anew = [], []
        for pair in self._pairs(context):
            if time - self._touching.get(pair, -np.inf) > _SEPARATED:
                self.begun.append(BodyContact(time, *pair))
            self._touching[pair] = time
            touched = self._objects.intersection(self._owners(pair))
            if len(touched) == 1:
                (name,) = touched
                if time - self._by_robot.get(name, -np.inf) > APART:
                    anew.append(name)
                self._by_robot[name] = time
        return anew

    def in_robot(self, context: Context) -> Iterator[tuple[str, float]]:
        """Names of the objects that are in the robot, and how deep [m]."""
        for overlap in self._shapes.Eval(context).ComputePointPairPenetration():
            pair = {self._bodies[overlap.id_A], self._bodies[overlap.id_B]} - {_TABLE}
            owners = {self._owner[name] for name in pair if name in self._owner}
            if len(pair) == 2 and len(owners) == 1 and not pair <= self._owner.keys():
                yield *owners, overlap.depth

    def _standing(self) -> Iterator[tuple[str, str]]:
        """Pairs of bodies whose contact is nothing to tell: what belongs together, or stands."""
        for name, owner in self._owner.items():
            yield from ((name, _TABLE), (_TABLE, name))
            yield from ((name, other) for other, its in self._owner.items() if its == owner)

    def _pairs(self, context: Context) -> Iterator[tuple[str, str]]:
        """Names of the bodies in contact, but for what only stands."""
        for overlap in self._shapes.Eval(context).ComputePointPairPenetration():
            a, b = self._bodies[overlap.id_A], self._bodies[overlap.id_B]
            if (a, b) not in self._untold:
                yield (a, b) if a < b else (b, a)

    def _owners(self, pair: tuple[str, str]) -> set[str]:
        """The two bodies, with objects instead of their lids."""
        return {self._owner.get(name, name) for name in pair}
