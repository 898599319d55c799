"""Words near two meanings: each is read as the one that people mean, or refused where it stands."""

from __future__ import annotations

import pytest

from grammar import ParseError, parse


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("push the tin to the left straight away", "push the tin to the left"),
        ("straight away, push the tin to the left", "push the tin to the left"),
        ("push the tin straight away", "push the tin away"),
        ("push the tin straight away from me", "push the tin away"),
        ("back to work: push the tin to the right", "push the tin to the right"),
        ("no rush, but push the tin away", "push the tin away"),
        ("push the tin away. No hurry.", "push the tin away"),
        ("push the tin away with no hurry", "slowly push the tin away"),
        ("push the tin left, then stop", "push the tin to the left"),
        ("then stop", "stop"),
        ("why not push the tin away?", "push the tin away"),
        ("why not?", "why?"),
        ("actually, push the tin away", "push the tin away"),
        ("actually, push it away", "no, push it away"),
        ("move the tin, that is, behind the jar", "move the tin behind the jar"),
        ("slide the tin that is behind the jar", "slide the tin that is behind the jar"),
        ("haul up the tin", "lift the tin"),
        ("it would be best if the tin was lifted", "lift the tin"),
        ("take the tin and push it left", "push the tin to the left"),
        ("take the tin and put it behind the jar", "lift the tin, then put it behind the jar"),
        ("lift the tin and push it left", "lift the tin, then push it to the left"),
        ("slide the tin so it is in the middle", "slide the tin to the middle"),
        ("push the tin beside the jar, on its left", "push the tin left of the jar"),
        ("turn the tin without moving the jar", "turn the tin without touching the jar"),
        ("give a gentle push to the tin", "gently push the tin"),
        ("push this tin here to the left", "push the tin to the left"),
        ("put them both together", "put them both together"),
        ("push the tin to the left right away please", "push the tin to the left"),
        ("just quickly push the tin away", "push the tin away"),
        ("push the tin away just quickly", "quickly push the tin away"),
        ("can you quickly push the tin away?", "push the tin away"),
        ("push the tin further away", "push the tin away"),
        ("push it further away", "push it away more"),
        ("push the tin until it touches the jar a bit slowly",
         "push the tin until it touches the jar slowly"),
        ("move right, the tin a little away", "move the tin away a little"),
        ("turn the tin through 45 degrees", "turn the tin by 45 degrees"),
        ("lift the tin onto the jar", "put the tin on the jar"),
        ("lift the tin on the jar", "lift the tin that is on the jar"),
        ("lower the tin onto the jar", "put the tin on the jar"),
        ("pick up the tin and lower it", "lift the tin, then set it down"),
        ("lower", "more at the bottom"),
        ("grip the jar's lid and remove it from the jar",
         'lift "jar\'s lid", then open the lid of the jar'),
        ("push the tin left sorry right", "push the tin to the right"),
        ("push the tin left, you know why", "push the tin to the left"),
        ("push the object called tin left", "push the tin to the left"),
        ("lift the tin, whatever happens", "lift the tin"),
        ("slide the tin left with no toppling", "slide the tin to the left without toppling it"),
        ("ignore the others and lift the tin", "lift the tin"),
        ("push the tin over to where I am", "push the tin toward the robot"),
        ("push the tin to the left, no?", "push the tin to the left"),
        ("push the tin left as I said", "push the tin to the left"),
        ("move the tin so it is further left", "move the tin to the left"),
        ("would it be possible for you to push the tin left", "push the tin to the left"),
        ("push the tin left avoiding the jar", "push the tin to the left without touching the jar"),
        ("push the tin in front in front of the jar", "push the tin in front of the jar"),
        ("lift it until it is aligned with the jar", "lift it until it is in line with the jar"),
        ("lift it with one hand um at most 2 cm/s", "lift it with one hand at most 0.02 m/s"),
        ("the tin should go behind the jar", "move the tin behind the jar"),
        ("push the tin below the jar", "push the tin in front of the jar"),
        ("is the tin on the table?", "is the tin on the table?"),
        ("is the red tin on the table now?", "is the red tin on the table?"),
        ("is the tin on the book?", "is the tin on the book?"),
        ("which red box is the heaviest?", "which red box is the heaviest?"),
        ("which is the heaviest box?", "which box is the heaviest?"),
        ("right it", "stand it upright"),
        ("could you right the tin?", "stand the tin upright"),
        ("push it to the right, then right it", "push it to the right, then stand it upright"),
        ("right, push the tin", "push the tin"),
        ("will the tin be moved to the middle?", "is it possible to move the tin to the middle?"),
        ("will the tin be moved if you push it?", "will the tin move if you push it?"),
        ("push it directly toward the left jar", "push it toward the left jar"),
        ("what would be standing in the jar?", "what is in the jar?"),
        ("which can you topple right close to me?", "which can you topple toward the robot?"),
        ("lift the tin that is at the front side of the jar",
         "lift the tin that is in front of the jar"),
    ],
)  # fmt: skip
def test_words_near_two_meanings_are_read_as_meant(text: str, meant: str) -> None:
    assert parse(text).paraphrase == meant


@pytest.mark.parametrize(
    ("text", "words", "code"),
    [
        ("take the tin to the right of the jar", "to the right of the jar", "does_not_apply"),
        ("heave the tin toward me", "heave", "unknown_verb"),
        ("pull the tin next to the jar on the left side", "on the left side", "does_not_apply"),
        ("move the tin next to the jar, on the left", "on the left", "unexpected_words"),
        ("slide the tin so that it stands on the left", "on the left", "unexpected_words"),
        ("push the tin one sec 3 cm to the right", "sec", "missing_unit"),
        ("push this tin here", "here", "unexpected_words"),
        ("bring down the tin to the left", "down", "unexpected_words"),
        ("in 5 seconds push the tin left", "in 5 seconds", "does_not_apply"),
        ("push the tin to the left, no", "no", "unexpected_words"),
        ("move the tin to the edge in front", "in front", "unexpected_words"),
        ("move the tin near the left", "near the left", "does_not_apply"),
        ("put the tin under the jar", "under the jar", "does_not_apply"),
        ("lift the tin right underneath the jar", "right underneath the jar", "does_not_apply"),
        ("what did you move first?", "first", "unexpected_words"),
        ("right it should be pushed", "pushed", "several_commands"),
        ("push the tin away until it touches the jar right", "right", "does_not_apply"),
    ],
)
def test_words_of_no_clear_meaning_are_refused_where_they_stand(
    text: str, words: str, code: str
) -> None:
    with pytest.raises(ParseError) as raised:
        parse(text)
    assert raised.value.code == code
    assert raised.value.span == (text.index(words), text.index(words) + len(words))
