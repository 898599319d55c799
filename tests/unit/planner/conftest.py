"""A state to plan in, and a reach that says yes or no by rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import pytest
from pydantic import BaseModel

import grammar
from grammar.frames.command import Frame, ObjectRef
from objectmodels import Registry
from planner import plan
from planner.problem.frame_interpretation import interpret_frame
from planner.problem.planning_problem import PushProblem
from planner.refusals.blocked import Blocked
from planner.types.actions import Push
from planner.types.defaults import DEFAULTS, Defaults
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.robot import Grip, ReachAnswer, ReachEffort, Robot, RobotLimits
from planner.types.world_state import PlanarPose, SeenObject, TableState, WorldState

Part = TypeVar("Part", bound=BaseModel)

TABLE = TableState(-0.2, 1.2, -0.8, 0.8)


LIMITS = RobotLimits(
    fingertip_radius=0.010,
    finger_spreads=(0.04, 0.032, 0.024),
    max_force=10.0,
    force_skew=0.35,
    lowest_height=0.025,
)


@dataclass
class RuledReach:
    """A robot that only pushes, and gets where a rule says."""

    rule: Callable[[Push], bool] = lambda _: True
    limits: RobotLimits = LIMITS
    asked: list[Push] = field(default_factory=list)
    last: Callable[[Push], bool] | None = None
    """What it answers by when it looks thoroughly; as always if None."""
    stiffness: float = 0.0
    max_press: float = 0.0

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        self.asked.append(push)
        rule = self.rule if self.last is None or effort == "usual" else self.last
        if rule(push):
            return ReachAnswer(ok=True, margin=0.5, stiffness=self.stiffness)
        return ReachAnswer(False, "kinematics", "told", words={"text": "too far"})

    def estimate_reach(self, push: Push, state: WorldState) -> float:
        return 0.5

    def grasp(self, width: float, *, pinch: bool = False, depth: float = 0.0) -> Grip | None:
        return None

    def reach_plan(self, plan: Plan, state: WorldState) -> ReachAnswer:
        return ReachAnswer(False, "width", "told", words={"text": "it only pushes"})


@pytest.fixture(autouse=True)
def _every_dead_end_can_be_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Words all dead ends of a search, of which but one is told: none lacks a word or a number."""
    init = Blocked.__init__

    def told(self: Blocked, *args: Any, **fields: Any) -> None:
        init(self, *args, **fields)
        assert self.refusal.message

    monkeypatch.setattr(Blocked, "__init__", told)


def world(**poses: PlanarPose) -> WorldState:
    """Objects of the registry, by their names with underscores."""
    registry = Registry.default()
    objects = {}
    for name, pose in poses.items():
        plain = name.replace("_", " ")
        objects[plain] = SeenObject(plain, pose, registry.get(plain))
    return WorldState(objects, TABLE)


def frame_of(text: str) -> Frame:
    """The frame of a sentence, its objects named as in the scene."""
    (frame,) = grammar.parse(text).frames
    return _bound(frame)


def problem_of(
    frame: Frame, state: WorldState, defaults: Defaults = DEFAULTS, robot: Robot | None = None
) -> PushProblem:
    """The problem of pushes that a frame poses."""
    problem = interpret_frame(frame, state, defaults, robot)
    assert not isinstance(problem, Blocked), problem.sentence
    return problem


def _bound(part: Part) -> Part:
    """A part of a frame with the id of every object."""
    if isinstance(part, ObjectRef):
        return part.model_copy(update={"id": part.text})
    values = {key: getattr(part, key) for key in type(part).model_fields}
    return part.model_copy(update={key: _value(value) for key, value in values.items()})


def _value(value: object) -> object:
    if isinstance(value, tuple):
        return tuple(_value(item) for item in value)
    return _bound(value) if isinstance(value, BaseModel) else value


def planned(text: str, state: WorldState, reach: RuledReach | None = None) -> Plan:
    """The plan for a sentence; by default of a hand that gets everywhere."""
    made = plan(frame_of(text), state, reach or RuledReach())
    assert isinstance(made, Plan), made
    return made


def refused(text: str, state: WorldState, reach: RuledReach | None = None) -> Refusal:
    """Why there is none."""
    made = plan(frame_of(text), state, reach or RuledReach())
    assert isinstance(made, Refusal), made
    assert made.message
    return made


@pytest.fixture
def kitchen() -> WorldState:
    """Three boxes far apart, standing square."""
    return world(
        ice_tea_box=PlanarPose(0.45, 0.0),
        cereal_box=PlanarPose(0.60, 0.40),
        coffee_box=PlanarPose(0.62, -0.40),
    )


@pytest.fixture
def reach() -> RuledReach:
    """A hand that gets everywhere."""
    return RuledReach()
