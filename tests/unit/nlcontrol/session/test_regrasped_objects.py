"""What the hand does not get to its place as it holds it is put down and grasped anew."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from grammar import parse
from grammar.frames import command as g
from nlcontrol.session.controller import Controller
from nlcontrol.session.foresight import PlanCache
from nlcontrol.session.step_search import StepSearch, Ways
from planner import planning
from planner.clearing import may_be_grasped_anew, setting_down_frame
from planner.problem.predicted_states import state_after
from planner.types.defaults import CLEARED, DEFAULTS
from planner.types.plan import Plan, PlanningResult
from planner.types.refusal import Refusal
from planner.types.world_state import WorldState
from sim.supervision import StopToken

MUG = g.ObjectRef(text="mug", noun="mug", id="mug")


def mugs_frame(said: str) -> g.Frame:
    (frame,) = parse(said).frames
    return frame.model_copy(update={"object": MUG})


def held_mug(controller: Controller) -> WorldState:
    """What is believed once the mug was lifted as is planned."""
    state = controller.look()
    made = controller.plan(mugs_frame("lift the mug by 5 cm"), state)
    assert isinstance(made, Plan)
    after = state_after(made, state)
    assert after is not None
    assert after.held is not None
    return after


def lame(frame: g.Frame, state: WorldState, robot: Any, **options: Any) -> PlanningResult:
    """A planner whose hand lets down what it holds, but does not carry it."""
    if state.held is not None and frame.goal.kind == "place":
        return Refusal(code="no_reach_in_hand", reason="out_of_reach", message="not so")
    return planning.plan(frame, state, robot, **options)


@pytest.mark.parametrize(("clear", "found"), [("no", None), ("yes", ["set_down", "place"])])
def test_it_is_put_down_first_if_things_may_be_moved(clear: str, found: list[str] | None) -> None:
    may = replace(DEFAULTS, clear=CLEARED.index(clear))
    controller = Controller("kitchen", defaults=may, planner=lame)
    state = held_mug(controller)
    frames = (mugs_frame("put the mug at x 0.7 y -0.3"),)
    search = StepSearch(controller, frames, frozenset({"mug"}), StopToken(), PlanCache())
    ways = search.ways(state, "not so")
    kinds = [frame.goal.kind for frame in ways.frames] if isinstance(ways, Ways) else None
    assert kinds == found


@pytest.mark.parametrize(
    ("said", "anew"),
    [
        ("put the mug at x 0.7 y -0.3 gently", True),
        # How high and from where is told by how it is held, or by where it stood.
        ("lift the mug by 5 cm", False),
        ("put the mug back", False),
        ("put the mug at x 0.7 y -0.3 within 10 s", False),
    ],
)
def test_only_what_may_begin_anywhere_is_put_down_first(said: str, anew: bool) -> None:
    controller = Controller("kitchen")
    frame, state = mugs_frame(said), controller.look()
    assert not may_be_grasped_anew(frame, state)  # nothing is held
    assert may_be_grasped_anew(frame, held_mug(controller)) == anew


def test_it_is_put_down_as_gently_as_it_is_carried() -> None:
    frame = setting_down_frame(mugs_frame("put the mug at x 0.7 y -0.3 gently"))
    assert [each.kind for each in frame.constraints] == ["gentle"]
