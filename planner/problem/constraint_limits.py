"""Constraints of a sentence as limits on contact, force, speed and way of its pushes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from grammar.frames import command as g
from planner.geometry.directions import FACE_OF_PUSH, HEADINGS
from planner.problem.contact_heights import bands
from planner.problem.tilt_goals import almost_tips, spill_tilt
from planner.refusals.push_refusals import NoPlanError, unsupported
from planner.types.refusal import Refusal

if TYPE_CHECKING:
    from planner.problem.push_problem import Asked
    from planner.types.actions import Aim
    from planner.types.defaults import Defaults
    from planner.types.world_state import SeenObject, WorldState


@dataclass(frozen=True)
class Setting:
    """What a constraint is read in.

    Attributes:
        target: the object of the frame.
        state: what is believed.
        defaults: what a clause means when the sentence does not say more.
    """

    target: SeenObject
    state: WorldState
    defaults: Defaults


def restricted(asked: Asked, clause: g.Constraint, setting: Setting) -> Asked:
    """What is asked, with one more constraint.

    Raises:
        NoPlanError: it contradicts the goal, or this version cannot keep it.
    """
    handler = _HANDLERS.get(clause.kind)
    if handler is None:
        what = {
            "duration": "pushing for an exact time",
        }.get(clause.kind, clause.kind.replace("_", " "))
        message = f"this version of the robot is not capable of {what}"
        raise unsupported(what, message, clause.spans)
    return handler(asked, clause, setting)


def _against(message: str, spans: g.Spans) -> NoPlanError:
    return NoPlanError(Refusal(reason="impossible", message=message, spans=spans))


def _limited(asked: Asked, **limits: float) -> Asked:
    """With narrower limits; the narrowest of each holds."""
    before = asked.limits
    least = {name: min(value, getattr(before, name) or math.inf) for name, value in limits.items()}
    return replace(asked, limits=before.model_copy(update=least))


# -- tilting, turning, sliding ----------------------------------------------------------------


def _stays(asked: Asked, clause: g.NoTopple | g.NoTilt | g.MaxTilt, s: Setting) -> Asked:
    """It stays on its base: what slides does, what is tilted comes back, what topples does not."""
    most = {"no_topple": None, "no_tilt": s.defaults.no_tilt}.get(clause.kind)
    if isinstance(clause, g.MaxTilt):
        most = clause.value
    if asked.outcome == "slide":
        return asked if most is None else _limited(asked, tilt=most)
    if asked.tilt is None or clause.kind == "no_tilt":
        raise _against("it cannot topple and stay on its base", clause.spans)
    if most is None:
        return asked
    if most < asked.tilt - s.defaults.tilt_tolerance:
        asks = f"{math.degrees(asked.tilt):.0f}° are asked"
        message = f"{asks}, but {math.degrees(most):.0f}° are the most that is allowed"
        raise _against(message, clause.spans)
    return _limited(asked, tilt=most)


def _stays_there(asked: Asked, clause: g.NoSlide, _: Setting) -> Asked:
    if asked.aims:
        raise _against("it cannot move over the table and not slide", clause.spans)
    return asked


def _heading_kept(asked: Asked, clause: g.NoTurn | g.MaxTurn, s: Setting) -> Asked:
    most = s.defaults.no_turn if isinstance(clause, g.NoTurn) else clause.value
    yaw = s.target.pose.yaw
    turned = [abs(yaw if aim.yaw is None else aim.yaw - yaw) for aim in asked.aims]
    if asked.rotates and min(turned) > most:
        raise _against("it cannot turn and keep its heading", clause.spans)
    return _limited(asked, turn=most)


def _kept(asked: Asked, clause: g.Constraint, s: Setting) -> Asked:
    """Pushes on the table hold it anyhow."""
    return asked


def _until(asked: Asked, clause: g.Until, s: Setting) -> Asked:
    """A push that ends with the object's fall, or with a tilt well before it."""
    if clause.event not in ("tips", "about_to_tip"):
        if not asked.aims:
            what = f"toppling until '{clause.event}'"
            raise unsupported(what, f"this version is not capable of {what}", clause.spans)
        return asked  # the aim is where it happens
    used = tuple(d for d in asked.defaults if d.name != "distance")
    asked = replace(asked, outcome="topple", aims=(), distance=math.inf, defaults=used)
    return asked if clause.event == "tips" else _almost_tipped(asked, s)


def _almost_tipped(asked: Asked, s: Setting) -> Asked:
    return replace(asked, tilt=almost_tips(s.target.model, s.defaults))


