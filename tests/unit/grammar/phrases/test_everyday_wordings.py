"""What people say of lids, ways of moving, amounts and what went before, in everyday words."""

from __future__ import annotations

import pytest

from grammar.errors import ParseError
from grammar.parser import parser_for
from grammar.words.phrase_templates import needed_words

KNOWN = parser_for({"tea tin", "coffee box", "jar", "mug"})
BEFORE = ("push the mug 5 cm to the left",)


def frames(said: str) -> list[object]:
    """What a sentence says after another one, without the places of its words."""
    every = KNOWN.parse(said, BEFORE).frames
    return [_plain(frame.model_dump(exclude={"spans"})) for frame in every]


def _plain(value: object) -> object:
    if isinstance(value, dict):
        kept = {key: _plain(each) for key, each in value.items() if key != "spans"}
        return {k: v for k, v in kept.items() if not (k == "text" and value.get("pronoun"))}
    return [_plain(each) for each in value] if isinstance(value, list | tuple) else value


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        # lids
        ("whip the lid off the jar", "open the jar"),
        ("the cap needs to come off", "open it"),
        ("could you have the jar open?", "open the jar"),
        ("lid back on, nice and tight", "close it"),
        ("the jar, lid back on", "close the jar"),
        ("make sure the jar is properly shut", "close the jar"),
        # verbs
        ("plunk the mug next to the jar", "put the mug next to the jar"),
        ("clout the tea tin over", "knock the tea tin over"),
        ("get the tea tin back on its feet again", "stand the tea tin up"),
        ("let the mug and the jar switch places", "swap the mug and the jar"),
        ("leave the mug by the jar", "put the mug next to the jar"),
        ("ease the mug down", "gently lower the mug"),
        ("restore everything to its original position", "put everything back to its old place"),
        # several, and what goes for all of them
        ("push first the mug and then the jar 5 cm left",
         "push the mug 5 cm left, then push the jar 5 cm left"),
        ("pull first the mug, then the tea tin and then the jar nearer",
         "pull the mug nearer, then pull the tea tin nearer, then pull the jar nearer"),
        ("push the mug left, then the tea tin, then the jar right",
         "push the mug left, then push the tea tin left, then push the jar right"),
        # back, and what is meant instead
        ("lift the jar, then move it left and then back",
         "lift the jar, then move it left, then put it back to where it was"),
        ("push the jar left, then pull it back", "push the jar left, then pull it toward me"),
        ("push the mug left - right, I mean", "push the mug right"),
        ("push the mug 5 cm, 6 cm, I mean", "push the mug 6 cm"),
        ("do it, slowly", "do it slowly"),
        ("try that, but gently", "do it gently"),
        # what may be so
        ("is the jar too heavy for you", "is it possible to lift the jar?"),
        ("is it going to tip if you push it hard?", "will it tip if you push it hard?"),
        ("suppose you pushed the jar. Would it slide, or would it tip?",
         "will the jar topple if you push it?"),
        ("could you open it, I mean, are you able to?", "is it possible to open it?"),
        ("could you lift it, or is it too heavy?", "is it possible to lift it?"),
        ("what things are here on the table?", "what do you see?"),
        ("not so far, 3 cm is plenty", "no, by 3 cm"),
        ("push the jar away and put it back", "push the jar away, then put it back"),
        ("put it down and spin it once all the way round", "put it down and turn it a full turn"),
        # how, and what must not happen
        ("push the jar left without knocking anything over",
         "push the jar left without toppling it and without touching anything"),
        ("push the jar left without tipping anything else over",
         "push the jar left without touching anything"),
        ("push the jar left without hitting the mug over",
         "push the jar left without touching the mug"),
        ("push the jar left so that nothing falls over",
         "push the jar left without toppling it and without touching anything"),
        ("push the jar left, but limit the tilt to 10 degrees",
         "push the jar left without tilting it more than 10 degrees"),
        ("push the jar at its lower third", "push the jar at the bottom"),
        ("increase the force to four newtons", "no, with four newtons"),
        ("push the jar away ultra slow", "slowly push the jar away"),
        ("push the jar away, no sudden jerks", "slowly push the jar away"),
        ("push the jar away with barely any force", "gently push the jar away"),
        ("keep your fingers low and push the jar away", "push the jar away at the bottom"),
        ("push the jar away, it mustn't keel over", "push the jar away without toppling it"),
        ("push the jar away; stop if it starts to tip", "push the jar away without toppling it"),
        ("push the jar away, I'd hate to see it spill", "push the jar away without spilling it"),
        ("push the jar away, I don't want it scratched", "gently push the jar away"),
        ("push the jar left, steer clear of the mug", "push the jar left without touching the mug"),
        ("slide it left, stop just short of the mug", "slide it left without touching the mug"),
        ("push the jar away until it keels over", "push the jar away until it topples"),
        ("don't shove it too hard", "no, gently"),
        # amounts
        ("one more inch", "another 1 inch"),
        ("a further 3 cm", "3 cm more"),
        ("about half of that would be fine", "no, half way"),
        ("give back a quarter of it", "the other way a quarter of the way"),
        ("that's 2 cm too far", "the other way 2 cm"),
        ("push the jar left a palm's width", "push the jar left by 8 cm"),
        ("push the jar a little to the left, say 3 cm", "push the jar to the left by 3 cm"),
        ("nudge the jar a bit to the left, not too much", "nudge the jar a bit to the left"),
        ("push the jar to the left as far as it will go", "push the jar all the way to the left"),
        # what went before
        ("same shove on the jar", "do the same with the jar"),
        ("same but to the right", "again to the right"),
        ("switch them back again", "undo that"),
        ("bring the jar forward", "bring the jar to me"),
    ],
)  # fmt: skip
def test_everyday_words_mean_what_plain_ones_do(said: str, plain: str) -> None:
    assert frames(said) == frames(plain)


@pytest.mark.parametrize(
    "said",
    [
        "if it starts to tip, tell me",
        "suppose I asked you to push the mug away",
        "don't knock the lid off",
        "I want the jar open, but it's a long way off, so first move it next to the mug",
        "too fast by half",
        "push the mug a lot, 2 cm",
        "sorry not the mug I mean the jar push that to the right",
        "push the mug left when I say so",
        "push the mug left and back again",
        "push the mug 5 cm left and then 2 cm back",
        "push the mug so the jar is on its left",
        "push the mug, the blue one, left",
    ],
)
def test_what_is_not_clear_is_not_done(said: str) -> None:
    with pytest.raises(ParseError):
        KNOWN.parse(said, BEFORE)


def test_words_that_a_rewording_swallows_are_told() -> None:
    said = "why did you slide it instead of lifting it?"
    assert [said[slice(*aside)] for aside in KNOWN.parse(said, BEFORE).asides] == ["lifting it"]


def test_one_sentence_of_several_is_put_in_other_words() -> None:
    assert frames("Plunk the mug next to the jar. Lift the tea tin.") == frames(
        "Put the mug next to the jar. Lift the tea tin."
    )


def test_a_template_needs_a_word_of_each_of_its_pieces() -> None:
    needed = needed_words("[please] (get|take) {} off [now] (_ing|up) .")
    assert needed == [frozenset({"get", "take"}), frozenset({"off"}), frozenset(".;!?")]
