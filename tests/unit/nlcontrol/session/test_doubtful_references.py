"""References with more than one honest meaning, which are asked back."""

from __future__ import annotations

import pytest

from nlcontrol.session.conversation import Conversation

BOTH = "push the mug and the coffee box 4 cm to the left"


@pytest.mark.parametrize(
    ("sentences", "named"),
    [
        ((BOTH, "now turn it by 30 degrees"), ("the coffee box", "the mug")),
        ((BOTH, "now turn it by 30 degrees", "slowly"), ("the coffee box", "the mug")),
        (
            ("push the mug away", "push the box to the left", "push it away"),
            ("the ice tea box", "the cereal box", "the coffee box"),
        ),
        (("push the box 5 cm away", "the ice tea one"), ("the ice tea box", "the ice tea")),
    ],
)
def test_a_pronoun_that_may_mean_several_things_is_asked_back(
    conversation: Conversation, sentences: tuple[str, ...], named: tuple[str, ...]
) -> None:
    result = [conversation.say(text, plan_only=True) for text in sentences][-1]
    assert result.error is not None
    assert result.error.code == "ambiguous_object"
    assert set(result.error.suggestions) >= set(named)


@pytest.mark.parametrize(
    "sentences",
    [
        ("push the mug to the left by 5 cm", "push it back"),
        ("push the coffee box left 5 cm and the cereal box right 5 cm", "8 cm"),
    ],
)
def test_a_remark_that_may_mean_several_things_is_asked_back(
    conversation: Conversation, sentences: tuple[str, ...]
) -> None:
    result = [conversation.say(text, plan_only=True) for text in sentences][-1]
    assert result.error is not None
    assert result.error.code == "nothing_before"


def test_what_a_question_with_which_names_is_spoken_of(conversation: Conversation) -> None:
    said = (
        "push the mug away",
        "which is taller, the mug or the cereal box?",
        "push that one away",
    )
    result = [conversation.say(text, plan_only=True) for text in said][-1]
    assert [frame.object.id for frame in result.frames if frame.object] == ["cereal box"]


def test_a_remark_goes_to_all_that_were_handled_alike(conversation: Conversation) -> None:
    for remark, distance in (("slowly", 0.04), ("6 cm", 0.06)):
        conversation.say(BOTH, plan_only=True)
        frames = conversation.say(remark, plan_only=True).frames
        told = [(f.object.id, f.goal.model_dump()["distance"]) for f in frames if f.object]
        assert told == [("mug", distance), ("coffee box", distance)]


def test_them_is_what_was_handled_together(conversation: Conversation) -> None:
    conversation.say(BOTH, plan_only=True)
    frames = conversation.say("push them away by 3 cm", plan_only=True).frames
    assert {frame.object.id for frame in frames if frame.object} == {"mug", "coffee box"}
    conversation.say("push the cereal box away", plan_only=True)
    refused = conversation.say("push them away by 3 cm", plan_only=True).error
    assert refused is not None
    assert refused.code == "no_antecedent"


def test_back_by_a_length_is_the_way_that_it_came(conversation: Conversation) -> None:
    conversation.say("push the mug to the left by 5 cm", plan_only=True)
    (frame,) = conversation.say("push it back 3 cm", plan_only=True).frames
    assert frame.goal.model_dump(include={"direction", "distance"}) == {
        "direction": "right",
        "distance": 0.03,
    }


def test_a_reason_is_told_for_what_was_said_alone(conversation: Conversation) -> None:
    conversation.say("push the mug to the left by 5 cm", plan_only=True)
    assert conversation.say("why to the left?", plan_only=True).status == "answered"
    refused = conversation.say("why to the right?", plan_only=True)
    assert refused.error is not None
    assert refused.error.code == "nothing_before"


def test_a_question_goes_on_with_what_it_compares(conversation: Conversation) -> None:
    conversation.say("is the coffee box lighter than the cereal box?")
    answer = conversation.say("and than the mug?").answer
    assert answer is not None
    assert answer.objects == ("coffee box",)
    assert "mug" in answer.text


@pytest.mark.parametrize(
    ("said", "remark"),
    [
        ("push it glorp", "more"),
        ("glorp the ice tea box 2 cm left", "i meant the ice tea"),
        ("use glorp the right one", "what is in it?"),
    ],
)
def test_what_could_lean_on_a_sentence_that_was_not_read_is_asked_back(
    conversation: Conversation, said: str, remark: str
) -> None:
    conversation.say("push the mug away", plan_only=True)
    assert conversation.say(said, plan_only=True).status == "not_understood"
    assert conversation.say(remark, plan_only=True).status == "not_understood"


def test_it_is_what_a_refused_sentence_named(conversation: Conversation) -> None:
    conversation.say("how tall is the cereal box?", plan_only=True)
    refused = conversation.say("zorp the ice tea box", plan_only=True)
    assert refused.error is not None
    assert refused.error.code == "unknown_verb"
    (frame,) = conversation.say("tilt it by 5 degrees", plan_only=True).frames
    assert frame.object is not None
    assert frame.object.id == "ice tea box"


def test_the_one_on_the_right_is_of_the_kind_that_was_spoken_of(conversation: Conversation) -> None:
    conversation.say("push the box on the left 3 cm away", plan_only=True)
    (frame,) = conversation.say("and the one on the right", plan_only=True).frames
    assert frame.object is not None
    assert frame.object.id == "coffee box"  # the mug stands farther right


def test_it_is_what_a_sentence_with_an_unknown_verb_named(conversation: Conversation) -> None:
    for text in ("push the coffee box 5 cm away", "now throw the cup in the bin", "why?"):
        conversation.say(text, plan_only=True)
    (frame,) = conversation.say("then push it 3 cm away", plan_only=True).frames
    assert frame.object is not None
    assert frame.object.id == "ice tea cup"


def test_the_one_moved_first_is_that_of_the_plans_where_nothing_was_moved(
    conversation: Conversation,
) -> None:
    said = ("push the mug away", "push the cereal box left", "lift the one you moved first")
    result = [conversation.say(text, plan_only=True) for text in said][-1]
    assert [frame.object.id for frame in result.frames if frame.object] == ["mug"]


def test_a_thing_and_its_place_need_nothing_before(conversation: Conversation) -> None:
    said = ("push the mug away", "cereal box next to the coffee box")
    result = [conversation.say(text, plan_only=True) for text in said][-1]
    (frame,) = result.frames
    assert (frame.action, frame.object and frame.object.id) == ("move", "cereal box")


def test_what_is_lost_may_be_named_by_some_of_its_words(conversation: Conversation) -> None:
    said = ("push the mug away", "blorp the big cereal over there", "faster")
    result = [conversation.say(text, plan_only=True) for text in said][-1]
    assert result.error is not None
    assert result.error.code == "nothing_before"
