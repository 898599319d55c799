"""A push that the hand did not get to is asked for again once what stopped it has moved."""

from __future__ import annotations

import dataclasses

from nlcontrol.session.step_search import ReachCache
from objectmodels import Registry
from planner.types.actions import Push
from planner.types.robot import NoRobot, ReachAnswer, ReachEffort
from planner.types.world_state import PlanarPose, SeenObject, WorldState

TEA = Registry.built_in().get("ice tea box")
PUSH = Push(
    object="it", face="front", p_BC=(-0.03, 0.0, 0.05), normal_W=(-1.0, 0.0, 0.0),
    direction_W=(1.0, 0.0, 0.0), force_limit=1.0, speed=0.05, stroke=0.1, fingers=1, spread=0.0,
    ends_on="stroke",
)  # fmt: skip


class _Stopped(NoRobot):
    """A robot that a post stops, and that counts how often it is asked."""

    def __init__(self, stopped_by: frozenset[str] | None) -> None:
        self.asked, self._stopped_by = 0, stopped_by

    def reach(self, push: Push, state: WorldState, effort: ReachEffort = "usual") -> ReachAnswer:
        self.asked += 1
        return ReachAnswer(False, "obstacle", work=70, stopped_by=self._stopped_by)


def _state(**x: float) -> WorldState:
    places = {"it": 0.5, "post": 0.6, "lamp": 0.9} | x
    return WorldState(
        {name: SeenObject(name, PlanarPose(at, 0.0), TEA) for name, at in places.items()}
    )


def test_only_what_stopped_the_hand_makes_it_worth_asking_again() -> None:
    stopped = _Stopped(frozenset({"post"}))
    robot = ReachCache(stopped, None, None)
    first = robot.reach(PUSH, _state())
    assert robot.reach(PUSH, _state(lamp=0.2)) == dataclasses.replace(first, work=1)
    assert stopped.asked == 1
    for number, state in enumerate([_state(post=0.7), _state(it=0.4)], start=2):
        assert robot.reach(PUSH, state).work == 70
        assert stopped.asked == number
    robot.reach(PUSH, _state(), "thorough")
    assert stopped.asked == 4


def test_a_robot_that_does_not_know_what_stopped_it_is_asked_each_time() -> None:
    stopped = _Stopped(None)
    robot = ReachCache(stopped, None, None)
    for _ in range(2):
        robot.reach(PUSH, _state())
    assert stopped.asked == 2
