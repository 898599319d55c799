"""Meaning of a clause when the sentence does not say more: the one table of defaults.

Results name each default that they used. Values are SI, but for people who set them (`Setting`).
"""

from __future__ import annotations

import difflib
import inspect
import math
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Annotated, Any, get_type_hints

from objectmodels.errors import NlcontrolError


@dataclass(frozen=True)
class Kind:
    """Unit of a default, and the values between which it lies.

    Attributes:
        unit: SI unit; "" for a plain number.
        suffix: of its name where people set it.
        scale: SI units in one unit of theirs.
        most: the largest value.
        zero: whether it may be 0.
        whole: whether it counts something.
        words: for the values 0, 1, …, which people may set instead.
    """

    unit: str
    suffix: str
    scale: float
    most: float
    zero: bool = False
    whole: bool = False
    words: tuple[str, ...] = ()


DEGREE = math.radians(1.0)
LISTED = ("nlcontrol defaults lists all with their units",)

Length = Annotated[float, Kind("m", "_m", 1.0, 10.0)]
Gap = Annotated[float, Kind("m", "_m", 1.0, 10.0, zero=True)]
Angle = Annotated[float, Kind("rad", "_deg", DEGREE, math.tau)]
Rate = Annotated[float, Kind("rad/s", "_deg_s", DEGREE, math.tau)]
Volume = Annotated[float, Kind("m³", "_ml", 1e-6, 1e-2)]
Force = Annotated[float, Kind("N", "_n", 1.0, 1000.0)]
Speed = Annotated[float, Kind("m/s", "_m_s", 1.0, 10.0)]
Time = Annotated[float, Kind("s", "_s", 1.0, 1000.0)]
Share = Annotated[float, Kind("", "", 1.0, 1.0)]
Probability = Annotated[float, Kind("", "", 1.0, 0.9999)]
Count = Annotated[int, Kind("", "", 1.0, 1000.0, whole=True)]
Work = Annotated[int, Kind("", "", 1.0, 1e6, whole=True)]
Factor = Annotated[float, Kind("", "", 1.0, 10.0)]

CLEARED = ("no", "ask", "yes")
"""Whether what stands in the way is moved aside, by the value of `Defaults.clear`."""

Choice = Annotated[int, Kind("", "", 1.0, len(CLEARED) - 1, zero=True, whole=True, words=CLEARED)]


class DefaultsError(NlcontrolError, ValueError):
    """A default that is none, or that has no sensible value.

    Attributes:
        code: `bad_default`.
        message: what is wrong.
        suggestions: what would be right.
    """

    code = "bad_default"

    def __init__(self, message: str, suggestions: tuple[str, ...] = LISTED) -> None:
        super().__init__(message)
        self.message = message
        self.suggestions = suggestions


def out_of_range(name: str, value: float, kind: Kind) -> DefaultsError:
    """The error of a value, in the unit in which people give it."""
    least = "at least 0" if kind.zero else "more than 0"
    return DefaultsError(
        f"{name} must be {least} and at most {kind.most / kind.scale:g}, found {value:g}"
    )


def value_of_word(value: object, words: tuple[str, ...]) -> Any:
    """The number of a word; YAML reads "yes" and "no" as truth values."""
    word = {True: "yes", False: "no"}[value] if isinstance(value, bool) else value
    return words.index(word) if isinstance(word, str) and word in words else value


