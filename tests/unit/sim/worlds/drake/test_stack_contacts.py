"""Objects on one another in Drake: what stands, what falls, and what is not changed."""

from __future__ import annotations

import pytest

from benchmarks.engines.pressed_things import Stack
from objectmodels.models.shapes import Box, Cylinder
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, SceneObject

POST = Truth(
    shape=Cylinder(radius=0.03, height=0.06), mass_kg=0.4, friction_table=0.4, friction_finger=0.6
)
BEAM = Truth(
    shape=Box(size=(0.24, 0.03, 0.02)), mass_kg=0.3, friction_table=0.4, friction_finger=0.6
)


def stack(*members: tuple[Truth, float, float]) -> list[SceneObject]:
    """Objects on one another: how each is, where along x [m], and its heading [degrees]."""
    items, z = [], 0.0
    for number, (truth, x, yaw) in enumerate(members):
        pose = Pose(x_m=x, y_m=0.0, z_m=z, yaw_deg=yaw)
        items.append(SceneObject(name=f"{number}", model="box", pose=pose, truth=truth))
        z += truth.shape.top
    return items


@pytest.mark.parametrize(
    ("members", "falls"),
    [
        # Faces that cross have no corner of one in the other.
        (((BEAM, 0.0, 0.0), (BEAM, 0.0, 90.0), (BEAM, 0.0, 0.0)), False),
        (((POST, 0.0, 0.0), (BEAM, 0.026, 0.0)), False),
        (((POST, 0.0, 0.0), (BEAM, 0.034, 0.0)), True),
    ],
)
def test_a_stack_stands_if_its_margins_say_so(
    members: tuple[tuple[Truth, float, float], ...], falls: bool
) -> None:
    case, expected = Stack(stack(*members)), "falls" if falls else "stands"
    assert case.prediction()[0] == expected
    assert case.roll_out().seen == expected
