"""Liquid that is drawn: as much as there is, where it is; its stream reaches what it fills."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from objectmodels.models.object_parts import Vessel
from sim.traces.trace import Trace
from sim.truth.scene_file import parse_scene
from sim.views.trace_scene import Part, parts, triangles
from tests.unit.sim.worlds.drake.test_liquid import FORWARDS, FULL, SCENE, Moved

Array = NDArray[np.float64]

LIP = np.array([0.5, 0.12, 0.122])


@pytest.fixture(scope="module")
def poured() -> tuple[Moved, Trace]:
    """A carton that was poured into a mug; the robot is left out."""
    moved = Moved(parse_scene(SCENE))
    rows, contents = [], []
    for i in range(300):
        moved.lean("carton", min(i / 250.0, 1.0) * np.radians(110.0), FORWARDS, LIP)
        rows.append(dict(moved.poses))
        contents.append(dict(moved.liquid.contents))
    n = len(rows)
    trace = Trace(
        time=np.linspace(0.0, 0.01 * (n - 1), n),
        phase=np.full(n, "pour"),
        poses={name: np.array([_pose(*row[name]) for row in rows]) for name in rows[0]},
        seen={}, joints=np.zeros((n, 0)), joint_names=(), tips={}, felt={},
        force_limit=np.zeros(n), contacts=(), pushed="carton", direction=np.array([0.0, 1.0, 0.0]),
        end="handled", detail="", seed=0,
        contents={name: np.array([c[name] for c in contents]) for name in contents[0]},
        spilled=np.zeros(n),
    )  # fmt: skip
    return moved, trace


def _pose(R_WB: Array, p_WB: Array) -> Array:
    return np.concatenate([Rotation.from_matrix(R_WB).as_quat()[[3, 0, 1, 2]], p_WB])


def _parts(poured: tuple[Moved, Trace], sample: int) -> dict[tuple[str, str], Part]:
    moved, trace = poured
    return {(part.name, part.of): part for part in parts(trace, moved.scene, sample)}


def _vessel(poured: tuple[Moved, Trace], name: str) -> Vessel:
    vessel = poured[0].scene.object(name).truth.vessel
    assert vessel is not None
    return vessel


def test_upright_there_is_a_block_of_it(poured: tuple[Moved, Trace]) -> None:
    drawn = _parts(poured, 0)
    assert set(drawn) == {("carton", "level")}
    (piece,) = drawn["carton", "level"].pieces
    low, high = piece.min(axis=0), piece.max(axis=0)
    assert high - low == pytest.approx([0.056, 0.076, FULL / (0.056 * 0.076)], rel=1e-3)
    assert low[2] == pytest.approx(0.002)


def test_while_it_pours_as_much_is_drawn_as_there_is(poured: tuple[Moved, Trace]) -> None:
    drawn = _parts(poured, 220)
    assert set(drawn) == {("carton", "level"), ("carton", "stream"), ("mug", "level")}
    # A round one is drawn with 24 corners, which lack 1.1 %.
    for name, lacking in (("carton", 2e-3), ("mug", 0.013)):
        (piece,) = drawn[name, "level"].pieces
        contents = poured[1].contents[name][220]
        assert ConvexHull(piece).volume == pytest.approx(contents, rel=lacking)


def test_the_stream_goes_from_the_lip_into_the_mug(poured: tuple[Moved, Trace]) -> None:
    stream = _parts(poured, 220)["carton", "stream"]
    first, last = stream.pieces[0], stream.pieces[-1]
    assert np.linalg.norm(first[:8].mean(axis=0) - LIP) < 1e-6
    end = last[8:].mean(axis=0)
    level = float(_vessel(poured, "mug").surface_level(poured[1].contents["mug"][220], 0.0, 0.0))
    assert end[2] == pytest.approx(level, abs=1e-6)
    assert np.hypot(*(end[:2] - [0.5, 0.15])) < 0.037


def test_triangles_close_each_piece(poured: tuple[Moved, Trace]) -> None:
    pieces = _parts(poured, 220)["carton", "stream"].pieces
    corners, faces = triangles(pieces)
    assert len(corners) == sum(map(len, pieces))
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]))
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()


def test_triangles_are_seen_from_outside(poured: tuple[Moved, Trace]) -> None:
    piece = _parts(poured, 220)["carton", "stream"].pieces[0]
    corners, faces = triangles([piece])
    a, b, c = corners[faces].transpose(1, 0, 2)
    outwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), (a + b + c) / 3 - corners.mean(axis=0))
    assert (outwards > 0.0).all()
