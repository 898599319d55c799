"""Questions as people ask them, put plainly; none of them is read as a command."""

from __future__ import annotations

import pytest

from grammar.errors import ParseError
from grammar.parser import parser_for

KNOWN = parser_for({"mug", "jar", "tea tin", "soup can", "water bottle"})


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        # what a question is opened with, what asks for assent, words that ask nothing
        ("may I ask whether the jar is shut?", "is the jar closed?"),
        ("any idea how tall that is?", "how tall is that?"),
        ("do you think the tin is heavier than the jar?", "is the tin heavier than the jar?"),
        ("the jar isn't open, is it?", "is the jar open?"),
        ("how heavy would you say the jar is?", "how heavy is the jar?"),
        ("so how heavy is the jar really, in your opinion?", "how heavy is the jar?"),
        # what was done
        ("has anything been bumped?", "what did you do?"),
        ("how many newtons did you need?", "what did you do?"),
        ("Did it slip? By how much?", "what did you do?"),
        ("it ended where you thought it would, didn't it?", "what did you do?"),
        # how a value is known
        ("is that a measurement or only a guess?", "how do you know that?"),
        ("what do you base that on?", "how do you know that?"),
        # how things stand
        ("has the jar got its lid on?", "is the jar closed?"),
        ("is the lid off the jar?", "is the jar open?"),
        ("has the tin fallen over?", "is the tin lying down?"),
        ("how close is the mug to the edge?", "how far is the mug from the edge?"),
        ("is anything standing behind the jar?", "what is behind the jar?"),
        ("is the jar closer to me than the mug?", "is the jar more distant than the mug?"),
        ("are the mug and the jar touching?", "is the mug against the jar?"),
        # what is there, what can be done, what would happen
        ("how many objects are on the table, and which ones have caps?", "what do you see?"),
        ("what all are you able to do?", "what can you do?"),
        ("suppose I asked you to tilt the jar, what would follow?",
         "what happens if you tilt the jar?"),
        ("would 4 N be enough to shift the jar?", "what happens if you push the jar with 4 N?"),
        ("is there room for the mug between the jar and the tin?",
         "is it possible to put the mug between the jar and the tin?"),
        ("how much force would be needed to topple the jar?",
         "how hard do you have to topple the jar?"),
        ("could you pull the jar, if you had to?", "is it possible to pull the jar?"),
        ("it won't topple, will it?", "would it topple?"),
        ("where has the jar gone?", "where is the jar?"),
        ("what's the friction like under the jar?", "what is the friction of the jar?"),
        ("state the weight and friction of the mug",
         "what is the mass and the friction of the mug?"),
        ("compare its weight with that of the jar", "is it heavier than the jar?"),
        ("what would happen if the jar were shoved to the left?",
         "what happens if you push the jar to the left?"),
        ("how much juice is left in it?", "what is in it?"),
        ("how far is the jar from your hand?", "how far is the jar?"),
        ("which of them is the most heavy?", "which is the heaviest?"),
        ("how far off is the jar from the mug?", "how far is the jar from the mug?"),
        ("what is the reason you stopped there?", "why?"),
        ("why on that side?", "why?"),
    ],
)  # fmt: skip
def test_question_is_read_as_the_plain_one(said: str, plain: str) -> None:
    assert KNOWN.parse(said, []).paraphrase == KNOWN.parse(plain, []).paraphrase


@pytest.mark.parametrize(
    "said",
    [
        "you won't tip the mug over, will you?",
        "I want them level. Is the jar open?",
        "Did it move at all? If it didn't, push it again.",
        "Not the mug. How heavy is it?",
        "Suppose I told you to lift the jar, how glad would you be?",
    ],
)
def test_question_beside_something_else_is_refused(said: str) -> None:
    with pytest.raises(ParseError):
        KNOWN.parse(said, [])
