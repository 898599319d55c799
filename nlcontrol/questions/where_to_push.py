"""Where: the places of a face at which an event comes first, and at which it is sure.

Model: the outcome map of the face, pushed straight in by a finger that does not turn the object or,
for turning it, by one that may. Heights are above the table.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.questions.answer import DOES, Answer, Chart, likelihood
from nlcontrol.questions.asked_push import Inquiry, inquiry, outcome_of, wanted_event
from nlcontrol.text_format import quantity
from objectmodels.mechanics.outcome_map import OutcomeMap, outcome_map
from planner.affordances import SPACING, least, turning_map

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from planner.types.defaults import Defaults
    from planner.types.world_state import WorldState


@dataclass(frozen=True)
class Places:
    """Where on a face an event comes; arrays over the contacts of an outcome map.

    Attributes:
        chart: the map; undecided are places where no outcome is sure.
        first: whether the event comes first.
        sure: whether it does so with the probability that was asked for.
        likely: its probability.
    """

    chart: OutcomeMap
    first: NDArray[np.bool_]
    sure: NDArray[np.bool_]
    likely: NDArray[np.float64]


def where_answer(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The places of a face where an event is sure, with the map that shows them."""
    event, push = wanted_event(frame), inquiry(frame, state, defaults)
    found = event_places(push, event, defaults.probability)
    numbers = {"probability": defaults.probability} | _flip(push)
    if found.sure.any():
        heights = found.chart.height[found.sure]
        numbers |= {"lowest": float(heights.min()), "highest": float(heights.max())}
    return Answer(
        query="where",
        text=_places_text(push, event, found, numbers),
        numbers=numbers,
        probability=float(found.likely.max(initial=0.0)),
        yes=bool(found.sure.any()),
        push=push.considered.model_copy(update={"height": None}),
        chart=Chart(object=push.target.name, face=push.face_name),
        map=found.chart,
    )


def event_places(push: Inquiry, event: g.Event, probability: float) -> Places:
    """Where on its face an event comes first, and where it does so with a probability or more."""
    if event == "turns":
        chart, turns = turning_map(push.target, push.face, push.sense)
    else:
        chart = outcome_map(
            push.target.model, push.face, spacing=SPACING, level=probability, turning=False
        )
        turns = np.ones(len(chart.height), dtype=bool)
    allowed = (chart.height >= push.low - 1e-9) & (chart.height <= push.high + 1e-9)
    outcome = outcome_of(event)
    first = chart.topple < chart.slide if outcome == "topple" else chart.slide < chart.topple
    return Places(
        chart=chart,
        first=first & turns & allowed,
        sure=chart.is_safe(outcome, probability) & first & turns & allowed,
        likely=np.where(turns & allowed, getattr(chart.likelihood, outcome), 0.0),
    )


def most_favourable(push: Inquiry, event: g.Event, defaults: Defaults) -> Inquiry:
    """The same push where the event takes the least force, if the question leaves the place open.

    A question that says what is to happen, and not where, means a place that lets it happen: one
    where it is sure, else where it comes first, else where it is most probable.
    """
    if push.placed or event in ("moves", "stays_upright"):
        return push
    found = event_places(push, event, defaults.probability)
    best = least(found.chart, found.sure)
    if best is None:
        best = least(found.chart, found.first)
    if best is None:
        aside = np.abs(found.chart.lateral).round(6)
        best = int(np.lexsort((aside, -found.likely.round(4)))[0])
    chart = found.chart
    return replace(push, lateral=float(chart.lateral[best]), height=float(chart.height[best]))


def _flip(push: Inquiry) -> dict[str, float]:
    """The height that separates sliding from toppling, if the object topples at all."""
    middle, normals = push.face.points_at([0.0], [push.height])
    height = push.target.model.cone_thresholds(middle, normals, yaw=False).critical_height[0]
    return {"critical_height": float(height)} if np.isfinite(height) else {}


def _places_text(push: Inquiry, event: g.Event, found: Places, numbers: dict[str, float]) -> str:
    name, level = push.target.name, likelihood(numbers["probability"])
    does = "slides and stays upright" if event == "moves" else DOES[event]
    flip = _flipping(event, numbers.get("critical_height"))
    if not found.sure.any():
        return (
            f"Nowhere on its {push.face_name} face is it sure that the {name} {does} (no place "
            f"has probability {level}): {flip}."
        )
    low, high = quantity(numbers["lowest"], "m"), quantity(numbers["highest"], "m")
    return (
        f"On its {push.face_name} face, {low} to {high} above the table{_aside(event, found)}: "
        f"pushed there the {name} {does} with probability {level} or more; {flip}."
    )


def _flipping(event: g.Event, height: float | None) -> str:
    if height is None:
        return "it slides before it topples all over that face"
    if outcome_of(event) == "topple":
        return f"below {quantity(height, 'm')} it slides before it topples"
    return f"above {quantity(height, 'm')} it topples before it slides"


def _aside(event: g.Event, found: Places) -> str:
    """How far off the middle a push must be to turn the object."""
    if event != "turns":
        return ""
    lateral = found.chart.lateral[found.sure]
    side = "the right" if lateral[0] > 0.0 else "the left"
    if np.ptp(np.sign(lateral)) > 0.0:
        side = "either side"
    return f", at least {quantity(float(np.abs(lateral).min()), 'm')} to {side} of its middle"
