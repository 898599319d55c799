"""Several executions as one trace."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.traces.trace import ContactEvent, Trace, join_traces

N = 40


def trace(x: float, moved: float, fingers: int, began: float) -> Trace:
    """A push from x by some way, seen with an offset that a mean does not care for."""
    phase = np.array(["look"] * 10 + ["push"] * 20 + ["settle"] * 10)
    way = x + moved * np.concatenate([np.zeros(10), np.linspace(0, 1, 20), np.ones(10)])
    poses = np.column_stack([np.ones(N), *np.zeros((3, N)), way, *np.zeros((2, N))])
    blinking = 0.001 * (-1.0) ** np.arange(N)
    seen = poses + np.outer(blinking, [0, 0, 0, 0, 1, 0, 0])
    names = [f"finger_{i}" for i in range(fingers)]
    return Trace(
        time=began + np.arange(N) / 100.0,
        phase=phase,
        poses={"box": poses},
        seen={"box": seen},
        joints=np.full((N, 2), began),
        joint_names=("a", "b"),
        tips={name: np.full((N, 3), x + 0.01 * i) for i, name in enumerate(names)},
        felt={name: np.full((N, 3), 1.0 + i) for i, name in enumerate(names)},
        force_limit=np.full(N, 5.0),
        contacts=(ContactEvent(began, "finger_0", "box"),),
        pushed="box",
        direction=np.array([1.0, 0.0, 0.0]),
        end="stroke",
        detail="",
        seed=0,
    )


def test_one_alone_is_itself() -> None:
    only = trace(0.5, 0.1, 2, 0.0)
    assert join_traces([only]) is only


@pytest.mark.parametrize(("before", "after"), [(2, 2), (2, 1), (1, 2)])
def test_one_after_another(before: int, after: int) -> None:
    first = replace(trace(0.5, 0.04, before, 0.0), end="tilted")
    second = trace(0.54, 0.06, after, 1.0)
    both = join_traces([first, second])
    assert len(both.time) == len(both.phase) == len(both.joints) == len(both.force_limit) == 2 * N
    assert (np.diff(both.time) > 0.0).all()
    assert (both.end, tuple(both.tips)) == ("stroke", tuple(second.tips))
    assert [event.time for event in both.contacts] == [0.0, 1.0]
    # The midpoint of the fingertips and the sum of their forces are those of each push.
    middle = np.mean(list(both.tips.values()), axis=0)
    total = both.push_force()
    for part, one in ((slice(0, N), first), (slice(N, None), second)):
        np.testing.assert_allclose(middle[part], np.mean(list(one.tips.values()), axis=0))
        np.testing.assert_allclose(total[part], one.push_force())


def test_the_way_is_from_the_first_look_to_the_last() -> None:
    first, second = trace(0.5, 0.04, 2, 0.0), trace(0.54, 0.06, 2, 1.0)
    both = join_traces([first, second])
    assert both.displacement("box") == pytest.approx((0.1, 0.0, 0.0))
    assert first.seen_displacement("box") == pytest.approx((0.04, 0.0, 0.0))
    assert both.seen_displacement("box") == pytest.approx((0.1, 0.0, 0.0))


def test_what_a_robot_without_an_observer_saw_is_kept() -> None:
    both = join_traces([trace(0.5, 0.04, 2, 0.0).perceived, trace(0.54, 0.06, 2, 1.0).perceived])
    assert both.seen_displacement("box") == pytest.approx((0.1, 0.0, 0.0))


def test_without_a_look_or_a_rest_the_first_and_the_last_sample_tell_the_way() -> None:
    whole = trace(0.5, 0.04, 2, 0.0)
    cut = replace(whole, phase=np.full(N, "push"))
    p = cut.seen["box"][:, 4:]
    assert cut.seen_displacement("box") == pytest.approx((p[-1] - p[0])[0] * np.array([1, 0, 0]))
    assert cut.seen_turn("box") == pytest.approx(0.0)


def test_one_that_ended_before_the_hand_got_there_has_no_fingers() -> None:
    first = trace(0.5, 0.04, 2, 0.0)
    ended = replace(trace(0.54, 0.0, 1, 1.0), tips={}, felt={}, end="unreachable")
    both = join_traces([first, ended])
    assert (both.end, tuple(both.tips)) == ("unreachable", tuple(first.tips))
    np.testing.assert_allclose(both.push_force()[:N], first.push_force())
    assert not both.push_force()[N:].any()
    assert join_traces([ended, ended]).tips == {}
