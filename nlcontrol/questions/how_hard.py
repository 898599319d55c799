"""How hard: the force at which an event begins, or up to which an object stays upright.

Model: slow pushes, so what comes first at the onset decides. A force is told with its standard
deviation; `force_low` and `force_high` hold 95 % of it.
"""

from __future__ import annotations

from dataclasses import replace
from statistics import NormalDist
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.questions.answer import DOES, Answer, force_text, likelihood
from nlcontrol.questions.asked_push import Inquiry, inquiry, outcome_of, wanted_event
from nlcontrol.questions.force_uncertainty import CERTAIN
from nlcontrol.questions.push_prediction import PushPrediction, in_turn, needed_force, threshold
from nlcontrol.questions.where_to_push import most_favourable

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.world_state import WorldState

_MAKE = {"moves": "move", "slides": "slide", "tips": "topple", "tilts": "tilt", "turns": "turn"}


def figures(found: PushPrediction) -> dict[str, float]:
    """The numbers of a prediction that exist."""
    told = {
        "height": found.push.height,
        "lateral": found.push.lateral,
        "given_force": found.push.force,
        "onset": found.onset,
        "slide": found.slide,
        "slide_sd": found.slide_sd,
        "topple": found.topple,
        "topple_sd": found.topple_sd,
    }
    return {name: value for name, value in told.items() if value is not None}


def how_hard(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The force at which an event begins, or up to which the object stays as it is."""
    event, kept = wanted_event(frame), {clause.kind for clause in frame.constraints}
    push = replace(inquiry(frame, state, defaults), force=None)
    if frame.event is None and "no_slide" in kept:
        return _up_to(push, ("slide", "topple"), defaults)
    if event == "stays_upright" or (frame.event is None and kept & {"no_topple", "no_tilt"}):
        return _without_toppling(push, defaults)
    return _needed_force(most_favourable(push, event, defaults), event)


def _needed_force(push: Inquiry, event: g.Event) -> Answer:
    """The least force that makes the event happen, or that something else comes first."""
    found = push.predicted()
    first, other = in_turn(found)
    outcome = first if event == "moves" else outcome_of(event)
    p, name = found.probability[outcome], push.target.name
    likely = f"(probability that it {DOES[outcome if event == 'moves' else event]} {likelihood(p)})"
    value, sd = needed_force(found, outcome)
    if outcome != first or value is None:
        never = "never" if value is None else "not"
        before = "" if value is None else f", before the {force_text(value, sd)} that would do it"
        pushed = "Even pushed" if not push.placed else "Pushed"
        text = (
            f"{pushed} {push.where}, the {name} would {never} {_MAKE[event]}: it "
            f"{threshold(found, first, force_text)}{before} {likely}."
        )
        return Answer(
            query="how_hard",
            text=text,
            numbers=figures(found),
            probability=p,
            yes=False,
            push=push.considered,
        )
    text = (
        f"It takes {force_text(value, sd)} to {_verb(event, name)}, pushed {push.where}: "
        f"it then {DOES[first]}{' and turns' if event == 'turns' else ''} and "
        f"{threshold(found, other, force_text, only=True)} {likely}."
    )
    numbers = figures(found) | _range(value, sd)
    return Answer(
        query="how_hard",
        text=text,
        numbers=numbers,
        probability=p,
        yes=True,
        push=push.considered,
    )


def _verb(event: g.Event, name: str) -> str:
    verb = _MAKE[event]
    return f"make the {name} slide" if verb == "slide" else f"{verb} the {name}"


def _range(value: float, sd: float | None) -> dict[str, float]:
    if sd is None:
        return {"force": value}
    low, high = max(value - CERTAIN * sd, 0.0), value + CERTAIN * sd
    return {"force": value, "force_sd": sd, "force_low": low, "force_high": high}


def _without_toppling(push: Inquiry, defaults: Defaults) -> Answer:
    """Up to which force it stays upright; however hard it is pushed, if it is sure to slide."""
    found = push.predicted()
    p = found.probability["topple"]
    if p > 1.0 - defaults.probability:
        return _up_to(push, ("topple",), defaults)
    slides = threshold(found, "slide", force_text)
    topples = threshold(found, "topple", force_text, only=True)
    text = (
        f"Pushed slowly {push.where}, the {push.target.name} does not topple however hard it is "
        f"pushed: it {slides} and {topples} (probability that it topples {likelihood(p)})."
    )
    return Answer(
        query="how_hard",
        text=text,
        numbers=figures(found),
        probability=1.0 - p,
        push=push.considered,
    )


def _up_to(push: Inquiry, outcomes: tuple[str, ...], defaults: Defaults) -> Answer:
    """The force up to which outcomes are as improbable as a plan must have them."""
    found, sigmas = push.predicted(), NormalDist().inv_cdf(defaults.probability)
    thresholds = [needed_force(found, outcome) for outcome in outcomes]
    sure = [force - sigmas * (sd or 0.0) for force, sd in thresholds if force is not None]
    most = max(min(sure, default=0.0), 0.0)
    at_most = replace(push, force=most).predicted().probability
    p = 1.0 - sum(at_most[outcome] for outcome in outcomes)
    stays = "stays upright" if outcomes == ("topple",) else "stays where it is"
    first, other = in_turn(found)
    text = (
        f"With up to {force_text(most)} the {push.target.name}, pushed {push.where}, {stays} "
        f"(probability {likelihood(p)}): it {threshold(found, first, force_text)} and "
        f"{threshold(found, other, force_text, only=True)}."
    )
    numbers = figures(found) | {"force": most}
    return Answer(query="how_hard", text=text, numbers=numbers, probability=p, push=push.considered)
