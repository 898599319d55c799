"""The record of an execution: what happened, sampled over time.

What an observer of the world recorded (`poses`, `contacts`, `contents`, `lids`, `lid_poses`,
`spilled`) is for judging and for replay, and nothing that plans or controls reads it; a real
robot's trace has none of it. All else is what the robot itself perceived, felt and commanded
(`Trace.perceived`).

A trace is saved as an npz file with an array for each attribute, named as it, and for each name of
those that are kept by name (`poses/mug`). `contacts` are three arrays, one for each of their
attributes; `format` names the form of the file, `units` says the unit of every attribute.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import LIMITS, read_bytes, replace_file
from objectmodels.geometry.rotations import Array, from_quaternion, yaw_of
from planner.types.end_reasons import END_REASONS, EndReason


def _read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays by name, in the order of an npz file; numbers and texts alone.

    What `numpy.savez_compressed` has written is read with limits of size, without pickle, and
    without trust in the sizes that it states.

    Raises:
        ModelError: `unreadable_file`, or `bad_trace` if it is no such file.
    """
    content = read_bytes(path, "trace_file")
    most = LIMITS["trace_file"].most
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            if sum(each.file_size for each in members.infolist()) > most:
                raise ValueError(f"it unpacks to more than {most:.0f} bytes")
            return {
                each.filename.removesuffix(".npy"): _array(members.read(each))
                for each in members.infolist()
            }
    except (
        zipfile.BadZipFile,
        zlib.error,
        ValueError,
        EOFError,
        OSError,
        RuntimeError,
    ) as error:
        _refuse_trace(path, f"no npz file of numbers and texts: {error}", error)


def _array(content: bytes) -> NDArray[Any]:
    """The array of an npy file, of a size that the file really has."""
    file = io.BytesIO(content)
    if np.lib.format.read_magic(file) != (1, 0):
        raise ValueError("another version of npy")
    shape, by_columns, kind = np.lib.format.read_array_header_1_0(file)
    if kind.kind not in "fiU":  # numbers and texts
        raise ValueError(f"an array of {kind}")
    flat = np.frombuffer(content[file.tell() :], kind)
    return flat.reshape(shape, order="F" if by_columns else "C")


def _refuse_trace(path: Path, message: str, cause: Exception) -> NoReturn:
    """Raises `bad_trace` for a file."""
    raise ModelError(
        "bad_trace",
        message,
        path=str(path),
        suggestions=("give a file that `Trace.save` or `say --trace` has written",),
    ) from cause


FORMAT = "nlcontrol-trace/1"
"""Form of the file of a trace, and its version."""

UNITS = {
    "time": "s",
    "poses": "quaternion (w, x, y, z), then m",
    "seen": "quaternion (w, x, y, z), then m",
    "sightings": "s, then quaternion (w, x, y, z), then m",
    "joints": "rad",
    "tips": "m",
    "felt": "N",
    "force_limit": "N",
    "contacts/time": "s",
    "contents": "m^3",
    "lids": "rad, or m of one that lifts off",
    "seen_lids": "rad, or m of one that lifts off",
    "sighted_lids": "s, then rad, or m of one that lifts off",
    "sighted_levels": "s, then m",
    "lid_poses": "quaternion (w, x, y, z), then m",
    "spilled": "m^3",
}
"""Units of what a trace holds; the rest has none."""

_SAMPLED = ("time", "phase", "force_limit")
_BY_NAME: Mapping[str, tuple[int, ...]] = {
    "poses": (7,),
    "seen": (7,),
    "tips": (3,),
    "felt": (3,),
    "contents": (),
    "lids": (),
    "seen_lids": (),
    "lid_poses": (7,),
}
_FRAMES: Mapping[str, int] = {"sightings": 8, "sighted_lids": 2, "sighted_levels": 2}
_TEXTS = ("pushed", "end", "detail")


@dataclass(frozen=True)
class ContactEvent:
    """Two bodies that began to touch.

    Attributes:
        time: when [s].
        body_a, body_b: the scene's names of the two, e.g. `index_tip` and `ice tea box`.
    """

    time: float
    body_a: str
    body_b: str


