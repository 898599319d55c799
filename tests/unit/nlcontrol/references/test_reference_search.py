"""What tells objects apart: colours, sizes, positions, and what they stand beside."""

from __future__ import annotations

import math
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.references.object_names import Candidate, with_attribute
from nlcontrol.references.reference_resolution import resolve_references
from nlcontrol.references.reference_search import Context
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import BoxModel, Registry
from planner.problem.footprints import gap
from planner.problem.stacks import put_on
from planner.types.world_state import Colour, PlanarPose, SeenObject, WorldState
from tests.sizes import examples

RED, BLUE, GREEN = (0.8, 0.1, 0.1), (0.1, 0.2, 0.8), (0.1, 0.6, 0.2)


def _box(
    name: str,
    x: float,
    y: float,
    colour: Colour | None = RED,
    size: tuple[float, float, float] = (0.08, 0.08, 0.20),
    mass: float = 0.5,
    mass_sd: float = 0.0,
) -> SeenObject:
    model = BoxModel(name="carton", size=size, mass=mass, mass_sd=mass_sd, friction=0.4)
    return SeenObject(name, PlanarPose(x, y), model, colour=colour)


def _ref(text: str, *qualities: str, **fields: Any) -> g.ObjectRef:
    """A reference as the sentence has it: "the red one", whose noun is what else there is."""
    words = [w for w in text.split() if w not in qualities and w != "one"]
    noun = " ".join(words) if qualities else ""
    fields = {"text": text, "qualities": qualities, "noun": noun, **fields}
    return g.ObjectRef.model_validate(fields)


def _resolved(ref: g.ObjectRef, *seen: SeenObject, last: tuple[str, ...] = ()) -> str:
    table = [Candidate(s.name, (s.name, s.model.name)) for s in seen]
    state = WorldState({s.name: s for s in seen})
    command = g.Command(text="", frames=(g.Frame(object=ref),), paraphrase="")
    (frame,) = resolve_references(command, table, (), lambda: state, Context(last)).frames
    assert frame.object is not None
    assert frame.object.id is not None
    return frame.object.id


def _refused(ref: g.ObjectRef, *seen: SeenObject) -> ControlError:
    with pytest.raises(ControlError) as raised:
        _resolved(ref, *seen)
    return raised.value


def _in(scene: str, ref: g.ObjectRef) -> str:
    controller = Controller(scene, registry=Registry.built_in())
    command = g.Command(text="", frames=(g.Frame(object=ref),), paraphrase="")
    (frame,) = controller.resolve(command).frames
    assert frame.object is not None
    assert frame.object.id is not None
    return frame.object.id


@pytest.mark.parametrize(
    ("scene", "ref", "name"),
    [
        ("kitchen", _ref("red box", "red"), "cereal box"),
        ("kitchen", _ref("yellow one", "yellow"), "ice tea box"),
        ("kitchen", _ref("brown object", "brown"), "coffee box"),
        ("kitchen", _ref("tall box", "tall"), "cereal box"),
        ("kitchen", _ref("short box", "short"), "coffee box"),
        ("kitchen", _ref("big box", "big"), "cereal box"),
        ("kitchen", _ref("wide box", "wide"), "cereal box"),
        ("kitchen", _ref("heavy box", "heavy"), "ice tea box"),
        ("kitchen", _ref("light box", "light"), "cereal box"),
        ("kitchen", _ref("left box", "left"), "cereal box"),
        ("kitchen", _ref("right box", "right"), "coffee box"),
        ("kitchen", _ref("middle box", "middle"), "ice tea box"),
        ("kitchen", _ref("near box", "near"), "ice tea box"),
        ("kitchen", _ref("box", relation="left_of", reference=[_ref("ice tea box")]), "cereal box"),
        ("kitchen", _ref("box", relation="right_of", reference=[_ref("tea box")]), "coffee box"),
        (
            "kitchen",
            _ref("box", relation="between", reference=[_ref("coffee"), _ref("cereal")]),
            "ice tea box",
        ),
        ("kitchen", _ref("near box", "near", reference=[_ref("coffee")]), "ice tea box"),
        ("counter", _ref("one", relation="next_to", reference=[_ref("mug")]), "soup can"),
        ("counter", _ref("one", relation="next_to", reference=[_ref("red one", "red")]), "mug"),
        ("counter", _ref("green thing", "green"), "tea tin"),
        ("counter", _ref("far one", "far"), "tea tin"),
    ],
)
def test_the_built_in_scenes(scene: str, ref: g.ObjectRef, name: str) -> None:
    assert _in(scene, ref) == name


