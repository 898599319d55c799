"""Names to objects: exact, by synonym, by part; never by guess."""

from __future__ import annotations

import pytest

from grammar import frames as g
from nlcontrol.errors import ControlError
from nlcontrol.resolve import Candidate, find, resolve

TABLE = (
    Candidate("ice tea box", ("ice tea box", "ice tea", "ice tea carton")),
    Candidate("cereal box", ("cereal box", "cereal")),
    Candidate("coffee box", ("coffee box", "coffee", "coffee pack")),
)
KNOWN = (*(c.names for c in TABLE), ("mug", "cup"))


def _ref(text: str) -> g.ObjectRef:
    return g.ObjectRef(text=text, spans=((9, 9 + len(text)),))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("ice tea box", "ice tea box"),
        ("Ice  Tea Box", "ice tea box"),
        ("the coffee", "coffee box"),
        ("ice-tea box", "ice tea box"),
        ("tea", "ice tea box"),
        ("tea box", "ice tea box"),
        ("pack", "coffee box"),
    ],
)
def test_names_that_lead_to_one_object(text: str, name: str) -> None:
    assert find(_ref(text), TABLE, KNOWN) == name


def test_a_part_that_fits_several_is_ambiguous_and_says_what_tells_them_apart() -> None:
    with pytest.raises(ControlError) as raised:
        find(_ref("box"), TABLE, KNOWN)
    info = raised.value.info
    assert info.code == "ambiguous_object"
    assert info.span == (9, 12)
    assert info.message.endswith("say which: ice tea, cereal or coffee")
    assert info.suggestions == ("the ice tea box", "the cereal box", "the coffee box")


def test_a_whole_name_wins_over_a_part_of_another() -> None:
    table = (Candidate("box", ("box",)), Candidate("tea box", ("tea box",)))
    assert find(_ref("box"), table, ()) == "box"


def test_two_objects_of_one_model_are_ambiguous() -> None:
    table = (
        Candidate("red box", ("red box", "ice tea box")),
        Candidate("blue box", ("blue box", "ice tea box")),
    )
    with pytest.raises(ControlError, match="red or blue"):
        find(_ref("ice tea box"), table, ())


@pytest.mark.parametrize("text", ["iced tee box", "ice tea bax", "icetea box"])
def test_a_misspelled_name_gets_a_suggestion_and_is_not_guessed(text: str) -> None:
    with pytest.raises(ControlError) as raised:
        find(_ref(text), TABLE, KNOWN)
    assert raised.value.code == "unknown_object"
    assert raised.value.info.suggestions == ("did you mean 'ice tea box'?",)


def test_near_ties_and_far_names_only_list_what_is_there() -> None:
    tie = (Candidate("box a", ("box a",)), Candidate("box b", ("box b",)))
    for text, table in (("box c", tie), ("elephant", TABLE), ("elephant", TABLE[:1])):
        with pytest.raises(ControlError) as raised:
            find(_ref(text), table, ())
        assert raised.value.info.suggestions == tuple(c.name for c in table)


@pytest.mark.parametrize("text", ["box tea", "tea tea", "big tea box"])
def test_words_that_are_no_part_of_a_name(text: str) -> None:
    with pytest.raises(ControlError) as raised:
        find(_ref(text), TABLE, KNOWN)
    assert raised.value.code == "unknown_object"


def test_known_but_not_on_the_table_has_a_code_of_its_own() -> None:
    with pytest.raises(ControlError) as raised:
        find(_ref("cup"), TABLE, KNOWN)
    assert raised.value.code == "not_on_table"
    assert "ice tea box, cereal box and coffee box" in raised.value.info.message


def test_every_reference_in_a_frame_is_bound() -> None:
    frame = g.Frame(
        action="push",
        object=_ref("ice tea"),
        goal=g.Displace(
            toward=_ref("coffee"), distance=g.RelativeLength(value=2, of=_ref("cereal"))
        ),
        constraints=(g.NoTopple(), g.NoTouch(object=_ref("cereal box"))),
    )
    place = g.Frame(goal=g.Place(relation="between", reference=(_ref("coffee"), _ref("cereal"))))
    command = g.Command(text="", frames=(frame, place), paraphrase="")
    first, second = resolve(command, TABLE, KNOWN).frames
    assert first.object is not None
    assert first.object.id == "ice tea box"
    assert isinstance(first.goal, g.Displace)
    assert isinstance(first.goal.toward, g.ObjectRef)
    assert first.goal.toward.id == "coffee box"
    assert isinstance(first.goal.distance, g.RelativeLength)
    assert first.goal.distance.of.id == "cereal box"
    assert isinstance(first.constraints[1], g.NoTouch)
    assert first.constraints[1].object is not None
    assert first.constraints[1].object.id == "cereal box"
    assert first.object.spans == frame.object.spans if frame.object else False
    assert isinstance(second.goal, g.Place)
    assert isinstance(second.goal.reference, tuple)
    assert [r.id for r in second.goal.reference] == ["coffee box", "cereal box"]
