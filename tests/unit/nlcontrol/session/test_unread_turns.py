"""A sentence that is not understood as a whole: what is understood of it is done when accepted."""

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

UNREAD = "Push the mug 5 cm to the left, so that the whatsit can see it"


@pytest.fixture
def talk() -> Conversation:
    return Conversation(Controller("kitchen", seed=1))


def test_what_is_understood_is_offered_and_done_when_accepted(talk: Conversation) -> None:
    refused = talk.say(UNREAD, plan_only=True)
    assert refused.status == "not_understood"
    assert refused.error is not None
    assert any('say "yes": "push the mug' in each for each in refused.error.suggestions)
    done = talk.say("yes", plan_only=True)
    assert done.status == "planned"
    assert [(f.action, f.object and f.object.id) for f in done.frames] == [("push", "mug")]


@pytest.mark.parametrize(
    "between", ["how heavy is the coffee box?", "what do you see?", "thanks", "zorp it"]
)
def test_what_was_offered_is_forgotten_with_the_next_turn(talk: Conversation, between: str) -> None:
    talk.say(UNREAD, plan_only=True)
    talk.say(between, plan_only=True)
    said = talk.say("yes", plan_only=True)
    assert not any(f.action and f.object and f.object.id == "mug" for f in said.frames)


@pytest.mark.parametrize(
    "said",
    ["slower", "again", "the other way", "no, the mug", "a bit more", "mug?", "do it gently"],
)
def test_a_remark_on_what_was_not_read_is_asked_back(talk: Conversation, said: str) -> None:
    assert talk.say("push the mug 5 cm to the left", plan_only=True).status == "planned"
    assert talk.say("zorp the whatsit", plan_only=True).status == "not_understood"
    asked = talk.say(said, plan_only=True)
    assert asked.status == "not_understood"
    assert talk.say("push the jar away", plan_only=True).frames[0].action == "push"


def test_what_is_to_be_said_later_is_one_sentence(talk: Conversation) -> None:
    refused = talk.say("once it is dry, push the mug 5 cm to the left", plan_only=True)
    assert refused.error is not None
    assert refused.error.say == ("push the mug to the left by 5 cm",)


def test_a_veto_is_never_offered_without_its_words(talk: Conversation) -> None:
    refused = talk.say("push the mug 5 cm to the left unless it is full", plan_only=True)
    assert refused.error is not None
    assert refused.error.code == "unbound_words"
    assert talk.say("yes", plan_only=True).plan is None


@pytest.mark.parametrize("said", ["do it with one finger", "no", "and the jar?"])
def test_only_a_bare_yes_accepts(talk: Conversation, said: str) -> None:
    talk.say(UNREAD, plan_only=True)
    assert talk.say(said, plan_only=True).status not in ("planned", "done")


def test_what_is_done_is_not_done_again_for_a_yes(talk: Conversation) -> None:
    assert talk.say("move the mug 2 cm to the left").status == "done"
    for agreed in ("yes please", "go ahead", "do it"):
        said = talk.say(agreed)
        assert (said.status, said.steps, said.answer is None) == ("done", (), False)
    assert talk.say("again", plan_only=True).plan
