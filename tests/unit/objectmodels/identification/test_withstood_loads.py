"""What a lid that did not open tells, and a hold that slipped."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import Registry
from objectmodels.containers.lids import flip
from objectmodels.identification.belief_update import (
    belief_of_slipperier_object,
    belief_of_stiffer_lid,
)
from objectmodels.models.object_parts import FlipLid, LiftOffLid

CUP = Registry.built_in().get("ice tea cup")
JAR = Registry.built_in().get("jar")
DRAWS = 400_000


def _force(model: object, angle: float, opens: bool) -> float:
    """Force that the lid takes at an angle by what is believed [N]."""
    assert isinstance(CUP.lid, FlipLid)
    lid = getattr(model, "lid")  # noqa: B009
    ends = (angle, 1.5) if opens else (angle, 0.0)
    return float(flip(CUP, lid, start=ends[0], end=ends[1]).force[0])


@pytest.mark.parametrize(("angle", "opens"), [(0.0, True), (0.03, True), (0.5, True), (1.2, False)])
def test_a_lid_is_believed_as_if_it_was_drawn_again(angle: float, opens: bool) -> None:
    """Oracle: draws of both torques, of which those stay that would have withstood."""
    lid = CUP.lid
    assert isinstance(lid, FlipLid)
    load = 1.1 * _force(CUP, angle, opens)
    after = belief_of_stiffer_lid(CUP, load, angle=angle, opens=opens).model.lid
    assert isinstance(after, FlipLid)
    rng = np.random.default_rng(0)
    friction = lid.friction_torque + lid.friction_torque_sd * rng.standard_normal(DRAWS)
    snap = lid.snap_torque + lid.snap_torque_sd * rng.standard_normal(DRAWS)
    stiff = lid.model_copy(update={"friction_torque": lid.friction_torque + 1e-3})
    stiffer = CUP.model_copy(update={"lid": stiff})
    lever = 1e-3 / (_force(stiffer, angle, opens) - _force(CUP, angle, opens))
    share = max(0.0, 1.0 - angle / lid.snap_angle) * (1.0 if opens else -1.0)
    more = (friction - lid.friction_torque) + share * (snap - lid.snap_torque)
    stayed = more > lever * (load - _force(CUP, angle, opens))
    assert stayed.sum() > 1000
    # A hundredth of a standard deviation is what so many draws leave.
    for found, drawn, sd in (
        (after.friction_torque, friction, lid.friction_torque_sd),
        (after.snap_torque, snap, lid.snap_torque_sd),
    ):
        assert found == pytest.approx(drawn[stayed].mean(), abs=0.03 * sd)
    assert after.friction_torque_sd == pytest.approx(friction[stayed].std(), rel=0.03)


def test_what_was_sure_is_doubted_once_it_withstood() -> None:
    lid = JAR.lid
    assert isinstance(lid, LiftOffLid)
    sure = JAR.model_copy(update={"lid": lid.model_copy(update={"retention_sd": 0.0})})
    found = belief_of_stiffer_lid(sure, 2.0 * lid.retention + 0.06 * 9.81)
    assert isinstance(found.model.lid, LiftOffLid)
    assert found.surprise > 3.0
    assert found.model.lid.retention > 2.0 * lid.retention
    assert found.model.lid.retention_sd > 0.0


def test_what_was_sure_is_doubted_by_a_tenth_if_it_withstood_just_that() -> None:
    lid = JAR.lid
    assert isinstance(lid, LiftOffLid)
    sure = JAR.model_copy(update={"lid": lid.model_copy(update={"retention_sd": 0.0})})
    found = belief_of_stiffer_lid(sure, lid.retention + 0.06 * 9.81).model.lid
    assert isinstance(found, LiftOffLid)
    # The upper half of a normal law whose deviation is a tenth of its mean.
    assert found.retention == pytest.approx((1.0 + 0.1 * np.sqrt(2.0 / np.pi)) * lid.retention)
    deviation = 0.1 * np.sqrt(1.0 - 2.0 / np.pi) * lid.retention
    assert found.retention_sd == pytest.approx(deviation)


def test_what_slipped_is_more_slippery_than_the_squeeze_bore() -> None:
    """Held with half more than was needed: at μ it would have held, so it is less than μ/1.5."""
    found = belief_of_slipperier_object(JAR, 1.5)
    assert found.model.finger_friction < JAR.finger_friction / 1.5
    assert found.model.mass == JAR.mass
    again = belief_of_slipperier_object(found.model, 1.5)
    assert again.model.finger_friction < found.model.finger_friction / 1.5
