"""Several threads at one controller."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim.robots.cell_description import LOOK
from sim.simulated_executor import simulation


def test_looks_of_several_threads_are_made_one_after_another() -> None:
    controller = Controller("kitchen")
    executor = simulation(controller.executor)
    begun = executor.world.time
    with ThreadPoolExecutor(4) as threads:
        looks = [threads.submit(controller.look) for _ in range(8)]
        seen = [look.result().objects["mug"].pose for look in looks]
    # Each has camera frames, and so noise, of its own.
    assert len(set(seen)) == 8
    assert executor.time - begun == pytest.approx(8 * LOOK)


def test_a_conversation_and_its_controller_share_their_turns() -> None:
    controller = Controller("kitchen")
    conversation = Conversation(controller)
    conversation.say("where is the mug?")  # all is loaded, so that the next one is quick
    with ThreadPoolExecutor(1) as thread:
        with controller.turn:
            answer = thread.submit(conversation.say, "where is the mug?")
            with pytest.raises(TimeoutError):
                answer.result(timeout=0.2)
        assert answer.result().status == "answered"
