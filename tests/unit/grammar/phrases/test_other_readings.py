"""Other words for a sentence that is not read as it stands."""

from __future__ import annotations

import pytest

from grammar.errors import ParseError
from grammar.parser import parse, parser_for

KNOWN = parser_for({"tea tin", "coffee box", "jar"})


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        ("did you measure it?", "how sure are you?"),
        ("tea tin: mass?", "how heavy is the tea tin?"),
        ("gap between the jar and the tea tin?", "how far is the jar from the tea tin?"),
        ("why won't it budge?", "why?"),
        ("I need the jar open", "open the jar"),
        ("can you make the jar fall over?", "is it possible to topple the jar?"),
        ("next, the coffee box, same rotation", "the same with the coffee box"),
        ("let's do the jar instead", "no, the jar"),
        ("the one on the right", "no, the one on the right"),
        ("could you perhaps tell me how tall the jar is?", "how tall is the jar?"),
        ("tell me where the jar is", "where is the jar?"),
        ("what friction does the jar have?", "what is the friction of the jar?"),
        ("now put down", "put it down"),
        ("that's far enough", "enough"),
        ("the tea tin could go the same way", "the same with the tea tin"),
        ("which weighs more, the jar or the tea tin?", "is the jar heavier than the tea tin?"),
        ("and the jar, is that heavier?", "is the jar heavier?"),
        ("how much water is in the jar?", "how much is in the jar?"),
        ("how heavy is the jar, exactly?", "how heavy is the jar?"),
        ("for the jar it must be to the right", "now the jar to the right"),
        ("the jar can go to the left", "now the jar to the left"),
        ("make ten centimetres more", "ten centimetres more"),
        ("leave ten centimetres between them", "ten centimetres away from it"),
        ("back to where it was", "undo that"),
        ("treat the jar the same way", "do the same with the jar"),
        ("give the jar half a turn", "turn the jar by half a turn"),
        ("take the jar and put it back where it was", "undo the push of the jar"),
        ("now the jar. Take its lid off", "open the jar"),
        ("be careful with the jar, please. Push it away", "gently push the jar away"),
        ("is the jar left of the tea tin or behind it?", "is the jar left of the tea tin?"),
        ("give the jar a quarter turn to the left", "turn the jar by 90 degrees to the left"),
        ("the jar needs half a turn clockwise", "turn the jar clockwise by half a turn"),
        ("get the jar over here", "move the jar toward me"),
        ("turn the jar so that its label points to me", "turn the jar to face me"),
        (
            "the other way round: the jar should face the tea tin",
            "turn the jar to face the tea tin",
        ),
        ("roughly how heavy is the jar?", "how heavy is the jar?"),
        ("bring it to me, the jar I mean, but slowly", "bring the jar to me slowly"),
        ("I need the jar half full of tea", "fill the jar half full with tea"),
        ("it was better where it stood", "undo that"),
        ("did you move the jar?", "what did you do?"),
        ("which of the three boxes is the heaviest?", "which of the boxes is the heaviest?"),
        ("let's try the jar next, the same way", "the same with the jar"),
        ("not the jar, I meant the tea tin", "no, not the jar, the tea tin"),
        ("first the jar: move it 8 cm to the left", "move the jar 8 cm to the left"),
        ("now set it down to the right of the jar", "put it to the right of the jar"),
        ("push it there, and keep going until it tips", "do it until it tips"),
        ("now the jar, that should go next to the tea tin", "move the jar next to the tea tin"),
        ("jar. Ten centimetres left", "move the jar 10 cm to the left"),
    ],
)
def test_few_words_mean_what_many_do(said: str, plain: str) -> None:
    assert KNOWN.parse(said).paraphrase == KNOWN.parse(plain).paraphrase


@pytest.mark.parametrize("said", ["make it 8", "push the jar 5 cm and the tin 3"])
def test_a_number_needs_its_unit_outside_of_a_conversation(said: str) -> None:
    with pytest.raises(ParseError) as raised:
        parse(said)
    assert raised.value.code == "missing_unit"


def test_undoing_two_is_not_undoing_one() -> None:
    with pytest.raises(ParseError):
        KNOWN.parse("undo the last two")


def test_the_unit_is_that_of_the_last_sentence_that_has_one() -> None:
    before = ("is it upright?", "push the jar 5 mm", "push it 5 cm")
    assert KNOWN.parse("make it 8", before).frames[0].goal.model_dump()["distance"] == 0.008
    with pytest.raises(ParseError):
        KNOWN.parse("make it 8", ("push the jar 5 cm with 3 N",))


@pytest.mark.parametrize(
    "said",
    ["is the jar 5 cm to the left?", "the jar is left of the tin", "not the jar, 5 cm to the left"],
)
def test_what_is_only_said_of_a_thing_does_not_move_it(said: str) -> None:
    try:
        frames = KNOWN.parse(said).frames
    except ParseError:
        return
    assert all(frame.action is None for frame in frames)


def test_two_are_not_all_that_were_spoken_of() -> None:
    (frame,) = parse("push those two 10 cm away").frames
    assert frame.object is not None
    assert frame.object.quantifier == "both"


def test_a_can_is_a_thing_and_no_courtesy() -> None:
    assert parse("and to the can, but gently").frames[0].goal.kind == "place"


@pytest.mark.parametrize(
    "text",
    [
        "explain why you did it that way what can I do to it?",
        "how far did it go and push it left?",
        "why did you stop there, then lift it?",
    ],
)
def test_a_question_in_other_words_swallows_no_other_one_and_no_command(text: str) -> None:
    with pytest.raises(ParseError):
        parse(text)
