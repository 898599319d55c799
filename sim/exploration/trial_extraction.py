"""Recordings of touches, and the trials extracted: balances of forces at which an object moved.

Of a touch only what was moving counts. Of a slide that is its whole way but for the first
millimetre: the mean force, in the axes that the object had half-way, and by how much it turned. Of
a tilt there are two balances, one at small and one at large tilts, so that the height of the centre
of mass shows; each is the mean over a range of tilts, over which the force is as good as linear. Of
a rub it is the mean while the fingertip slips. A touch that showed something else than was meant
counts as what it showed.

An ordinary push that slides the object tells the force that it takes, once it goes at an even
speed; one that tilts it tells the force at the onset of the tilt; one that stops at its force limit
tells that more is needed. One that lost the object, became too fast or did not fall tells nothing.
Two fingers keep the object from turning, so that their midpoint counts as level with the centre of
mass.

Frames: W is the world, B the object's as it stood before, T the fingertip's centre.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from objectmodels.geometry.rotations import Array, rot_z, wrap
from objectmodels.identification import Moved, Onset, Trial, detect_onset
from objectmodels.identification.onset_detection import LEAST_SAMPLES
from planner.touch_experiments import Experiment
from planner.types.end_reasons import END_REASONS, EndReason
from planner.types.world_state import PlanarPose
from sim.motion.fingertip_path import TiltArc
from sim.traces.trace import Trace

if TYPE_CHECKING:
    from planner.types.actions import Push
    from planner.types.world_state import SeenObject


EVEN = (0.005, 0.9)
"""Way after which, and share of the stroke until which, a push goes at an even speed [m]."""

FORCE_SD = 0.03
"""Standard deviation of a pushing force as a share of it: speeds that change, joints that flex."""

_UNDER_WAY = 0.0015  # way of the fingertip from which on an object counts as sliding [m]
_FEWEST = 5  # samples that a mean needs


@dataclass(frozen=True)
class Recording:
    """The robot's knowledge during one touch, sampled n times from the touch on if it came to one.

    Attributes:
        experiment: what was tried.
        end: how it ended; `detail` says it in words.
        before: where the object was seen before.
        after: where it was seen at the end, the finger still there; None if it was not looked at.
        moved: what the touch showed: that the object slid or tilted, that the finger slipped; None
            if nothing did, or if that is not clear.
        time: shape (n,) [s].
        tips: the fingertip's centre p_WT, shape (n, 3) [m].
        forces: on the object in W, shape (n, 3) [N].
        tip_radius: of the finger [m].
        force_sd: standard deviation of one sample of the force along the push [N].
        zero_sd: of the sensors' zero, as a force along the push [N].
        pose_sd: of the seen position [m] and heading [rad].
        trace: of the whole trip, for judging and replay.
    """

    experiment: Experiment
    end: EndReason
    detail: str
    before: PlanarPose
    after: PlanarPose | None = None
    moved: Moved | None = None
    time: Array = field(default_factory=lambda: np.empty(0))
    tips: Array = field(default_factory=lambda: np.empty((0, 3)))
    forces: Array = field(default_factory=lambda: np.empty((0, 3)))
    tip_radius: float = 0.0
    force_sd: float = 0.0
    zero_sd: float = 0.0
    pose_sd: tuple[float, float] = (0.0, 0.0)
    trace: Trace | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Curve:
    """The force over time of one touch, for people.

    Attributes:
        time: since the touch, shape (n,) [s].
        force: along the push, shape (n,) [N].
        travel: of the fingertip along the push, shape (n,) [m].
        onset: when and at which force the object began to move; None if there are too few samples.
    """

    time: Array
    force: Array
    travel: Array
    onset: Onset | None


def force_curve(recording: Recording) -> Curve:
    """Force and travel over time, with the onset of motion."""
    u = np.array(recording.experiment.push.direction_W)
    time = recording.time - recording.time[0] if len(recording.time) else recording.time
    force = recording.forces @ u
    travel = (recording.tips - recording.tips[:1]) @ u
    onset = detect_onset(time, force, travel) if len(time) >= LEAST_SAMPLES else None
    return Curve(time, force, travel, onset)


def extract_trials(recording: Recording, *, repetition: int = 0) -> tuple[Trial, ...]:
    """Trials that a touch showed, with the number of its repetition; none if nothing moved."""
    if len(recording.time) < LEAST_SAMPLES or recording.moved is None:
        return ()
    source = recording.experiment.name
    reduced = {"topple": _tilts, "slide": _slide, "slip": _slip}
    found = reduced[recording.moved](recording, source)
    return tuple(replace(trial, repetition=repetition) for trial in found)


def _tilts(recording: Recording, source: str) -> list[Trial]:
    """Balances at a small and at a large tilt."""
    push = recording.experiment.push
    u, length = np.array(push.direction_W), recording.experiment.length
    arc = TiltArc(recording.tips[0], u, length, recording.tip_radius)
    tilt, height = arc.tilt_angles(recording.tips), arc.contact_heights(recording.tips)
    forces = recording.forces @ recording.before.R_WB
    top = float(tilt.max())
    small, large = np.radians([0.5, 1.5]), np.radians(1.5)
    ranges = [small] if top < small[1] + large else [small, np.array([top - large, top])]
    found = []
    for low, high in ranges:
        inside = (tilt >= low) & (tilt <= high)
        if inside.sum() < _FEWEST:
            continue
        x, y, _ = push.p_BC
        mean = float(tilt[inside].mean())
        found.append(
            Trial(
                "topple",
                point=(x, y, float(height[inside].mean())),
                force=_triple(forces[inside].mean(axis=0)),
                force_sd=_force_sd(recording, inside),
                tilt=mean,
                # The far edge is as far from the touch as the shape says, to half a millimetre.
                tilt_sd=0.0005 / float(height[inside].mean()),
                source=f"{source}, {np.degrees(mean):.1f}°",
            )
        )
    return found


def _slide(recording: Recording, source: str) -> list[Trial]:
    """The mean over the way, and the turn at its end."""
    push = recording.experiment.push
    u, normal = np.array(push.direction_W), np.array(push.normal_W)
    travel = (recording.tips - recording.tips[0]) @ u
    moving = travel > _UNDER_WAY
    if moving.sum() < _FEWEST:
        return []
    before, after = recording.before, recording.after
    if recording.experiment.kind == "tilt":
        after = None  # it was pressed high: on a base about to rise, a little turns it much
    turned = 0.0 if after is None else float(wrap(after.yaw - before.yaw))
    yaw = before.yaw + turned * travel / travel[-1]
    forces = np.einsum("nij,ni->nj", rot_z(yaw), recording.forces)[moving]
    force = forces.mean(axis=0)
    # The fingertip slips a little along the face: half-way is the mean of both ends. Where the face
    # is along its normal the shape knows better than the camera.
    out = before.R_WB.T @ normal
    ends = zip((before, after or before), recording.tips[[0, -1 if after else 0]], strict=True)
    seen = np.mean([(tip - pose.p_WB) @ pose.R_WB for pose, tip in ends], axis=0)
    point = seen + (np.array(push.p_BC) - seen) @ out * out
    along = rot_z(yaw[moving].mean()) @ force
    way = float((recording.tips[-1] - recording.tips[0]) @ along / np.linalg.norm(along))
    # Besides what was seen: how the base carries it is not known exactly, and the force turns
    # a little as it begins to slide, by 0.4 rad/m.
    rate, rate_sd = turned / way, np.hypot(0.4, np.sqrt(2.0) * recording.pose_sd[1] / way)
    return [
        Trial(
            "slide",
            point=_triple(point),
            force=_triple(force),
            force_sd=_force_sd(recording, moving),
            turn_rate=None if after is None else rate,
            turn_rate_sd=None if after is None else float(rate_sd),
            source=source,
        )
    ]


def _slip(recording: Recording, source: str) -> list[Trial]:
    """The mean over the way on which the finger slipped."""
    down = recording.tips[0, 2] - recording.tips[:, 2]
    slipping = down > _UNDER_WAY
    if slipping.sum() < _FEWEST:
        return []
    R_BW = recording.before.R_WB.T
    push = recording.experiment.push
    return [
        Trial(
            "slip",
            point=push.p_BC,
            force=_triple(R_BW @ recording.forces[slipping].mean(axis=0)),
            force_sd=_force_sd(recording, slipping),
            normal=_triple(R_BW @ np.array(push.normal_W)),
            source=source,
        )
    ]


def _force_sd(recording: Recording, chosen: NDArray[np.bool_]) -> float:
    """Of the mean over samples whose scatter lasts three of them, and of the sensors' zero."""
    along = recording.forces[chosen] @ np.array(recording.experiment.push.direction_W)
    steps = np.arange(len(along))
    scatter = float(np.std(along - np.polyval(np.polyfit(steps, along, 1), steps)))
    sample = max(scatter, recording.force_sd) * np.sqrt(3.0 / len(along))
    return float(np.hypot(sample, recording.zero_sd))


