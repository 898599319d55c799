"""Constraints of a sentence as limits on how a hand holds, carries, pours and opens.

What is held is held upright and keeps its heading, so most of what a sentence forbids holds anyhow;
what this version cannot keep is refused by the words that ask for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from grammar.frames import command as g
from objectmodels.models.object_parts import FlipLid
from planner.problem import constraint_limits as restrictions
from planner.problem.constraint_limits import require_right
from planner.problem.contact_heights import bands
from planner.refusals.push_refusals import NoPlanError, unsupported
from planner.types.plan import DefaultUsed
from planner.types.refusal import Refusal


@dataclass(frozen=True)
class Manner:
    """How something is to be handled.

    Attributes:
        speed: largest speed of the hand while it holds something [m/s].
        lid_speed: of a fingertip that moves a lid [m/s].
        reserve: factor by which a squeeze exceeds the one that just holds.
        most_force: largest squeeze, or force of a fingertip [N]; inf if not said.
        force_spans: words that limit it.
        low, high: heights between which it may be held [m].
        region: words for those heights, if the sentence restricts them.
        contact_spans: words that restrict them.
        clear_of: other objects, and the distance that is kept from each of them [m].
        upright: words that forbid to tilt it; empty if none do.
        on_the_table: words that forbid to lift it; empty if none do.
        defaults: what the sentence left open.
    """

    speed: float
    lid_speed: float
    reserve: float
    most_force: float = math.inf
    force_spans: g.Spans = ()
    low: float = 0.0
    high: float = math.inf
    region: str | None = None
    contact_spans: g.Spans = ()
    clear_of: tuple[tuple[str, float], ...] = ()
    upright: g.Spans = ()
    on_the_table: g.Spans = ()
    defaults: tuple[DefaultUsed, ...] = field(default=())


@dataclass(frozen=True)
class Setting(restrictions.Setting):
    """What a constraint is read in.

    Attributes:
        doing: what is done, such as `lifting`.
    """

    doing: str


def manner(frame: g.Frame, setting: Setting) -> Manner:
    """How the constraints of a frame want it handled.

    Raises:
        NoPlanError: this version cannot keep one of them.
    """
    d = setting.defaults
    used = DefaultUsed(name="carry_speed", value=d.carry_speed, unit="m/s", reason="no speed said")
    found = Manner(d.carry_speed, d.lid_speed, d.grasp_reserve, defaults=(used,))
    for clause in frame.constraints:
        handler = _HANDLERS.get(clause.kind)
        if handler is None:
            raise _not_so(_WORDS[clause.kind], clause, setting)
        found = handler(found, clause, setting)
    return found


def _not_so(what: str, clause: g.Constraint, s: Setting) -> NoPlanError:
    message = f"this version of the robot is not capable of {what} while {s.doing}"
    return unsupported(f"{what} while {s.doing}", message, clause.spans, "leave that out")


_WORDS = {
    "hard": "using much force",
    "min_force": "pressing with a least force",
    "fast": "moving fast",
    "max_duration": "keeping to a time",
    "duration": "keeping to a time",
    "max_distance": "limiting a distance",
    "until": "stopping at an event",
}
"""What a sentence asks for that no hand of this version does."""


def _kept(found: Manner, clause: g.Constraint, _: Setting) -> Manner:
    """What stands stays on its base, and what is held keeps its heading."""
    return found


def _upright(found: Manner, clause: g.NoTilt | g.MaxTilt, s: Setting) -> Manner:
    if isinstance(clause, g.MaxTilt) and clause.value < s.defaults.upright:
        least = math.degrees(s.defaults.upright)
        raise _not_so(f"keeping it within less than {least:.0f}° of upright", clause, s)
    return replace(found, upright=found.upright + clause.spans)


def _on_the_table(found: Manner, clause: g.NoLift, _: Setting) -> Manner:
    return replace(found, on_the_table=found.on_the_table + clause.spans)


def _clear(found: Manner, clause: g.NoTouch, s: Setting) -> Manner:
    others = [name for name in s.state.objects if name != s.target.name]
    if clause.object is not None:
        assert clause.object.id is not None, "objects are resolved by now"
        others = [clause.object.id]
    apart = s.defaults.clearance if clause.clearance is None else clause.clearance
    before = dict(found.clear_of)
    both = {name: max(apart, before.get(name, 0.0)) for name in others}
    return replace(found, clear_of=tuple(sorted({**before, **both}.items())))


def _force(found: Manner, clause: g.MaxForce | g.Force, _: Setting) -> Manner:
    spans = found.force_spans + clause.spans
    return replace(found, most_force=min(found.most_force, clause.value), force_spans=spans)


def _gentle(found: Manner, clause: g.Gentle, s: Setting) -> Manner:
    reserve = min(found.reserve, s.defaults.grasp_reserve_gentle)
    return replace(_slower(found, s.defaults.carry_speed_gentle), reserve=reserve)


def _slow(found: Manner, clause: g.Slow, s: Setting) -> Manner:
    return _slower(found, s.defaults.carry_speed_gentle)


def _speed(found: Manner, clause: g.MaxSpeed | g.Speed | g.MinSpeed, s: Setting) -> Manner:
    most = s.defaults.carry_speed
    if not isinstance(clause, g.MaxSpeed) and clause.value > most:
        raise NoPlanError(
            Refusal(
                reason="impossible",
                message=f"{1e3 * clause.value:.0f} mm/s are asked; what is held is moved at up to "
                f"{1e3 * most:.0f} mm/s",
                numbers={"speed": clause.value, "most": most},
                spans=clause.spans,
                suggestions=(f"at {100 * most:.0f} cm/s",),
            )
        )
    if isinstance(clause, g.MinSpeed):
        return found
    return _slower(found, clause.value)


def _slower(found: Manner, speed: float) -> Manner:
    """A speed that the sentence gave is no default any more."""
    return replace(
        found,
        speed=min(found.speed, speed),
        lid_speed=min(found.lid_speed, speed),
        defaults=tuple(used for used in found.defaults if used.name != "carry_speed"),
    )


def _contact(found: Manner, clause: g.ContactRegion, s: Setting) -> Manner:
    if clause.face is not None:
        raise _not_so("touching a named face", clause, s)
    for low, high, region in bands(clause, s.target.model.top, s.defaults):
        told = f"{found.region} and {region}" if found.region else region
        found = replace(found, low=max(found.low, low), high=min(found.high, high), region=told)
    return replace(found, contact_spans=found.contact_spans + clause.spans)


def _effector(found: Manner, clause: g.Effector, s: Setting) -> Manner:
    require_right(clause)
    fingertip = isinstance(s.target.model.lid, FlipLid) and s.doing in ("opening", "closing")
    if clause.tool == "arm" or (clause.tool == "finger" and not fingertip):
        which = "fingers" if clause.tool == "finger" else "the arm"
        raise _not_so(f"using only {which}", clause, s)
    if clause.tool == "finger" and (clause.count or 1) > 1:
        raise _not_so(f"using {clause.count} fingers", clause, s)
    return found


_HANDLERS: dict[str, Callable[[Manner, Any, Setting], Manner]] = {
    "no_topple": _kept,
    "no_turn": _kept,
    "max_turn": _kept,
    "no_slide": _kept,
    "no_spill": _kept,
    "no_tilt": _upright,
    "max_tilt": _upright,
    "no_lift": _on_the_table,
    "no_touch": _clear,
    "max_force": _force,
    "force": _force,
    "gentle": _gentle,
    "slow": _slow,
    "max_speed": _speed,
    "min_speed": _speed,
    "speed": _speed,
    "contact": _contact,
    "effector": _effector,
}
