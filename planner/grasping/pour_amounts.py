"""How much is poured: what the sentence says, what is there, and what fits.

Volumes that a refusal names are there and fit even in the worst case of what is believed.
"""

from __future__ import annotations

from dataclasses import dataclass

from grammar.frames import command as g
from objectmodels.models.object_parts import Container, Vessel
from planner.grasping.lid_planner import is_open
from planner.problem.planning_problem import GraspProblem
from planner.refusals.refusal_builder import no_plan
from planner.types.defaults import Defaults
from planner.types.plan import DefaultUsed
from planner.types.world_state import SeenObject

_DROP = 1e-6  # less than this is nothing [m³]
_LEAST_SAID = 1e-5  # nobody is told to pour less than this [m³]


@dataclass(frozen=True, eq=False)
class Hollow:
    """An open container that stands, as it is believed to be.

    Attributes:
        seen: the object.
        container: what is in it.
        vessel: its cavity.
    """

    seen: SeenObject
    container: Container
    vessel: Vessel

    @classmethod
    def from_object(cls, seen: SeenObject, defaults: Defaults) -> Hollow:
        """An object as a container.

        Raises:
            NoPlanError: it is none, lies, or is closed.
        """
        if seen.lies_on != "bottom":
            raise no_plan("container_lies", object=seen.name)
        container, vessel = seen.model.container, seen.model.vessel
        if container is None or vessel is None:
            raise no_plan("no_container", object=seen.name)
        if not is_open(seen, defaults):
            raise no_plan("is_closed", object=seen.name)
        return cls(seen, container, vessel)

    @property
    def room(self) -> float:
        """Volume that still fits in [m³]; negative if it is believed to be too full."""
        return self.vessel.capacity - self.container.contents


@dataclass(frozen=True)
class Amount:
    """Volume that is poured.

    Attributes:
        volume: how much [m³].
        room: how much fits in [m³].
        all: whether that is everything.
        defaults: what the sentence left open.
    """

    volume: float
    room: float
    all: bool = False
    defaults: tuple[DefaultUsed, ...] = ()


def poured_amount(
    problem: GraspProblem, source: Hollow, into: Hollow, goal: g.Pour
) -> Amount | None:
    """Volume that is poured; None if it is filled as far as it should be already.

    Raises:
        NoPlanError: there is not so much, or it does not fit.
    """
    has, room, d = source.container.contents, into.room, problem.defaults
    if has < _DROP:
        raise no_plan("is_empty", {"contents": 0.0}, object=problem.target.name)
    wanted, used = _wanted_volume(source, into, goal, d)
    if goal.fill is not None and wanted < _DROP:
        return None
    if wanted > room:
        numbers = {"volume": wanted, "room": max(room, 0.0), "contents": has}
        code = "does_not_fit" if has > room else "all_does_not_fit"
        words = {"into": into.seen.name, "surely": _surely_poured(source, into, d)}
        raise no_plan(code if room > 0.0 else "is_full", numbers, spans=goal.spans, **words)
    if wanted > has:
        numbers = {"volume": wanted, "contents": has}
        words = {"object": problem.target.name, "surely": _surely_poured(source, into, d)}
        raise no_plan("not_so_much", numbers, spans=goal.spans, **words)
    everything = goal.volume is None and goal.fill is None and wanted > has - _DROP
    return Amount(wanted, room, everything, used)


def _surely_poured(source: Hollow, into: Hollow, d: Defaults) -> float:
    """Volume that is there and fits, in the worst case; as believed if that leaves nothing [m³]."""
    there = source.container.contents - d.sigmas * source.container.contents_sd
    fits = into.room - d.sigmas * into.container.contents_sd
    surely = min(there, fits)
    return surely if surely >= _LEAST_SAID else min(source.container.contents, max(into.room, 0.0))


def _wanted_volume(
    source: Hollow, into: Hollow, goal: g.Pour, d: Defaults
) -> tuple[float, tuple[DefaultUsed, ...]]:
    """The volume that is meant [m³], and what the sentence left open."""
    has = source.container.contents
    if goal.volume is not None:
        return goal.volume, ()
    if goal.fraction is not None:
        return goal.fraction * has, ()
    if goal.fill is not None:
        share = min(goal.fill, d.pour_fill)
        full = DefaultUsed(name="pour_fill", value=d.pour_fill, unit="", reason="“full”")
        volume = share * into.vessel.capacity - into.container.contents
        return volume, (full,) if goal.fill > d.pour_fill else ()
    if goal.amount is None:
        return has, ()
    said = {
        "little": ("pour_little", min(d.pour_little, has), "m³", "“a little”"),
        "lot": ("pour_lot", d.pour_lot, "", "“a lot”"),
    }
    name, value, unit, reason = said[goal.amount]
    used = DefaultUsed(name=name, value=value, unit=unit, reason=reason)
    return value if unit else value * has, (used,)
