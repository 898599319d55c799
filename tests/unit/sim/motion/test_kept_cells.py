"""What a map of reach keeps is bounded."""

from __future__ import annotations

import numpy as np
import pytest

from sim import load_scene
from sim.motion import robot_reach
from sim.robots.hand import Mount
from sim.robots.robots import ARM, HAND


def test_a_map_keeps_so_many_cells_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robot_reach, "MOST_CELLS", 2)
    reach = robot_reach.ReachabilityMap(Mount.from_cell(load_scene("kitchen").robot, ARM, HAND))
    monkeypatch.setattr(reach, "_best_room", lambda *_: 1.0)
    for place in np.linspace(0.0, 1.0, 5):
        assert reach.room_at(1, 0.0, np.array([place, 0.0, 0.0]), 0.0) == 1.0
        assert len(reach._kept) <= 2
