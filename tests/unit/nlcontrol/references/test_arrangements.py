"""Objects that are to stand to each other somehow: what each of them is asked."""

from __future__ import annotations

import numpy as np
import pytest

from grammar.frames import command as g
from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller

WORKBENCH = Controller("workbench")


def frames(text: str) -> tuple[g.Frame, ...]:
    return WORKBENCH.resolve(WORKBENCH.parse(text)).frames


def points(text: str) -> dict[str, tuple[float, float]]:
    found = {}
    for frame in frames(text):
        assert frame.object is not None
        assert isinstance(frame.goal, g.Place)
        assert isinstance(frame.goal.reference, g.Point)
        found[frame.object.id or ""] = frame.goal.reference.x, frame.goal.reference.y
    return found


def test_swapped_objects_go_where_the_other_stands() -> None:
    seen = WORKBENCH.look().objects
    there = points("swap the sugar box and the tea tin")
    # The camera's noise is 2 mm, its mean over a look less.
    for name, other in (("sugar box", "tea tin"), ("tea tin", "sugar box")):
        pose = seen[other].pose
        np.testing.assert_allclose(there[name], (pose.x, pose.y), atol=2e-3)


def test_objects_in_a_row_stand_on_one_line_in_their_order() -> None:
    there = points("put the tea tin, the cereal box and the sugar box in a row")
    assert len({x for x, _ in there.values()}) == 1
    assert there["tea tin"][1] < there["cereal box"][1] < there["sugar box"][1]


def test_what_has_the_largest_top_is_lowest_in_a_stack() -> None:
    stacked = frames("stack the sugar box, the tea tin and the cereal box")
    below = []
    for frame in stacked:
        assert isinstance(frame.goal, g.Place)
        assert isinstance(frame.goal.reference, tuple)
        assert frame.goal.relation == "on"
        below += [(frame.object and frame.object.id, frame.goal.reference[0].id)]
    # Tops of 99.8, 52.6 and 33.8 cm².
    assert below == [("tea tin", "cereal box"), ("sugar box", "tea tin")]


def test_only_what_stands_there_is_cleared() -> None:
    moved = [
        frame.object.id for frame in frames("clear the left half of the table") if frame.object
    ]
    # The cereal box stands on the middle line, the others on the left.
    assert sorted(filter(None, moved)) == ["cereal box", "ice tea box", "sugar box"]


def test_one_object_is_no_row() -> None:
    with pytest.raises(ControlError) as raised:
        frames("put the tea tin in a row")
    assert raised.value.info.code == "unknown_object"
