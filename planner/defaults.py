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
        speed_fast: least speed of a fast push [m/s].
        force_hard: a hard push is ready to press with at least so much [N].
        force_tolerance: of the felt force, from the sensor's noise [N].
        speed_tolerance: of a speed [m/s].
        duration_tolerance: of a bare duration [s].
        height_tolerance: of a contact height [m].
        side_tolerance: between the asked and the actual direction of a fall or of a tilt [rad].
        place_gap: between the surfaces of an object and of what it is brought next to, behind,
            left of… if no distance is said [m].
        place_gap_tolerance: of that gap [m].
        place_tolerance: of a gap that is said, and of a point on the table [m].
        place_aside: an object left of another (behind it, …) may be off the middle of that side by
            this share of the offset at which the two would no longer face each other.
        between_tolerance: of a place between two objects, from the middle of the gap [m].
        touching_gap: surfaces that are closer than this touch [m].
        edge_gap: between an object at the table's edge and that edge [m].
        edge_tolerance: of that gap [m].
        centre_tolerance: of the middle of the table [m].
        clear_tolerance: of a distance that is to be kept from another object, from their shapes
            [m].
        in_line_tolerance: between two objects that are in line [m].
        turn: angle of a turn, if none is said [rad].
        turn_little: of "a little" [rad].
        turn_lot: of "a lot" [rad].
        turn_tolerance: of a bare angle [rad].
        turn_drift: an object that is turned stays where it is within this [m].
        tilt: angle of a tilt, if none is said [rad].
        tilt_little: of "a little" [rad].
        tilt_lot: of "a lot" and of "until it almost tips", as a share of the angle of no return.
        tilt_tolerance: of a bare angle [rad].
        tips: an object tilted by more than this has begun to tip [rad].
        moves: an object that went farther than this has moved [m].
        overrun: way that an object goes on after the event that it was to stop at [m].
        no_slide: `no_slide` holds while the base slides by less than this [m].
        no_lift: `no_lift` holds while the lowest point rises by less than this [m].
        clearance: that objects keep from each other, and from the table's edge, on their way [m].
        clearance_fragile: from what is fragile [m].
        speed_most: fastest push with which an object keeps to the fingertips [m/s].
        aim_position: an object this near to where it should be is there [m].
        aim_drift: the same of one that is turned on the spot [m].
        aim_angle: an object turned by less than this from how it should look is there [rad].
        most_pushes: pushes made for one frame before it is given up.
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
    speed_fast: float = 0.10
    force_hard: float = 8.0
    force_tolerance: float = 0.3
    speed_tolerance: float = 0.005
    duration_tolerance: float = 0.25
    height_tolerance: float = 0.005
    side_tolerance: float = math.radians(45.0)
    place_gap: float = 0.03
    place_gap_tolerance: float = 0.02
    place_tolerance: float = 0.01
    place_aside: float = 0.5
    between_tolerance: float = 0.03
    touching_gap: float = 0.003
    edge_gap: float = 0.05
    edge_tolerance: float = 0.02
    centre_tolerance: float = 0.05
    clear_tolerance: float = 0.002
    in_line_tolerance: float = 0.01
    turn: float = math.radians(90.0)
    turn_little: float = math.radians(15.0)
    turn_lot: float = math.radians(180.0)
    turn_tolerance: float = math.radians(3.0)
    turn_drift: float = 0.02
    tilt: float = math.radians(10.0)
    tilt_little: float = math.radians(5.0)
    tilt_lot: float = 0.55
    tilt_tolerance: float = math.radians(2.0)
    tips: float = math.radians(2.0)
    moves: float = 0.002
    overrun: float = 0.01
    no_slide: float = 0.01
    no_lift: float = 0.005
    clearance: float = 0.01
    clearance_fragile: float = 0.03
    speed_most: float = 0.12
    aim_position: float = 0.002
    aim_drift: float = 0.005
    aim_angle: float = math.radians(1.0)
    most_pushes: int = 12
    known_to: float = 0.10
    found_to: float = 0.03


DEFAULTS = Defaults()
