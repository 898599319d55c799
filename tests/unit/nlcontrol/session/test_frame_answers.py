"""Whether something can be done is answered as it would be done."""

from __future__ import annotations

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_execution import run_command
from sim.simulated_executor import simulation


def test_an_exchange_is_possible_as_it_would_be_carried_out() -> None:
    talk = Conversation(Controller("workbench"))
    asked = talk.say("can you swap the sugar box and the tea tin?")
    assert (asked.status, len(asked.steps)) == ("answered", 1)
    assert asked.answer is not None
    assert asked.answer.yes
    # One of them stands where the other is to go, so it goes aside first.
    assert asked.answer.text.startswith("Yes, in 3 steps: ")
    assert len(talk.say("do it", plan_only=True).frames) == 3
    assert not simulation(talk.controller.executor).is_built


def test_what_is_moved_aside_for_a_command_is_moved_aside_for_a_question() -> None:
    controller = Controller("examples/flat_book.yaml")
    command = controller.resolve(controller.parse("can you put the tea tin on the book?"))
    (frame,) = command.frames
    assert not controller.answer(frame).yes
    answer = run_command(controller, command).answer
    assert answer is not None
    assert answer.yes


def test_what_cannot_be_carried_out_is_denied() -> None:
    answer = (
        Conversation(Controller("pantry")).say("can you swap the jar and the fixed bottle?").answer
    )
    assert answer is not None
    assert answer.yes is False


def test_what_is_left_is_told_where_the_first_is_there_already() -> None:
    controller = Controller("workbench")
    seen = controller.look().objects["tea tin"].pose
    command = controller.command(f"put the tea tin to x {seen.x:.3f} y {seen.y:.3f}")
    there = controller.resolve(command).frames
    (other,) = controller.resolve(controller.command("push the coffee box 5 cm away")).frames
    asked = [
        f.model_copy(update={"query": "possible", "spans": ((0, 1),)}) for f in (*there, other)
    ]
    answer = run_command(controller, command.model_copy(update={"frames": tuple(asked)})).answer
    assert answer is not None
    assert answer.yes
    assert "in 2 steps" in answer.text
