"""Remarks on what was said and done before, as frames made by hand, in the kitchen."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from grammar.frames import command as g
from nlcontrol.results.result import Result
from nlcontrol.session.conversation import Conversation
from planner.types.plan import Plan
from tests.fakes.played_executor import PlayedExecutor, played
from tests.unit.nlcontrol.pushes import Happens

AWAY = "push the coffee box away"
PUSH = "push the ice tea box away"


def plan(conversation: Conversation, *sentences: str) -> Result:
    """What comes of the last of some sentences, none of which is executed."""
    return [conversation.say(text, plan_only=True) for text in sentences][-1]


def goal(result: Result) -> tuple[str | None, Any]:
    (frame,) = result.frames
    assert isinstance(frame.goal, g.Displace)
    assert frame.object is not None
    return frame.object.id, (frame.goal.direction, frame.goal.distance, frame.goal.amount)


@pytest.mark.parametrize(
    ("remark", "object_", "asked"),
    [
        ("again", "coffee box", ("away", 0.1, None)),
        ("push it again", "coffee box", ("away", 0.1, None)),
        ("push it to the right again", "coffee box", ("right", 0.1, None)),
        ("push the cereal box again", "cereal box", ("away", 0.1, None)),
        ("a bit more", "coffee box", ("away", None, "little")),
        ("5 cm more", "coffee box", ("away", 0.05, None)),
        ("a bit more to the right", "coffee box", ("right", None, "little")),
        ("no, I meant the cereal box", "cereal box", ("away", 0.1, None)),
        ("no, to the right", "coffee box", ("right", 0.1, None)),
        ("no, 5 cm", "coffee box", ("away", 0.05, None)),
        ("5 cm", "coffee box", ("away", 0.05, None)),
        ("to the right", "coffee box", ("right", 0.1, None)),
        ("push it to the right", "coffee box", ("right", None, None)),
    ],
)
def test_a_remark_becomes_the_frame_that_it_means(
    conversation: Conversation, remark: str, object_: str, asked: tuple[object, ...]
) -> None:
    result = plan(conversation, f"{AWAY} 10 cm", remark)
    assert (result.status, result.text) == ("planned", remark)
    assert goal(result) == (object_, asked)
    assert isinstance(result.plan, Plan)
    assert result.plan.push.object == object_


def test_remarks_may_follow_one_another(conversation: Conversation) -> None:
    result = plan(
        conversation, AWAY, "a bit more to the right", "no, I meant the cereal box", "again"
    )
    assert goal(result) == ("cereal box", ("right", None, "little"))
    assert conversation.context.last == ("cereal box",)


def test_the_words_of_an_earlier_sentence_are_not_quoted_from_this_one(
    conversation: Conversation,
) -> None:
    result = plan(conversation, f"{AWAY} without toppling it", "no, to the right")
    (frame,) = result.frames
    assert frame.goal.spans == ((4, 16),)
    assert [clause.spans for clause in frame.constraints] == [()]
    assert result.paraphrase == "push the coffee box to the right without toppling it"


@pytest.mark.parametrize("remark", ["again", "a bit more", "no, 5 cm", "undo that", "why?"])
def test_nothing_before(conversation: Conversation, remark: str) -> None:
    result = plan(conversation, remark)
    assert (result.status, result.exit_status) == ("not_understood", 3)
    assert result.error is not None
    assert result.error.code == "nothing_before"
    assert result.error.suggestions


def test_nothing_is_remembered_by_the_controller_alone(conversation: Conversation) -> None:
    Conversation(conversation.controller).say(AWAY, plan_only=True)
    assert Conversation(conversation.controller).say("again").error is not None


def test_a_correction_answers_the_question_which_one(conversation: Conversation) -> None:
    asked = plan(conversation, "push the box away, without touching the ice tea box")
    assert asked.error is not None
    assert asked.error.code == "ambiguous_object"
    result = plan(conversation, "no, I meant the cereal box")
    assert goal(result)[0] == "cereal box"
    other = result.frames[0].constraints[0]
    assert isinstance(other, g.NoTouch)
    assert other.object is not None
    assert other.object.id == "ice tea box"


def test_a_correction_takes_the_place_of_the_name_that_was_wrong(
    conversation: Conversation,
) -> None:
    asked = plan(conversation, "push the cereal box away without touching the box")
    assert asked.status == "not_understood"
    result = plan(conversation, "no, I meant the cereal box")
    assert result.frames[0].object is not None
    assert result.frames[0].object.id == "cereal box"
    clause = result.frames[0].constraints[0]
    assert isinstance(clause, g.NoTouch)
    assert clause.object is not None
    assert (clause.object.text, clause.object.id) == ("cereal box", "cereal box")


@pytest.mark.parametrize("remark", ["no, to the right", "to the right", "5 cm"])
def test_what_was_not_understood_cannot_be_corrected(
    conversation: Conversation, remark: str
) -> None:
    result = plan(conversation, AWAY, "frobnicate it", remark)
    assert result.error is not None
    assert result.error.code == "nothing_before"
    assert plan(conversation, "again").status == "not_understood"


def test_behind_what_was_not_understood_a_name_corrects_nothing(
    conversation: Conversation,
) -> None:
    result = plan(conversation, AWAY, "frobnicate it", "no, the mug")
    assert result.error is not None
    assert result.error.code == "nothing_before"


def test_of_names_in_what_was_not_understood_the_longest_is_meant(
    conversation: Conversation,
) -> None:
    result = plan(conversation, "frobnicate the ice tea box", "turn it 45 degrees clockwise")
    assert result.frames[0].object is not None
    assert result.frames[0].object.id == "ice tea box"


def test_behind_a_question_on_how_it_stands_a_way_is_of_the_last_command(
    conversation: Conversation,
) -> None:
    asked = plan(conversation, AWAY, "is the mug standing?", "and now 5 cm to the left")
    assert (asked.status, asked.answer) == ("planned", None)


def test_what_was_not_understood_is_not_done_anyway(conversation: Conversation) -> None:
    result = plan(conversation, AWAY, "frobnicate the mug", "do it anyway")
    assert result.error is not None
    assert result.error.code == "nothing_before"


def test_the_taller_one_and_the_other_one_are_of_those_compared(
    conversation: Conversation,
) -> None:
    compared = "which is taller, the mug or the coffee box?"
    taller = plan(conversation, compared, "push the taller one away", "3 cm")
    assert goal(taller) == ("coffee box", ("away", 0.03, None))
    assert goal(plan(conversation, "now the other one")) == ("mug", ("away", 0.03, None))
    tallest = plan(conversation, compared, "push the tallest one away")
    assert goal(tallest)[0] == "cereal box"


def test_the_taller_one_is_asked_for_where_no_two_were_compared(
    conversation: Conversation,
) -> None:
    result = plan(conversation, "push the taller one away")
    assert result.error is not None
    assert result.error.code == "ambiguous_object"
    assert result.error.suggestions
    assert goal(plan(conversation, "push the tallest one away"))[0] == "cereal box"


def test_the_other_one_is_asked_for_once_a_third_was_handled(conversation: Conversation) -> None:
    compared = "which is taller, the mug or the coffee box?"
    result = plan(conversation, compared, "push the cereal box away", "now the other one")
    assert result.error is not None
    assert result.error.code == "ambiguous_object"


def test_it_is_not_what_the_sentence_names_besides(conversation: Conversation) -> None:
    said = ("push the mug away", "how heavy is the coffee box?", "push it next to the coffee box")
    (frame,) = plan(conversation, *said).frames
    assert frame.object is not None
    assert frame.object.id == "mug"


def test_the_same_is_done_with_each(conversation: Conversation) -> None:
    both = "do the same to the mug and the cereal box"
    frames = plan(conversation, f"{AWAY} 4 cm", both).frames
    assert [frame.object and frame.object.id for frame in frames] == ["mug", "cereal box"]
    assert {getattr(frame.goal, "distance", None) for frame in frames} == {0.04}


def test_a_question_and_a_remark_go_on_with_the_last_command(conversation: Conversation) -> None:
    asked = plan(conversation, "can you topple the coffee box?", "and the cereal box?")
    assert asked.frames[0].query == "possible"
    assert asked.frames[0].object is not None
    assert asked.frames[0].object.id == "cereal box"
    result = plan(conversation, AWAY, "and now 5 cm to the left")
    assert goal(result) == ("coffee box", ("left", 0.05, None))


def test_a_remark_that_cannot_be_taken_leaves_the_sentence_before(
    conversation: Conversation,
) -> None:
    assert plan(conversation, AWAY, "undo that").error is not None
    assert goal(plan(conversation, "no, to the right")) == ("coffee box", ("right", None, None))


def test_of_several_frames_the_first_is_planned(conversation: Conversation) -> None:
    result = plan(conversation, "push the coffee box away, then again")
    assert [frame.action for frame in result.frames] == ["push", "push"]
    assert [step.status for step in result.steps] == ["planned"]
    assert "first of 2 steps" in result.notes[0]
    assert result.notes[0] in str(result)


def test_stop_is_answered_quietly(conversation: Conversation) -> None:
    result = plan(conversation, "stop")
    assert (result.ok, result.status, result.exit_status) == (True, "done", 0)
    assert result.answer is not None
    assert result.answer.text in str(result)
    assert "every clause held" not in str(result)


@pytest.mark.parametrize("question", ["why?", "why did you push it there?"])
def test_why_this_push(conversation: Conversation, question: str) -> None:
    result = plan(conversation, AWAY, question)
    assert (result.ok, result.status) == (True, "answered")
    assert result.answer is not None
    planned = conversation.say(AWAY, plan_only=True).plan
    assert isinstance(planned, Plan)
    height = planned.push.prediction.critical_height
    assert height is not None
    assert f"topple only when pushed above {1e3 * height:.0f} mm" in result.answer.text
    assert planned.push.margins.height == pytest.approx(result.answer.numbers["margin_height"])
    assert f"{1e3 * planned.push.p_BC[2]:.0f} mm above the table" in result.answer.text
    assert Result.model_validate_json(result.to_json()) == result


def test_why_it_was_refused(conversation: Conversation) -> None:
    refused = plan(conversation, "push the ice tea box at the top")
    assert refused.error is not None
    result = plan(conversation, "why?")
    assert result.answer is not None
    assert refused.error.message in result.answer.text
    assert result.answer.numbers == refused.error.numbers


@pytest.mark.slow
def test_why_another_push_would_not_do(conversation: Conversation) -> None:
    result = plan(conversation, "push the ice tea box away", "why can you not push it at the top?")
    assert result.answer is not None
    assert result.answer.text.startswith("I cannot: at the top means 153 mm or higher")


def test_a_correction_tells_that_it_was_done(
    conversation: Conversation, stage: PlayedExecutor
) -> None:
    conversation.say(PUSH)
    conversation.say(AWAY, plan_only=True)
    assert conversation.say("no, 5 cm", plan_only=True).notes == ()
    conversation.say(PUSH)
    result = conversation.say("no, to the right", plan_only=True)
    assert result.notes == (f"already carried out: “{PUSH}”; that is left as it is",)
    assert len(stage.executed) == 2


@pytest.mark.slow
def test_more_after_a_place_goes_on_where_all_pushes_led(
    conversation: Conversation, stage: PlayedExecutor
) -> None:
    # Over two faces: the first push alone went elsewhere.
    conversation.say("put the ice tea box at x 52 cm, y 7 cm")
    assert len(stage.executed) == 2
    result = conversation.say("a bit more", plan_only=True)
    (frame,) = result.frames
    assert isinstance(frame.goal, g.Displace)
    assert frame.goal.heading == pytest.approx(math.radians(45.0), abs=0.02)  # seen within 1 mm


def test_why_a_clause_failed(
    conversation: Conversation,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    halves = (goes(share=0.5, end="guard"), stands(force=60.0))
    played(conversation.controller, *halves)
    failed = conversation.say(PUSH)
    assert (failed.status, len(failed.steps[0].plans)) == ("failed", 2)
    result = conversation.say("why?")
    assert result.answer is not None
    assert (
        "moved in the asked direction was 50 mm, where 100 mm ± 10 mm was asked"
        in result.answer.text
    )
    assert "ended early" in result.answer.text
    assert failed.steps[0].stuck is not None
    assert f"Nothing more was done: {failed.steps[0].stuck}." in result.answer.text


def test_behind_what_named_another_object_a_bare_remark_is_asked_back(
    conversation: Conversation,
) -> None:
    result = plan(conversation, AWAY, "blorp the mug", "faster")
    assert result.error is not None
    assert result.error.code == "nothing_before"
    assert plan(conversation, "the mug again").error is not None
    assert goal(plan(conversation, "push the mug away"))[0] == "mug"


def test_behind_a_question_in_vain_a_further_question_does_nothing(
    conversation: Conversation,
) -> None:
    result = plan(conversation, AWAY, "what colour has the mug?", "and the cereal box?")
    assert result.error is not None
    assert result.error.code == "nothing_before"


def test_a_remark_that_a_kept_clause_forbids_does_nothing(conversation: Conversation) -> None:
    said = "push the mug to the left without touching the coffee box"
    result = plan(conversation, said, "do the same with the coffee box")
    assert (result.status, result.error and result.error.code) == (
        "not_understood",
        "nothing_before",
    )
    other = plan(conversation, said, "do the same but with the cereal box")
    assert [frame.object and frame.object.id for frame in other.frames] == ["cereal box"]


@pytest.mark.parametrize(
    ("remark", "constraint"),
    [("do it with one finger", "effector"), ("do that gently", "gentle"), ("quicker", "fast")],
)
def test_the_last_command_is_done_as_a_remark_says(
    conversation: Conversation, remark: str, constraint: str
) -> None:
    result = plan(conversation, AWAY, remark)
    assert [c.kind for c in result.frames[0].constraints] == [constraint]


def test_a_question_is_about_the_last_command(conversation: Conversation) -> None:
    asked = plan(conversation, AWAY, "would it topple?").frames[0]
    assert (asked.query, asked.event, asked.action) == ("predict", "tips", "push")
    (lower,) = plan(conversation, "and lower?").frames
    assert [c.kind for c in lower.constraints] == ["contact"]
    assert lower.query == "predict"


def test_back_is_the_other_way(conversation: Conversation) -> None:
    left = plan(conversation, "push the mug 3 cm to the left", "and back again")
    assert goal(left) == ("mug", ("right", 0.03, None))


def test_the_other_one_and_both_are_of_two_that_were_spoken_of(conversation: Conversation) -> None:
    said = ("push the mug 3 cm away", "push the cereal box 4 cm away", "now the other one")
    assert goal(plan(conversation, *said)) == ("mug", ("away", 0.04, None))
    both = plan(conversation, "both of them").frames
    assert {f.object.id for f in both if f.object} == {"mug", "cereal box"}