@dataclass(frozen=True)
class Defaults:
    """Distances, speeds, margins and tolerances.

    Raises:
        DefaultsError: a value is out of its range.

    Attributes:
        distance: of "away" and the other directions, if none is said [m].
        distance_little: of "a little" [m].
        distance_lot: of "a lot" [m].
        tolerance_share: most of an amount that is asked that its tolerance may be.
        exactly: share of a tolerance that is left of it where "exactly" is said.
        distance_tolerance: of a bare distance, along the direction [m].
        direction_tolerance: between the asked and the travelled direction [rad].
        rest_tilt: an object tilted by less than this stands on its base [rad].
        no_topple_share: `no_topple` holds while the tilt stays below this share of the angle of
            no return.
        no_turn: `no_turn` holds while the object turns by less than this [rad].
        no_tilt: `no_tilt` holds while the object tilts by less than this [rad].
        no_spill: `no_spill` holds while less than this share of the contents is spilled.
        toppled: an object that ends tilted by more than this has toppled [rad].
        speed: of a push [m/s].
        speed_gentle: of a gentle push [m/s].
        force_reserve: share by which the force limit exceeds the largest force needed.
        force_reserve_gentle: the same for a gentle push.
        sigmas: standard deviations that a worst case takes.
        probability: the least probability of the wanted outcome that a plan may have.
        probability_on: the same of what is left of it once its first push is made.
        drag_probability: the same of a fingertip that presses from above and draws something along;
            where it slips over it instead, that is seen, and ends the push.
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
        overhang: of an object over the table's edge, if it is not said how far [m].
        overhang_tolerance: of an overhang [m].
        overhang_sd: standard deviation with which a drag ends over the table's edge [m].
        centre_tolerance: of the middle of the table [m].
        clear_tolerance: of a distance that is kept from another object, between shapes [m].
        in_line_tolerance: between two objects that are in line [m].
        tap: the farthest that an object is to go when it is only touched [m].
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
        push_overhead: time of a push beside its way at full speed: until it moves, and braking [s].
        aim_position: an object this near to where it should be is there [m].
        aim_drift: the same of one that is turned on the spot [m].
        aim_angle: an object turned by less than this from how it should look is there [rad].
        lift_height: of a lift, if none is said [m].
        lift_little: of "a little" [m].
        lift_lot: of "a lot" [m].
        grasp_reserve: factor by which a squeeze exceeds the one that just holds.
        grasp_reserve_gentle: the same of a gentle one.
        carry_speed: of the hand while it holds something [m/s].
        carry_speed_gentle: the same of a gentle or slow one [m/s].
        carry_clearance: height of what is carried over the table and over what it passes [m].
        upright: what is held counts as upright while it tilts by less than this [rad].
        pour_rate: of tilting while it is poured [rad/s].
        pour_clearance: of the lip over the rim of what is poured into [m].
        pour_wait: with the largest tilt, after all has run out [s].
        pour_little: volume of "a little" [m³].
        pour_lot: share of what can be poured that is "a lot".
        pour_fill: share of its volume up to which something is filled that is to be full.
        pour_aim: standard deviation of where a stream lands [m].
        pour_tolerance: of a volume that is said, as a share of what was in it.
        pour_all: share of what is poured that is everything.
        spill_tolerance: share of what is poured that may miss.
        lid_open: angle to which a flip lid is opened [rad].
        lid_opened: a flip lid that is open by more than this is open [rad].
        lid_closed: a flip lid that is open by less than this is closed [rad].
        lid_speed: of the fingertip that moves a lid [m/s].
        lid_reserve: factor by which a standing object must resist what opens its lid.
        lid_press: force with which a lid is put on [N].
        most_grasps: grasps of each kind for which one plan asks whether the hand gets there.
        most_tries: times that a whole hand tries what failed, before it is given up.
        lift_tolerance: of the height to which something is lifted [m].
        clear: what stands in the way and is not fragile is moved aside: 0 (`no`), never; 1 (`ask`),
            never, but the refusal says how; 2 (`yes`), and the plan says so.
        room: that is kept around what is to have room [m].
        aside: way of what is moved aside [m].
        stays_put: what stands by itself while a hand works on it, or pours into it, moves by less
            than this [m].
        pour_least: share of what was to be poured in that must arrive, if no volume is said.
        pour_share: by which the volume that arrives may differ from one that is said.
        pour_margin: the same as a volume; the larger of the two counts [m³].
        most_contacts: of a push with as many fingers for which it is asked if the hand gets there.
        most_contacts_last: the same before it is refused that the hand gets there.
        most_looks: pushes for which one plan asks whether the hand gets there.
        most_looks_last: the same once more before it is refused that the hand gets there.
        most_work: work of one plan; a quiet core does four thousand in about a second.
        most_pushes: pushes made for one frame before it is given up.
        known_to: relative standard deviation up to which a question is answered without touching.
        found_to: relative standard deviation to which a property is found out by touching.
    """

    distance: Length = 0.10
    distance_little: Length = 0.05
    distance_lot: Length = 0.20
    tolerance_share: Share = 1.0 / 3.0
    exactly: Share = 0.5
    distance_tolerance: Length = 0.01
    direction_tolerance: Angle = 10.0 * DEGREE
    rest_tilt: Angle = 2.0 * DEGREE
    no_topple_share: Share = 0.5
    no_turn: Angle = 10.0 * DEGREE
    no_tilt: Angle = 5.0 * DEGREE
    no_spill: Share = 0.01
    toppled: Angle = 60.0 * DEGREE
    speed: Speed = 0.05
    speed_gentle: Speed = 0.02
    force_reserve: Factor = 0.5
    force_reserve_gentle: Factor = 0.25
    sigmas: Factor = 2.0
    probability: Probability = 0.95
    probability_on: Probability = 0.85
    drag_probability: Probability = 0.8
    speed_fast: Speed = 0.10
    force_hard: Force = 8.0
    force_tolerance: Force = 0.3
    speed_tolerance: Speed = 0.005
    duration_tolerance: Time = 0.25
    height_tolerance: Length = 0.005
    side_tolerance: Angle = 45.0 * DEGREE
    place_gap: Gap = 0.03
    place_gap_tolerance: Length = 0.02
    place_tolerance: Length = 0.01
    place_aside: Share = 0.5
    between_tolerance: Length = 0.03
    touching_gap: Gap = 0.003
    edge_gap: Gap = 0.05
    edge_tolerance: Length = 0.02
    overhang: Length = 0.03
    overhang_tolerance: Length = 0.01
    overhang_sd: Length = 0.004
    centre_tolerance: Length = 0.05
    clear_tolerance: Gap = 0.002
    in_line_tolerance: Length = 0.01
    tap: Length = 0.005
    turn: Angle = 90.0 * DEGREE
    turn_little: Angle = 15.0 * DEGREE
    turn_lot: Angle = 180.0 * DEGREE
    turn_tolerance: Angle = 3.0 * DEGREE
    turn_drift: Length = 0.01
    tilt: Angle = 10.0 * DEGREE
    tilt_little: Angle = 5.0 * DEGREE
    tilt_lot: Share = 0.47
    tilt_tolerance: Angle = 2.0 * DEGREE
    tips: Angle = 2.0 * DEGREE
    moves: Length = 0.002
    overrun: Length = 0.01
    no_slide: Length = 0.01
    no_lift: Length = 0.005
    clearance: Gap = 0.01
    clearance_fragile: Gap = 0.03
    speed_most: Speed = 0.12
    push_overhead: Time = 4.5
    aim_position: Length = 0.002
    aim_drift: Length = 0.005
    aim_angle: Angle = 1.0 * DEGREE
    lift_height: Length = 0.10
    lift_little: Length = 0.03
    lift_lot: Length = 0.20
    grasp_reserve: Factor = 1.5
    grasp_reserve_gentle: Factor = 1.2
    carry_speed: Speed = 0.10
    carry_speed_gentle: Speed = 0.04
    carry_clearance: Length = 0.03
    upright: Angle = 10.0 * DEGREE
    pour_rate: Rate = 20.0 * DEGREE
    pour_clearance: Length = 0.03
    pour_wait: Time = 1.0
    pour_little: Volume = 5e-5
    pour_lot: Share = 0.75
    pour_fill: Share = 0.9
    pour_aim: Length = 0.006
    pour_tolerance: Share = 0.05
    pour_all: Share = 0.9
    spill_tolerance: Share = 0.02
    lid_open: Angle = 90.0 * DEGREE
    lid_opened: Angle = 80.0 * DEGREE
    lid_closed: Angle = 5.0 * DEGREE
    lid_speed: Speed = 0.05
    lid_reserve: Factor = 1.1
    lid_press: Force = 3.0
    most_grasps: Count = 120
    most_tries: Count = 3
    lift_tolerance: Length = 0.02
    clear: Choice = 2
    room: Length = 0.10
    aside: Length = 0.20
    stays_put: Length = 0.01
    pour_least: Share = 0.9
    pour_share: Share = 0.1
    pour_margin: Volume = 1e-5
    most_contacts: Count = 6
    most_contacts_last: Count = 24
    most_looks: Count = 100
    most_looks_last: Count = 300
    most_work: Work = 11_500
    most_pushes: Count = 12
    known_to: Share = 0.10
    found_to: Share = 0.03

    def __post_init__(self) -> None:
        for name, kind in kinds().items():
            value = getattr(self, name)
            if not (0.0 < value <= kind.most or (kind.zero and value == 0.0)):
                raise out_of_range(name + kind.suffix, value / kind.scale, kind)

    def tolerance_of(self, amount: float, most: float, bound: str = "exact") -> float:
        """Tolerance of an amount that is asked, in its unit; a bound has none.

        It never reaches nothing at all, which is no amount.

        Args:
            amount: that is asked.
            most: the tolerance of large amounts.
            bound: whether `amount` is meant as it is, or as a bound.
        """
        left = {"exact": 1.0, "exactly": self.exactly}.get(bound, 0.0)
        return left * min(most, self.tolerance_share * abs(amount))

    def least_amount(self, aim: float, bound: str = "exact") -> float:
        """The least amount that is told from nothing: its tolerance is all that is aimed to.

        Args:
            aim: how near to what is asked the robot brings an object, in the unit of the amount.
            bound: as of `tolerance_of`.
        """
        return aim / (self.tolerance_share * (self.exactly if bound == "exactly" else 1.0))


