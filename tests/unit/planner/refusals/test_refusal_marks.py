"""Marks of refusals: heights, lengths and angles where they are on the table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nlcontrol import Session
from planner.refusals.blocked import dead_end
from planner.types.world_state import HeightMark, LengthMark, Mark, ObstacleMark, TiltMark

BOX = "ice tea box"


@pytest.fixture(scope="module")
def kitchen() -> Session:
    return Session("kitchen")


def marks_of(session: Session, said: str) -> tuple[tuple[Mark, ...], dict[str, float]]:
    """Marks of a sentence that is refused, and the numbers of the error."""
    offer = session.plan(said)
    assert offer.result.error is not None
    assert offer.drawing is not None
    return offer.drawing.marks, offer.result.error.numbers


def test_heights_of_the_numbers_are_marked_once_each() -> None:
    numbers = {"critical_height": 0.12, "lowest_asked": 0.15, "lowest_height": 0.15, "ways": 3.0}
    found = dead_end("fell", numbers, object=BOX, side="its back").refusal.marks
    assert [mark.height for mark in found if isinstance(mark, HeightMark)] == [0.12, 0.15]


def test_what_blocks_is_marked_and_what_is_never_met_is_not() -> None:
    taken = dead_end("place_taken", what="the mug", other=BOX).refusal
    assert taken.marks == (ObstacleMark(object=BOX, text=f"the {BOX} stands in the way"),)
    assert dead_end("never_met", object="mug", other=BOX).refusal.marks == ()


def test_a_height_that_topples_is_marked_on_the_object(kitchen: Session) -> None:
    marks, numbers = marks_of(kitchen, f"push the {BOX} at the top without toppling it")
    heights = {mark.height for mark in marks if isinstance(mark, HeightMark)}
    assert {numbers["critical_height"], numbers["lowest_asked"]} <= heights
    assert {mark.object for mark in marks if isinstance(mark, HeightMark)} == {BOX}


def test_what_is_free_is_marked_from_the_side_of_the_object_to_what_stands_there(
    kitchen: Session,
) -> None:
    marks, numbers = marks_of(kitchen, "push the mug 3 m away")
    (length,) = (mark for mark in marks if isinstance(mark, LengthMark))
    along = np.subtract(length.end_W, length.start_W)
    # Points are told to a hundredth of a millimetre.
    assert np.linalg.norm(along) == pytest.approx(numbers["free"], abs=2e-5)
    assert along[0] > 0.3
    seen = {each.name: each for each in kitchen.look().objects}
    assert length.start_W[0] - seen["mug"].x == pytest.approx(seen["mug"].size[0] / 2, abs=1e-3)
    assert length.asked == pytest.approx(3.0)
    assert ObstacleMark(object="coffee box", text="the coffee box stands in the way") in marks


def test_the_angle_of_no_return_is_marked_at_the_edge_over_which_it_tips(kitchen: Session) -> None:
    marks, numbers = marks_of(kitchen, f"tilt the {BOX} by 40 degrees")
    (mark,) = marks
    assert isinstance(mark, TiltMark)
    assert mark.angle == numbers["stay_on_base_angle"]
    box = next(each for each in kitchen.look().objects if each.name == BOX)
    away = math.dist(mark.edge_W[:2], (box.x, box.y))
    assert away == pytest.approx(box.size[0] / 2, abs=1e-3)
    # It turns about its edge towards the side on which the edge is.
    over = np.cross(mark.axis_W, [0.0, 0.0, 1.0])
    assert over @ np.subtract(mark.edge_W, [box.x, box.y, 0.0]) > 0.04
