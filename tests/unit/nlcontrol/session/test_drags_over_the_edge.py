"""A book is drawn over the table's edge, lies there, and is brought back."""

from __future__ import annotations

from pathlib import Path

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

DESK = """
version: 1
name: desk
objects:
  - name: book
    model: book
    pose: {x_m: 0.1, y_m: -0.1}
    truth: {size_m: [0.15, 0.22, 0.03], mass_kg: 0.72, friction_table: 0.27, friction_finger: 0.63,
            centre_of_mass_m: [0.006, 0.0, 0.015]}
"""


@pytest.mark.slow
def test_a_book_hangs_over_the_edge_and_comes_back(tmp_path: Path) -> None:
    scene = tmp_path / "desk.yaml"
    scene.write_text(DESK)
    talk = Conversation(Controller(scene, seed=7))
    drawn = talk.say("pull the book over the edge by 4 cm")
    assert drawn.ok, drawn.report()
    assert drawn.trace is not None
    # The trace tells where it truly is; its edge is half its width ahead.
    overhang = -0.2 - (drawn.trace.poses["book"][-1, 4] - 0.075)
    assert overhang == pytest.approx(0.04, abs=0.01)  # of `overhang_tolerance`
    back = talk.say("undo")
    assert back.ok, back.report()
    assert back.trace is not None
    assert back.trace.poses["book"][-1, 4] == pytest.approx(0.1, abs=0.01)  # of `place_tolerance`
