"""Touches that find out how an object behaves: the robot's side of the paper's experiments.

After the guarded touch the fingertip presses on, so slowly that nothing but friction and weight
holds against it: for a slide straight ahead, for a tilt along the arc that the contact takes about
the far edge of the base. Along the face it gives way, so that the object may turn freely and is
neither lifted nor dragged. A rub presses with a steady force and draws the fingertip down along the
face. The force comes from the finger's joint torques, zeroed before the
touch; where the fingertip is, from the joint angles. At the end the hand holds still and looks, and
a tilted object is let down as slowly as it was raised.

Guards stop a touch that shows something else than was meant, that slips off, that needs more force
than the finger has or that comes near to toppling the object; it then ends with what was seen.

Frames: W is the world, T the fingertip's centre.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sized
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from planner.touch_experiments import Experiment
from planner.types.end_reasons import EndReason
from planner.types.world_state import PlanarPose, WorldState
from sim.control.guarded_touch import TouchControl
from sim.control.object_estimate import mean_poses
from sim.control.plan_execution import PushExecution
from sim.control.trace_recorder import EarlyEndError
from sim.exploration.trial_extraction import Recording
from sim.motion.fingertip_path import TiltArc
from sim.motion.inverse_kinematics import UnreachableError

if TYPE_CHECKING:
    from objectmodels.identification import Moved
    from sim.control.free_motion import RobotSetup
    from sim.control.trace_recorder import TraceRecorder
    from sim.motion.fingertip_path import FingertipPath
    from sim.motion.inverse_kinematics import ArmConfiguration
    from sim.supervision import Progress
    from sim.worlds.ports import Frame


RUB_FORCE = 0.5
"""Force with which a rub presses, as a share of the one that would move the object."""


class ProbeControl(TouchControl):
    """One touch, from before the face until the hand holds still at its end.

    Attributes:
        gives_way: time constant with which forces along the face are given way to [s].
        stays: the hand stays at the object in the end.
    """

    pause = 1.5
    speed = 0.012
    gives_way = 0.08
    stays = False

    def __init__(
        self,
        experiment: Experiment,
        recorder: TraceRecorder,
        stance: ArmConfiguration,
        way: FingertipPath,
    ) -> None:
        super().__init__(experiment.push, experiment.onset, recorder, stance, way)
        self.experiment = experiment
        self._samples: list[tuple[float, Array, Array]] = []
        # Time, seen tilt along the push, and the one at which the fingertip was then.
        self._views: deque[tuple[float, float, float]] = deque()
        self._origin = way.touch
        axes = np.array([[-self._u[1], self._u[0], 0.0], [0.0, 0.0, 1.0]])
        self._face_axes = [(axis, stance.push_stiffness(axis)) for axis in axes]
        self._aside = np.zeros(3)
        self._moved: Moved | None = None
        self._most = 0.0
        self._lost = 0.0
        self._seen: list[Frame] = []

    def run(self) -> tuple[EndReason, str]:
        """Touches, presses until an end or a guard, holds still; returns how it ended."""
        kind = self.experiment.kind
        self._begin()
        try:
            ended = {"tilt": self._raise, "rub": self._rub}.get(kind, self._slide)()
            self._hold()
        except EarlyEndError:
            self.recorder.phase = "retreat"
            if kind == "tilt":
                self._let_down()
            raise
        if kind == "tilt":
            if self._moved == "topple" and self._seen:
                # A tilt too small to be told from a slide on the way is looked for at its end.
                seen = float(np.mean([self._tilt_in(frame) for frame in self._seen]))
                ended = self._slid(seen, self._own_tilt(), self._seen) or ended
            self._let_down()
        return ended

    def _begin(self) -> None:
        """Touches; from then on it presses."""
        kind = self.experiment.kind
        self.recorder.report("touch", f"feeling for the face ({kind})")
        self.touch()
        self._origin = self._here.midpoint
        self._start = self.recorder.port.time
        self.recorder.begin("push", f"pressing until something moves ({kind})")

    def _slide(self) -> tuple[EndReason, str]:
        """Straight ahead."""
        command, step = self.commanded, self.experiment.push.speed * self._period
        while True:
            command = command + step * self._u
            self._press(command)
            ended = self._way_end() or self._tilts()
            if ended is not None:
                return ended

    def _raise(self) -> tuple[EndReason, str]:
        """Along the arc about the far edge."""
        radius = self._arc.arc_radius
        start = float(self._arc.tilt_angles(self.commanded[None])[0])
        self._angle = start
        while True:
            self._angle += self.experiment.push.speed * self._period / radius
            # Where the fingertip touches goes round on it as the face leans.
            lean = self._own_tilt()
            self.recorder.inward = np.cos(lean) * self._u - [0.0, 0.0, np.sin(lean)]
            self._press(self._arc.tip_at(self._angle))
            ended = self._way_end() or self._slides()
            if ended is not None:
                return ended

    def _rub(self) -> tuple[EndReason, str]:
        """Pressing gently, down along the face."""
        down = np.array([0.0, 0.0, -1.0])
        wanted = RUB_FORCE * self.experiment.onset
        time_constant = 0.15
        stiffness = self.stance.push_stiffness(self._u)
        command, drawn = self.commanded, 0.0
        while True:
            lacking = wanted - float(self._forces.sum())
            command = command + self._period / time_constant * lacking / stiffness * self._u
            drawn += self.experiment.push.speed * self._period
            self._step(command + drawn * down, self._u)
            self._keep()
            way = self._here.midpoint - self._origin
            if abs(float(way @ self._u)) > 0.002:
                return "guard", "the object moved where the finger should slip"
            if -way[2] >= self.experiment.raised:
                self._moved = "slip"
                return "stroke", f"the finger slipped by {-1e3 * way[2]:.0f} mm"
            ended = self._guard_end()
            if ended is not None:
                return ended

    def _let_down(self) -> None:
        radius = self._arc.arc_radius
        while self._angle > 0.0:
            # Twice as fast as it was raised.
            self._angle -= 2.0 * self.experiment.push.speed * self._period / radius
            self._step(self._arc.tip_at(self._angle) + self._aside, self._u)

    def _hold(self) -> None:
        """Stands still and looks."""
        since = self.recorder.port.time
        for _ in range(round(0.8 / self._period)):  # for 0.8 s
            self._step(self.commanded, self._u)
            self._seen += [frame for frame in self.recorder.frames if frame.time > since]

    @property
    def _arc(self) -> TiltArc:
        return TiltArc(self._origin, self._u, self.experiment.length, self._tip_radius)

    def _own_tilt(self) -> float:
        """Tilt at which the fingertip touches the face where it is [rad]."""
        return float(self._arc.tilt_angles(self._here.midpoint[None])[0])

    def _press(self, tip: Array) -> None:
        """Commands T, giving way to forces along the face."""
        self._step(tip + self._aside, self._u)
        self._keep()
        for axis, stiffness in self._face_axes:
            force = float(self._here.forces[0] @ axis)
            self._aside = self._aside - self._period / self.gives_way * force / stiffness * axis

    def _keep(self) -> None:
        """Keeps what was felt and seen."""
        here, now = self._here, self.recorder.port.time
        self._samples.append((now, here.midpoint, here.forces[0]))
        for frame in self.recorder.frames:
            own = self._own_tilt()
            self._views.append((frame.time, self._tilt_in(frame), own))
        while self._views and self._views[0][0] < now - 0.35:  # [s]
            self._views.popleft()

    def _way_end(self) -> tuple[EndReason, str] | None:
        """The way is done, or a guard."""
        here = self._here.midpoint
        travel = float((here - self._origin) @ self._u)
        if self.experiment.kind == "tilt":
            tilt = self._own_tilt()
            if tilt >= self.experiment.angle:
                self._moved = "topple"
                return "stroke", f"it was tilted by {np.degrees(tilt):.1f}°"
        elif travel >= self.experiment.push.stroke:
            self._moved = "slide"
            return "stroke", f"it was moved by {1e3 * travel:.0f} mm"
        return self._guard_end()

    def _guard_end(self) -> tuple[EndReason, str] | None:
        """Too much force, a fingertip that slipped off, or too much time."""
        push, felt = self.experiment.push, float(self._forces.sum())
        (finger,) = self.stance.posture.pushing
        # Bent back as far as it goes, a finger bears what no sensor shows.
        at_stop = self.stance.mount.hand.is_at_stop(self.recorder.port.finger_angles(finger))
        if felt > push.force_limit or at_stop:
            return "force", f"it does not move with {felt:.1f} N, the most of this finger"
        # It feels less than a tenth of the most for 0.3 s, or has gone 15 mm along the face.
        aside = float((self._here.midpoint - self._origin) @ [-self._u[1], self._u[0], 0.0])
        self._most = max(self._most, felt)
        self._lost = self._lost + self._period if felt < 0.1 * self._most else 0.0
        if self._lost > 0.3 or abs(aside) > 0.015:
            return "guard", "the fingertip slipped off"
        # Six seconds for the force to rise, then four times what the way alone takes.
        longest = 6.0 + 4.0 * (push.stroke + self.experiment.raised) / push.speed
        if self.recorder.port.time - self._start > longest:
            return "guard", f"it took longer than {longest:.0f} s"
        return None

    def _lately(self) -> tuple[float, float]:
        """Means of the tilts seen lately and of the fingertip's own [rad]; nan if too few."""
        if len(self._views) < 5:
            return np.nan, np.nan
        _, seen, own = np.mean(self._views, axis=0).tolist()
        return seen, own

    def _tilts(self) -> tuple[EndReason, str] | None:
        seen, _ = self._lately()
        if seen > np.radians(2.5):  # which no slide has, beyond the noise
            self._moved = "topple"
            return "guard", f"it tilts ({np.degrees(seen):.0f}°) where it should slide"
        return None

    def _slides(self) -> tuple[EndReason, str] | None:
        """Compares tilts of the same frames: what is seen lags behind."""
        return self._slid(*self._lately(), self._views)

    def _slid(self, seen: float, own: float, views: Sized) -> tuple[EndReason, str] | None:
        """The end if much less of a tilt is seen in some frames than the fingertip has gone."""
        noise = np.radians(self.recorder.port.cell.vision.angle_noise_deg)
        # Four deviations of what is seen; half a degree may always be missing.
        unsure = 4.0 * float(noise) / np.sqrt(max(len(views), 1))
        if own - seen > max(0.5 * own, unsure, np.radians(0.5)):
            self._moved = "slide"
            return "guard", "it slides where it should tilt"
        return None

    def _tilt_in(self, frame: Frame) -> float:
        """Tilt along the push that a frame shows [rad]."""
        up = frame.poses[self.experiment.push.object].R_WB[:, 2]
        return float(np.arctan2(up @ self._u, up[2]))

    def recording(self, end: EndReason, detail: str, before: PlanarPose) -> Recording:
        """The record of what was felt and seen."""
        name = self.experiment.push.object
        port, vision = self.recorder.port, self.recorder.port.cell.vision
        noise = self.stance.force_noise_gain(self._u) * port.torque_noise
        frames = max(1.0, vision.rate_hz)
        return Recording(
            experiment=self.experiment,
            end=end,
            detail=detail,
            moved=self._moved,
            time=np.array([t for t, _, _ in self._samples]),
            tips=np.array([p for _, p, _ in self._samples]),
            forces=np.array([f for _, _, f in self._samples]),
            before=before,
            after=mean_poses(self._seen)[name] if self._seen else None,
            force_sd=noise,
            zero_sd=noise / float(np.sqrt(max(1.0, self.pause / self._period))),
            tip_radius=self._tip_radius,
            pose_sd=(
                vision.position_noise_m / float(np.sqrt(frames)),
                float(np.radians(vision.angle_noise_deg) / np.sqrt(frames)),
            ),
        )


