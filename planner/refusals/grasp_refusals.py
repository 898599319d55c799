"""Refusals of what a whole hand does: which sentence it is, and the numbers that decide."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from planner.refusals.push_refusals import deciding_answer
from planner.refusals.refusal_builder import Spans, no_plan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from objectmodels.containers.lid_forces import FlipArc, Loosening
    from planner.types.refusal import NoPlanError
    from planner.types.robot import ReachAnswer
    from planner.types.world_state import SeenObject


def not_that_wide(
    name: str, widths: Sequence[float], held: tuple[float, float], part: str = "body"
) -> NoPlanError:
    """Dead end since the hand does not close about the object, or about its lid."""
    what = f"the {name}" if part == "body" else f"the {name}'s lid"
    if not widths:
        return no_plan("no_two_sides", part=what)
    narrowest, widest = held
    wide = min(widths) > widest
    width = min(widths) if wide else max(widths)
    numbers = {"width": width, "widest": widest, "narrowest": narrowest}
    return no_plan("too_wide" if wide else "too_narrow", numbers, part=what)


def too_heavy(
    doing: str,
    name: str,
    numbers: dict[str, float],
    *,
    width: float,
    crush: float,
    allowed: float,
    spans: Spans,
) -> NoPlanError:
    """Dead end since it takes more squeeze than there is.

    Args:
        doing: what takes it, such as `lifting`.
        name: of the object.
        numbers: `needed_force`, `strongest` of the hand [N], and `friction`.
        width: between the touched sides [m].
        crush: squeeze that the object bears [N].
        allowed: squeeze that the sentence allows [N].
        spans: words that say so.
    """
    words: dict[str, Any] = {"doing": doing, "object": name, "width": width}
    if allowed <= min(numbers["strongest"], crush):
        numbers = {"allowed_force": allowed, **numbers}
        return no_plan("squeeze_not_allowed", numbers, spans=spans, **words)
    if crush < numbers["strongest"]:
        return no_plan("bears_no_squeeze", {"crush": crush, **numbers}, **words)
    return no_plan("squeeze_not_there", numbers, **words)


def no_reach(doing: str, name: str, answers: Sequence[ReachAnswer], *, held: bool) -> NoPlanError:
    """Dead end since there are ways, but the hand cannot make them."""
    last, blocker = deciding_answer(answers)
    one = len(answers) == 1
    code = {
        (False, False): "no_grasp_reached",
        (False, True): "grasps_blocked",
        (True, False): "no_reach_in_hand",
        (True, True): "blocked_in_hand",
    }[held, blocker is not None]
    return no_plan(
        code,
        {"ways": float(len(answers)), **last.numbers},
        doing=doing,
        object=name,
        last=last.message,
        blocker=blocker,
        are="is" if one else "are",
        number="one way" if one else f"{len(answers)} ways",
    )


def no_place(what: str, blocker: str | None) -> NoPlanError:
    """Dead end since there is no room where something should stand."""
    if blocker is None:
        return no_plan("table_ends", what=what)
    return no_plan("place_taken", what=what, other=blocker)


# -- lids ---------------------------------------------------------------------------------------


def gives_way(doing: str, target: SeenObject, arc: FlipArc, reserve: float) -> NoPlanError:
    """Dead end since the standing object would slide or topple before its lid moves all the way."""
    numbers = {**_arc_numbers(arc), "margin": arc.least_margin}
    return no_plan("gives_way", numbers, **_arc_words(doing, target, arc), reserve=reserve)


def may_give_way(doing: str, target: SeenObject, arc: FlipArc, asked: float) -> NoPlanError:
    """Dead end since it may, as weight, friction or the lid are not known well enough."""
    sure = {"probability": arc.probability, "asked_probability": asked}
    return no_plan("may_give_way", {**_arc_numbers(arc), **sure}, **_arc_words(doing, target, arc))


def _arc_words(doing: str, target: SeenObject, arc: FlipArc) -> dict[str, Any]:
    near = arc.weakest_index
    slides = bool(arc.slide[near] < arc.topple[near])
    return {
        "doing": doing,
        "object": target.name,
        "mass": target.model.mass,
        "verb": "slides" if slides else "tips",
        "limit": float((arc.slide if slides else arc.topple)[near]),
    }


def _arc_numbers(arc: FlipArc) -> dict[str, float]:
    near = arc.weakest_index
    found = {
        "lid_force": float(arc.force[near]),
        "largest_lid_force": arc.largest_force,
        "slide_force": float(arc.slide[near]),
        "topple_force": float(arc.topple[near]),
        "angle": float(arc.angles[near]),
    }
    return {name: value for name, value in found.items() if math.isfinite(value)}


def comes_along(target: SeenObject, found: Loosening) -> NoPlanError:
    """Dead end since the object would be lifted or turned with its lid."""
    code = "turned_along" if _is_screwed(target) else "pulled_along"
    return no_plan(code, _loosening_numbers(found), object=target.name)


def may_come_along(target: SeenObject, found: Loosening, asked: float) -> NoPlanError:
    """Dead end since it may, as friction, weight or the lid are not known well enough."""
    code = "may_be_turned_along" if _is_screwed(target) else "may_be_pulled_along"
    sure = {"probability": found.probability, "asked_probability": asked}
    return no_plan(code, {**_loosening_numbers(found), **sure}, object=target.name)


def _is_screwed(target: SeenObject) -> bool:
    return target.model.lid is not None and target.model.lid.kind == "screw"


def _loosening_numbers(found: Loosening) -> dict[str, float]:
    return {"needed": found.needed, "held": found.held, "margin": found.margin}


# -- pouring ------------------------------------------------------------------------------------


def does_not_fit(
    into: str, wanted: float, room: float, contents: float, spans: Spans
) -> NoPlanError:
    """Dead end since it would run over, whether or not there is so much."""
    numbers = {"volume": wanted, "room": max(room, 0.0), "contents": contents}
    fits = min(numbers["room"], contents)
    code = "does_not_fit" if contents > room else "all_does_not_fit"
    return no_plan(code if fits > 0.0 else "is_full", numbers, spans=spans, into=into, fits=fits)
