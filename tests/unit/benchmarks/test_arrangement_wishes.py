"""Draws depend on seed and number alone, and the judge tells what came about from poses alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.goals.__main__ import chosen, parsed
from benchmarks.goals.drawn_worlds import standing
from benchmarks.goals.judge import TruePlace
from benchmarks.goals.sentences import Job, Sentence, kind_of, said
from benchmarks.goals.wish_sense import is_sensible, slides
from benchmarks.goals.wishes import WISHED, Wish, Wished, harm, is_met, is_told
from objectmodels import Registry
from objectmodels.geometry.rotations import rot_x, rot_z
from sim.truth.scene_file import Scene


def thing(model: str, x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> TruePlace:
    return TruePlace(Registry.built_in().get(model), rot_z(yaw), np.array([x, y, z]))


TIN, BOX, BOOK = thing("tea tin", 0.5, 0.2), thing("coffee box", 0.6, 0.0), thing("book", 0.5, -0.2)
BIN = thing("storage bin", 0.5, -0.2)
BEFORE = {"tin": TIN, "box": BOX, "book": BOOK}


def at(placed: TruePlace, x: float, y: float, z: float = 0.0) -> TruePlace:
    return TruePlace(placed.model, placed.R_WB, np.array([x, y, z]))


def turned(placed: TruePlace, R: np.ndarray) -> TruePlace:
    return TruePlace(placed.model, R @ placed.R_WB, placed.p_WB)


# Each met, and then missed by a little more than what is allowed.
@pytest.mark.parametrize(
    ("wish", "met", "missed"),
    [
        (
            Wish("swap", ("tin", "box")),
            {"tin": at(TIN, 0.6, 0.0), "box": at(BOX, 0.51, 0.2)},
            {"tin": at(TIN, 0.6, 0.0), "box": at(BOX, 0.515, 0.2)},
        ),
        (
            Wish("row", ("tin", "box", "book")),
            {"box": at(BOX, 0.51, 0.0)},
            {"box": at(BOX, 0.53, 0.0)},
        ),
        (
            Wish("between", ("box",), ("tin", "book")),
            {"box": at(BOX, 0.51, 0.02)},
            {"box": at(BOX, 0.55, 0.02)},
        ),
        (
            Wish("clear", ("tin", "box"), way="left"),
            {"tin": at(TIN, 0.4, -0.05), "box": at(BOX, 0.6, -0.05)},
            {"tin": at(TIN, 0.4, -0.05)},
        ),
        (
            Wish("room", ("box",), ("tin",)),
            {"box": at(BOX, 0.6, -0.02)},
            {"box": at(BOX, 0.5, 0.1)},
        ),
        (
            Wish("straight", ("box",)),
            {"box": turned(BOX, rot_z(0.06))},
            {"box": turned(BOX, rot_z(0.07))},
        ),
        (
            Wish("on", ("tin",), ("book",)),
            {"tin": at(TIN, 0.5, -0.2, 0.03)},
            {"tin": at(TIN, 0.5, -0.33, 0.03)},
        ),
        (Wish("stand", ("box",)), {}, {"box": turned(BOX, rot_x(0.1))}),
        (
            Wish("lay", ("box",)),
            {"box": turned(at(BOX, 0.6, 0.0, 0.0465), rot_x(np.pi / 2.0))},
            {"box": turned(BOX, rot_x(0.1))},
        ),
        (
            Wish("all", ("tin", "box"), way="away", distance=0.1),
            {"tin": at(TIN, 0.61, 0.2), "box": at(BOX, 0.69, 0.0)},
            {"tin": at(TIN, 0.6, 0.2)},
        ),
        (
            Wish("back", ("tin",), way="left", distance=0.1),
            {"tin": replace(at(TIN, 0.5, 0.21), farthest=0.1)},
            {"tin": replace(at(TIN, 0.5, 0.21), farthest=0.05)},
        ),
        (
            Wish("restore", ("box", "tin"), way="away", distance=0.1),
            {"box": at(BOX, 0.7, 0.0), "tin": replace(at(TIN, 0.51, 0.2), farthest=0.2)},
            {"box": at(BOX, 0.7, 0.0), "tin": replace(at(TIN, 0.52, 0.2), farthest=0.2)},
        ),
        (
            Wish("into", ("tin",), ("bin",)),
            # Half the inside is 106 mm, the tin 45 mm along x from its middle to a corner.
            {"bin": BIN, "tin": at(TIN, 0.56, -0.2, 0.004)},
            {"bin": BIN, "tin": at(TIN, 0.562, -0.2, 0.004)},
        ),
        (
            # Half the book is 75 mm, an overhang may be off by 12.5 mm.
            Wish("edge", ("book",), way="away", distance=0.03, edge=0.6),
            {"book": at(BOOK, 0.567, -0.2)},
            {"book": at(BOOK, 0.568, -0.2)},
        ),
        (
            Wish("edge", ("book",), way="away", edge=0.6),  # nobody says how far: a centimetre
            {"book": at(BOOK, 0.536, -0.2)},
            {"book": at(BOOK, 0.534, -0.2)},
        ),
        (
            Wish("out of", ("tin",), ("bin",)),
            {"bin": BIN, "tin": at(TIN, 0.66, -0.2)},
            {"bin": BIN, "tin": at(TIN, 0.65, -0.2)},
        ),
    ],
)
def test_the_judge_tells_from_where_things_are(
    wish: Wish, met: dict[str, TruePlace], missed: dict[str, TruePlace]
) -> None:
    assert is_met(wish, BEFORE, BEFORE | met)
    assert not is_met(wish, BEFORE, BEFORE | missed)


def drawn(seed: int, kind: Wished) -> tuple[Scene, Sentence, Wish]:
    scene, sentence = said(Job(seed, WISHED.index(kind), "several"))
    assert sentence.wish is not None
    return scene, sentence, sentence.wish


@pytest.mark.parametrize("kind", ["into", "out of"])
def test_a_case_about_an_open_box_has_one(kind: Wished) -> None:
    scene, _, wish = drawn(5, kind)
    assert wish.told == ("storage bin",)
    inside = {item.name for item in scene.objects if item.pose.z_m > 0.0}
    assert (wish.moved[0] in inside) == (kind == "out of")


def test_a_case_about_an_edge_keeps_the_middle_of_the_book_over_the_table() -> None:
    scene, sentence, wish = drawn(404, "edge")
    assert "the right edge" in sentence.text
    assert wish.edge == -scene.table.extent.y_min
    alone = {name: seen for name, seen in standing(scene).items() if name == "book"}
    assert is_sensible(wish, alone)
    # Its middle is at most 133 mm from its farthest corner.
    assert not is_sensible(replace(wish, distance=0.12), alone)


def test_an_answer_names_all_that_is_asked_for_and_nothing_else() -> None:
    wish, question = Wish("asked", (), ("tin", "mug")), "what is on the book?"
    names = ["tin", "mug", "box", "book"]
    assert is_told(wish, question, "The book carries the tin and the mug.", names)
    assert not is_told(wish, question, "The book carries the tin.", names)
    assert not is_told(wish, question, "The book carries the tin, the mug and the box.", names)


def test_every_second_case_of_each_kind_is_carried_out() -> None:
    cases = 4 * len(WISHED)
    asked = [
        "several",
        "--seed",
        "5",
        "--seeds",
        "2",
        "--cases",
        str(cases),
        "--execute-every",
        "2",
    ]
    jobs = chosen(parsed(asked))
    assert len(set(jobs)) == 2 * cases
    for kind in WISHED:
        assert [job.executed for job in jobs if kind_of(job) == kind] == 4 * [True, False]


def test_a_side_faces_what_it_is_square_to() -> None:
    wish = Wish("facing", ("box",), ("tin",))
    angle = np.arctan2(0.2, -0.1)  # from the box to the tin; its broad sides look along its x axis
    assert is_met(wish, BEFORE, BEFORE | {"box": turned(BOX, rot_z(angle))})
    assert not is_met(wish, BEFORE, BEFORE | {"box": turned(BOX, rot_z(angle + 0.07))})


def test_harm_is_what_fell_or_was_stirred_and_should_not() -> None:
    wish, fragile = Wish("between", ("box",), ("tin", "book")), replace(BOOK, fragile=True)
    after = BEFORE | {"box": turned(BOX, rot_x(1.5)), "tin": at(TIN, 0.5, 0.22)}
    assert list(harm(wish, BEFORE, after)) == ["tin"]
    before = BEFORE | {"book": fragile}
    moved = before | {"book": at(fragile, 0.5, -0.22)}
    assert list(harm(Wish("swap", ("tin", "box")), before, moved)) == ["book"]


@pytest.mark.parametrize("kind", WISHED)
def test_a_case_depends_on_seed_kind_and_number_alone(kind: Wished) -> None:
    scene, sentence, wish = drawn(5, kind)
    assert drawn(5, kind) == (scene, sentence, wish)
    assert wish.kind == sentence.kind == kind
    assert {*wish.moved, *wish.told} <= {item.name for item in scene.objects}
    assert sentence.sensible == is_sensible(wish, standing(scene))


def test_what_is_tall_and_slim_would_tip() -> None:
    model = Registry.built_in().get("coffee box")
    assert slides(model)
    assert not slides(model.model_copy(update={"friction": 2.0}))