def test_adjectives_that_belong_to_a_name_are_no_qualities() -> None:
    shoe, other = _box("left shoe", 0.5, -0.3), _box("right shoe", 0.5, 0.3)
    assert _resolved(_ref("left shoe", "left"), shoe, other) == "left shoe"
    can, crate = _box("red bull can", 0.5, 0.0, BLUE), _box("soup can", 0.5, 0.3, RED)
    assert _resolved(_ref("red bull can", "red"), can, crate) == "red bull can"
    assert _resolved(_ref("red can", "red"), can, crate) == "red bull can"


def test_a_quality_outside_the_words_counts_though_they_are_a_name() -> None:
    mug, near, far = _box("mug", 0.5, 0.0), _box("tea box", 0.5, 0.2), _box("box", 0.5, 0.5)
    nearest = _ref("box", "near", noun="box", reference=[_ref("mug")])
    assert _resolved(nearest, mug, near, far) == "box"  # the whole name decides
    nearest = _ref("carton", "near", noun="carton", reference=[_ref("mug")])
    assert _resolved(nearest, mug, near, far) == "tea box"
    leftmost = _ref("carton", "left", noun="carton")
    assert _resolved(leftmost, mug, near, far) == "box"


def test_colours_narrow_down_before_sizes() -> None:
    tall, red, small = (
        _box("a", 0.5, 0.3, BLUE, (0.08, 0.08, 0.3)),
        _box("b", 0.5, 0.0, RED, (0.08, 0.08, 0.2)),
        _box("c", 0.5, -0.3, RED, (0.08, 0.08, 0.1)),
    )
    for ref in (_ref("tall red one", "tall", "red"), _ref("red tall one", "red", "tall")):
        assert _resolved(ref, tall, red, small) == "b"


def test_of_two_about_equally_tall_the_left_one() -> None:
    """Qualities narrow down from the noun outwards."""
    boxes = (
        _box("a", 0.5, 0.1, size=(0.08, 0.08, 0.30)),
        _box("b", 0.5, -0.1, size=(0.08, 0.08, 0.29)),
        _box("c", 0.5, 0.3, size=(0.08, 0.08, 0.10)),
    )
    assert _resolved(_ref("left tall one", "left", "tall"), *boxes) == "a"
    assert _refused(_ref("tall one", "tall"), *boxes).info.suggestions == (
        "the left tall one",
        "the right tall one",
    )


@pytest.mark.parametrize(
    ("quality", "apart", "close"),
    [
        # Just more and just less than 10 % of the larger, 2 cm, and the masses' uncertainty.
        ("tall", {"size": (0.08, 0.08, 0.223)}, {"size": (0.08, 0.08, 0.221)}),
        ("short", {"size": (0.08, 0.08, 0.179)}, {"size": (0.08, 0.08, 0.181)}),
        ("big", {"size": (0.089, 0.08, 0.20)}, {"size": (0.088, 0.08, 0.20)}),
        ("small", {"size": (0.0715, 0.08, 0.20)}, {"size": (0.0725, 0.08, 0.20)}),
        ("wide", {"size": (0.08, 0.0895, 0.20)}, {"size": (0.08, 0.0885, 0.20)}),
        ("narrow", {"size": (0.08, 0.0715, 0.20)}, {"size": (0.08, 0.0725, 0.20)}),
        ("heavy", {"mass": 0.56}, {"mass": 0.55}),
        ("heavy", {"mass": 0.61, "mass_sd": 0.1}, {"mass": 0.59, "mass_sd": 0.1}),
        ("light", {"mass": 0.44}, {"mass": 0.46}),
        ("left", {"y": 0.021}, {"y": 0.019}),
        ("right", {"y": -0.021}, {"y": -0.019}),
        ("near", {"x": 0.479}, {"x": 0.481}),
        ("far", {"x": 0.521}, {"x": 0.519}),
    ],
)
def test_near_ties_are_not_guessed(
    quality: str, apart: dict[str, Any], close: dict[str, Any]
) -> None:
    here: dict[str, Any] = {"x": 0.5, "y": 0.0}
    plain, ref = _box("plain", **here), _ref(f"{quality} one", quality)
    assert _resolved(ref, plain, _box("more", **(here | apart))) == "more"
    refused = _refused(ref, plain, _box("more", **(here | close)))
    assert refused.code == "ambiguous_object"


def test_the_middle_one_of_a_row_and_of_a_file() -> None:
    row = [_box("a", 0.5, -0.3), _box("b", 0.51, 0.1), _box("c", 0.52, 0.3)]
    file = [_box(n, x, 0.0) for n, x in zip("abc", (0.5, 0.3, 0.7), strict=True)]
    middle = _ref("middle one", "middle")
    assert _resolved(middle, *row) == "b"
    assert _resolved(middle, *file) == "a"
    assert _refused(middle, *row[:2]).code == "ambiguous_object"


