"""An object as it stands, before anybody pushes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.base_shapes import Array, Base
from objectmodels.mechanics.exact.support_springs import Springs


@dataclass(frozen=True, eq=False)
class Standing:
    """An object as it stands; the last three for all pushes, or one for each of n.

    Attributes:
        base: over which it would topple.
        springs: that it stands on.
        scale: factor of their distances from the centre of pressure, shape (1,) or (n,).
        mu: friction coefficient at the table, shape (1,) or (n,).
        com: centre of mass over the base, shape (1, 2) or (n, 2) [m].
    """

    base: Base
    springs: Springs
    scale: Array
    mu: Array
    com: Array

    @cached_property
    def loaded_at_rest(self) -> NDArray[np.bool_]:
        """Which points are loaded before anybody pushes, shape (k, 1) or (k, n)."""
        com = self.com.T
        loaded = np.ones((len(self.springs.points), com.shape[1]), dtype=bool)
        self.springs.loads(com, np.zeros_like(com), loaded)
        return loaded
