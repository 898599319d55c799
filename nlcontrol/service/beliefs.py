"""Beliefs about a table: as a document, as a digest, and compared with what was before.

A plan holds for the poses, the models and the held object that it was made from. All objects
count, not the moved one alone, since another may stand in its way by now.

Tolerances: two looks at a table on which nothing moved differ by the noise of the camera, each by
σ/√n along an axis for n frames of deviation σ, their difference by √2 of that. Six deviations of it
are taken, so that one look in millions is wrong, and no less than what a look is good for without
noise.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nlcontrol.errors import ControlError, error
from nlcontrol.json_document import finite_or_none
from nlcontrol.service.documents import TableObject, TableView
from objectmodels.registry.model_registry import model_document
from sim.robots.cell_description import LOOK

if TYPE_CHECKING:
    from nlcontrol.service.documents import Source
    from planner.types.world_state import SeenObject, WorldState
    from sim.robots.cell_description import CellDescription, Vision

_DEVIATIONS = 6.0
_LEAST_MOVE, _LEAST_TURN = 0.001, math.radians(0.5)
_LEAST_LID = math.radians(2.0)


@dataclass(frozen=True)
class Tolerances:
    """Differences that are no change.

    Attributes:
        move: of a position [m].
        turn: of an attitude [rad].
        lid: of how far a lid is open [rad or m].
    """

    move: float
    turn: float
    lid: float

    @classmethod
    def of(cls, vision: Vision) -> Tolerances:
        """Those of a camera, after a look."""
        share = _DEVIATIONS * math.sqrt(2.0 / max(vision.rate_hz * LOOK, 1.0))
        move = share * vision.position_noise_m
        turn = share * math.radians(vision.angle_noise_deg)
        return cls(max(move, _LEAST_MOVE), max(turn, _LEAST_TURN), max(turn, _LEAST_LID))


def table_view(state: WorldState, cell: CellDescription, time: float, source: Source) -> TableView:
    """A belief as a document."""
    models = {item.name: item.model for item in cell.objects}
    return TableView(
        source=source,
        time=time,
        scene=cell.name,
        objects=tuple(
            _table_object(seen, models.get(seen.name, seen.model.name))
            for seen in state.objects.values()
        ),
        held=None if state.held is None else state.held.name,
        digest=belief_digest(state),
    )


def _table_object(seen: SeenObject, model: str) -> TableObject:
    x, y, z = (float(side) for side in seen.model.extents)
    return TableObject(
        name=seen.name,
        model=model,
        x=seen.pose.x,
        y=seen.pose.y,
        yaw=seen.pose.yaw,
        lies_on=seen.lies_on,
        size=(x, y, z),
        fragile=seen.fragile,
        fixed=seen.fixed,
        lid=None if seen.lid is None else finite_or_none(seen.lid),
        mass=seen.model.mass,
        mass_sd=seen.model.mass_sd,
        friction=seen.model.friction,
        friction_sd=seen.model.friction_sd,
    )


def belief_digest(state: WorldState) -> str:
    """Digest of all that is believed, to the last digit: equal only where nothing is otherwise."""
    held = state.held
    document = {
        "objects": {name: _belief(seen) for name, seen in sorted(state.objects.items())},
        "held": held and [held.name, held.grasp.model_dump(mode="json"), held.height],
    }
    text = json.dumps(document, sort_keys=True, default=repr)
    return hashlib.sha256(text.encode()).hexdigest()


def _belief(seen: SeenObject) -> list[Any]:
    pose = seen.pose
    place = [pose.x, pose.y, pose.yaw, pose.attitude, seen.attitude, seen.lies_on]
    state = [seen.lid, seen.lid_at, seen.fragile, seen.fixed]
    return [place, state, model_document(seen.model)]


def require_unchanged(then: WorldState, now: WorldState, tolerances: Tolerances) -> None:
    """Checks that what a plan was made from is still believed.

    Raises:
        ControlError: `stale_plan`, with how far things moved [m] and turned [rad].
    """
    numbers: dict[str, float] = {}
    told = list(_changes(then, now, tolerances, numbers))
    if told:
        raise _stale(told, numbers)


def _changes(
    then: WorldState, now: WorldState, tolerances: Tolerances, numbers: dict[str, float]
) -> Iterator[str]:
    """Sentences on what is otherwise now; the figures are put with the others."""
    for name in sorted({*then.objects, *now.objects}):
        before, here = then.objects.get(name), now.objects.get(name)
        if before is None or here is None:
            yield f"the {name} is {'gone' if here is None else 'new'}"
            continue
        moved, turned = _way(before, here)
        if moved > tolerances.move:
            numbers[f"{name}: moved"] = moved
            yield f"the {name} moved {1e3 * moved:.0f} mm"
        if turned > tolerances.turn:
            numbers[f"{name}: turned"] = turned
            yield f"the {name} turned {math.degrees(turned):.1f}°"
        if before.lies_on != here.lies_on:
            yield f"the {name} lies on its {here.lies_on}"
        elif before.model != here.model:
            yield f"the {name} is believed to be otherwise (its mass or friction)"
        if abs((before.lid or 0.0) - (here.lid or 0.0)) > tolerances.lid:
            yield f"the lid of the {name} was moved"
    held = [None if state.held is None else state.held.name for state in (then, now)]
    if held[0] != held[1]:
        yield f"the hand {'is empty' if held[1] is None else f'holds the {held[1]}'}"


def _way(before: SeenObject, here: SeenObject) -> tuple[float, float]:
    """Distance [m] and angle [rad] between two poses."""
    R = _attitude(before).T @ _attitude(here)
    moved = math.hypot(here.pose.x - before.pose.x, here.pose.y - before.pose.y)
    return moved, math.acos(min(1.0, max(-1.0, (float(np.trace(R)) - 1.0) / 2.0)))


def _attitude(seen: SeenObject) -> Any:
    return seen.pose.R_WB if seen.attitude is None else np.reshape(seen.attitude, (3, 3))


def _stale(told: list[str], numbers: dict[str, float]) -> ControlError:
    return error(
        "stale_plan",
        f"since it was planned, {', '.join(told)}",
        suggestions=("plan it again: the new plan goes by what is seen now",),
        numbers=numbers,
    )
