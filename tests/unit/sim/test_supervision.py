"""A motion that is told to stop: the hand lets go, and nothing moves after that."""

from __future__ import annotations

from threading import Thread

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.events import Event
from planner.types.plan import Plan
from sim.supervision import Monitor, StopToken
from sim.traces.trace import Trace

SOON = 0.2
"""Within which a stop takes effect [s]."""


class StopAfter(StopToken):
    """Asks for a stop some time after a phase has begun."""

    def __init__(self, controller: Controller, phase: str, delay: float) -> None:
        super().__init__()
        self._controller, self.phase, self._delay = controller, phase, delay
        self.at = np.inf

    def tell(self, phase: str, time: float, text: str) -> None:
        if phase == self.phase and self.at == np.inf:
            self.at = time + self._delay

    @property
    def requested(self) -> bool:
        return self._controller.executor.time >= self.at


def stopped(sentence: str, phase: str, delay: float) -> tuple[Controller, Trace, StopAfter]:
    """What is left of a sentence's plan that is stopped so long after a phase has begun."""
    controller = Controller("kitchen")
    frame = controller.resolve(controller.parse(sentence)).frames[0]
    plan = controller.plan(frame)
    assert isinstance(plan, Plan)
    token = StopAfter(controller, phase, delay)
    trace = controller.execute(plan, Monitor(token.tell, token))
    assert (trace.end, token.at < np.inf) == ("stopped", True)
    return controller, trace, token


def phases_after(trace: Trace, token: StopAfter) -> set[str]:
    return set(trace.phase[trace.time > token.at + SOON])


def assert_at_home(controller: Controller, trace: Trace) -> None:
    """The arm has come back to where it waits, by its own joints."""
    home = np.asarray(controller.robot.mount.home)  # type: ignore[attr-defined]
    assert trace.joints[-1, :7] == pytest.approx(home, abs=np.radians(1.0))


@pytest.mark.parametrize(
    ("phase", "delay"),
    [
        pytest.param("look", 0.3, id="look"),
        pytest.param("transit", 0.6, id="transit"),
        pytest.param("push", 1.0, id="push"),
        pytest.param("approach", 0.5, id="approach", marks=pytest.mark.slow),
    ],
)
def test_a_push_lets_go_and_comes_home(phase: str, delay: float) -> None:
    controller, trace, token = stopped("push the ice tea box away", phase, delay)
    assert phases_after(trace, token) <= {"retreat", "settle"}
    assert trace.time[-1] < token.at + 6.0
    assert_at_home(controller, trace)
    # Half a second of pushing at most was left to it.
    went = trace.displacement("ice tea box")
    assert np.linalg.norm(went) < (0.06 if phase == "push" else 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "phase", "delay"),
    [
        ("lift the mug", "grasp", 3.6),
        ("tilt the ice tea box by 8 degrees", "push", 1.2),
    ],
)
def test_what_is_held_or_tilted_is_set_down(sentence: str, phase: str, delay: float) -> None:
    controller, trace, token = stopped(sentence, phase, delay)
    assert phases_after(trace, token) <= {"retreat", "settle"}
    assert controller.held is None
    assert_at_home(controller, trace)
    name = trace.pushed
    assert np.linalg.norm(trace.displacement(name)) < 0.01
    assert trace.tilt(name)[-1] < np.radians(1.0)


@pytest.mark.slow
def test_another_thread_stops_a_push_and_the_robot_goes_on_afterwards() -> None:
    controller, stop = Controller("kitchen"), StopToken()

    def ask(event: Event) -> None:
        if event.phase == "push":
            Thread(target=stop.request).start()

    result = Conversation(controller).say("push the ice tea box away", on_event=ask, stop=stop)
    assert (result.status, result.execution and result.execution.end) == ("cancelled", "stopped")
    assert Conversation(controller).say("push the ice tea box 3 cm to the left").ok
