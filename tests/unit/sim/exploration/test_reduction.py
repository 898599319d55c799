"""From recordings to trials: a made-up recording of known physics gives that physics back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from objectmodels import BoxModel
from planner.touch_experiments import Experiment, experiments
from planner.types.world_state import PlanarPose, SeenObject
from sim import load_scene
from sim.exploration.trial_extraction import Recording, extract_trials, force_curve
from sim.motion.fingertip_path import TiltArc
from sim.motion.robot_reach import ArmHandReach
from sim.robots.finger_kinematics import TIP_RADIUS
from sim.robots.robots import ARM, HAND

Array = NDArray[np.float64]

BOX = BoxModel(name="box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.4, com=(0.0, 0.0, 0.08))
YAW = 0.3
SEEN = SeenObject("box", PlanarPose(0.5, 0.1, YAW), BOX)
RNG = np.random.default_rng(0)


def experiment(kind: str) -> Experiment:
    found = experiments(SEEN, ArmHandReach(load_scene("kitchen").cell, ARM, HAND).limits)
    return next(e for e in found if e.kind == kind and e.push.face == "front")


def recording(
    tried: Experiment, moved: str | None, tips: Array, forces: Array, turned: float = 0.0
) -> Recording:
    return Recording(
        experiment=tried,
        end="stroke",
        detail="",
        moved=moved,  # type: ignore[arg-type]
        time=np.arange(len(tips), dtype=np.float64) / 100.0,
        tips=tips,
        forces=forces,
        before=SEEN.pose,
        after=PlanarPose(0.51, 0.1, YAW + turned),
        tip_radius=TIP_RADIUS,
        force_sd=0.03,
        zero_sd=0.003,
        pose_sd=(0.0004, 0.003),
    )


def touched(tried: Experiment) -> tuple[Array, Array]:
    """Where the fingertip's centre is at the touch, and the direction of the push, in W."""
    normal = np.array(tried.push.normal_W)
    contact = SEEN.pose.p_WB + SEEN.pose.R_WB @ np.array(tried.push.p_BC)
    return contact + TIP_RADIUS * normal, -normal


def tilt_recording(noise: float = 0.0) -> Recording:
    """Force that holds the box at each tilt, perpendicular to the arm from the edge."""
    tried = experiment("tilt")
    start, u = touched(tried)
    back, up = tried.length + TIP_RADIUS, start[2]
    theta = np.concatenate([np.zeros(60), np.linspace(0.0, np.radians(7.0), 300)])
    c, s = np.cos(theta), np.sin(theta)
    tips = start + np.outer(back - (back * c - up * s), u)
    tips[:, 2] = back * s + up * c
    # Moments about the far edge: the weight's lever against the contact's height.
    lever = 0.045 * c - 0.08 * s
    height = tried.length * s + tried.push.p_BC[2] * c
    size = 9.81 * lever / height
    size[:60] *= np.linspace(0.0, 1.0, 60)
    forces = np.outer(size + noise * RNG.standard_normal(len(size)), u)
    return recording(tried, "topple", tips, forces)


def test_a_tilt_gives_the_balance_at_two_tilts() -> None:
    small, large = extract_trials(tilt_recording(), repetition=3)
    for trial in (small, large):
        assert trial.moved == "topple"
        assert trial.repetition == 3
        u_x = trial.force[0]
        lever = 0.045 * np.cos(trial.tilt) - 0.08 * np.sin(trial.tilt)
        height = 0.09 * np.sin(trial.tilt) + trial.point[2] * np.cos(trial.tilt)
        # The mean over a degree of tilt is the force at its middle up to the curvature: 1e-4.
        assert u_x == pytest.approx(9.81 * lever / height, rel=3e-4)
        assert trial.force[1:] == pytest.approx((0.0, 0.0), abs=1e-12)
        assert trial.point == pytest.approx((-0.045, 0.0, 0.22), abs=1e-9)
    assert np.degrees([small.tilt, large.tilt]) == pytest.approx([1.0, 6.25], abs=0.1)


def test_the_tilt_follows_from_the_fingertip_wherever_it_slips_to() -> None:
    tried = experiment("tilt")
    start, u = touched(tried)
    back = tried.length + TIP_RADIUS
    for angle, up in ((0.05, start[2]), (0.1, start[2] - 0.02)):
        along = back - (back * np.cos(angle) - up * np.sin(angle))
        tip = start + along * u
        tip[2] = back * np.sin(angle) + up * np.cos(angle)
        assert TiltArc(start, u, tried.length, TIP_RADIUS).tilt_angles(tip[None])[
            0
        ] == pytest.approx(angle, abs=1e-12)