# -- contents ---------------------------------------------------------------------------------


def _kept_in(asked: Asked, clause: g.NoSpill, s: Setting) -> Asked:
    """It leans less than what makes its contents run out; what slides upright keeps them."""
    spills = spill_tilt(s.target, s.defaults.sigmas)
    if spills is None:
        return asked
    most = max(spills, s.defaults.rest_tilt)
    if asked.outcome == "slide":
        return _limited(asked, tilt=most)
    tilt = None if asked.tilt is None else asked.tilt + s.defaults.tilt_tolerance
    if tilt is not None and tilt <= spills:
        return _limited(asked, tilt=most)
    does = "toppling tilts it further"
    if asked.tilt is not None:
        does = f"{math.degrees(asked.tilt):.0f}° are asked"
    numbers = {"spill_angle": spills} | ({} if asked.tilt is None else {"tilt": asked.tilt})
    raise NoPlanError(
        Refusal(
            reason="impossible",
            message=f"the {s.target.name} begins to spill at {math.degrees(spills):.0f}°; {does}",
            numbers=numbers,
            spans=clause.spans,
        )
    )


# -- others -----------------------------------------------------------------------------------


def _clear(asked: Asked, clause: g.NoTouch, s: Setting) -> Asked:
    """Objects from which a distance is kept, on the way and by a guard."""
    others = [name for name in s.state.objects if name != s.target.name]
    if clause.object is not None:
        assert clause.object.id is not None, "objects are resolved by now"
        others = [clause.object.id]
    if asked.meets in others:
        raise _against(f"it cannot touch the {asked.meets} and not touch it", clause.spans)
    apart = s.defaults.clearance if clause.clearance is None else clause.clearance
    before = dict(asked.limits.clear_of)
    both = {name: max(apart, before.get(name, 0.0)) for name in others}
    kept = tuple(sorted({**before, **both}.items()))
    return replace(asked, limits=asked.limits.model_copy(update={"clear_of": kept}))


# -- force and speed --------------------------------------------------------------------------


def _force_below(asked: Asked, clause: g.MaxForce | g.Force, _: Setting) -> Asked:
    limit = min(asked.max_force, clause.value)
    return replace(asked, max_force=limit, force_spans=clause.spans)


def _force_above(asked: Asked, clause: g.MinForce, _: Setting) -> Asked:
    return replace(asked, min_force=clause.value, force_spans=clause.spans)


def _hard(asked: Asked, clause: g.Hard, s: Setting) -> Asked:
    return replace(asked, least_limit=s.defaults.force_hard)


def _gentle(asked: Asked, clause: g.Gentle, s: Setting) -> Asked:
    asked = replace(asked, reserve=s.defaults.force_reserve_gentle)
    return _slower(asked, s.defaults.speed_gentle)


def _speed(asked: Asked, clause: g.Constraint, s: Setting) -> Asked:
    d = s.defaults
    match clause:
        case g.MaxSpeed():
            return _slower(asked, clause.value)
        case g.Slow():
            return _slower(asked, d.speed_gentle)
        case g.Fast():
            return _at_speed(asked, d.speed_fast, clause.spans, d)
        case g.Speed() | g.MinSpeed():
            return _at_speed(asked, clause.value, clause.spans, d)
    raise AssertionError(f"{clause.kind} is about no speed")


def _duration(asked: Asked, clause: g.MaxDuration, _: Setting) -> Asked:
    return _limited(replace(asked, time_spans=clause.spans), duration=clause.value)


def _slower(asked: Asked, speed: float) -> Asked:
    """A speed that the sentence gave is no default any more."""
    used = tuple(d for d in asked.defaults if d.name != "speed")
    return replace(asked, speed=min(asked.speed, speed), defaults=used)


def _at_speed(asked: Asked, speed: float, spans: g.Spans, defaults: Defaults) -> Asked:
    if speed > defaults.speed_most:
        raise NoPlanError(
            Refusal(
                reason="impossible",
                message=f"{1e3 * speed:.0f} mm/s are asked; objects keep to the fingertips up to "
                f"{1e3 * defaults.speed_most:.0f} mm/s",
                numbers={"speed": speed, "most": defaults.speed_most},
                spans=spans,
                suggestions=(f"at {100 * defaults.speed_most:.0f} cm/s",),
            )
        )
    used = tuple(d for d in asked.defaults if d.name != "speed")
    return replace(asked, speed=speed, defaults=used)


# -- how far, and where to touch --------------------------------------------------------------