def test_width_is_what_the_robot_sees() -> None:
    """A long box that points at the robot is narrow, one across it wide."""
    long = (0.2, 0.05, 0.1)
    along, across = _box("along", 0.5, 0.2, size=long), _box("across", 0.5, -0.2, size=long)
    turned = SeenObject("across", PlanarPose(0.5, -0.2, math.pi / 2), across.model)
    assert _resolved(_ref("wide one", "wide"), along, turned) == "across"
    assert _resolved(_ref("narrow one", "narrow"), along, turned) == "along"


def test_what_has_fallen_is_as_tall_as_it_lies_and_keeps_its_colour() -> None:
    standing = _box("standing", 0.5, 0.3, BLUE)
    attitude = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0)
    pose = PlanarPose(0.5, 0.0, 0.0, attitude)
    fallen = SeenObject.lying("fallen", pose, standing.model, GREEN)
    assert _resolved(_ref("short one", "short"), standing, fallen) == "fallen"
    assert _resolved(_ref("green one", "green"), standing, fallen) == "fallen"


@pytest.mark.parametrize(
    ("relation", "name"),
    [
        ("left_of", "left"),
        ("right_of", "right"),
        ("behind", "behind"),
        ("in_front_of", "front"),
        ("touching", "front"),
        ("next_to", "front"),
    ],
)
def test_relations_are_seen_from_the_robot(relation: str, name: str) -> None:
    boxes = (
        _box("mug", 0.5, 0.0),
        _box("left", 0.52, 0.2),
        _box("right", 0.48, -0.2),
        _box("behind", 0.7, 0.02),
        _box("front", 0.415, 0.02),
        _box("far off", 0.5, 0.6),
    )
    ref = _ref("carton", relation=relation, reference=[_ref("mug")])
    assert _resolved(ref, *boxes) == name


def test_on_is_standing_on_it() -> None:
    book = _box("book", 0.5, 0.0, size=(0.2, 0.2, 0.03))
    boxes = (book, put_on(_box("above", 0.55, 0.05), book), _box("beside", 0.5, 0.2))
    assert _resolved(_ref("carton", relation="on", reference=[_ref("book")]), *boxes) == "above"


def test_two_about_equally_near_are_ambiguous_and_none_beside_is_none() -> None:
    mug = _box("mug", 0.5, 0.0)
    ref = _ref("carton", relation="next_to", reference=[_ref("mug")])
    refused = _refused(ref, mug, _box("a", 0.5, 0.2, GREEN), _box("b", 0.5, -0.21, BLUE))
    assert "say which: a or b" in refused.info.message
    assert _resolved(ref, mug, _box("a", 0.5, 0.2), _box("b", 0.5, -0.23)) == "a"
    refused = _refused(ref, mug, _box("a", 0.5, 0.6), _box("b", 0.5, -0.6))
    assert refused.code == "unknown_object"
    assert refused.info.message.startswith("there is no 'carton next to the mug' on the table")
    refused = _refused(_ref("red carton", "red"), _box("a", 0.5, 0.6, BLUE))
    assert refused.info.suggestions == ("the a",)


def test_it_beside_an_object_is_what_was_spoken_of() -> None:
    it = _ref("it", pronoun=True)
    boxes = (_box("a", 0.5, 0.0), _box("b", 0.5, 0.2), _box("c", 0.5, 0.5))
    ref = _ref("carton", relation="next_to", reference=[it])
    assert _resolved(ref, *boxes, last=("a",)) == "b"


def test_generic_nouns_are_told_apart_by_looks() -> None:
    boxes = (_box("a", 0.5, 0.2, RED), _box("b", 0.5, -0.2, BLUE))
    refused = _refused(_ref("thing"), *boxes)
    assert refused.info.suggestions == ("the red thing", "the blue thing")
    assert refused.info.message.endswith("say which: the red thing or the blue thing")
    alike = (boxes[0], _box("b", 0.5, -0.2, RED))
    refused = _refused(_ref("red one", "red"), *alike)
    assert refused.info.suggestions == ("the left red one", "the right red one")


def test_names_that_do_not_tell_apart_give_way_to_looks() -> None:
    """A synonym of one object may be the name of another."""
    a, b = _box("box", 0.5, 0.2, RED), _box("crate", 0.5, -0.2, BLUE)
    table = [Candidate("box", ("box",)), Candidate("crate", ("crate", "box"))]
    state = WorldState({s.name: s for s in (a, b)})
    command = g.Command(text="", frames=(g.Frame(object=_ref("box")),), paraphrase="")
    with pytest.raises(ControlError) as raised:
        resolve_references(command, table, (), lambda: state)
    assert raised.value.info.suggestions == ("the red box", "the blue box")


