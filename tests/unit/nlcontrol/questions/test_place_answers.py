"""How far, beside what, in what, upright: asked of objects whose places are known by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grammar.frames import command as g
from nlcontrol import Registry
from nlcontrol.errors import ControlError
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.scene_answers import (
    distance_answer,
    edge_answer,
    far_answer,
    neighbours_answer,
    state_answer,
)
from planner.types.world_state import PlanarPose, SeenObject, WorldState

SIDE = 0.09  # of the ice tea box, which stands square to the table [m]
LYING = (1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)  # a quarter turn about x


def _state(*, on: str | None = None) -> WorldState:
    """A box in the middle, one 20 cm behind it, and a bin 40 cm to its left."""
    models = Registry.built_in()
    box = models.get("ice tea box")
    here = SeenObject("here", PlanarPose(0.5, 0.0), box, on=on)
    behind = SeenObject("behind", PlanarPose(0.7, 0.0), box)
    bin_ = SeenObject("bin", PlanarPose(0.5, 0.4), models.get("storage bin"))
    return WorldState({each.name: each for each in (here, behind, bin_)})


def _asked(goal: g.Goal, name: str = "here") -> g.Frame:
    return g.Frame(query="value", object=_ref(name), goal=goal)


def _ref(name: str) -> g.ObjectRef:
    return g.ObjectRef(text=name, id=name)


def _stands(relation: g.Relation, other: str, name: str = "here") -> g.Frame:
    return _asked(g.Place(relation=relation, reference=(_ref(other),)), name)


def test_a_distance_is_the_gap_and_that_of_the_middles() -> None:
    goal = g.Parameters(which=("distance",), than=(_ref("behind"),))
    found = distance_answer(_asked(goal), _state())
    assert found.numbers == pytest.approx({"gap": 0.2 - SIDE, "middles": 0.2})


@pytest.mark.parametrize(
    ("relation", "other", "yes"),
    [
        ("in_front_of", "behind", True),
        ("behind", "behind", False),
        ("right_of", "bin", True),
        ("left_of", "bin", False),
        ("touching", "behind", False),
        ("in", "bin", False),
    ],
)
def test_a_relation_is_as_it_is_seen(relation: g.Relation, other: str, *, yes: bool) -> None:
    assert state_answer(_stands(relation, other), _state()).yes is yes


def test_a_relation_tells_the_gap() -> None:
    found = state_answer(_stands("in_front_of", "behind"), _state())
    assert found.numbers == pytest.approx({"gap": 0.2 - SIDE})


def test_in_a_bin_is_not_on_it_and_on_a_box_is_not_in_it() -> None:
    def told(relation: g.Relation, other: str) -> Answer:
        return state_answer(_stands(relation, other), _state(on=other))

    assert told("in", "bin").yes
    assert not told("on", "bin").yes
    assert told("on", "behind").yes
    assert not told("in", "behind").yes


def test_what_stands_on_another_thing_is_not_on_the_table() -> None:
    assert state_answer(_asked(g.SetDown()), _state()).yes
    assert not state_answer(_asked(g.SetDown()), _state(on="behind")).yes


def test_what_lies_on_its_side_is_not_upright() -> None:
    state = _state()
    assert state_answer(_asked(g.Upright()), state).yes
    leaning = replace(state.objects["here"], attitude=LYING)
    fallen = replace(state, objects={**state.objects, "here": leaning})
    assert not state_answer(_asked(g.Upright()), fallen).yes


def test_what_stands_upright_does_not_lie() -> None:
    state = _state()
    assert not state_answer(_asked(g.Topple()), state).yes
    leaning = replace(state.objects["here"], attitude=LYING)
    fallen = replace(state, objects={**state.objects, "here": leaning})
    assert state_answer(_asked(g.Topple()), fallen).yes


@pytest.mark.parametrize(("lid", "is_open"), [(0.0, False), (1.5, True)])
def test_a_lid_is_open_or_closed(lid: float, *, is_open: bool) -> None:
    cup = SeenObject("cup", PlanarPose(0.5, 0.0), Registry.built_in().get("ice tea cup"), lid=lid)
    state = WorldState({"cup": cup})
    assert state_answer(_asked(g.Open(), "cup"), state).yes is is_open
    assert state_answer(_asked(g.Close(), "cup"), state).yes is not is_open


def test_of_a_thing_without_a_lid_neither_is_said() -> None:
    assert state_answer(_asked(g.Open()), _state()).yes is None


def test_the_distance_from_an_edge_is_to_the_nearest_corner() -> None:
    state = _state()  # whose table reaches from -0.2 to 1.2 m, and 0.8 m to both sides

    def gap(edge: g.TableRegion) -> float:
        return edge_answer(_asked(g.Displace(away_from=edge)), state).numbers["gap"]

    assert gap("back_edge") == pytest.approx(0.7 - SIDE / 2.0)
    assert gap("edge") == pytest.approx(0.7 - SIDE / 2.0)
    assert gap("left_edge") == pytest.approx(0.8 - SIDE / 2.0)


def test_only_the_distance_from_an_edge_is_told() -> None:
    with pytest.raises(ControlError, match="edge"):
        edge_answer(_asked(g.Displace(away_from="corner")), _state())


def test_what_stands_behind_a_thing_is_told() -> None:
    there = g.Place(relation="behind", reference=(_ref("here"),))
    assert neighbours_answer(there, _state()).objects == ("behind",)


def test_how_far_one_thing_is_without_another_is_from_the_robot() -> None:
    answer = far_answer(_asked(g.Parameters(which=("distance",)), "bin"), _state())
    assert "500 mm away from the robot, 400 mm to the left" in answer.text
