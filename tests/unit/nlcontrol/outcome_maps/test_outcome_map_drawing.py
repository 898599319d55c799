"""What the legend of a drawn map tells."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import pytest

from nlcontrol.outcome_maps.outcome_map_drawing import save_map
from objectmodels import Registry
from objectmodels.mechanics.outcome_map import outcome_map


@pytest.mark.parametrize("solid", [False, True])
def test_a_drawing_tells_by_what_its_probabilities_are(solid: bool, tmp_path: Path) -> None:
    """Where a level decides what is undecided, or what is less probable is paler."""
    box, path = Registry.built_in().get("ice tea box"), tmp_path / "map.svg"
    chart = outcome_map(box, box.faces()[2], spacing=0.02, level=0.9)
    with mpl.rc_context({"svg.fonttype": "none"}):
        save_map(chart, "front", path, solid=solid, shaded=True)
    told = path.read_text(encoding="utf-8").count(f"({chart.likelihood.method})")
    assert told == (1 if solid else 2)
