"""The most of a text that is read, where the whole is not."""

import pytest

from grammar.parser import parser_for
from grammar.part_reader import understood_part

KNOWN = parser_for(["mug", "jar", "soup can"])


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("Push the mug left, so that the whatsit can see it", "push the mug to the left"),
        ("The whatsit frobs well, but push the jar 5 cm away and zorp it",
         "push the jar away by 5 cm"),
        ("Frobnicate! Lift the mug. Hold it. Then quuxify the jar.", "lift the mug, then lift it"),
    ],
)  # fmt: skip
def test_the_longest_part_that_is_a_command_is_read(text: str, means: str) -> None:
    command = understood_part(KNOWN, text, ())
    assert command is not None
    assert command.paraphrase == means


@pytest.mark.parametrize(
    "text",
    ["push the mug left, unless the whatsit frobs", "if the whatsit frobs, lift the mug",
     "lift the mug, but ask the whatsit first", "tomorrow we zorp, lift the mug"],
)  # fmt: skip
def test_what_restricts_a_command_is_never_left_out_of_an_offer(text: str) -> None:
    assert understood_part(KNOWN, text, ()) is None


@pytest.mark.parametrize("text", ["", "quux", "the mug, the jar, quux", "push the quux, zorp it"])
def test_there_is_no_part_without_an_action_and_known_names(text: str) -> None:
    assert understood_part(KNOWN, text, ()) is None


def test_a_text_of_many_parts_is_given_up_soon() -> None:
    assert understood_part(KNOWN, "zorp it, " * 50, ()) is None