@cache
def kinds() -> dict[str, Kind]:
    """Unit of each default, by its name."""
    hints = get_type_hints(Defaults, include_extras=True)
    return {field.name: hints[field.name].__metadata__[0] for field in fields(Defaults)}


DEFAULTS = Defaults()


@dataclass(frozen=True)
class Setting:
    """One default as people set it.

    Attributes:
        name: with its unit.
        value: in that unit.
        most: largest value, in that unit.
        zero: whether it may be 0.
        meaning: in words.
    """

    name: str
    value: float
    most: float
    zero: bool
    meaning: str


def settings(defaults: Defaults = DEFAULTS) -> tuple[Setting, ...]:
    """Every default in the order of the table."""
    meanings = _default_meanings()
    return tuple(
        Setting(
            name=name + kind.suffix,
            value=_value_as_set(getattr(defaults, name), kind),
            most=_value_as_set(kind.most, kind),
            zero=kind.zero,
            meaning=meanings.get(name, ""),
        )
        for name, kind in kinds().items()
    )


def settings_beginning(names: Sequence[str], defaults: Defaults = DEFAULTS) -> tuple[Setting, ...]:
    """The defaults whose names begin so; raises `DefaultsError` if one does not."""
    listed = settings(defaults)
    for said in names:
        if not any(each.name.startswith(said) for each in listed):
            raise _unknown_default(said, tuple(each.name for each in listed))
    return tuple(each for each in listed if each.name.startswith(tuple(names)))


