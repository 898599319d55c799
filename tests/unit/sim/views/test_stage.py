"""Where a replay or a picture is looked at from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.traces.trace import Trace
from sim.views.trace_picture import _moments
from sim.views.trace_scene import view

AT, OFF = np.array([0.45, 0.0, 0.2]), np.array([-0.8, -1.15, 0.4])
N = 40


def _still(x: float, y: float) -> Array:
    return np.tile([1.0, 0.0, 0.0, 0.0, x, y, 0.0], (N, 1))


def _trace(*phases: str) -> Trace:
    """A carton and a mug that stand still, with phases that last equally long."""
    poses = {"carton": _still(0.2, -0.2), "mug": _still(0.2, -0.4), "box": _still(0.7, 0.4)}
    return Trace(
        time=np.linspace(0.0, 4.0, N, dtype=np.float64),
        phase=np.repeat(phases, N // len(phases)),
        poses=poses,
        seen=poses,
        joints=np.zeros((N, 1)),
        joint_names=("joint",),
        tips={},
        felt={},
        force_limit=np.zeros(N),
        contacts=(),
        pushed="carton",
        direction=np.array([1.0, 0.0, 0.0]),
        end="handled",
        detail="all steps were made",
        seed=0,
    )


def test_a_push_is_seen_with_the_whole_table() -> None:
    eye, at = view(_trace("look", "push"), AT, OFF)
    assert (eye == AT + OFF).all()
    assert (at == AT).all()


def test_the_work_of_a_hand_is_seen_from_nearer() -> None:
    lift = _trace("look", "lift")
    eye, at = view(lift, AT, OFF)
    assert np.allclose(at, [0.2, -0.2, AT[2]])
    assert np.linalg.norm(eye - at) < np.linalg.norm(OFF)
    contents = {"carton": np.linspace(2e-4, 0.0, N), "mug": np.linspace(0.0, 2e-4, N)}
    poured = replace(lift, contents=contents | {"box": np.zeros(N)})
    _, at = view(poured, AT, OFF)
    assert np.allclose(at, [0.2, -0.3, AT[2]])


def test_moments_show_what_it_is_about() -> None:
    first, start, during, last = _moments(_trace("look", "lift", "pour", "settle")).values()
    assert (first, start, last) == (0, N // 2, N - 1)
    assert N // 2 < during < 3 * N // 4
    # A look at which nothing happens is shown from end to end.
    assert _moments(_trace("look"))["it begins"] == 0
