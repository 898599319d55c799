"""What may not spill is tilted less, and not toppled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from objectmodels import BoxModel
from objectmodels.models.object_parts import Container, FlipLid, Opening
from planner.problem.constraint_limits import spill_tilt
from planner.problem.frame_interpretation import interpret_frame
from planner.refusals.blocked import Blocked
from planner.types.defaults import DEFAULTS
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import TABLE, frame_of, problem_of

CUP = BoxModel(
    name="ice tea box", size=(0.09, 0.06, 0.18), mass=1.0, friction=0.4,
    container=Container(wall=0.002, opening=Opening(radius=0.02), contents_l=0.8),
)  # fmt: skip
LID = FlipLid(mass=0.01, tab=0.02, friction_torque=0.01)


def _seen(model: BoxModel = CUP, lid: float | None = None) -> SeenObject:
    return SeenObject("ice tea box", PlanarPose(0.5, 0.0), model, lid=lid)


def _state(seen: SeenObject) -> WorldState:
    return WorldState({seen.name: seen}, TABLE)


def _spills(seen: SeenObject) -> float:
    angle = spill_tilt(seen, DEFAULTS.sigmas)
    assert angle is not None
    return angle


def test_a_push_may_tilt_it_as_far_as_it_holds() -> None:
    asked = problem_of(
        frame_of("push the ice tea box away without spilling"), _state(_seen()), DEFAULTS
    )
    assert asked.motion.tilt == pytest.approx(_spills(_seen()))
    vessel = CUP.vessel
    assert vessel is not None
    # Whichever way it leans: towards a short side it spills first.
    assert _spills(_seen()) <= vessel.spill_angle(0.8e-3, [0.0, np.pi / 2.0, 1.0]).min()


def test_more_may_be_in_it_than_is_believed() -> None:
    container = CUP.container
    assert container is not None
    unsure = container.model_copy(update={"contents_l_sd": 0.05})
    seen = _seen(CUP.model_copy(update={"container": unsure}))
    assert _spills(seen) < _spills(_seen()) - 0.01


def test_a_brimful_one_still_slides() -> None:
    container = CUP.container
    assert container is not None
    assert CUP.vessel is not None
    full = container.model_copy(update={"contents_l": 1e3 * CUP.vessel.capacity})
    seen = _seen(CUP.model_copy(update={"container": full}))
    assert _spills(seen) == 0.0
    frame = frame_of("push the ice tea box away without spilling")
    assert problem_of(frame, _state(seen), DEFAULTS).motion.tilt == DEFAULTS.rest_tilt


@pytest.mark.parametrize(
    "order", ["by 8 degrees without spilling", "without spilling by 8 degrees"]
)
def test_a_tilt_short_of_it_is_made(order: str) -> None:
    asked = problem_of(frame_of(f"tilt the ice tea box {order}"), _state(_seen()), DEFAULTS)
    assert asked.goal.tilt == pytest.approx(np.radians(8.0))


@pytest.mark.parametrize(
    "sentence",
    [
        "topple the ice tea box without spilling",
        "tilt the ice tea box by 40 degrees without spilling",
        "push the ice tea box until it tips without spilling",
    ],
)
def test_what_would_spill_is_refused_with_the_angle(sentence: str) -> None:
    why = interpret_frame(frame_of(sentence), _state(_seen()), DEFAULTS)
    assert isinstance(why, Blocked)
    assert why.numbers["spill_angle"] == pytest.approx(_spills(_seen()))
    degrees = round(np.degrees(_spills(_seen())))
    assert f"begins to spill at {degrees}°" in why.sentence
    assert why.spans


def test_what_holds_nothing_may_be_toppled() -> None:
    container = CUP.container
    assert container is not None
    empty = container.model_copy(update={"contents_l": 0.0})
    for model in (
        CUP.model_copy(update={"container": empty}),
        CUP.model_copy(update={"container": None}),
        CUP.model_copy(update={"lid": LID}),
    ):
        frame = frame_of("topple the ice tea box without spilling")
        assert problem_of(frame, _state(_seen(model)), DEFAULTS).goal.outcome == "topple"


def test_an_open_lid_keeps_nothing_in() -> None:
    covered = _seen(CUP.model_copy(update={"lid": LID}))
    assert spill_tilt(covered, 2.0) is None
    assert spill_tilt(replace(covered, lid=1.5), 2.0) == _spills(_seen())