def _triple(v: Array) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z


def trial_from_push(push: Push, target: SeenObject, trace: Trace) -> Trial | None:
    """Trial that a push showed of an object that was seen before.

    None if that is not clear, or nothing was felt for want of a sensor.
    """
    pushing = trace.phase == "push"
    moved = END_REASONS[trace.end].shows
    unfallen = trace.end == "stroke" and push.ends_on == "toppled"
    if moved is None or unfallen or pushing.sum() < LEAST_SAMPLES or not trace.felt:
        return None
    time = trace.time[pushing]
    tips = np.mean([tip[pushing] for tip in trace.tips.values()], axis=0)
    forces = np.sum([felt[pushing] for felt in trace.felt.values()], axis=0)
    travel = (tips - tips[0]) @ trace.direction
    chosen = _chosen(moved, push, time, forces @ trace.direction, travel)
    if chosen is None:
        return None
    force = forces[chosen].mean(axis=0) @ target.pose.R_WB
    point = np.array(push.p_BC)
    if push.fingers == 2 and moved != "topple":
        # The part of its place along the face that lies off the centre of mass turns nothing.
        along = np.array([-force[1], force[0], 0.0]) / np.hypot(*force[:2])
        point = point - ((point - np.array(target.model.com)) @ along) * along
    (x, y, z), (f_x, f_y, f_z) = point.tolist(), force.tolist()
    return Trial(
        moved,
        point=(x, y, z),
        force=(f_x, f_y, f_z),
        force_sd=FORCE_SD * float(np.linalg.norm(force)),
        normal=_triple(target.pose.R_WB.T @ np.array(push.normal_W)) if moved == "slip" else None,
        source="a push",
    )


def _chosen(
    moved: Moved, push: Push, time: Array, force: Array, travel: Array
) -> NDArray[np.bool_] | None:
    """The samples whose force counts."""
    if moved == "none":
        return np.asarray(time > time[-1] - 0.5)  # held at its limit for so long [s]
    if moved == "slip":
        end = time[int(np.argmax(travel))]  # after it the finger springs back
        return np.asarray((time > end - 0.2) & (time <= end))  # it surely slips then [s]
    if moved == "topple":
        onset = detect_onset(time, force, travel)
        if not onset.moved:
            return None
        return np.asarray(np.abs(np.arange(len(time)) - onset.index) <= 5)  # samples
    even = (travel > EVEN[0]) & (travel < EVEN[1] * push.stroke)
    return np.asarray(even) if even.sum() >= 20 else None  # that a mean needs
