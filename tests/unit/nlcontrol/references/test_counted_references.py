"""Several objects and which of a row: from the sentence to the objects on the table, in order."""

from __future__ import annotations

import pytest

from grammar.frames import command as g
from grammar.parser import parse
from nlcontrol.errors import ControlError
from nlcontrol.references.object_names import Candidate
from nlcontrol.references.reference_resolution import NOTHING_SAID, resolve_references
from nlcontrol.references.reference_search import Context
from objectmodels import BoxModel
from planner.types.world_state import PlanarPose, SeenObject, WorldState

RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.2, 0.8)


def _seen(name: str, x: float, y: float, height: float, friction: float) -> SeenObject:
    model = BoxModel(name=name, size=(0.08, 0.08, height), mass=0.5, friction=friction)
    return SeenObject(name, PlanarPose(x, y), model, colour=RED if name == "tin c" else BLUE)


# From the left: a, b, c, and the mug; from the robot: b, c, a, mug.
TABLE = (
    _seen("tin a", 0.70, 0.3, 0.10, 0.5),
    _seen("tin b", 0.50, 0.1, 0.20, 0.3),
    _seen("tin c", 0.60, -0.1, 0.15, 0.4),
    _seen("mug", 0.80, -0.3, 0.12, 0.6),
)
NAMES = [Candidate(s.name, (s.name,)) for s in TABLE]


def _resolved(text: str, context: Context = NOTHING_SAID) -> tuple[g.Frame, ...]:
    state = WorldState({s.name: s for s in TABLE})
    return resolve_references(parse(text), NAMES, (), lambda: state, context).frames


def _objects(text: str, context: Context = NOTHING_SAID) -> list[str | None]:
    return [frame.object.id for frame in _resolved(text, context) if frame.object]


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("push the tins away", ["tin a", "tin c", "tin b"]),
        ("push the red tins away", ["tin c"]),
        (
            "push tin b and the mug away, then push each of them to the left",
            ["tin b", "mug", "tin b", "mug"],
        ),
        # Not next to itself.
        ("put everything next to the mug", ["tin b", "tin c", "tin a"]),
        # What is foremost on the way goes first, so that no step hits what comes later.
        ("push all the tins away", ["tin a", "tin c", "tin b"]),
        ("pull all the tins", ["tin b", "tin c", "tin a"]),
        ("push every tin to the left", ["tin a", "tin b", "tin c"]),
        ("push all tins to the right", ["tin c", "tin b", "tin a"]),
        ("lift all the tins", ["tin b", "tin c", "tin a"]),
        ("push everything away except the mug", ["tin a", "tin c", "tin b"]),
        ("push every tin but the red one away", ["tin a", "tin b"]),
        ("push the mug and all the tins away", ["mug", "tin a", "tin c", "tin b"]),
        ("push one of the tins away", ["tin b"]),
        ("push the mug away, then push the rest to the left", ["mug", "tin a", "tin b", "tin c"]),
        ("push the third tin from the right away", ["tin a"]),
        ("push the second tin from the left away", ["tin b"]),
        ("push the second tallest tin away", ["tin c"]),
        ("push the tallest of the tins away", ["tin b"]),
        ("push the tin with the least friction away", ["tin b"]),
        ("push the tin that is the shortest away", ["tin a"]),
        ("slide the red tin away and the mug toward me", ["tin c", "mug"]),
    ],
)
def test_objects_of_a_sentence_in_their_order(text: str, names: list[str]) -> None:
    assert _objects(text) == names


def test_each_step_has_the_constraints() -> None:
    for frame in _resolved("push all the tins away without toppling them"):
        assert [clause.kind for clause in frame.constraints] == ["no_topple"]


def test_what_was_moved_tells_objects_apart() -> None:
    context = Context(moved=("tin c", "mug", "tin a"))
    assert _objects("push the tin that we moved first away", context) == ["tin c"]
    assert _objects("push the tin you moved last away", context) == ["tin a"]
    assert _objects("push the rest away", Context(latest=("tin a", "tin b", "tin c"))) == ["mug"]


def test_between_two_that_are_named_at_once() -> None:
    state = WorldState({s.name: s for s in TABLE if s.name != "tin b"})
    names = [each for each in NAMES if each.name != "tin b"]
    command = parse("move the mug between both tins")
    (frame,) = resolve_references(command, names, (), lambda: state).frames
    assert isinstance(frame.goal, g.Place)
    assert isinstance(frame.goal.reference, tuple)
    assert [ref.id for ref in frame.goal.reference] == ["tin a", "tin c"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("push both tins away", "unknown_object"),  # there are three
        ("push all the jars away", "unknown_object"),
        ("push the tin that we moved first away", "no_antecedent"),
        ("push the tin away", "ambiguous_object"),
    ],
)
def test_what_does_not_fit_is_refused(text: str, code: str) -> None:
    with pytest.raises(ControlError) as raised:
        _resolved(text)
    assert raised.value.info.code == code
