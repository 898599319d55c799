"""Overhangs: how far an object hangs over each edge of the table, and how far it may.

Model: what lies on the table is carried by what of its base is over it
(`objectmodels.mechanics.standing_balance`). It may hang over so far that it lies with the
probability that a plan must have: its centre of mass is not known for sure, nor where it ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics.standing_balance import UNLOADED, TopLoad, largest_overhang
from planner.problem.directions import HEADINGS, unit
from planner.problem.footprints import footprint, travel_to_edge
from planner.types.defaults import Defaults
from planner.types.world_state import SeenObject, TableState


def edge_name(side: str) -> str:
    """Name of the table's edge that lies in a direction of `HEADINGS`."""
    return {"toward": "front", "away": "back"}.get(side, side)


@dataclass(frozen=True, eq=False)
class Overhang:
    """An object over an edge of the table.

    Attributes:
        side: direction in which the edge lies, of `HEADINGS`.
        length: how far it reaches beyond the edge [m].
        normal: of the edge, off the table, in B, shape (2,).
    """

    side: str
    length: float
    normal: Array

    @property
    def edge(self) -> str:
        """Name of the edge."""
        return edge_name(self.side)


def overhangs(seen: SeenObject, table: TableState) -> Iterator[Overhang]:
    """The edges of the table over which an object hangs."""
    for side, heading in HEADINGS.items():
        n = unit(heading)
        beyond = -travel_to_edge(footprint(seen), table, n[:2], 0.0)
        if beyond > 0.0:
            yield Overhang(side, beyond, (seen.pose.R_WB.T @ n)[:2])


def most_overhang(
    seen: SeenObject, over: Overhang, d: Defaults, loads: Sequence[TopLoad] = ()
) -> float:
    """Farthest that an object may hang over an edge, by itself and under each of some loads [m]."""
    model, sigmas = seen.model, NormalDist().inv_cdf(d.probability)
    lengths = []
    for load in (UNLOADED, *loads):
        share = model.weight / (model.weight + load.press)
        com_sd = share * float(np.hypot(*(over.normal * model.com_sd[:2])))
        spare = sigmas * math.hypot(com_sd, d.overhang_sd)
        lengths.append(largest_overhang(model, over.normal, load, spare=spare))
    return min(lengths)


def table_with_room(table: TableState, over: Sequence[Overhang], room: float) -> TableState:
    """The table with so much more room beyond edges as what hangs over them takes [m]."""
    borders = {
        "away": ("x_max", 1.0),
        "toward": ("x_min", -1.0),
        "left": ("y_max", 1.0),
        "right": ("y_min", -1.0),
    }
    moved = {}
    for one in over:
        border, sign = borders[one.side]
        moved[border] = getattr(table, border) + sign * (one.length + room)
    return replace(table, **moved)
