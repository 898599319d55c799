"""A verdict on one quantity of one clause: it held, it did not, or it cannot be told.

A measure is a number, a name, or None where nothing was recorded that could tell. What was not
perceived neither holds nor fails, whatever was asked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from grammar.frames.command import Bound, Frame, Spans
from nlcontrol.checks import trace_measures as measures
from nlcontrol.json_document import DocumentPart
from nlcontrol.text_format import quantity
from objectmodels.errors import ModelError
from objectmodels.html_table import html_table
from planner.problem.stacks import with_supports
from planner.types.end_reasons import END_REASONS
from planner.types.world_state import PlanarPose, SeenObject, TableState, WorldState

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nlcontrol.checks.trace_measures import Array
    from objectmodels import ObjectModel
    from objectmodels.models.object_model import Resting
    from planner.problem.places import Measure
    from planner.types.defaults import Defaults
    from sim.traces.trace import Trace


Relation = Literal["about", "at_most", "at_least", "is"]
Unit = Literal["m", "rad", "N", "m/s", "s", "m³", ""]

PLANNED_ENDS = frozenset(end for end, meaning in END_REASONS.items() if meaning.is_planned)
"""Ends of a push, or of what a hand did, that are as they were meant."""

HAND_ENDS = frozenset(end for end, meaning in END_REASONS.items() if meaning.is_of_hand)
"""Ends of what a whole hand did that are not as they were meant."""


Verdict = Literal["held", "not_held", "unknown"]
"""What is known of a clause."""

NOT_PERCEIVED = "not perceived"
"""What stands for a measure that nothing was recorded of."""


class Clause(Protocol):
    """A goal or a constraint: a kind, and the words it comes from."""

    @property
    def kind(self) -> str:
        """Its kind in the frame contract."""

    @property
    def spans(self) -> Spans:
        """The words it comes from."""


class Observed(DocumentPart):
    """The same clause as an observer saw it, who knows the truth of a simulation.

    Attributes:
        measured: what was true.
        ok: whether it holds.
    """

    measured: float | str
    ok: bool


class Check(DocumentPart):
    """One clause: what it asked and what was measured, in SI units.

    Attributes:
        clause: kind of the goal or constraint; `others` for what is implied, that nothing else is
            touched.
        spans: the words it comes from, `[start, end)` in the sentence.
        quantity: what was measured, in words.
        relation: how `measured` must stand to `expected`.
        expected: asked value, or a name.
        measured: what the trace says; `not perceived` if it says nothing.
        tolerance: by how much it may miss; None for names.
        unit: of the values.
        verdict: `held`, `not_held`, or `unknown`: it can be neither confirmed nor denied.
        ok: it is known to hold.
        low, high: where `measured` lies with all that was perceived; None if that is not limited.
        why: of what is unknown: `too_near` to the limit, or `not_perceived`.
        observed: what an observer saw of it; None if there was none.
    """

    clause: str
    spans: Spans = ()
    quantity: str
    relation: Relation
    expected: float | str
    measured: float | str
    tolerance: float | None = None
    unit: Unit = ""
    verdict: Verdict
    ok: bool
    low: float | None = None
    high: float | None = None
    why: Literal["too_near", "not_perceived"] | None = None
    observed: Observed | None = None

    @property
    def differs(self) -> bool:
        """An observer has another verdict; true as well of what only the observer could tell."""
        seen = self.observed
        return seen is not None and self.verdict != ("held" if seen.ok else "not_held")

    def __repr__(self) -> str:
        measured, asked = (
            value if isinstance(value, str) else quantity(value, self.unit)
            for value in (self.measured, self.expected)
        )
        relation = self.relation.replace("_", " ")
        return f"<Check {self.verdict}: {self.quantity} {measured}, asked {relation} {asked}>"

    def _repr_html_(self) -> str:
        values = (self.measured, self.expected, self.tolerance or 0.0)
        texts = [v if isinstance(v, str) else quantity(v, self.unit) for v in values]
        row = (self.quantity, texts[0], f"{self.relation.replace('_', ' ')} {texts[1]}", texts[2])
        header = ("quantity", "measured", "asked", "tolerance")
        came = {"held": "held", "not_held": "missed", "unknown": "cannot be told"}[self.verdict]
        return html_table(f"{self.clause}: {came}", header, [row])


def compare(
    clause: Clause,
    relation: Relation,
    quantity: str,
    expected: float,
    measured: float | None,
    tolerance: float,
    unit: Unit,
) -> Check:
    """A verdict on a number; None if nothing tells it."""
    ok = measured is not None and holds(relation, expected, measured, tolerance)
    told = None if measured is None else float(measured)
    return _check(clause, relation, quantity, float(expected), told, ok, tolerance, unit)


def relation_of(bound: Bound) -> Relation:
    """How a measure must stand to an amount that is meant so."""
    return bound if bound in ("at_least", "at_most") else "about"


def holds(relation: Relation, expected: float, measured: float, tolerance: float) -> bool:
    """Whether a number stands to another one as asked, within a tolerance."""
    excess = measured - expected
    miss = {"about": abs(excess), "at_most": excess, "at_least": -excess}[relation]
    return bool(miss <= tolerance)


def object_name(clause: Clause, quantity: str, expected: str, measured: str | None) -> Check:
    """A verdict on a name; None if nothing tells it."""
    return _check(clause, "is", quantity, expected, measured, measured == expected)


def _check(
    clause: Clause,
    relation: Relation,
    quantity: str,
    expected: float | str,
    measured: float | str | None,
    ok: bool,
    tolerance: float | None = None,
    unit: Unit = "",
) -> Check:
    """The verdict on a clause; nothing is claimed of what nothing was recorded of."""
    if measured is None:
        verdict: Verdict = "unknown"
    else:
        verdict = "held" if ok else "not_held"
    return Check(
        clause=clause.kind,
        spans=clause.spans,
        quantity=quantity,
        relation=relation,
        expected=expected,
        measured=NOT_PERCEIVED if measured is None else measured,
        tolerance=tolerance,
        unit=unit,
        verdict=verdict,
        ok=ok,
        why="not_perceived" if measured is None else None,
    )


def place_check(clause: Clause, measure: Measure) -> Check:
    """A verdict on a place."""
    return compare(
        clause,
        measure.relation,
        measure.quantity,
        measure.expected,
        measure.measured,
        measure.tolerance,
        "m",
    )


# Evidence for the checks of one frame: an account of what happened, and the believed shapes.
#
# There are two sources, and the checks do not know which one speaks: an observer of a simulation,
# who recorded the truth, and the robot itself, whose account is one draw of what it perceived
# (`nlcontrol.checks.own_accounts`). What an account does not know is None, and nothing holds by
# it.
#
# An object that lies on another face than its model stands on is seen as it lies: its frame B is
# that of the face which was below at the start, so that its tilt counts from there.


LEVEL = np.radians(15.0)
"""What is tilted by less than this stands on its base, or leans; more may lie on another face."""

EVERY = 5
"""Of so many samples one is looked at where footprints are compared."""


@dataclass(frozen=True)
class Evidence:
    """Evidence for the checks of one frame.

    Attributes:
        trace: what happened, each object in the frame of the face on which it lay at the start.
        name: of the object that the frame is about.
        start, end: what stood where; objects without a model are left out.
        frame: what was asked.
        defaults: what a clause means when the sentence does not say more.
        rests: how objects lay on other faces than their models stand on.
        unsure: objects that may have been touched without being moved.
        unseen: objects that were not seen in the end.
    """

    trace: Trace
    name: str
    start: WorldState
    end: WorldState
    frame: Frame
    defaults: Defaults
    rests: Mapping[str, Resting]
    unsure: frozenset[str] = frozenset()
    unseen: frozenset[str] = frozenset()

    @classmethod
    def of(
        cls,
        frame: Frame,
        trace: Trace,
        models: Mapping[str, ObjectModel],
        table: TableState,
        defaults: Defaults,
        *,
        unsure: frozenset[str] = frozenset(),
        unseen: frozenset[str] = frozenset(),
    ) -> Evidence:
        """The evidence of a trace, with what is believed of the objects' shapes."""
        name = frame.object.id if frame.object and frame.object.id else trace.pushed
        trace, models, rests = _as_they_lay(trace, models)
        start, end = (
            WorldState({n: _standing(n, trace.poses[n][i], models[n]) for n in models}, table)
            for i in (0, -1)
        )
        return cls(trace, name, start, end, frame, defaults, rests, unsure, unseen)

    @property
    def model(self) -> ObjectModel:
        """Believed model of the object, as it lay at the start."""
        return self.start.objects[self.name].model

    @property
    def stood_on(self) -> str | None:
        """Name of what the object stood on at the start; None on the table."""
        height = float(self.trace.poses[self.name][0, 6])
        return with_supports(self.start.objects, {self.name: height})[self.name].on

    @property
    def largest_tilt(self) -> float:
        """Of the object [rad]."""
        return float(self.trace.tilt(self.name).max())

    @property
    def lid_at_end(self) -> float | None:
        """How far the object's lid is open in the end; None if nothing tells it."""
        opened = self.trace.lids.get(self.name)
        return None if opened is None else float(opened[-1])

    def contents(self, name: str, sample: int) -> float | None:
        """Volume in a container at a sample [m³]; None if nothing tells it."""
        volume = self.trace.contents.get(name)
        return None if volume is None else float(volume[sample])

    @property
    def spilled(self) -> float | None:
        """Volume that ran out and into nothing [m³]; None if nothing tells it."""
        spilled = self.trace.spilled
        return float(spilled[-1] - spilled[0]) if len(spilled) else None

    def has(self, *kinds: str) -> bool:
        """True if the frame has a constraint of one of the kinds."""
        return any(clause.kind in kinds for clause in self.frame.constraints)

    def covered_outlines(self, name: str) -> list[Array]:
        """Outlines that an object covered of the table, corners in W of every so many samples."""
        poses, model = self.trace.poses[name], self.start.objects[name].model
        tilts = self.trace.tilt(name)
        chosen = {*range(0, len(poses), EVERY), len(poses) - 1}
        upright = self.defaults.rest_tilt
        return [_shadow(poses[i], model, tilts[i] < upright) for i in sorted(chosen)]


