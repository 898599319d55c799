"""What a clause means when the sentence does not say more: the one table of defaults.

Results name each default that they used. All values are SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Defaults:
    """Distances, speeds, margins and tolerances.

    Attributes:
        distance: of "away" and the other directions, if none is said [m].
        distance_little: of "a little" [m].
        distance_lot: of "a lot" [m].
        distance_tolerance: of a bare distance, along the direction [m].
        direction_tolerance: between the asked and the travelled direction [rad].
        rest_tilt: an object tilted by less than this stands on its base [rad].
        no_topple_share: `no_topple` holds while the tilt stays below this share of the angle of
            no return.
        no_turn: `no_turn` holds while the object turns by less than this [rad].
        no_tilt: `no_tilt` holds while the object tilts by less than this [rad].
        toppled: an object that ends tilted by more than this has toppled [rad].
        speed: of a push [m/s].
        speed_gentle: of a gentle push [m/s].
        force_reserve: share by which the force limit exceeds the largest force needed.
        force_reserve_gentle: the same for a gentle push.
        sigmas: standard deviations that a worst case takes.
        probability: the least probability of the wanted outcome that a plan may have.
        force_tolerance: of the felt force against a limit, from the sensor's noise [N].
        speed_tolerance: of a speed against a limit [m/s].
        height_tolerance: of a contact height [m].
        side_tolerance: between the asked and the actual direction of a fall [rad].
        known_to: relative standard deviation up to which a property counts as known: a question
            about it is then answered without touching the object.
        found_to: relative standard deviation to which a property is found out by touching.
    """

    distance: float = 0.10
    distance_little: float = 0.05
    distance_lot: float = 0.20
    distance_tolerance: float = 0.01
    direction_tolerance: float = math.radians(10.0)
    rest_tilt: float = math.radians(2.0)
    no_topple_share: float = 0.5
    no_turn: float = math.radians(10.0)
    no_tilt: float = math.radians(5.0)
    toppled: float = math.radians(60.0)
    speed: float = 0.05
    speed_gentle: float = 0.02
    force_reserve: float = 0.5
    force_reserve_gentle: float = 0.25
    sigmas: float = 2.0
    probability: float = 0.95
    force_tolerance: float = 0.3
    speed_tolerance: float = 0.005
    height_tolerance: float = 0.005
    side_tolerance: float = math.radians(45.0)
    known_to: float = 0.10
    found_to: float = 0.03


DEFAULTS = Defaults()
