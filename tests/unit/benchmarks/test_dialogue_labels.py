"""What a label of a turn asks of a result: objects by name, one of several actions, undoing."""

from benchmarks.dialogues import acts_wrongly, is_right
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation


def test_a_label_names_objects_of_a_goal_and_may_leave_the_action_open() -> None:
    result = Conversation(Controller("kitchen", seed=1)).say(
        "push the mug next to the coffee box", plan_only=True
    )
    beside = {"relation": "next_to", "reference": ["coffee box"]}
    assert is_right(result, {"steps": [[["move", "push"], "mug", beside]]})
    assert not is_right(result, {"steps": [[["move", "place"], "mug", beside]]})
    other = {**beside, "reference": ["cereal box"]}
    assert not is_right(result, {"steps": [["push", "mug", other]]})


def test_what_takes_back_where_nothing_moved_is_read_as_that() -> None:
    talk = Conversation(Controller("kitchen", seed=1))
    pushed = talk.say("push the mug away", plan_only=True)
    assert not is_right(pushed, {"undoes": "mug"})
    assert not acts_wrongly(pushed, {"undoes": "mug"})
    assert acts_wrongly(pushed, {"undoes": "coffee box"})
    assert is_right(talk.say("undo that", plan_only=True), {"undoes": "mug"})
