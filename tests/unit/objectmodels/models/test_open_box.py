"""Open boxes: of what they consist, and what stands in them."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import ModelError, Registry
from objectmodels.models.object_parts import Cavity, open_box_parts
from objectmodels.registry.model_registry import model_document, model_from_document

ROUNDING = 1e-12  # of sums of a few products of centimetres
BIN = Registry.built_in().get("storage bin")
INSIDE = Cavity(size=(0.212, 0.292), floor=0.004)


def test_its_parts_fill_the_box_but_for_the_cavity() -> None:
    parts = open_box_parts(BIN.extents, INSIDE)
    volume = sum(float(np.prod(high - low)) for low, high in parts)
    hollow = np.prod(INSIDE.size) * (BIN.top - INSIDE.floor)
    assert volume == pytest.approx(np.prod(BIN.extents) - hollow, abs=ROUNDING)
    low, high = (np.array(ends) for ends in zip(*parts, strict=True))
    for number, point in enumerate(np.random.default_rng(3).uniform(-0.5, 0.5, (200, 3))):
        p = point * BIN.extents + [0.0, 0.0, 0.5 * BIN.top]
        within = int(((low < p) & (p < high)).all(axis=1).sum())
        hollow_there = (abs(p[:2]) < 0.5 * np.array(INSIDE.size)).all() and p[2] > INSIDE.floor
        assert within == (not hollow_there), number


def test_others_stand_on_its_floor() -> None:
    face, book = BIN.standing_face, Registry.built_in().get("book")
    assert face is not None
    np.testing.assert_allclose(np.ptp(face.vertices, axis=0), INSIDE.size, atol=ROUNDING)
    assert (BIN.standing_height, book.standing_height) == (INSIDE.floor, book.top)


def test_it_is_read_and_written_and_not_open_on_its_side() -> None:
    document = model_document(BIN)
    assert model_from_document(document, "bin.yaml").inside == INSIDE
    assert BIN.model_on_face("left").inside is None


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"inside": {"size_m": [0.22, 0.20], "floor_m": 0.004}}, "inside.size_m"),
        ({"inside": {"size_m": [0.20, 0.20], "floor_m": 0.06}}, "inside.floor_m"),
        ({"container": {"wall_m": 0.004, "opening": {"radius_m": 0.02}}}, "inside"),
        ({"format": "cylinder/1", "radius_m": 0.2, "height_m": 0.06}, "inside"),
    ],
)
def test_a_cavity_without_walls_is_refused(change: dict[str, object], key: str) -> None:
    document = {**model_document(BIN), **change}
    if "radius_m" in change:
        del document["size_m"]
    with pytest.raises(ModelError) as raised:
        model_from_document(document, "bin.yaml")
    assert raised.value.code == "bad_value"
    assert f": {key}" in str(raised.value.path)
