"""Record of an execution: steps the robot, keeps what it saw, felt and did, reports progress."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import quaternion
from planner.types.end_reasons import Ended
from sim.control.object_estimate import Touch, frame_as_things_lie, sense_touch
from sim.supervision import Monitor
from sim.traces.trace import ContactEvent, Trace

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike

    from objectmodels.geometry.rotations import Array
    from objectmodels.models.object_model import Resting
    from planner.types.end_reasons import EndReason
    from sim.robots.hand import Mount
    from sim.supervision import Progress
    from sim.worlds.ports import Frame, ObserverPort, RobotPort, SeenPose

_SWINGING = 0.1  # of a pause, until the hand hangs still [s]


UNSTOPPED = ("retreat", "settle", "set_down")
"""Phases that go on when a stop is asked for: they lead to where the robot may rest."""


class EarlyEndError(Exception):
    """An execution cannot go on.

    Attributes:
        ended: how the trace ends, and why.
    """

    def __init__(self, end: EndReason, detail: str) -> None:
        super().__init__(detail)
        self.ended = Ended(end, detail)


class TraceRecorder:
    """The robot's port with a record of every step.

    What an observer sees is read when the trace is asked for, never while the robot moves.

    Args:
        port: of the robot.
        observer: of the same world.
        mount: of the arm.
        normal_W: outward normal of the touched face in W, shape (3,).
        progress: called while something happens; a `Monitor` also says when to stop.

    Attributes:
        port: as given.
        mount: of arm and hand.
        phase: what is being done now; see `Trace.phase`.
        fingers: the fingers that push.
        force_limit: in force now [N].
        torques: what the pushing fingers' sensors read last, shape (k, 3) [N·m].
        zero: what they read while nothing is touched, of the same shape.
        touch: what the fingers felt last; None until there are any.
        frames: camera frames that arrived with the last step.
        rests: how objects lay on other faces than their models stand on when they were looked at;
            frames show them in the frames of those faces from then on.
        inward: unit normal into the touched face in W, shape (3,), or of each finger, (k, 3).
    """

    def __init__(
        self,
        port: RobotPort,
        observer: ObserverPort,
        mount: Mount,
        normal_W: Array,
        progress: Progress | None = None,
    ) -> None:
        self.port = port
        self.phase = "look"
        self.fingers: tuple[str, ...] = ()
        self.force_limit = 0.0
        self.torques = np.zeros((0, 3))
        self.zero: Array | float = 0.0
        self.touch: Touch | None = None
        self.frames: list[Frame] = []
        self.rests: Mapping[str, Resting] = {}
        self.mount = mount
        self.inward = -normal_W
        self._seed = observer.seed
        self._record = observer.record()
        self._monitor = Monitor.of(progress)
        self._newest: dict[str, SeenPose] = {}
        self._newest_lids: Mapping[str, float] = {}
        self._phases: list[str] = []
        self._limits: list[float] = []
        self._touches: list[Touch | None] = []
        self._seen: list[dict[str, SeenPose]] = []
        self._seen_lids: list[Mapping[str, float]] = []
        self._shown: list[Frame] = []

    def step(self, q_arm: Array, q_hand: Array) -> None:
        """Commands joint angles, lets a control period pass, reads the sensors.

        Raises:
            EarlyEndError: `stopped` if that was asked for, but on the way to rest.
        """
        # A trace shows where everything was seen, so that the first frame is waited for.
        stoppable = self._newest and self.phase not in UNSTOPPED
        if self._monitor.stop.requested and stoppable:
            raise EarlyEndError("stopped", f"it was told to stop (phase {self.phase})")
        self.port.step(q_arm, q_hand)
        self.frames = self.port.frames()
        self._shown += self.frames
        if self.frames:
            self._newest = dict(self.frames[-1].poses)
            self._newest_lids = self.frames[-1].lids
        if self.rests:
            self.frames = [frame_as_things_lie(frame, self.rests) for frame in self.frames]
        if self.fingers:
            self.torques = np.array([self.port.finger_torques(f) for f in self.fingers])
            self.touch = sense_touch(
                self.port, self.mount, self.fingers, self.inward, self.torques - self.zero
            )
            if np.any(self.zero):
                self._monitor.feel(self.port.time, self.fingers, self.touch.forces)
        self._phases.append(self.phase)
        self._limits.append(self.force_limit)
        self._touches.append(self.touch)
        self._seen.append(self._newest)
        self._seen_lids.append(self._newest_lids)

    def report(self, phase: str, text: str) -> None:
        """Reports what happens."""
        self._monitor(phase, self.port.time, text)

    def report_contact(self) -> None:
        """Reports that the fingers have felt what they were to touch."""
        assert self.touch is not None, "the recorder knows the fingers"
        self._monitor.contact(self.port.time, self.fingers, self.touch.forces)

    def begin(self, phase: str, text: str) -> None:
        """Reports a phase, and records it as such from now on."""
        self.phase = phase
        self.report(phase, text)

    def take_zero(self, pause: float, hang_still: Callable[[], None]) -> int:
        """Takes what the torque sensors read while the hand hangs still as their zero.

        Args:
            pause: time for which it does; at first it still swings [s].
            hang_still: its command for a control step.

        Returns:
            The number of steps over which the zero was taken.
        """
        torques = []
        for k in range(round(pause / self.port.period)):
            hang_still()
            if k * self.port.period >= _SWINGING:
                torques.append(self.torques)
        self.zero = np.mean(torques, axis=0)
        return len(torques)

    def trace(self, pushed: str, direction_W: Array, *, end: EndReason, detail: str) -> Trace:
        """Everything since the start as a trace about an object, with why it ended."""
        samples = self._record.samples[1:]
        n, k = len(samples), len(self.fingers)
        tips, forces = np.zeros((n, k, 3)), np.zeros((n, k, 3))
        touches = [touch for touch in self._touches if touch is not None]
        for i, touch in enumerate(self._touches):
            known = touch or touches[0] if touches else None
            if known is not None:
                tips[i] = known.tips
            if touch is not None:
                forces[i] = touch.forces
        names = self.port.cell.names
        first = next((seen for seen in self._seen if seen), {})
        lids = next((seen for seen in self._seen_lids if seen), {})
        return Trace(
            time=np.array([sample.time for sample in samples]),
            phase=np.array(self._phases),
            poses=_columns([sample.poses for sample in samples]),
            seen={name: _rows([(seen or first)[name] for seen in self._seen]) for name in names},
            joints=np.array([sample.joints for sample in samples]),
            joint_names=self.port.joint_names,
            tips={finger: tips[:, i] for i, finger in enumerate(self.fingers)},
            felt={finger: forces[:, i] for i, finger in enumerate(self.fingers)},
            force_limit=np.array(self._limits),
            contacts=tuple(
                ContactEvent(contact.time, contact.body_a, contact.body_b)
                for contact in self._record.contacts
            ),
            pushed=pushed,
            direction=direction_W,
            end=end,
            detail=detail,
            seed=self._seed,
            contents=_columns([sample.contents for sample in samples]),
            spilled=np.array([sample.spilled for sample in samples]),
            lids=_columns([sample.lids for sample in samples]),
            seen_lids=_columns([seen or lids for seen in self._seen_lids]),
            lid_poses=_columns([sample.lid_poses for sample in samples]),
            sightings=_sightings(self._shown),
            sighted_lids=_shown([(frame.time, frame.lids) for frame in self._shown]),
            sighted_levels=_shown([(frame.time, frame.levels) for frame in self._shown]),
        )


def _columns(rows: Sequence[Mapping[str, ArrayLike]]) -> dict[str, Array]:
    """Values of n mappings with the same names, by these names, shape (n, …) each."""
    return {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}


def _sightings(frames: Sequence[Frame]) -> dict[str, Array]:
    """Times and poses of everything that frames show, by its name, shape (m, 8) each."""
    names = dict.fromkeys(name for frame in frames for name in frame.poses)
    found = {}
    for name in names:
        showing = [frame for frame in frames if name in frame.poses]
        times = np.array([frame.time for frame in showing])
        found[name] = np.column_stack([times, _rows([frame.poses[name] for frame in showing])])
    return found


def _shown(frames: Sequence[tuple[float, Mapping[str, float]]]) -> dict[str, Array]:
    """Times and values of what frames show, by its name, shape (m, 2) each."""
    names = dict.fromkeys(name for _, values in frames for name in values)
    return {
        name: np.array([(time, values[name]) for time, values in frames if name in values])
        for name in names
    }


def _rows(poses: list[SeenPose]) -> Array:
    """Quaternions (w, x, y, z) and positions of poses, shape (n, 7)."""
    R_WB = np.array([pose.R_WB for pose in poses])
    return np.column_stack([quaternion(R_WB), np.array([pose.p_WB for pose in poses])])
