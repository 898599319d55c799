"""Trial: one touch of an object, with its contact, its force and what moved.

Frame: B is the object's, origin at the centre of its base, z up. Forces are given in the axes that
B has while the object stands upright with its heading of that moment: a tilt does not turn them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Moved = Literal["slide", "topple", "slip", "none"]
"""What gave way: the object slid, it tilted about an edge of its base, the finger slipped on it; or
nothing did, so that the force is less than what moves the object."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Trial:
    """A balance of forces at which something moved.

    Attributes:
        moved: what gave way.
        point: contact point p_BC, a point of the object [m].
        force: whole force f_BC on the object then, in the level axes of B [N]. Of a slide the mean
            on the way, with the axes and the contact half-way; of a tilt, what holds it at `tilt`.
        force_sd: standard deviation of the force along its direction [N].
        tilt: angle about the edge at which the force was felt [rad]; 0 at the onset.
        tilt_sd: its standard deviation [rad].
        turn_rate: of a slide, by how much the object turned for each metre that the contact went
            along the force, counter-clockwise [rad/m]; None if that was not measured.
        turn_rate_sd: its standard deviation [rad/m].
        normal: of a slip, the outward unit normal of the touched face in B.
        repetition: number of the repetition of the experiments that it belongs to.
        source: what to call it in messages, such as `row 3` or `tilt at the front, 8°`.
    """

    moved: Moved
    point: Vector
    force: Vector
    force_sd: float
    tilt: float = 0.0
    tilt_sd: float = 0.0
    turn_rate: float | None = None
    turn_rate_sd: float | None = None
    normal: Vector | None = None
    repetition: int = 0
    source: str = "a trial"