def test_one_look_is_enough() -> None:
    boxes = [_box("a", 0.5, 0.2), _box("b", 0.5, -0.2)]
    looks = []

    def look() -> WorldState:
        looks.append(1)
        return WorldState({s.name: s for s in boxes})

    frame = g.Frame(object=_ref("left one", "left"), goal=g.Displace(toward=_ref("one", "right")))
    command = g.Command(text="", frames=(frame, frame), paraphrase="")
    resolve_references(command, [Candidate(s.name, (s.name,)) for s in boxes], (), look)
    assert len(looks) == 1


def test_distance_between_footprints() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert gap(square, square + np.array([3.0, 0.5])) == pytest.approx(2.0)
    # Corner to corner, and corner to the middle of an edge.
    assert gap(square, square + np.array([4.0, 5.0])) == pytest.approx(5.0)
    diamond = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    assert gap(square, diamond + np.array([2.5, 0.5])) == pytest.approx(0.5)
    assert gap(square, square + 0.5) == pytest.approx(-0.5)


def test_objects_that_overlap_are_equally_near() -> None:
    mug, a, b = _box("mug", 0.5, 0.0), _box("a", 0.5, 0.01), _box("b", 0.5, -0.06)
    assert with_attribute("near", [a, b], [mug]) == [a, b]


QUALITIES = tuple(q for q in get_args(g.Quality) if q not in {"other", "same"})


@st.composite
def tables(draw: st.DrawFn) -> tuple[SeenObject, ...]:
    """A few boxes that stand on a grid, so that some are alike and some in line."""
    count = draw(st.integers(2, 5))
    cells = st.tuples(st.integers(0, 3), st.integers(0, 3))
    places = draw(st.lists(cells, min_size=count, max_size=count, unique=True))
    lengths = st.sampled_from([0.06, 0.061, 0.09, 0.12])
    return tuple(
        _box(
            f"box {'abcde'[i]}",
            0.3 + 0.15 * x,
            0.15 * y,
            draw(st.sampled_from([RED, BLUE, GREEN, None])),
            (draw(lengths), draw(lengths), draw(lengths)),
            draw(st.sampled_from([0.2, 0.21, 0.5])),
            0.02,
        )
        for i, (x, y) in enumerate(places)
    )


@st.composite
def references(draw: st.DrawFn) -> g.ObjectRef:
    noun = draw(st.sampled_from(["one", "box", "carton", "thing"]))
    qualities = draw(st.lists(st.sampled_from(QUALITIES), max_size=2, unique=True))
    fields: dict[str, Any] = {}
    if draw(st.booleans()):
        relations = st.sampled_from(["next_to", "left_of", "behind", "touching"])
        fields = {"relation": draw(relations), "reference": [_ref("box a")]}
    return _ref(" ".join([*qualities, noun]), *qualities, **fields)


def _read(text: str, asked: g.ObjectRef) -> g.ObjectRef:
    """What a suggestion says: adjectives up to the noun, then the place that was said."""
    plain, place, _ = text.removeprefix("the ").partition(" next to ")
    for words in (" to the left of ", " behind ", " touching "):
        if not place:
            plain, place, _ = plain.partition(words)
    qualities = [word for word in plain.split() if word in QUALITIES]
    fields: dict[str, Any] = {}
    if place:
        fields = {"relation": asked.relation, "reference": asked.reference}
    return _ref(plain, *qualities, **fields)


@given(tables(), references())
@example((_box("box a", 0.5, 0.2), _box("box b", 0.5, -0.2)), _ref("red one", "red"))
# Few tables have objects that cannot be told apart, which is no reason to give up.
@settings(
    max_examples=examples(300),
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
def test_what_an_ambiguity_offers_leads_to_each_object(
    table: tuple[SeenObject, ...], asked: g.ObjectRef
) -> None:
    try:
        _resolved(asked, *table)
        assume(False)
    except ControlError as raised:
        assume(raised.code == "ambiguous_object")
        info = raised.info
    led_to = [_resolved(_read(text, asked), *table) for text in info.suggestions]
    assert len(set(led_to)) == len(led_to) > 1
    assert all(f"{name}" in info.message for name in led_to)


@pytest.mark.parametrize(
    ("text", "more", "meant"),
    [
        ("push the ice tea box awya", "awya", "'away'"),
        ("push the ice tea box gentley to the left", "gentley", "'gently'"),
        ("push the coffee box blorply", "blorply", "leave out 'blorply'"),
    ],
)
def test_words_that_a_name_runs_on_into_are_pointed_at(text: str, more: str, meant: str) -> None:
    error = Conversation(Controller("kitchen")).say(text, plan_only=True).error
    assert error is not None
    assert (error.code, error.span) == (
        "unknown_object",
        (text.index(more), text.index(more) + len(more)),
    )
    assert meant in error.suggestions[0]
