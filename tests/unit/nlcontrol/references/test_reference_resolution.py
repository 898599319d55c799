"""Names to objects: exact, by synonym, by part; never by guess. And what "it" stands for."""

from __future__ import annotations

import pytest

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.references.object_names import Candidate
from nlcontrol.references.reference_resolution import (
    objects_spoken_of,
    parts_within,
    resolve_references,
)
from nlcontrol.references.reference_search import Context
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import Registry
from planner.types.world_state import WorldState
from sim.truth.scene_file import parse_scene

TABLE = (
    Candidate("ice tea box", ("ice tea box", "ice tea", "ice tea carton")),
    Candidate("cereal box", ("cereal box", "cereal")),
    Candidate("coffee box", ("coffee box", "coffee", "coffee pack")),
)
KNOWN = tuple(Registry.built_in())


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen", registry=Registry.built_in())


@pytest.fixture(scope="module")
def counter() -> Controller:
    return Controller("counter", registry=Registry.built_in())


def _ref(text: str, **fields: object) -> g.ObjectRef:
    return g.ObjectRef.model_validate({"text": text, "spans": ((9, 9 + len(text)),), **fields})


IT = _ref("it", pronoun=True)


def _command(*frames: g.Frame) -> g.Command:
    return g.Command(text="", frames=frames, paraphrase="")


def _not_looked() -> WorldState:
    raise AssertionError("names decide without a look")


def _named(text: str, table: tuple[Candidate, ...] = TABLE) -> str | None:
    """What a bare name leads to; nobody looks at the table for it."""
    command = _command(g.Frame(action="push", object=_ref(text)))
    (frame,) = resolve_references(command, table, KNOWN, _not_looked).frames
    assert frame.object is not None
    return frame.object.id


def _only(controller: Controller, frame: g.Frame, *last: str) -> g.Frame:
    (resolved,) = controller.resolve(_command(frame), Context(last)).frames
    return resolved


def _id(ref: object) -> str | None:
    assert isinstance(ref, g.ObjectRef)
    return ref.id


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
    assert _named(text) == name


def test_a_part_that_fits_several_is_ambiguous_and_says_what_tells_them_apart() -> None:
    with pytest.raises(ControlError) as raised:
        _named("box")
    info = raised.value.info
    assert info.code == "ambiguous_object"
    assert info.span == (9, 12)
    assert info.message.endswith("say which: ice tea, cereal or coffee")
    assert info.suggestions == ("the ice tea box", "the cereal box", "the coffee box")


def test_a_whole_name_wins_over_a_part_of_another() -> None:
    table = (Candidate("box", ("box",)), Candidate("tea box", ("tea box",)))
    assert _named("box", table) == "box"


def test_two_objects_of_one_model_are_ambiguous() -> None:
    table = (
        Candidate("red box", ("red box", "ice tea box")),
        Candidate("blue box", ("blue box", "ice tea box")),
    )
    with pytest.raises(ControlError, match="red or blue"):
        _named("ice tea box", table)


@pytest.mark.parametrize("text", ["iced tee box", "ice tea bax", "icetea box"])
def test_a_misspelled_name_gets_a_suggestion_and_is_not_guessed(text: str) -> None:
    with pytest.raises(ControlError) as raised:
        _named(text)
    assert raised.value.code == "unknown_object"
    assert raised.value.info.suggestions == ("did you mean 'ice tea box'?",)


def test_near_ties_and_far_names_only_list_what_is_there() -> None:
    tie = (Candidate("box a", ("box a",)), Candidate("box b", ("box b",)))
    for text, table in (("box c", tie), ("elephant", TABLE), ("elephant", TABLE[:1])):
        with pytest.raises(ControlError) as raised:
            _named(text, table)
        assert raised.value.info.suggestions == tuple(c.name for c in table)


@pytest.mark.parametrize("text", ["box tea", "tea tea", "big tea box"])
def test_words_that_are_no_part_of_a_name(text: str) -> None:
    with pytest.raises(ControlError) as raised:
        _named(text)
    assert raised.value.code == "unknown_object"


def test_known_but_not_on_the_table_has_a_code_of_its_own() -> None:
    with pytest.raises(ControlError) as raised:
        _named("coffee mug")
    assert raised.value.code == "not_on_table"
    assert "ice tea box, cereal box and coffee box" in raised.value.info.message


