"""Who is seen to stand on whom."""

from __future__ import annotations

from dataclasses import replace

import pytest

from planner.problem.stacks import put_on, stack_with, with_supports
from planner.types.world_state import PlanarPose
from tests.unit.planner.conftest import world

BOOK = 0.03  # its height [m]


def test_what_is_as_high_as_a_top_below_it_stands_there() -> None:
    state = world(
        book=PlanarPose(0.4, 0.0),
        mug=PlanarPose(0.42, 0.03),
        tea_tin=PlanarPose(0.42, 0.03),
        sugar_box=PlanarPose(0.4, 0.3),
    )
    tin = state.objects["tea tin"].model.top
    heights = {"book": 0.001, "tea tin": BOOK + 0.004, "mug": BOOK + tin - 0.005, "sugar box": 0.03}
    found = with_supports(state.objects, heights)
    assert {name: seen.on for name, seen in found.items()} == {
        "book": None, "tea tin": "book", "mug": "tea tin", "sugar box": None,
    }  # fmt: skip
    assert found["mug"].pose.z == BOOK + tin
    assert found["sugar box"].pose.z == 0.0
    assert found["mug"].top_height == BOOK + tin + state.objects["mug"].model.top


@pytest.mark.parametrize(("off", "stands"), [(0.011, True), (0.013, False)])
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_camera_may_be_off_by_12_mm(off: float, stands: bool, way: float) -> None:
    state = world(book=PlanarPose(0.4, 0.0), mug=PlanarPose(0.42, 0.03))
    found = with_supports(state.objects, {"book": 0.0, "mug": BOOK + way * off})
    assert (found["mug"].on == "book") == stands


def test_what_is_seen_less_than_12_mm_over_the_table_stands_on_it() -> None:
    state = world(book=PlanarPose(0.4, 0.0), mug=PlanarPose(0.42, 0.03))
    book = state.objects["book"]
    thin = book.model.model_copy(update={"size": (0.15, 0.22, 0.008)})
    objects = {**state.objects, "book": replace(book, model=thin)}
    for height, on in ((0.0115, None), (0.0125, "book")):
        assert with_supports(objects, {"book": 0.0, "mug": height})["mug"].on == on


def test_a_stack_has_all_that_its_lowest_object_carries() -> None:
    state = world(
        book=PlanarPose(0.4, 0.0), tea_tin=PlanarPose(0.38, 0.05), mug=PlanarPose(0.1, 0.0)
    )
    book = state.objects["book"]
    objects = {**state.objects, "tea tin": put_on(state.objects["tea tin"], book)}
    there = put_on(state.objects["mug"], book)
    assert [seen.name for seen in stack_with(there, objects)] == ["book", "tea tin", "mug"]
    assert [seen.name for seen in stack_with(objects["mug"], objects)] == ["mug"]


def test_what_is_within_the_walls_of_an_open_box_stands_in_it() -> None:
    state = world(
        storage_bin=PlanarPose(0.4, 0.0),
        mug=PlanarPose(0.42, 0.03),
        tea_tin=PlanarPose(0.4, 0.25),
        book=PlanarPose(0.4, 0.0),
    )
    # A camera that is off by 3 mm sees what stands in it lower than its floor.
    heights = {"storage bin": 0.002, "mug": 0.001, "tea tin": 0.004, "book": 0.061}
    found = with_supports(state.objects, heights)
    assert {name: seen.on for name, seen in found.items()} == {
        "storage bin": None, "mug": "storage bin", "tea tin": None, "book": None,
    }  # fmt: skip
    assert found["mug"].pose.z == 0.004