def _as_they_lay(
    trace: Trace, models: Mapping[str, ObjectModel]
) -> tuple[Trace, dict[str, ObjectModel], dict[str, Resting]]:
    """A trace in the frames of the faces that were below at the start, models and rests there."""
    poses, lay = dict(trace.poses), {n: m for n, m in models.items() if n in trace.poses}
    rests = {}
    for name, model in list(lay.items()):
        R_WB = measures.rotation(poses[name][0])
        if R_WB[2, 2] > np.cos(LEVEL):
            continue
        try:
            rest = model.resting_face(R_WB)
        except ModelError:
            continue  # it leans on something: its own frame is as good as any
        poses[name] = _in_object_frame(poses[name], rest.R_BN, rest.p_BN)
        lay[name], rests[name] = rest.model, rest
    return replace(trace, poses=poses), lay, rests


def _in_object_frame(poses: Array, R_BN: Array, p_BN: Array) -> Array:
    """Poses of frame N, which is fixed in B, from those of B; shape (n, 7)."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_quat(poses[:, [1, 2, 3, 0]])
    xyzw = (turns * Rotation.from_matrix(R_BN)).as_quat()
    return np.column_stack([xyzw[:, 3], xyzw[:, :3], poses[:, 4:] + turns.apply(p_BN)])


def _standing(name: str, pose: Array, model: ObjectModel) -> SeenObject:
    """An object where an observer saw it, on the face that is below."""
    R_WB = measures.rotation(pose)
    x, y, yaw = float(pose[4]), float(pose[5]), float(np.arctan2(R_WB[1, 0], R_WB[0, 0]))
    if R_WB[2, 2] > np.cos(LEVEL):
        return SeenObject.lying(name, PlanarPose(x, y, yaw, z=float(pose[6])), model)
    attitude = PlanarPose(x, y, yaw).R_WB.T @ R_WB
    here = PlanarPose(x, y, yaw, tuple(attitude.ravel().tolist()))
    return SeenObject.lying(name, here, model)


def _shadow(pose: Array, model: ObjectModel, upright: bool) -> Array:
    """Part of the table that an object covers, corners in W, shape (k, 2) [m]."""
    R_WB, outline = measures.rotation(pose), model.outline
    if upright:
        return np.asarray(outline @ R_WB[:2, :2].T + pose[4:6])
    from scipy.spatial import ConvexHull

    low, high = (np.column_stack([outline, np.full(len(outline), z)]) for z in (0.0, model.top))
    corners = np.vstack([low, high]) @ R_WB[:2].T + pose[4:6]
    return np.asarray(corners[ConvexHull(corners).vertices])
