"""Affordances of an object for this robot, and the reasons of what it cannot do.

For each way of moving it (slide or topple to a side, tilt, turn) two answers: what the object
allows, from its model (from which face, at what least force, where it is sure), and what the robot
can do, which is whether the planner makes a plan for it. For what a whole hand does with it (lift
it, stand it up, open or close its lid, pour from it) the planner alone is asked.

Frames: contacts are places on a face of B; directions are the robot's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grammar.frames import command as g
from objectmodels import Face
from objectmodels.geometry.rotations import cross
from objectmodels.mechanics.outcome_map import OutcomeMap, outcome_map
from planner.planning import plan
from planner.problem.directions import HEADINGS, angle_between, face_name, heading_of
from planner.types.actions import FaceName
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.refusal import Refusal, probability_text
from planner.types.robot import Robot
from planner.types.world_state import SeenObject, WorldState

SPACING = 0.01
"""Distance of the contacts that are looked at [m]."""

TURNING_ARM = 0.25
"""A push turns an object if its arm is at least this share of the friction radius."""


@dataclass(frozen=True)
class Affordance:
    """One thing that may be done with an object.

    Attributes:
        outcome: `slide`, `topple`, `tilt`, `turn`, `lift`, `stand`, `open`, `close` or `pour`.
        direction: `away`, `toward`, `left`, `right` (for `turn`: which way it turns); empty for
            what a whole hand does.
        face: face that is pushed, as the robot calls it; None if there is none.
        possible: whether any contact on that face has this outcome at the onset.
        least_force: smallest force at which it begins, nominal [N].
        place: where that is, (lateral, height) on the face [m].
        heights: lowest and highest contact at which the outcome has the default probability [m];
            None if it is sure nowhere.
        can: whether this robot can do it now.
        reason: why not: a reason of a refusal, or `impossible` for the object.
        message: the same in words; what the plan is if it can.
        suggestions: what would be possible instead.
    """

    outcome: str
    direction: str
    face: str | None
    possible: bool
    least_force: float | None
    place: tuple[float, float] | None
    heights: tuple[float, float] | None
    can: bool
    reason: str | None
    message: str
    suggestions: tuple[str, ...] = ()


def affordances(
    target: SeenObject,
    state: WorldState,
    robot: Robot,
    *,
    defaults: Defaults = DEFAULTS,
) -> tuple[Affordance, ...]:
    """Ways of moving an object of a state, each with what object and robot allow."""
    pushed = tuple(_push_affordances(target, state, robot, defaults))
    if robot.limits.grasp_widths is None:
        return pushed
    return (*pushed, *hand_affordances(target, state, robot, defaults))


def hand_affordances(
    target: SeenObject, state: WorldState, robot: Robot, defaults: Defaults
) -> Iterator[Affordance]:
    """Affordances for a whole hand: of what lies, of a lid and of contents if there are any."""
    model, ref = target.model, g.ObjectRef(text=target.name, id=target.name)
    frames = [g.Frame(action="lift", object=ref, goal=g.Lift())]
    if target.lies_on != "bottom":
        frames.append(g.Frame(action="place", object=ref, goal=g.Upright()))
    if model.lid is not None:
        frames.append(g.Frame(action="open", object=ref, goal=g.Open()))
        frames.append(g.Frame(action="close", object=ref, goal=g.Close()))
    if model.container is not None and model.container.contents > 0.0:
        frames += [
            g.Frame(action="pour", object=ref, goal=g.Pour(into=g.ObjectRef(text=name, id=name)))
            for name, seen in state.objects.items()
            if name != target.name and seen.model.container is not None
        ][:1]
    for frame in frames:
        made = plan(frame, state, robot, defaults=defaults)
        none = None, True, None, None, None
        assert frame.action is not None
        outcome = "stand" if isinstance(frame.goal, g.Upright) else frame.action
        if isinstance(made, Refusal):
            yield Affordance(outcome, "", *none, False, made.reason, made.message, made.suggestions)
        elif made.status == "planned":
            told = f"probability {probability_text(made.probability)}"
            if made.grasp is not None:
                told = f"squeezed with {made.grasp.squeeze:.1f} N, {told}"
            yield Affordance(outcome, "", *none, True, None, told)


def _push_affordances(
    target: SeenObject, state: WorldState, robot: Robot, defaults: Defaults
) -> Iterator[Affordance]:
    found = {way: pushed_face(target, heading) for way, heading in HEADINGS.items()}
    faces = {way: face for way, face in found.items() if face is not None}
    if not faces:
        message = f"the {target.name} has no side that is wide enough for a fingertip"
        none = False, None, None, None, False, "impossible", message
        yield from (Affordance("slide", way, None, *none) for way in HEADINGS)
        return
    straight = {
        way: outcome_map(target.model, face, spacing=SPACING, turning=False)
        for way, (_, face) in faces.items()
    }
    for outcome in ("slide", "topple", "tilt"):
        for way, chart in straight.items():
            slides = outcome == "slide"
            first = chart.slide < chart.topple if slides else chart.topple < chart.slide
            sure = chart.is_safe("slide" if slides else "topple", defaults.probability)
            on_it = _place_and_heights(chart, first, sure)
            yield _push_affordance(
                outcome, way, faces[way][0], on_it, target, state, robot, defaults
            )
    for sense in ("left", "right"):
        name, on_it = _best_turning_face(target, faces, sense, defaults.probability)
        yield _push_affordance("turn", sense, name, on_it, target, state, robot, defaults)


def pushed_face(target: SeenObject, heading: float) -> tuple[FaceName, Face] | None:
    """The face that a push along a heading in W [rad] touches, with its name; None without one."""
    outward = [
        (target.pose.R_WB @ np.array(face.normal), face)
        for face in target.model.faces(np.array([heading - target.pose.yaw]))
    ]
    if not outward:
        return None
    normal, face = min(outward, key=lambda pair: abs(angle_between(heading_of(-pair[0]), heading)))
    return face_name(normal)[0], face


Shown = tuple[float, tuple[float, float], tuple[float, float] | None]
"""Least force [N], its place, and the sure heights [m]."""


def turning_map(
    target: SeenObject, face: Face, sense: str | None = None
) -> tuple[OutcomeMap, NDArray[np.bool_]]:
    """Outcomes over a face of an object that may turn, and where a slide turns it."""
    chart = outcome_map(target.model, face, spacing=SPACING)
    arm = cross(chart.points - np.array(target.model.com), chart.directions)
    turned = {"left": arm, "right": -arm, None: np.abs(arm)}[sense]
    return chart, turned > TURNING_ARM * target.model.friction_radius


def least(chart: OutcomeMap, places: NDArray[np.bool_]) -> int | None:
    """The contact of the least force among some, by its index; None if there is none.

    Of equal forces it is the one nearest to the middle of the face, aside before up and down.
    """
    (i,) = np.nonzero(places & np.isfinite(chart.force))
    if not i.size:
        return None
    aside = np.abs(chart.lateral[i]).round(6)
    up = np.abs(chart.height[i] - chart.face.centre[2]).round(6)
    return int(i[np.lexsort((up, aside, chart.force[i].round(6)))[0]])


def _place_and_heights(
    chart: OutcomeMap, first: NDArray[np.bool_], sure: NDArray[np.bool_]
) -> Shown | None:
    best = least(chart, first)
    if best is None:
        return None
    certain = chart.height[sure]
    heights = (float(certain.min()), float(certain.max())) if certain.size else None
    return (
        float(chart.force[best]),
        (float(chart.lateral[best]), float(chart.height[best])),
        heights,
    )


def _best_turning_face(
    target: SeenObject, faces: dict[str, tuple[FaceName, Face]], sense: str, probability: float
) -> tuple[str | None, Shown | None]:
    """The face on which the least force turns the object, and what it needs there."""
    best: tuple[str | None, Shown | None] = (None, None)
    for name, face in faces.values():
        chart, turns = turning_map(target, face, sense)
        sure = turns & chart.is_safe("slide", probability)
        found = _place_and_heights(chart, turns & (chart.slide < chart.topple), sure)
        if found is not None and (best[1] is None or found[0] < best[1][0]):
            best = name, found
    return best


def _push_affordance(
    outcome: str,
    way: str,
    face: str | None,
    on_it: Shown | None,
    target: SeenObject,
    state: WorldState,
    robot: Robot,
    defaults: Defaults,
) -> Affordance:
    """Affordance of one way: what the object allows, and what the robot can do."""
    if on_it is None:
        verb = {"slide": "slides", "turn": "turns"}.get(outcome, "topples")
        message = f"pushed anywhere on that face, the {target.name} never {verb} first"
        return Affordance(outcome, way, face, False, None, None, None, False, "impossible", message)
    made = plan(_command_frame(outcome, way, target.name), state, robot, defaults=defaults)
    if made.status == "planned":
        push = made.push
        fingers = "two fingers" if push.fingers == 2 else "one finger"
        several = len(made.pushes) > 1
        pushes = f"{len(made.pushes)} pushes, first " if several else ""
        message = (
            f"{pushes}{fingers} {1e3 * push.p_BC[2]:.0f} mm up, at most {push.force_limit:.1f} N, "
            f"probability {probability_text(made.probability)}"
        )
        return Affordance(outcome, way, face, True, *on_it, True, None, message)
    assert isinstance(made, Refusal), "a goal of its own is never reached beforehand"
    return Affordance(
        outcome, way, face, True, *on_it, False, made.reason, made.message, made.suggestions
    )


def _command_frame(outcome: str, way: str, name: str) -> g.Frame:
    """Frame of the sentence that asks for it."""
    ref = g.ObjectRef(text=name, id=name)
    if outcome == "slide":
        goal = g.Displace.model_validate({"direction": way})
        return g.Frame(action="push", object=ref, goal=goal, constraints=(g.NoTopple(),))
    if outcome == "topple":
        return g.Frame(
            action="topple", object=ref, goal=g.Topple.model_validate({"direction": way})
        )
    if outcome == "tilt":
        return g.Frame(action="tilt", object=ref, goal=g.Tilt.model_validate({"direction": way}))
    sense = "ccw" if way == "left" else "cw"
    return g.Frame(action="turn", object=ref, goal=g.Rotate.model_validate({"sense": sense}))


# How much of what a frame asks can be done: the largest amount of its goal that has a plan.
#
# What has a plan is taken to have one for less as well. First comes what people mean if they say
# no amount. It is doubled while there is a plan; if there is none, the least amount decides
# whether to look on. What lies between an amount that has a plan and one that has none is then
# bracketed.

_POURED_TO = DEFAULTS.tolerance_share * DEFAULTS.pour_margin  # so that the margin is the least

UNITS: dict[str, tuple[str, Callable[[int], float], float, float]] = {
    "displace": ("distance", lambda cm: cm / 100, DEFAULTS.distance, DEFAULTS.aim_position),
    "place": ("distance", lambda cm: cm / 100, DEFAULTS.distance_lot, DEFAULTS.aim_position),
    "lift": ("height", lambda cm: cm / 100, DEFAULTS.lift_height, DEFAULTS.aim_position),
    "rotate": ("angle", math.radians, DEFAULTS.turn, DEFAULTS.aim_angle),
    "tilt": ("angle", math.radians, DEFAULTS.tilt, DEFAULTS.aim_angle),
    "pour": ("volume", lambda cl: cl / 100_000, DEFAULTS.pour_little, _POURED_TO),
}
"""Field of a goal that says how much, by its kind, how many of the units in which people say that
are how much, a usual amount, and to what the robot does it [SI]."""


def frame_with_less(frame: g.Frame, is_planned: Callable[[g.Frame], bool]) -> g.Frame | None:
    """The frame with a smaller amount that has a plan; None if none is found.

    Args:
        frame: what is asked.
        is_planned: whether a frame has a plan.
    """
    if frame.goal.kind not in UNITS:
        return None
    name, amount, usual, aim = UNITS[frame.goal.kind]
    asked = getattr(frame.goal, name)
    if not isinstance(asked, float):
        return None

    def with_amount(units: int) -> g.Frame:
        return frame.model_copy(
            update={"goal": frame.goal.model_copy(update={name: amount(units)})}
        )

    most = math.ceil(asked / amount(1) - 1e-9)
    least = min(round(usual / amount(1)), most // 2)
    # Less cannot be told from nothing, and is refused.
    first = math.ceil(DEFAULTS.least_amount(aim) / amount(1) - 1e-9)
    if least < first:
        return None
    if is_planned(with_amount(least)):
        while 2 * least < most and is_planned(with_amount(2 * least)):
            least *= 2
        most = min(most, 2 * least)
    elif least > first and is_planned(with_amount(first)):
        least, most = first, least
    else:
        return None
    # Times that the bracket is halved by its ratio: between n and 2 n, to a fifth of the most.
    for _ in range(2):
        middle = round(math.sqrt(least * most))
        if not least < middle < most:
            break
        least, most = (middle, most) if is_planned(with_amount(middle)) else (least, middle)
    return with_amount(least)
