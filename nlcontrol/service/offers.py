"""Offers: plans that wait to be approved, and the beliefs for which they hold.

Beliefs about a table: as a document, as a digest, and compared with what was before.

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
import secrets
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from textwrap import shorten
from threading import RLock
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nlcontrol.errors import ControlError, error
from nlcontrol.json_document import finite_or_none
from nlcontrol.references.object_names import face_names
from nlcontrol.reports.plan_drawing import end_poses, plan_contacts
from nlcontrol.reports.replay_story import prediction_lines
from nlcontrol.service.documents import Drawing, Source, TableObject, TableView
from objectmodels.errors import printable
from objectmodels.registry.model_registry import model_document
from sim.robots.cell_description import LOOK, CellDescription, Vision

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.frame_execution import Proposal
    from planner.types.world_state import SeenObject, WorldState


@dataclass(frozen=True)
class Tolerances:
    """Differences that are no change.

    Attributes:
        move: tolerance of a position [m].
        turn: tolerance of an attitude [rad].
        lid: tolerance of the opening of a lid [rad or m].
    """

    move: float
    turn: float
    lid: float

    @classmethod
    def of(cls, vision: Vision) -> Tolerances:
        """Those of a camera, after a look."""
        share = 6.0 * math.sqrt(2.0 / max(vision.rate_hz * LOOK, 1.0))
        move = share * vision.position_noise_m
        turn = share * math.radians(vision.angle_noise_deg)
        # Without noise a look is good for 1 mm and half a degree, of a lid for two.
        least_turn, least_lid = math.radians(0.5), math.radians(2.0)
        return cls(max(move, 0.001), max(turn, least_turn), max(turn, least_lid))


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
        stale = error(
            "stale_plan",
            f"since it was planned, {', '.join(told)}",
            suggestions=("plan it again: the new plan goes by what is seen now",),
            numbers=numbers,
        )
        raise stale


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


# Drawing of an offer: what its plan predicts, or what stands in its way.


def offer_drawing(result: Result) -> Drawing | None:
    """The drawing of a plan or of a refusal; None if no object on the table is meant."""
    step = result.steps[-1] if result.steps else None
    if step is None or step.basis is None:
        return None
    target, plan = step.basis.target, step.plan
    # A front face looks towards the robot, along -x of W.
    normal_W = plan.push.normal_W if plan is not None and plan.pushes else (-1.0, 0.0, 0.0)
    faces, n = face_names(target.model, target.pose.yaw), target.pose.R_WB.T @ normal_W
    faces_towards = tuple(sorted(faces, key=lambda name: -float(np.dot(faces[name].normal, n))))
    return Drawing(
        object=target.name,
        faces=faces_towards,
        lines=tuple(prediction_lines(step)),
        ghosts=tuple(end_poses([step])),
        contacts=tuple(
            plan_contacts(plan, target.body_pose[0], target.rest) if plan is not None else ()
        ),
        marks=step.marks,
    )


# Plans that wait to be approved: each is used once, and for so long only.


LIFE = 600.0
"""Time for which a plan can be carried out [s]: a person looks at it, and nothing else has."""

MOST_OFFERED = 100
"""Plans that wait at a time; before one more, the oldest expires."""

_DROPPED = "the session was stopped or reset since"


class OfferedPlan(NamedTuple):
    """A plan that waits.

    Attributes:
        proposal: the sentence as it was planned.
        text: the sentence as it was given; "" if frames came without one.
        state: beliefs at that time.
        until: when it expires, on the clock [s].
    """

    proposal: Proposal
    text: str
    state: WorldState
    until: float


class OfferedPlans:
    """Plans of a session by their identifiers.

    Threads may share it; no method waits.

    Args:
        clock: clock by which they expire [s].

    Attributes:
        era: how often all of them were dropped; a plan that was asked for in an earlier one is
            none any more.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.era = 0
        self._clock = clock
        self._turn = RLock()
        self._waiting: dict[str, OfferedPlan] = {}
        self._past: dict[str, ControlError] = {}

    def offer(self, proposal: Proposal, text: str, state: WorldState, era: int) -> str:
        """Offers the plan of a text that was asked for in an era, and returns its identifier."""
        plan_id = f"plan-{secrets.token_hex(8)}"
        with self._turn:
            while len(self._waiting) >= MOST_OFFERED:
                self._end(next(iter(self._waiting)), _expired("newer plans have taken its place"))
            self._waiting[plan_id] = OfferedPlan(proposal, text, state, self._clock() + LIFE)
            if era != self.era:
                self._end(plan_id, _expired(_DROPPED))
        return plan_id

    def waiting(self, plan_id: str) -> OfferedPlan:
        """The plan of an identifier.

        Raises:
            ControlError: `unknown_plan`, `used_plan`, `expired_plan`.
        """
        with self._turn:
            plan = self._waiting.get(plan_id)
            if plan is not None and plan.until > self._clock():
                return plan
            if plan is not None:
                self._end(plan_id, _expired(f"it was made more than {LIFE / 60:g} min ago"))
            past = self._past.get(plan_id)
        raise past or error(
            "unknown_plan",
            "no plan of that identifier was made in this session",
            suggestions=("plan the sentence, and execute the `plan_id` of that offer",),
        )

    def approved(self, plan_id: str, text: str | None) -> OfferedPlan:
        """The plan of an identifier, approved under a text; None approves it by its name alone.

        Raises:
            ControlError: `other_sentence`; as `waiting`.
        """
        plan = self.waiting(plan_id)
        if text is not None and text != plan.text:
            raise error(
                "other_sentence",
                f"this plan is for {_quoted(plan.text)}, and {_quoted(text)} was approved",
                suggestions=(
                    f"plan {_quoted(text)}, and execute the `plan_id` of that offer",
                    f"approve this plan with the text {_quoted(plan.text)}",
                ),
            )
        return plan

    def use(self, plan_id: str) -> None:
        """Notes that a plan is carried out."""
        told = error(
            "used_plan",
            "this plan was carried out before, and a plan is carried out once",
            suggestions=("plan the sentence again, and execute the `plan_id` of that offer",),
        )
        with self._turn:
            self._end(plan_id, told)

    def drop(self) -> None:
        """Lets all plans expire, and those that are being made."""
        with self._turn:
            self.era += 1
            for plan_id in list(self._waiting):
                self._end(plan_id, _expired(_DROPPED))

    def _end(self, plan_id: str, reason: ControlError) -> None:
        self._waiting.pop(plan_id, None)
        self._past[plan_id] = reason
        # It is told why the last 10,000 are over.
        if len(self._past) > 10_000:
            del self._past[next(iter(self._past))]


def _quoted(text: str) -> str:
    return f"“{shorten(printable(text), 200)}”"


def _expired(why: str) -> ControlError:
    return error(
        "expired_plan",
        f"this plan has expired: {why}",
        suggestions=("plan the sentence again, and execute the `plan_id` of that offer",),
    )