def test_every_reference_in_a_frame_is_bound(kitchen: Controller) -> None:
    frame = g.Frame(
        action="push",
        object=_ref("tea box"),
        goal=g.Displace(toward=_ref("coffee"), spans=((0, 3),)),
        constraints=(g.NoTopple(), g.NoTouch(object=_ref("cereal box"))),
    )
    place = g.Frame(
        object=_ref("ice tea box"),
        goal=g.Place(relation="between", reference=(_ref("coffee"), _ref("cereal"))),
    )
    first, second = kitchen.resolve(_command(frame, place)).frames
    assert first.object == _ref("tea box", id="ice tea box")
    assert first.goal == g.Displace(toward=_ref("coffee", id="coffee box"), spans=((0, 3),))
    assert first.constraints == (
        g.NoTopple(),
        g.NoTouch(object=_ref("cereal box", id="cereal box")),
    )
    assert isinstance(second.goal, g.Place)
    assert isinstance(second.goal.reference, tuple)
    assert [r.id for r in second.goal.reference] == ["coffee box", "cereal box"]
    assert objects_spoken_of(second) == ("ice tea box", "coffee box", "cereal box")
    # What is only not to be touched is not what "it" means next.
    assert objects_spoken_of(first) == ("ice tea box", "coffee box")
    refs = [part for part in parts_within(first) if isinstance(part, g.ObjectRef)]
    assert [ref.id for ref in refs] == ["ice tea box", "coffee box", "cereal box"]


def test_it_is_the_object_of_the_clause_before_then_what_the_dialogue_spoke_of(
    kitchen: Controller,
) -> None:
    it = g.Frame(action="push", object=IT)
    tea = g.Frame(action="push", object=_ref("tea box"), goal=g.Displace(toward=_ref("coffee")))
    frames = kitchen.resolve(_command(it, tea, it), Context(("cereal box",))).frames
    assert [_id(frame.object) for frame in frames] == ["cereal box", "ice tea box", "ice tea box"]


def test_it_without_anything_spoken_of_is_refused_unless_there_is_but_one(
    kitchen: Controller,
) -> None:
    with pytest.raises(ControlError) as raised:
        kitchen.resolve(_command(g.Frame(object=IT)))
    assert raised.value.code == "no_antecedent"
    assert raised.value.info.message == "'it' — nothing was spoken of yet"
    assert raised.value.info.suggestions == kitchen.cell.names
    assert raised.value.info.status.exit == 3
    command = _command(g.Frame(object=IT))
    (frame,) = resolve_references(command, TABLE[:1], KNOWN, _not_looked).frames
    assert _id(frame.object) == "ice tea box"


def test_it_in_a_goal_is_never_the_object_itself(kitchen: Controller) -> None:
    to_it = g.Frame(object=_ref("coffee"), goal=g.Place(relation="next_to", reference=(IT,)))
    goal = _only(kitchen, to_it, "coffee box", "cereal box").goal
    assert isinstance(goal, g.Place)
    assert isinstance(goal.reference, tuple)
    assert _id(goal.reference[0]) == "cereal box"
    with pytest.raises(ControlError) as raised:
        _only(kitchen, to_it, "coffee box")
    assert raised.value.code == "no_antecedent"


@pytest.mark.parametrize(
    ("goal", "meant"),
    [
        (g.Displace(direction="away"), "coffee box"),
        (g.Displace(toward=_ref("cereal")), "cereal box"),
    ],
)
def test_it_in_a_constraint(kitchen: Controller, goal: g.Goal, meant: str) -> None:
    """ "Without touching it": what the goal names, if it names something, else the object."""
    frame = g.Frame(object=_ref("coffee"), goal=goal, constraints=(g.NoTouch(object=IT),))
    (clause,) = _only(kitchen, frame, "ice tea box").constraints
    assert isinstance(clause, g.NoTouch)
    assert _id(clause.object) == meant


def test_the_other_one_and_the_same_one(kitchen: Controller, counter: Controller) -> None:
    other = g.Frame(object=_ref("other one", qualities=("other",)))
    other_box = g.Frame(object=_ref("other box", qualities=("other",), noun="box"))
    same = g.Frame(object=_ref("same box", pronoun=True, qualities=("same",), noun="box"))
    assert _id(_only(kitchen, same, "coffee box", "cereal box").object) == "coffee box"
    with pytest.raises(ControlError) as raised:
        _only(counter, same, "mug")
    assert raised.value.code == "unknown_object"
    with pytest.raises(ControlError, match="ice tea or cereal"):
        _only(kitchen, other_box, "coffee box")
    with pytest.raises(ControlError, match="ice tea box, cereal box, ice tea, mug or ice tea cup"):
        _only(kitchen, other, "coffee box")
    for frame in (other, other_box, same):
        with pytest.raises(ControlError) as raised:
            _only(kitchen, frame)
        assert raised.value.code == "no_antecedent"
    short = g.Frame(object=_ref("other short one", qualities=("other", "short")))
    assert _id(_only(kitchen, short, "coffee box").object) == "mug"
    assert _id(_only(kitchen, short, "mug").object) == "ice tea cup"