def slide_recording(turned: float, aside: float = 0.0) -> Recording:
    """The box turns about the fingertip, which slips along the face meanwhile [m]."""
    tried = experiment("off-centre slide")
    start, u = touched(tried)
    travel = np.concatenate([np.zeros(50), np.linspace(0.0, 0.012, 240)])
    size = np.concatenate([np.linspace(0.0, 3.0, 50), np.full(240, 3.0)])
    tips = start + np.outer(travel, u)
    yaw = YAW + turned
    x, y, _ = SEEN.pose.R_WB.T @ (start - SEEN.pose.p_WB) + [0.0, aside, 0.0]
    c, s = np.cos(yaw), np.sin(yaw)
    after = PlanarPose(tips[-1, 0] - (c * x - s * y), tips[-1, 1] - (s * x + c * y), yaw)
    return replace(recording(tried, "slide", tips, np.outer(size, u)), after=after)


def test_a_slide_gives_the_mean_force_in_the_axes_half_way() -> None:
    turned = np.radians(6.0)
    rec = slide_recording(turned)
    (trial,) = extract_trials(rec)
    assert np.linalg.norm(trial.force) == pytest.approx(3.0, rel=1e-3)  # directions turn by 5°
    half_way = np.arctan2(trial.force[1], trial.force[0])
    assert half_way == pytest.approx(-turned * 6.75 / 12.0, abs=1e-3)
    # The contact goes along u, the force half-way is u itself: 12 mm.
    assert trial.turn_rate == pytest.approx(turned / 0.012, rel=1e-2)
    assert trial.point == pytest.approx(rec.experiment.push.p_BC, abs=1e-9)


def test_a_slide_counts_where_the_finger_was_half_way() -> None:
    rec = slide_recording(np.radians(6.0), aside=0.002)
    (trial,) = extract_trials(rec)
    x, y, z = rec.experiment.push.p_BC
    assert trial.point == pytest.approx((x, y + 0.001, z), abs=1e-9)


def test_a_tilt_that_slid_tells_a_force_and_no_turn() -> None:
    slid = slide_recording(np.radians(6.0))
    (trial,) = extract_trials(replace(slid, experiment=experiment("tilt")))
    assert trial.moved == "slide"
    assert trial.turn_rate is None


def test_a_rub_gives_the_force_while_the_finger_slips() -> None:
    tried = experiment("rub")
    start, u = touched(tried)
    down = np.concatenate([np.zeros(30), np.linspace(0.0, 0.01, 200)])
    tips = start - down[:, None] * [0.0, 0.0, 1.0]
    forces = np.where(down > 0, 1.0, np.linspace(0, 1, 230))[:, None] * (2.0 * u - [0.0, 0.0, 1.2])
    (trial,) = extract_trials(recording(tried, "slip", tips, forces))
    assert trial.normal == pytest.approx((-1.0, 0.0, 0.0))
    assert trial.force == pytest.approx((2.0, 0.0, -1.2), rel=1e-6)


def test_noise_is_told() -> None:
    quiet, noisy = extract_trials(tilt_recording())[0], extract_trials(tilt_recording(noise=0.1))[0]
    assert quiet.force_sd < noisy.force_sd
    assert abs(quiet.force[0] - noisy.force[0]) < 4.0 * noisy.force_sd


def test_what_is_not_known_of_edge_and_base_is_told() -> None:
    small, _ = extract_trials(tilt_recording())
    assert small.tilt_sd * small.point[2] == pytest.approx(5e-4)  # the far edge, to half a mm
    (slide,) = extract_trials(slide_recording(0.0))
    # How the base carries it, and two looks of 3 mrad over 12 mm.
    assert slide.turn_rate_sd == pytest.approx(np.hypot(0.4, np.sqrt(2.0) * 0.25), rel=0.1)
    # Noise of 0.03 N that lasts three of 210 samples, and that of the zero.
    assert slide.force_sd == pytest.approx(np.hypot(0.03 * np.sqrt(3.0 / 210.0), 0.003), rel=0.1)


@pytest.mark.parametrize(("moving", "trials"), [(3, 0), (8, 1)])
def test_a_slide_of_a_few_samples_tells_nothing(moving: int, trials: int) -> None:
    whole = slide_recording(0.0)
    last = int(np.searchsorted(np.linalg.norm(whole.tips - whole.tips[0], axis=1), 0.0015)) + moving
    short = replace(
        whole, time=whole.time[:last], tips=whole.tips[:last], forces=whole.forces[:last]
    )
    assert len(extract_trials(short)) == trials


def test_nothing_is_read_out_of_a_touch_that_moved_nothing() -> None:
    rec = tilt_recording()
    assert extract_trials(recording(rec.experiment, None, rec.tips, rec.forces)) == ()
    assert extract_trials(recording(rec.experiment, "topple", rec.tips[:5], rec.forces[:5])) == ()


def test_the_curve_shows_the_onset() -> None:
    found = force_curve(tilt_recording(noise=0.02))
    assert found.onset is not None
    assert found.onset.moved
    # The tilt begins at 0.6 s; the kink is found to a few samples.
    assert found.onset.time == pytest.approx(0.6, abs=0.05)
    # Force at the onset: 9.81 · 0.045 / 0.22; noise of 0.02 N over some 30 samples.
    assert found.onset.force == pytest.approx(9.81 * 0.045 / 0.22, abs=0.03)
