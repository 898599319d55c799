"""What holds no word with an effect is kept as an aside, and nothing else is."""

import pytest

from grammar import ParseError, parse
from grammar.parser import parser_for
from tests.property.test_grammar_properties import meaning

PARSER = parser_for(["mug", "coffee box"])
SAID = "push the mug 5 cm to the left"


@pytest.mark.parametrize(
    "text",
    [
        "Not to worry. {}",
        "So far so good. {}",
        "Two down, one to go. {}",
        "Shall we go on? {}",
        "No need to apologise. {}",
        "Oh, that makes me nervous. {}",
        "This gives me the creeps. {}",
        "My heart is racing. {}",
        "That's slow. {}",
        "You can't even do that? All right, {}",
        "Welcome, everybody. {}",
        "Ladies and gentlemen, welcome to our little demonstration. {}",
        "Test one. {}",
        "Trial 2 of 5. {}",
        "Step 3: {}",
        "Number four: {}",
        "Now for the second test. {}",
        "Well done. As a finale, {}",
        "For our next trick, {}",
        "Close enough. {}",
        "Don't be shy. {}",
        "Back to work. {}",
        "{}, and we're done",
        "{}. End of series.",
        "{}. After this we are ready.",
        "{}. Let's see what happens.",
        "{}. Fingers crossed.",
        "{}, and then I'll leave you alone",
        "{}, so that nothing gets in",
        "{}, so that the people at the back can see it",
        "Or would it be better to... {}",
    ],
)
def test_what_only_tells_something_changes_nothing(text: str) -> None:
    said = PARSER.parse(text.format(SAID))
    assert meaning(said.frames) == meaning(parse(SAID).frames)


@pytest.mark.parametrize(
    "text",
    [
        "Nice soft landing. {}",
        "Easy does it. {}",
        "Take all the time you need. {}",
        "Paint the wall. {}",
        "That one. {}",
        "Not that way up. {}",
        "It should not scratch. {}",
        "It has to dry first. {}",
        "Good, airily. {}",
        "When the show starts, {}",
        "The vase. {}",
        "Nice coffee box. {}",
        "That goes to the right. {}",
        "{}. That stops behind the coffee box.",
    ],
)
def test_what_may_have_an_effect_is_no_aside(text: str) -> None:
    try:
        said = PARSER.parse(text.format(SAID))
    except ParseError:
        return
    assert meaning(said.frames) != meaning(parse(SAID).frames)


@pytest.mark.parametrize(
    "text",
    [
        "Not to worry. You have been very kind, thank you.",
        "Lovely, that looks much nicer.",
        "Very good. That concludes our demonstration, thank you for watching.",
    ],
)
def test_thanks_ask_for_nothing(text: str) -> None:
    (frame,) = parse(text).frames
    assert frame.dialogue == "thank"
    assert parse(text).asides or frame.spans


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("push the mug and the tin 5 cm to the right each", "push the mug and the tin 5 cm right"),
        ("push the mug and the tin 5 cm away, both", "push the mug and the tin 5 cm away"),
        ("turn the mug and the tin 30 degrees each", "turn the mug and the tin 30 degrees"),
        ("push the mug and the tin, each by 5 cm, away", "push the mug and the tin 5 cm away"),
        ("push the mug and the tin to the left in turn", "push the mug and the tin left"),
    ],
)
def test_what_is_done_to_each_is_done_to_those_that_are_named(text: str, plain: str) -> None:
    assert meaning(parse(text).frames) == meaning(parse(plain).frames)


def test_each_alone_is_an_object() -> None:
    (frame,) = parse("push each to the left").frames
    assert frame.object is not None
    assert frame.object.text == "each"


@pytest.mark.parametrize("pause", ["hm", "hmm", "mm", "er", "um", "ah", "let me see"])
def test_a_hesitation_takes_no_manner_back(pause: str) -> None:
    (frame,) = parse(f"push the mug gently, {pause}, slowly").frames
    assert {each.kind for each in frame.constraints} == {"gentle", "slow"}
