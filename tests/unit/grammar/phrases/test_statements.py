"""What only tells something beside a command: what is left out, and what “it” means then."""

import pytest

from grammar import ParseError, parse


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("My aunt is coming over and the table is a mess. Push the mug away", "push the mug away"),
        ("The mug is rather close to the edge over there, so... push it away", "push the mug away"),
        ("The jar is in my way. Could you push the mug to the left?", "push the mug to the left"),
        ("The jar is in my way. Could you push it to the left?", "push the jar to the left"),
        ("That's not much. Then push it two centimetres away.", "push it away by 2 cm"),
        ("I never use the jar. Push it away.", "push the jar away"),
        ("My mother gave me the mug. Push it away.", "push the mug away"),
        ("Push the mug left, I don't need it at all.", "push the mug to the left"),
        ("Put the mug behind the jar. My sister always knocks things over.",
         "put the mug behind the jar"),
        ("Well, the kids are finally asleep, so let's tidy up: push the mug away, nobody uses it.",
         "push the mug away"),
        ("Now the jar. I never drink from a mug, so push it away.", "push the jar away"),
        ("I burned my hand yesterday, so please push the mug away.", "push the mug away"),
        ("My back hurts and I have no hands free, push the mug away", "push the mug away"),
        ("Let's begin with something easy: push the mug away.", "push the mug away"),
        ("Hang on, the jar is closed, so open that first.", "open the jar"),
        ("So at the bottom, then. Push it away.", "push it away at the bottom"),
        ("Blimey, that jar is in the way again. Push it away.", "push the jar away"),
        ("Stop, that's too risky. Push it left.", "push it to the left"),
    ],
)  # fmt: skip
def test_a_statement_changes_nothing_but_what_it_means(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase == plain


@pytest.mark.parametrize(
    "text",
    [
        "I want the mug on the left. Push it away.",  # a wish
        "Let's move the mug to the left, so push the jar away to somewhere nice.",
        "It was the cereal box. Push it away.",  # a correction
        "The tin goes left. Push the jar right.",  # another command
        "I don't need the jar. Push everything to the left.",  # is the jar meant, too?
        "I can't reach the mug and the jar. Bring it closer.",  # which of them?
        "Nobody may touch the jar. Push the mug away, would that work for all of us here.",
        "The mug must stay where it is. Push the jar away gently to somewhere nice.",
    ],
)
def test_what_may_say_what_is_meant_is_no_statement(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


@pytest.mark.parametrize(
    "text",
    [
        "Push the mug left. Never mind.",
        "Push the mug left. I was joking.",
        "Push the mug left. That was a mistake.",
        "Push the mug left. Later.",
        "Push the mug left. Not this one.",
        "Push the mug left, not it.",
        "Push the mug left. Stop.",
        "Nothing must happen to it. Push the mug left.",
        "Now all but the mug, 5 cm away.",
    ],
)
def test_what_takes_a_command_back_or_forbids_something_is_not_left_out(text: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert not any("thank you" in each for each in caught.value.suggestions)


def test_a_question_with_a_way_before_it_is_refused_quietly() -> None:
    with pytest.raises(ParseError):
        parse("at the top. did it blorp?")


def test_what_is_told_is_kept_as_an_aside() -> None:
    text = "My sister is coming over. Push the mug away."
    command = parse(text)
    assert [text[start:end] for start, end in command.asides] == ["My sister is coming over"]
