"""Words of courtesy: what closes, what only opens, and what asks for something all the same."""

from __future__ import annotations

import pytest

from grammar.errors import ParseError
from grammar.parser import parse


@pytest.mark.parametrize(
    "text",
    ["good job, robot", "we're done", "that's all folks", "thank you ever so much", "ok bye",
     ],
)  # fmt: skip
def test_who_closes_thanks(text: str) -> None:
    assert [frame.dialogue for frame in parse(text).frames] == ["thank"]


@pytest.mark.parametrize(
    ("text", "dialogue"),
    [("thanks, again", "repeat"),
     ("no thanks", "stop"), ("thank you, stop", "stop"), ("can you?", "repeat"),
     ("no, right", "correct"), ("okay do that, but gently", "do")],
)  # fmt: skip
def test_what_asks_for_something_is_no_courtesy(text: str, dialogue: str) -> None:
    assert [frame.dialogue for frame in parse(text).frames] == [dialogue]


@pytest.mark.parametrize("text", ["good morning", "too far", "too much"])
def test_greetings_and_complaints_ask_for_nothing(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("let's start with the jar: push it away", "push the jar away"),
        ("what about the jar, could you push it away?", "push the jar away"),
        ("push the jar with at most 9 N, er, at most 5 N", "push the jar with at most 5 N"),
        ("push the jar with 9 N for 3 s, er, 4 s", "push the jar with 9 N for 4 s"),
        ("not that far, push the jar 3 cm away", "push the jar 3 cm away"),
    ],
)
def test_what_stands_around_a_command_changes_nothing(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the jar 5 cm, right", "push the jar 5 cm to the right"),
        ("push the jar 5 cm, ahead please", "push the jar 5 cm away"),
        ("ahead, push the jar", "push the jar away"),
        ("push the jar, over please", "topple the jar"),
        ("push the jar, quick please", "quickly push the jar"),
        ("lift the jar 5 cm more slowly", "slowly lift the jar 5 cm"),
        ("push the jar 5 cm with force at most 5 N", "push the jar 5 cm with at most 5 N"),
        ("push the jar so it is out of my way", "push the jar out of the way"),
        ("push the jar to get it out of the way", "push the jar out of the way"),
    ],
)
def test_what_says_where_or_how_is_no_courtesy(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("move the jar 5 cm, right, toward me", "move the jar 5 cm toward me"),
        ("push the jar away, right?", "push the jar away"),
        ("push the jar away. Over.", "push the jar away"),
        ("go right ahead, push the jar", "push the jar"),
        ("push the jar behind the tin, that's the plan", "push the jar behind the tin"),
        ("try to please turn the jar 30 degrees", "turn the jar 30 degrees"),
    ],
)
def test_courtesy_beside_what_says_where_changes_nothing(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize("text", ["enough", "Enough!", "no thanks"])
def test_who_has_enough_stops_what_moves(text: str) -> None:
    assert parse(text).frames[0].dialogue == "stop"


def test_making_contact_is_touching() -> None:
    text = "push the tin away without {} the jar"
    said = parse(text.format("making any contact with"))
    assert said.paraphrase == parse(text.format("touching")).paraphrase


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("there is a jar on the table. Push it away", "push the jar away"),
        ("here is an old jar, could you tip it over?", "topple the old jar"),
        ("there is a jar beside the tin and push it", "push the jar that is beside the tin"),
        ("there is a jar. Is it heavy?", "is the jar heavy?"),
        ("look for the jar. Push it away", "push the jar away"),
        ("it is the jar that should be pushed away, not the tin", "push the jar away"),
        ("what my jar needs is a gentle push to the left", "gently push the jar to the left"),
    ],
)
def test_a_thing_may_be_named_before_what_is_done_to_it(text: str, plain: str) -> None:
    assert parse(text).paraphrase == parse(plain).paraphrase


@pytest.mark.parametrize(
    "text",
    [
        "it is the jar that should not be pushed away",
        "it is the jar that was pushed",
        "what the jar needs is a friend",
        "there is a jar on the table and a tin. Push it away",
    ],
)
def test_what_is_told_of_a_thing_asks_for_nothing(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)


def test_where_a_new_thing_stands_on_the_table_is_kept_as_an_aside() -> None:
    command = parse("there is a jar on the table. Push it away")
    assert [command.text[start:end] for start, end in command.asides] == ["on the table"]