def _nearer(asked: Asked, clause: g.MaxDistance, s: Setting) -> Asked:
    """The limit is kept with the tolerance to spare, if that is still far enough."""
    target, defaults = s.target, s.defaults
    if not asked.aims:
        raise unsupported(
            "limiting how far a toppling object moves",
            "this version does not limit how far an object moves while it topples",
            clause.spans,
        )
    most = clause.value - min(defaults.distance_tolerance, 0.5 * clause.value)
    start = target.pose.x, target.pose.y
    way = {aim: math.dist((aim.x, aim.y), start) for aim in asked.aims}
    aims = tuple(
        _shortened(aim, start, min(1.0, most / max(way[aim], 1e-9)))
        for aim in asked.aims
        if way[aim] - defaults.distance_tolerance <= most
    )
    if not aims:
        nearest = min(way.values())
        message = (
            f"{1e3 * nearest:.0f} mm are to be moved, but {1e3 * clause.value:.0f} mm "
            "are the most that is allowed"
        )
        numbers = {"distance": nearest, "max_distance": clause.value}
        raise NoPlanError(
            Refusal(reason="impossible", message=message, numbers=numbers, spans=clause.spans)
        )
    return replace(asked, aims=aims, distance=min(asked.distance, most))


def _shortened(aim: Aim, start: tuple[float, float], share: float) -> Aim:
    """An aim that lies only a share of the way from a start."""
    x, y = (a + share * (b - a) for a, b in zip(start, (aim.x, aim.y), strict=True))
    return aim.model_copy(update={"x": x, "y": y})


def _contact(asked: Asked, clause: g.ContactRegion, s: Setting) -> Asked:
    spans = asked.contact_spans + clause.spans
    if clause.face == "top":
        raise unsupported(
            "pushing on the top face",
            "this robot pushes objects on their side faces; the top face is not one",
            clause.spans,
            "say “at the top” for the upper third of a side face",
        )
    if clause.face is not None:
        asked = replace(asked, face=clause.face)
        if asked.outcome == "topple" and asked.heading is None:
            push = next(d for d, face in FACE_OF_PUSH.items() if face == clause.face)
            asked = replace(asked, heading=HEADINGS[push])
    for low, high, region in bands(clause, s.target.model.top, s.defaults):
        asked = _between(asked, low, high, region)
    return replace(asked, contact_spans=spans)


def _between(asked: Asked, low: float, high: float, region: str) -> Asked:
    """One more restriction of the heights; all of them hold."""
    region = f"{asked.region} and {region}" if asked.region else region
    return replace(asked, low=max(asked.low, low), high=min(asked.high, high), region=region)


def require_right(clause: g.Effector) -> None:
    """The robot has no left hand.

    Raises:
        NoPlanError: it is asked for.
    """
    if clause.side == "left":
        raise unsupported(
            "a second (left) hand",
            "this robot has one hand, a right one",
            clause.spans,
            "leave out which hand, or say the right one",
        )


def _effector(asked: Asked, clause: g.Effector, _: Setting) -> Asked:
    require_right(clause)
    if clause.tool == "arm" or (clause.tool == "hand" and clause.side is None):
        raise unsupported(
            f"pushing with the {clause.tool}",
            f"this robot pushes with its fingertips, not with the {clause.tool}",
            clause.spans,
            "say “with one finger” or “with two fingers”",
        )
    if clause.tool == "finger" and clause.count is not None:
        if clause.count > 2:
            raise unsupported(
                f"pushing with {clause.count} fingers",
                "this robot pushes with one or two fingertips",
                clause.spans,
            )
        return replace(
            asked,
            fingers=(2,) if clause.count == 2 else (1,),
            contact_spans=(*asked.contact_spans, *clause.spans),
        )
    return asked


_HANDLERS: dict[str, Callable[[Asked, Any, Setting], Asked]] = {
    "no_topple": _stays,
    "no_tilt": _stays,
    "max_tilt": _stays,
    "no_slide": _stays_there,
    "no_turn": _heading_kept,
    "max_turn": _heading_kept,
    "no_spill": _kept_in,
    "no_lift": _kept,
    "no_touch": _clear,
    "max_force": _force_below,
    "force": _force_below,
    "min_force": _force_above,
    "hard": _hard,
    "gentle": _gentle,
    "slow": _speed,
    "fast": _speed,
    "speed": _speed,
    "min_speed": _speed,
    "max_speed": _speed,
    "max_duration": _duration,
    "max_distance": _nearer,
    "contact": _contact,
    "effector": _effector,
    "until": _until,
}
