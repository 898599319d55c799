"""Refusals are true: finite numbers, a reason that is one, and never anything but an error."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from nlcontrol import ControlError, Controller

CAN = """format: cylinder/1
name: slick can
radius_m: 0.04
height_m: 0.1
mass_kg: 0.2
mass_kg_sd: 0.02
friction_table: 0.3
friction_table_sd: 0.03
friction_finger: {}
friction_finger_sd: 0.01
provenance: {{source: example, method: guess}}
"""
TABLE = """version: 1
name: slick
models: [slick.yaml]
objects: [{name: slick can, model: slick can, pose: {x_m: 0.45, y_m: 0.0}}]
"""


@pytest.mark.parametrize("friction", [0.02, 0.05, 0.2])
def test_what_slips_from_every_squeeze_is_refused_by_its_friction(
    friction: float, tmp_path: Path
) -> None:
    (tmp_path / "slick.yaml").write_text(CAN.format(friction))
    (tmp_path / "scene.yaml").write_text(TABLE)
    controller = Controller(tmp_path / "scene.yaml")
    refused = controller.say("lift the slick can", plan_only=True)
    assert refused.status == "refused"
    assert refused.error is not None
    numbers = refused.error.numbers
    assert numbers["friction"] == friction
    # The outer fingertips touch the round side where it looks some 13° aside.
    assert numbers["needed_friction"] == pytest.approx(math.tan(math.radians(13.4)), abs=0.01)
    for question in ("can you lift the slick can?", "what can you do with the slick can?"):
        assert controller.say(question).status == "answered"


def test_a_defect_is_an_error_with_a_code() -> None:
    def broken(*_: object, **__: Any) -> Any:
        raise ZeroDivisionError("somewhere")

    controller = Controller("kitchen", planner=broken)
    with pytest.raises(ControlError) as raised:
        controller.say("push the mug away")
    assert raised.value.code == "internal"
    assert isinstance(raised.value.__cause__, ZeroDivisionError)