@dataclass(frozen=True, eq=False)
class Trace:
    """The record of an execution, sampled n times.

    Attributes:
        time: shape (n,) [s].
        phase: shape (n,), one of `look`, `transit`, `approach`, `touch`, `push`, `retreat`,
            `settle`, or of a whole hand `grasp`, `lift`, `carry`, `pour`, `set_down`, `lid`, at
            each sample.
        poses: per object, shape (n, 7): quaternion (w, x, y, z) and position p_WB [m] of the
            frame B that the object had at the start.
        seen: per object, shape (n, 7): the newest pose from the camera port.
        sightings: per object, each camera frame that shows it once, shape (m, 8): when it was
            exposed, on the robot's clock [s], and the pose in it; no row where it was hidden.
        joints: robot positions, shape (n, m) [rad]; `joint_names` names them.
        tips: per pushing finger, position of the fingertip's centre in W, shape (n, 3) [m].
        felt: per pushing finger, force of the fingertip on the object in W, from the joint
            torque sensors, shape (n, 3) [N].
        force_limit: the force limit in force at each sample, shape (n,) [N]; of a drag that of
            the whole force, pressing and drawing.
        contacts: touches in order of time.
        pushed: name of the pushed object.
        direction: unit direction of the push in W, shape (3,).
        end: why the push ended; `detail` says it in words.
        seed: what everything random was drawn from.
        contents: per container, true volume in it, shape (n,) [m³].
        lids: per object with a lid, how far that truly is open: the angle of a flip lid [rad], the
            turn of a cap [rad], the distance of one that lifts off from its seat [m], shape (n,).
        seen_lids: the same from the camera port.
        sighted_lids: the same in each frame, with its time, shape (m, 2).
        sighted_levels: per open container, height of what is in it over the bottom of its cavity as
            a frame shows it, with its time, shape (m, 2) [s], [m].
        lid_poses: per object whose lid comes off, that lid's pose X_WL as in `poses`; see
            `sim.worlds.drake.drake_bodies`.
        spilled: true volume that has run onto the table or elsewhere, shape (n,) [m³].
    """

    time: Array
    phase: NDArray[np.str_]
    poses: dict[str, Array]
    seen: dict[str, Array]
    joints: Array
    joint_names: tuple[str, ...]
    tips: dict[str, Array]
    felt: dict[str, Array]
    force_limit: Array
    contacts: tuple[ContactEvent, ...]
    pushed: str
    direction: Array
    end: EndReason
    detail: str
    seed: int
    contents: dict[str, Array] = field(default_factory=dict)
    lids: dict[str, Array] = field(default_factory=dict)
    seen_lids: dict[str, Array] = field(default_factory=dict)
    lid_poses: dict[str, Array] = field(default_factory=dict)
    sightings: dict[str, Array] = field(default_factory=dict)
    sighted_lids: dict[str, Array] = field(default_factory=dict)
    sighted_levels: dict[str, Array] = field(default_factory=dict)
    spilled: Array = field(default_factory=lambda: np.zeros(0))

    def save(self, path: Path | str) -> None:
        """Writes the trace to an npz file, whole or not at all.

        Raises:
            ModelError: `cannot_write`.
        """
        units = np.array(json.dumps(UNITS))
        with replace_file(Path(path)) as temporary, temporary.open("wb") as file:
            np.savez_compressed(
                file, allow_pickle=False, format=np.array(FORMAT), units=units, **self.arrays()
            )

    @classmethod
    def load(cls, path: Path | str) -> Trace:
        """The trace that `save` wrote.

        Raises:
            ModelError: `unreadable_file`, or `bad_trace` if it holds something else.
        """
        arrays = _read_arrays(Path(path))
        try:
            return _trace_of(arrays)
        except KeyError as error:
            _refuse_trace(Path(path), f"{error.args[0]} is missing", error)
        except ValueError as error:
            _refuse_trace(Path(path), str(error), error)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Everything in it as arrays by name."""
        by_name = {
            f"{key}/{name}": values
            for key in (*_BY_NAME, *_FRAMES)
            for name, values in getattr(self, key).items()
        }
        single = ("joints", "direction", "seed", "spilled", *_SAMPLED, *_TEXTS)
        contacts = {
            f"contacts/{key}": np.array([getattr(each, key) for each in self.contacts], kind)
            for key, kind in (("time", float), ("body_a", str), ("body_b", str))
        }
        names = {"joint_names": np.array(self.joint_names, str)}  # there may be none
        return {key: np.asarray(getattr(self, key)) for key in single} | names | by_name | contacts

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trace):
            return NotImplemented
        mine, others = self.arrays(), other.arrays()
        return mine.keys() == others.keys() and all(
            np.array_equal(mine[key], others[key]) for key in mine
        )

    __hash__ = None  # type: ignore[assignment]

    @property
    def is_observed(self) -> bool:
        """An observer recorded the truth."""
        return bool(self.poses)

    @property
    def perceived(self) -> Trace:
        """What the robot itself perceived, felt and commanded, and nothing else."""
        return replace(
            self, poses={}, contacts=(), contents={}, lids={}, lid_poses={}, spilled=np.zeros(0)
        )

    @property
    def shown(self) -> Trace:
        """What is shown of it: as an observer saw it, or else as the robot's camera did."""
        return self if self.is_observed else replace(self, poses=self.seen)

    def displacement(self, name: str) -> Array:
        """Displacement p_WB(end) − p_WB(start) of an object, shape (3,) [m]."""
        p = self.poses[name][:, 4:]
        return np.asarray(p[-1] - p[0])

    def seen_displacement(self, name: str) -> Array:
        """The same as far as the robot saw it, horizontal, shape (3,) [m].

        Means over what was seen in the first look and after the hand was home at the end.
        """
        p = self.seen[name][:, 4:]
        first, last = self._still
        moved = p[last].mean(axis=0) - p[first].mean(axis=0)
        return np.array([moved[0], moved[1], 0.0])

    def seen_turn(self, name: str) -> float:
        """Angle by which the robot saw it turn, counter-clockwise, less than half a turn [rad]."""
        heading = np.exp(1j * yaw_of(from_quaternion(self.seen[name][:, :4])))
        first, last = self._still
        return float(np.angle(heading[last].mean() / heading[first].mean()))

    @property
    def _still(self) -> tuple[slice, slice]:
        """The first look, and the time after the hand was home at the end.

        Without one the first sample, or the last.
        """
        looked = int(np.argmax(self.phase != "look"))
        settling = int(np.flatnonzero(self.phase != "settle")[-1]) + 1
        return slice(max(looked, 1)), slice(min(settling, len(self.phase) - 1), None)

    def tilt(self, name: str) -> Array:
        """Angle between the object's axis B_z and the vertical over time, shape (n,) [rad]."""
        _, x, y, _ = self.poses[name][:, :4].T
        return np.asarray(np.arccos(np.clip(1.0 - 2.0 * (x**2 + y**2), -1.0, 1.0)))

    def yaw(self, name: str) -> Array:
        """Heading of B_x over time, relative to the start and unwrapped, shape (n,) [rad]."""
        heading = yaw_of(from_quaternion(self.poses[name][:, :4]))
        return np.asarray(np.unwrap(heading) - heading[0])

    def push_force(self) -> Array:
        """Felt force of all fingers along the push direction over time, shape (n,) [N]."""
        return np.asarray(np.sum([f @ self.direction for f in self.felt.values()], axis=0))


