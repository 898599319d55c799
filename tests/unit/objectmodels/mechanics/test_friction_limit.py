"""The friction limit of loaded points where some of them are in one place."""

from typing import Any

import numpy as np
import pytest

from objectmodels.geometry.base_shapes import Array
from objectmodels.mechanics import friction_limit as module
from objectmodels.mechanics.friction_limit import PRECISE, Limit, friction_limit


def test_points_in_one_place_are_one_point_with_their_loads(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A thumb opposite to a finger; most such bodies turn about both."""
    rng = np.random.default_rng(0)
    n = 200
    loads = np.vstack([np.full(n, 0.5), rng.dirichlet([2.0, 2.0, 2.0], n).T / 2.0])
    along, left = rng.uniform(-0.03, 0.03, (2, 4, n))
    left += 0.05
    along[2], left[2] = along[0], left[0]
    slow: list[int] = []
    by_descent = module._by_descent

    def counted(loads: Array, *args: Any) -> Limit:
        slow.append(loads.shape[1])
        return by_descent(loads, *args)

    monkeypatch.setattr(module, "_by_descent", counted)
    found = friction_limit(loads, along, left)
    # Those that turn about a point are exact; Newton's method settles the others but for few.
    assert (found.residual == 0.0).sum() > 0.5 * n
    assert sum(slow) < 0.02 * n
    keep = [0, 1, 3]
    merged = loads[keep]
    merged[0] += loads[2]
    alone = friction_limit(merged, along[keep], left[keep])
    # Each is as near to the truth as its residual.
    np.testing.assert_allclose(found.ratio, alone.ratio, rtol=2.0 * PRECISE)
    both = loads[0] * found.along_i[0] + loads[2] * found.along_i[2]
    np.testing.assert_allclose(both, merged[0] * alone.along_i[0], atol=1e-6)