def probe(
    experiment: Experiment,
    setup: RobotSetup,
    state: WorldState,
    *,
    progress: Progress | None = None,
    control: type[ProbeControl] = ProbeControl,
) -> Recording:
    """Carries out one experiment.

    Args:
        experiment: which.
        setup: the robot.
        state: what is believed, from a look since which nothing has moved.
        progress: told of the phase, the simulated time [s] and what happens.
        control: of the touch.

    Returns:
        What the robot felt and saw, also if the touch was aborted.
    """
    models = {name: seen.model for name, seen in state.objects.items()}
    execution = PushExecution(experiment.push, setup, models, progress)
    before = state.objects[experiment.push.object].pose
    try:
        stance, way = execution.stance(state)
        way = way.raised_by(experiment.raised)
        execution.approach(stance, way)
        touch = control(experiment, execution.recorder, stance, way)
        try:
            end, detail = touch.run()
        finally:
            if not control.stays:
                execution.leave(stance, touch.commanded, way)
        found = touch.recording(end, detail, before)
    except EarlyEndError as early:
        found = Recording(experiment, *early.ended, before)
    except UnreachableError as error:
        found = Recording(experiment, "unreachable", str(error), before)
    if control.stays:
        return found
    execution.come_home(0.3)  # time for an object to come to rest
    trace = execution.recorder.trace(
        experiment.push.object,
        np.array(experiment.push.direction_W),
        end=found.end,
        detail=found.detail,
    )
    return replace(found, trace=trace)