def _trace_of(arrays: Mapping[str, NDArray[Any]]) -> Trace:
    """The trace that a file holds.

    Raises:
        KeyError: something is missing.
        ValueError: something has another form, which is told.
    """
    if str(arrays["format"]) != FORMAT:
        raise ValueError(f"its format is {arrays['format']!s:.40}, expected {FORMAT}")
    n = len(_of_shape(arrays, "time", (-1,)))
    names = tuple(_of_shape(arrays, "joint_names", (-1,), "U").tolist())
    contacts = (
        _of_shape(arrays, f"contacts/{key}", (-1,), kind).tolist()
        for key, kind in (("time", "f"), ("body_a", "U"), ("body_b", "U"))
    )
    texts: dict[str, Any] = {key: str(_of_shape(arrays, key, (), "U")) for key in _TEXTS}
    if texts["end"] not in END_REASONS:
        raise ValueError(f"it ends with {texts['end']!r:.40}, which is no reason to end")
    sampled: dict[str, Any] = {
        key: _of_shape(arrays, key, (n,), "U" if key == "phase" else "f") for key in _SAMPLED
    }
    shapes = {field: (n, *shape) for field, shape in _BY_NAME.items()}
    shapes |= {field: (-1, columns) for field, columns in _FRAMES.items()}
    by_name: dict[str, Any] = {
        field: {
            key.partition("/")[2]: _of_shape(arrays, key, shape)
            for key in arrays
            if key.startswith(f"{field}/")
        }
        for field, shape in shapes.items()
    }
    return Trace(
        joints=_of_shape(arrays, "joints", (n, len(names))),
        joint_names=names,
        contacts=tuple(ContactEvent(*each) for each in zip(*contacts, strict=True)),
        direction=_of_shape(arrays, "direction", (3,)),
        seed=int(_of_shape(arrays, "seed", (), "i")),
        spilled=_of_shape(arrays, "spilled", (-1,)),
        **texts,
        **sampled,
        **by_name,
    )