def with_settings(defaults: Defaults, values: Mapping[str, float | str]) -> Defaults:
    """The defaults with some of them set.

    Args:
        defaults: that are changed.
        values: by the names and in the units of `Setting`.

    Raises:
        DefaultsError: there is no such default, or the value is out of its range.
    """
    known = {name + kind.suffix: (name, kind) for name, kind in kinds().items()}
    found: dict[str, Any] = {}
    for said, given in values.items():
        if said not in known:
            raise _unknown_default(said, tuple(known))
        name, kind = known[said]
        value = value_of_word(given, kind.words) if kind.words else given
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise DefaultsError(f"{said} must be a number, found {value!r}")
        number = math.inf if abs(value) > sys.float_info.max else float(value)
        if not 0.0 <= number <= kind.most / kind.scale:
            raise out_of_range(said, number, kind)
        if kind.whole and number % 1.0:
            raise DefaultsError(f"{said} must be a whole number, found {value:g}")
        found[name] = int(value) if kind.whole else number * kind.scale
    return replace(defaults, **found)


def _unknown_default(said: str, names: tuple[str, ...]) -> DefaultsError:
    """The error of a name that is none; most often its unit is missing."""
    units = [
        name for name in names if re.fullmatch(rf"{re.escape(said)}_(m|deg|n|m_s|deg_s|ml|s)", name)
    ]
    close = units or difflib.get_close_matches(said, names, n=3)
    return DefaultsError(
        f"there is no default '{said}'",
        tuple(f"did you mean '{name}'?" for name in close) or LISTED,
    )


def _value_as_set(value: float, kind: Kind) -> float:
    """A value in the unit in which it is set, without the rounding of the way there and back."""
    return float(f"{value / kind.scale:.10g}")


def _default_meanings() -> dict[str, str]:
    """Meaning of each default, from the one place where that is said."""
    text = inspect.cleandoc(Defaults.__doc__ or "")
    found = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", text, re.MULTILINE)
    unit = re.compile(r"\s*\[[^]]*\]")
    return {name: unit.sub("", " ".join(said.split())).rstrip(".") for name, said in found}
