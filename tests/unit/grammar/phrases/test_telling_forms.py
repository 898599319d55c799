"""What tells something by its form, whatever its words, and what does not."""

import pytest

from grammar import ParseError, parse
from grammar.parser import parser_for

TELLING = (
    "The postman rang twice this morning.", "Somebody has moved my glasses.",
    "My daughter gave me this robot.", "They stand opposite you.", "Rome wasn't built in a day.",
    "It's catching the light.", "For this run the flask is my beaker.", "That concludes it.",
    "As you could see, it didn't fall.", "You're a good soul.", "In my day we'd have used a spoon.",
    "Too close for my liking.", "Just as I feared.", "Plausible.", "Good seamanship.",
    "Quite a collection.", "Timber!", "The barometer remains unmoved.", "Nobody's reading it.",
)  # fmt: skip

EFFECTIVE = (
    "It must not fall.", "It mustn't touch the jar.", "It should go left.", "Later.", "Red.",
    "It belongs behind the jar.", "You should use two fingers.", "No higher than 5 cm.",
    "He wants it closer.", "My wife would like it nearer.", "I don't want it to fall.",
    "The handle should point at me.", "Ignore me.", "Slwoly.", "Lfet.", "Dance.",
    "It stops at the jar.", "It is 5 cm too far.", "That was only an example.",
    "This is about the jar.", "I regret that.", "Juggle the plates.", "Print your configuration.",
    "You push it left.", "I would turn it.", "It has to be slow.", "Two of them.",
)  # fmt: skip
"""What has an effect, or may have one: a wish, a constraint, a command, what takes back."""


@pytest.mark.parametrize("told", TELLING)
def test_what_tells_something_changes_nothing_before_a_command(told: str) -> None:
    command = parse(f"{told} Push the mug 5 cm away.")
    assert command.paraphrase == "push the mug away by 5 cm"
    assert command.asides


@pytest.mark.parametrize("said", EFFECTIVE)
@pytest.mark.parametrize("known", [True, False])
def test_what_has_an_effect_is_read_or_refused_behind_a_command(said: str, known: bool) -> None:
    read = parser_for(["mug", "jar"]).parse if known else parse
    try:
        command = read(f"Push the mug 5 cm away. {said}")
    except ParseError:
        return
    assert command.paraphrase != "push the mug away by 5 cm"


@pytest.mark.parametrize(
    "text",
    [
        "Sprocket. Push it left.",  # a name that is not known
        "Traffic was murder. Push it left.",
        "A sprocket fell down. Push it left.",
    ],
)
def test_it_is_not_what_was_spoken_of_before_something_else(text: str) -> None:
    known = parser_for(["mug", "jar"])
    try:
        command = known.parse(text)
    except ParseError:
        return
    assert command.frames[0].object is not None
    assert command.frames[0].object.text not in ("it", "mug", "jar")


def test_a_question_behind_a_command_is_not_left_out() -> None:
    with pytest.raises(ParseError):
        parse("Push the mug away. Has the moon any rings?")