def _of_shape(
    arrays: Mapping[str, NDArray[Any]], key: str, shape: tuple[int, ...], kind: str = "f"
) -> NDArray[Any]:
    """An array of that shape, -1 for any length, and kind of values."""
    found = arrays[key]
    fits = len(found.shape) == len(shape) and all(
        of in (-1, had) for of, had in zip(shape, found.shape, strict=True)
    )
    if not fits or found.dtype.kind != kind:
        raise ValueError(f"{key!r:.60} has shape {found.shape} of {found.dtype}, expected {shape}")
    return found


def join_traces(traces: Sequence[Trace]) -> Trace:
    """Executions one after another in one world as one.

    There is at least one, all of the same pushed object, in order of time. How it ended, the
    direction and the names of the fingers are those of the last one.
    """
    if len(traces) == 1:
        return traces[0]
    last = traces[-1]
    # One that ended before the hand got there has none.
    fingers = tuple(next((trace.tips for trace in reversed(traces) if trace.tips), ()))
    tips, felt = zip(*(_by_slots(trace, len(fingers)) for trace in traces), strict=True)
    joined: dict[str, Any] = {}
    for key in (*_SAMPLED, "joints", "spilled"):
        joined[key] = np.concatenate([getattr(trace, key) for trace in traces])
    for key in (key for key in _BY_NAME if key not in {"tips", "felt"}):
        joined[key] = _one_after_another([getattr(trace, key) for trace in traces])
    for key in _FRAMES:
        joined[key] = _frame_after_frame([getattr(trace, key) for trace in traces])
    return replace(
        last,
        tips=dict(zip(fingers, np.concatenate(tips, axis=1), strict=True)),
        felt=dict(zip(fingers, np.concatenate(felt, axis=1), strict=True)),
        contacts=tuple(event for trace in traces for event in trace.contacts),
        **joined,
    )


def _one_after_another(parts: Sequence[dict[str, Array]]) -> dict[str, Array]:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _frame_after_frame(parts: Sequence[dict[str, Array]]) -> dict[str, Array]:
    """Frames of every name; some may have been hidden, or not there, in some parts."""
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: np.concatenate([part[name] for part in parts if name in part]) for name in names}


def _by_slots(trace: Trace, slots: int) -> tuple[Array, Array]:
    """Tips and forces for so many fingers, shape (slots, n, 3) each; midpoint and sum are kept."""
    n = len(trace.time)
    middle = np.mean(list(trace.tips.values()), axis=0) if trace.tips else np.zeros((n, 3))
    total = np.sum(list(trace.felt.values()), axis=0) if trace.felt else np.zeros((n, 3))
    if len(trace.tips) == slots > 0:
        return np.array(list(trace.tips.values())), np.array(list(trace.felt.values()))
    return np.tile(middle, (slots, 1, 1)), np.tile(total / max(slots, 1), (slots, 1, 1))
