"""Forces of lids: closed forms by hand, and laws over random cups, jars and bottles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels import BoxModel, CylinderModel, Registry
from objectmodels.containers import lids
from objectmodels.containers.lids import (
    TAB_WIDTH,
    THICKNESS,
    grip_distance,
    lid_height,
    lid_hinge,
)
from objectmodels.models.object_parts import FlipLid, LiftOffLid, ScrewCap
from sim.robots.robots import HAND

G = 9.81
R, H, MASS, MU = 0.035, 0.12, 0.30, 0.38
LID = FlipLid(
    mass=0.02, tab=0.02, friction_torque=0.02, snap_torque=0.03, snap_angle_deg=3.0,
    opens_to_deg=120.0,
)  # fmt: skip
LEVER = 2 * R + 0.7 * 0.02


def cup(lid: FlipLid = LID, **changes: Any) -> CylinderModel:
    fields: dict[str, Any] = {
        "name": "cup", "radius": R, "height": H, "mass": MASS, "friction": MU, "lid": lid,
        "com": (0.0, 0.0, 0.045), "finger_friction": 1e-12,
    }  # fmt: skip
    return CylinderModel(**(fields | changes))


def test_the_force_over_the_arc_is_the_torques_over_the_lever() -> None:
    arc = lids.flip(cup(), LID)
    t = arc.angles
    arm = R * np.cos(t) - 0.5 * THICKNESS * np.sin(t)
    catch = 0.03 * np.maximum(0.0, 1.0 - t / np.radians(3.0))
    np.testing.assert_allclose(arc.force, (0.02 + catch + 0.02 * G * arm) / LEVER, rtol=1e-12)
    assert arc.largest_force == arc.force[0]
    assert (t[0], t[-1]) == pytest.approx((0.0, np.radians(120.0)))


def test_the_force_is_across_the_lid_at_the_tab() -> None:
    arc = lids.flip(cup(), LID, end=np.pi / 2)
    np.testing.assert_allclose(arc.points[0], [LEVER - R, 0.0, H], atol=1e-15)
    np.testing.assert_allclose(arc.directions[0], [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(arc.points[-1], [-R, 0.0, H + LEVER], atol=1e-15)
    np.testing.assert_allclose(arc.directions[-1], [-1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(
        np.sum((arc.points - [-R, 0, H]) * arc.directions, axis=1), 0.0, atol=1e-15
    )


def test_the_margin_is_that_of_the_moments_about_the_rim() -> None:
    # G (R + what the turned lid shifts) / F (ρ + H sin θ), about the rim under the hinge.
    arc = lids.flip(cup(), LID)
    t = arc.angles
    shift = (R * np.cos(t) - 0.5 * THICKNESS * np.sin(t) - R) * 0.02 / MASS
    tipping = MASS * G * (R + shift) / (LEVER + H * np.sin(t))
    np.testing.assert_allclose(arc.topple, tipping, rtol=1e-9)
    np.testing.assert_allclose(arc.margin, tipping / arc.force, rtol=1e-9)
    # Sliding: F sin θ ≤ μ (G − F cos θ); the force goes through the axis, so nothing turns.
    slide = MU * MASS * G / (np.sin(t) + MU * np.cos(t))
    np.testing.assert_allclose(arc.slide[1:], slide[1:], rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "outcome"),
    [({}, "moves"), ({"mass": 0.12}, "topples"), ({"friction": 0.05, "mass": 0.25}, "slides")],
)
def test_what_happens_first(changes: dict[str, Any], outcome: str) -> None:
    arc = lids.flip(cup(**changes), LID)
    assert arc.outcome == outcome
    assert arc.probability == (1.0 if outcome == "moves" else 0.0)
    assert lids.flip(cup(**changes), LID, fixed=True).outcome == "moves"


def test_a_rough_finger_holds_the_cup_by_its_tab() -> None:
    smooth, rough = (lids.flip(cup(finger_friction=mu), LID) for mu in (1e-12, 0.5))
    assert rough.topple[0] > smooth.topple[0] == pytest.approx(MASS * G * R / LEVER)
    assert (rough.margin >= smooth.margin).all()
    np.testing.assert_array_equal(rough.force, smooth.force)
    light = cup(finger_friction=0.5, mass=0.18)
    assert lids.flip(light, LID).outcome == "moves"
    assert lids.flip(cup(mass=0.16), LID).outcome == "topples"


def test_closing_is_helped_by_the_lids_weight_and_by_its_catch() -> None:
    arc = lids.flip(cup(), LID, start=1.5, end=0.0)
    assert arc.force[-1] == 0.0
    heavy = LID.model_copy(update={"mass": 0.08})
    # 0.08 G R = 27 mN·m against 20 mN·m of friction: it falls shut by itself.
    falls = lids.flip(cup(heavy), heavy, start=1.0, end=0.2)
    assert falls.force[-1] == 0.0 < falls.force[0]
    assert np.isinf(falls.margin[-1])
    np.testing.assert_allclose(arc.directions[0], [np.sin(1.5), 0.0, -np.cos(1.5)], atol=1e-12)


def test_the_tab_of_a_box_lies_over_the_side_that_it_looks_to() -> None:
    lid = LID.model_copy(update={"tab_heading_deg": 90.0})
    box = BoxModel(name="box", size=(0.06, 0.08, 0.1), mass=0.3, friction=0.4, lid=lid)
    hinge = lid_hinge(lid, box.rim, box.top)
    np.testing.assert_allclose(hinge.p_BH, [0.0, -0.04, 0.1], atol=1e-15)
    assert hinge.reach == pytest.approx(0.08)
    assert grip_distance(lid, hinge) == pytest.approx(0.094)


@settings(max_examples=25, deadline=None)
@given(
    st.floats(0.05, 0.6), st.floats(0.1, 0.8), st.floats(0.0, 0.05), st.floats(0.0, 0.1),
    st.floats(-180.0, 180.0),
)  # fmt: skip
@pytest.mark.slow
def test_laws_of_a_cup(mass: float, mu: float, torque: float, snap: float, turn: float) -> None:
    lid = LID.model_copy(update={"friction_torque": torque, "snap_torque": snap})
    arc = lids.flip(cup(lid, mass=mass, friction=mu), lid)
    turned = lid.model_copy(update={"tab_heading_deg": turn})
    # A round cup opens as easily to every side, but for rounding.
    other = lids.flip(cup(turned, mass=mass, friction=mu), turned)
    np.testing.assert_allclose(other.margin, arc.margin, rtol=1e-6)
    heavier = lids.flip(cup(lid, mass=1.2 * mass, friction=mu), lid)
    stiffer = lid.model_copy(update={"friction_torque": torque + 0.005})
    assert heavier.least_margin > arc.least_margin
    assert lids.flip(cup(stiffer, mass=mass, friction=mu), stiffer).least_margin < (
        arc.least_margin
    )
    assert (arc.probability == 1.0) == (arc.least_margin >= 1.0)


def test_a_doubtful_torque_makes_a_doubtful_opening() -> None:
    # The mean is at the margin: half of the torques drawn are below it.
    arc = lids.flip(cup(), LID, start=0.1)
    at_margin = LID.model_copy(
        update={
            "friction_torque": 0.02 + LEVER * float((np.minimum(arc.slide, arc.topple) - arc.force)[
                np.argmin(np.minimum(arc.slide, arc.topple) - arc.force)
            ]),
            "friction_torque_sd": 0.002,
        }
    )  # fmt: skip
    doubtful = lids.flip(cup(at_margin), at_margin, start=0.1)
    assert doubtful.least_margin == pytest.approx(1.0, abs=1e-3)
    # Three standard deviations of four hundred samples.
    assert doubtful.probability == pytest.approx(0.5, abs=0.075)


def jar(retention: float, sd: float = 0.0, **changes: Any) -> tuple[CylinderModel, LiftOffLid]:
    lid = LiftOffLid(
        mass=0.06, retention=retention, retention_sd=sd, radius=0.042, height=0.008,
        knob_radius=0.012, knob_height=0.025,
    )  # fmt: skip
    fields: dict[str, Any] = {
        "name": "jar",
        "radius": 0.042,
        "height": 0.11,
        "mass": 0.46,
        "friction": 0.25,
    }
    return CylinderModel(**(fields | {"lid": lid} | changes)), lid


def test_a_lid_comes_off_if_its_retention_is_less_than_what_stays_weighs() -> None:
    stays = 0.40 * G
    for retention, comes_off in ((0.98 * stays, True), (1.02 * stays, False)):
        pull = lids.lift_off(*jar(retention))
        assert pull.needed == pytest.approx(retention + 0.06 * G)
        assert pull.held == pytest.approx(0.46 * G)
        assert (pull.margin > 1.0, pull.probability) == (comes_off, float(comes_off))
    # Off the middle it tips first: G d about the nearer rim.
    aside = lids.lift_off(*jar(1.0, com=(0.01, 0.0, 0.05)))
    c = 0.46 * 0.01 / 0.40
    assert aside.held == pytest.approx(0.06 * G + stays * (0.042 - c) / 0.042)
    assert lids.lift_off(*jar(stays, 0.2), fixed=True).probability == 1.0
    assert lids.lift_off(*jar(stays, 0.2)).probability == pytest.approx(0.5, abs=0.075)


def test_a_bottle_turns_along_at_its_friction_torque() -> None:
    bottle = Registry.built_in().get("water bottle")
    assert isinstance(bottle.lid, ScrewCap)
    turn = lids.unscrew(bottle, bottle.lid)
    assert turn.needed == bottle.lid.friction_torque
    assert turn.held == pytest.approx(0.30 * 0.55 * G * 0.029)
    assert turn.margin < 1.0
    assert turn.probability < 0.5
    fixed = lids.unscrew(bottle, bottle.lid, fixed=True)
    assert (fixed.margin, fixed.probability) == (np.inf, 1.0)
    assert lids.unscrew(bottle, bottle.lid, down=6.0).margin > 1.0
    assert lids.unscrew(bottle, bottle.lid, down=-9.0).held == 0.0


def test_built_in_lids_open_as_their_scenes_need_it() -> None:
    registry = Registry.built_in()
    cup, jar = registry.get("ice tea cup"), registry.get("jar")
    assert isinstance(cup.lid, FlipLid)
    assert isinstance(jar.lid, LiftOffLid)
    assert lids.flip(cup, cup.lid).probability > 0.95
    assert lids.lift_off(jar, jar.lid).probability > 0.95


def test_a_flip_lid_is_a_plate_with_a_tab_for_a_fingertip() -> None:
    hinge = lid_hinge(LID, cup().rim, H)
    assert lid_height(LID) == pytest.approx(0.003)
    np.testing.assert_allclose(hinge.centre_of_mass(0.0), [0.0, 0.0, H + 0.0015], atol=1e-15)
    fingertip = 2.0 * HAND.tip_radius
    assert 0.9 * fingertip < TAB_WIDTH < 1.5 * fingertip