def test_the_other_one_in_a_goal_is_not_the_object(counter: Controller) -> None:
    other = _ref("other can", qualities=("other",), noun="soup can")
    frame = g.Frame(object=_ref("mug"), goal=g.Displace(toward=other))
    goal = _only(counter, frame, "soup can").goal
    assert isinstance(goal, g.Displace)
    assert _id(goal.toward) == "soup can"


def _length(side: str | None, of: g.ObjectRef, value: float = 2.0) -> g.RelativeLength:
    return g.RelativeLength.model_validate({"value": value, "of": of, "side": side})


@pytest.mark.parametrize(
    ("side", "of", "metres"),
    [
        # The models measure: cereal box 52 × 192 × 260 mm, coffee box 62 × 93 × 180 mm.
        ("width", _ref("its", pronoun=True), 2 * 0.052),
        ("length", _ref("its", pronoun=True), 2 * 0.192),
        ("height", _ref("its", pronoun=True), 2 * 0.26),
        (None, _ref("coffee box"), 2 * 0.062),
        ("width", _ref("box"), 2 * 0.052),  # fits several, the frame's own among them
        ("height", _ref("book"), 2 * 0.03),  # known, though not on the table
    ],
)
def test_lengths_measured_in_objects_become_metres(
    kitchen: Controller, side: str | None, of: g.ObjectRef, metres: float
) -> None:
    height = g.ContactHeight(value=_length("height", _ref("its", pronoun=True), 0.5), origin="top")
    frame = g.Frame(
        object=_ref("cereal"),
        goal=g.Displace(direction="away", distance=_length(side, of), spans=((4, 9),)),
        constraints=(g.ContactRegion(height=height),),
    )
    resolved = _only(kitchen, frame)
    assert isinstance(resolved.goal, g.Displace)
    assert resolved.goal.distance == pytest.approx(metres)
    assert resolved.goal.spans == ((4, 9),)
    (contact,) = resolved.constraints
    assert isinstance(contact, g.ContactRegion)
    assert contact.height == g.ContactHeight(value=0.13, origin="top")


def test_a_question_may_be_about_a_model_that_is_not_on_the_table(kitchen: Controller) -> None:
    can = _ref("soup can")
    heavy = g.Frame(query="value", object=can, goal=g.Parameters(which=("mass",)))
    assert _id(_only(kitchen, heavy).object) == "soup can"
    seen, state = kitchen.locate("soup can")
    assert (seen.pose.x, seen.pose.y) == kitchen.cell.table.centre_m
    assert list(state.objects) == ["soup can"]
    it = g.Frame(query="value", object=IT, goal=g.Parameters(which=("height",)))
    assert _id(kitchen.resolve(_command(heavy, it)).frames[1].object) == "soup can"
    for frame in (
        heavy.model_copy(update={"goal": g.Parameters(which=("position",))}),
        g.Frame(query="possible", object=can),
        g.Frame(query="predict", object=can, goal=g.Displace(toward=_ref("coffee"))),
        g.Frame(action="push", object=can),
    ):
        with pytest.raises(ControlError) as raised:
            _only(kitchen, frame)
        assert raised.value.code == "not_on_table"
    with pytest.raises(ControlError) as raised:
        kitchen.resolve(_command(heavy, g.Frame(action="push", object=IT)))
    assert raised.value.info.message.startswith("'it', the soup can, is known")


def test_undo_and_stop_need_no_object(kitchen: Controller) -> None:
    frame = g.Frame(dialogue="undo", object=IT)
    assert _only(kitchen, frame) == frame


def test_of_several_boxes_the_open_one_is_what_things_are_in() -> None:
    scene = parse_scene("""
version: 1
name: boxes
objects:
  - {name: storage bin, model: storage bin, pose: {x_m: 0.50, y_m: -0.05}}
  - {name: mug, model: mug, pose: {x_m: 0.50, y_m: 0.25}}
  - {name: sugar box, model: sugar box, pose: {x_m: 0.65, y_m: 0.25}}
""")
    robot = Controller(scene, registry=Registry.built_in())
    for said in ("put the mug in the box", "put the sugar box into the box"):
        (frame,) = robot.command(said).frames
        (resolved,) = robot.resolve(_command(frame)).frames
        assert isinstance(resolved.goal, g.Place)
        assert [_id(ref) for ref in resolved.goal.reference] == ["storage bin"]
    answer = Conversation(robot).say("what is in the box?").answer
    assert answer is not None
    assert answer.numbers == {"objects": 0.0}
    with pytest.raises(ControlError) as raised:
        robot.resolve(robot.command("push the box away"))
    assert raised.value.code == "ambiguous_object"
