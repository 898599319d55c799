"""Recordings of touches, force and place of the fingertip over time, made into trials.

Model: a finger travels slowly and presses; where the object begins to move is found as in the
simulated world (`objectmodels.identification.onset_detection`). Places and forces are in the level
axes that B had at the start of the recording. What moved is stated, or read off the object's tilt:
force and place of the finger alone do not tell it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians
from typing import cast

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array
from objectmodels.identification.logs.csv_tables import Row, Table, short_quote
from objectmodels.identification.onset_detection import (
    LEAST_SAMPLES,
    LEAST_TRAVEL,
    Onset,
    detect_onset,
)
from objectmodels.identification.plausibility_checks import (
    Objection,
    contact_objection,
    force_objection,
)
from objectmodels.identification.trial import Moved, Trial, Vector
from objectmodels.models.object_model import ObjectModel

CONTACT = ("x_m", "y_m", "z_m")
FORCE = ("fx_n", "fy_n", "fz_n")
COLUMNS = (
    "trial", "time_s", *FORCE, *CONTACT, "moved", "yaw_deg", "tilt_deg", "repetition", "note"
)  # fmt: skip
"""Columns that a table of recordings may have."""

LEAST_TILT = radians(2.0)
"""A recording in which the object tilts by this is of a topple, else of a slide [rad]."""

_WAY = 0.010  # travel after the onset over which direction and turn are taken [m]
_LONGEST = 1000.0  # a recording that is longer has its times in milliseconds [s]
_LAST = 0.1  # share of a recording, at its end, over which a held tilt is averaged
_SD = 0.01  # least standard deviation of a force as a share of it: tables are uneven
_ANGLE_SD = radians(0.5)  # of a tilt at an instant


@dataclass(frozen=True)
class Recording:
    """One touch over time.

    Attributes:
        time: of the n samples, shape (n,) [s].
        force: f_BC on the object, shape (n, 3) [N].
        tip: place of the fingertip's contact, shape (n, 3) [m].
        yaw: turn of the object, counter-clockwise, shape (n,) [rad]; None if not recorded.
        tilt: of the object, shape (n,) [rad]; None if not recorded.
        moved: what moved, if it was stated.
        repetition: as of `Trial`.
        source: what to call it in messages.
    """

    time: Array
    force: Array
    tip: Array
    yaw: Array | None = None
    tilt: Array | None = None
    moved: Moved | None = None
    repetition: int = 0
    source: str = "a recording"


def trial_from_series(recording: Recording) -> tuple[Trial, Onset] | None:
    """The trial at the onset of motion in a recording, and the onset; None if nothing moved.

    Raises:
        ModelError: `bad_array` if it is too short, or its times do not increase.
    """
    force, tip = recording.force, recording.tip
    d = _push_direction(recording)
    travel = (tip - tip[0]) @ d
    onset = detect_onset(recording.time, force @ d, travel)
    if not onset.moved:
        return None
    way = _samples_after_onset(travel, onset.index)
    mean = force[way].mean(axis=0)
    if mean @ d <= 0.0 or onset.force <= 0.0:
        raise ModelError("bad_array", "the force is against the travel of the finger")
    # The size is the onset's; what acts across the push is the mean on the way.
    found = onset.force * mean / (mean @ d)
    size = float(np.linalg.norm(found))
    moved = recording.moved or ("topple" if _held_tilt(recording) else "slide")
    rate, rate_sd = _turn_rate(recording, travel, way) if moved == "slide" else (None, None)
    trial = Trial(
        moved=moved,
        point=_vector_tuple(tip[onset.index]),
        force=_vector_tuple(found),
        force_sd=float(np.hypot(onset.force_sd * size / onset.force, _SD * size)),
        turn_rate=rate,
        turn_rate_sd=rate_sd,
        repetition=recording.repetition,
        source=recording.source,
    )
    return trial, onset


def tilted_trial(recording: Recording, onset: Trial, model: ObjectModel) -> Trial | None:
    """The balance at the end of a recording in which the object is held tilted, if it is one.

    Args:
        recording: with its tilt.
        onset: its trial at the onset, a topple.
        model: the object; its base has the edge about which it tilts.
    """
    if recording.tilt is None or onset.moved != "topple" or not _held_tilt(recording):
        return None
    last = slice(-max(int(_LAST * len(recording.time)), 3), None)
    tilt = float(recording.tilt[last].mean())
    force = recording.force[last].mean(axis=0)
    u = np.array(onset.force[:2])
    n = np.append(model.base.facing_normal(u / np.linalg.norm(u)), 0.0)
    d = float(model.base.extent(n[:2]))
    # The point of the object where the finger now is: turned back about the edge.
    tip = recording.tip[last].mean(axis=0)
    along, up = float(n @ tip) - d, float(tip[2])
    back = along * np.cos(tilt) - up * np.sin(tilt)
    height = along * np.sin(tilt) + up * np.cos(tilt)
    point = tip + (back - along) * n + [0.0, 0.0, height - up]
    scatter = float(recording.force[last].std(axis=0).max())
    return replace(
        onset,
        point=_vector_tuple(point),
        force=_vector_tuple(force),
        force_sd=float(np.hypot(scatter, _SD * np.linalg.norm(force))),
        tilt=tilt,
        tilt_sd=_ANGLE_SD,
        source=f"{onset.source}, held at {np.degrees(tilt):.0f}°",
    )


def read_recordings(table: Table, model: ObjectModel, prefix: str) -> tuple[list[Trial], list[str]]:
    """The trials of a table of recordings, and what was left out of it and why.

    Args:
        table: a row for each sample; the samples of a trial in their order.
        model: the object that was touched.
        prefix: how trials' names begin in messages.

    Raises:
        ModelError: `bad_data`.
    """
    table.require_columns(("trial", "time_s", *FORCE, *CONTACT), COLUMNS)
    if "moved" not in table.columns and "tilt_deg" not in table.columns:
        raise table.error(
            "lacks the column moved: force and place of the finger do not tell what moved",
            "add `moved` (slide or topple), or the object's tilt_deg over time",
        )
    trials: list[Trial] = []
    unused: list[str] = []
    for label, rows in _by_trial(table).items():
        recording = _recording_from(label, rows, prefix)
        require_none(rows[0], contact_objection(model, _vector_tuple(recording.tip[0])))
        try:
            found = trial_from_series(recording)
        except ModelError as error:
            raise rows[0].error("trial", f"trial {label}: {error.message}") from error
        if found is None:
            unused.append(
                f"{recording.source}: nothing moved in it (the finger travelled less than "
                f"{1e3 * LEAST_TRAVEL:.0f} mm with the force at its height)"
            )
            continue
        trial, onset = found
        largest = FORCE[int(np.argmax(np.abs(trial.force)))]
        require_none(rows[onset.index], force_objection(model, trial), largest)
        held = tilted_trial(recording, trial, model)
        trials += [trial] if held is None else [trial, held]
    return trials, unused


def require_none(row: Row, objection: Objection | None, force: str = FORCE[0]) -> None:
    """Raise an objection as an error of the row that it concerns.

    Args:
        row: where the measurement was read.
        objection: to it, None if it is plausible.
        force: column of the force, or of its largest component.

    Raises:
        ModelError: `bad_data`.
    """
    if objection is not None:
        columns = dict(zip("xyz", CONTACT, strict=True)) | {
            "force": force,
            "force_sd": "force_sd_n",
        }
        raise row.error(columns[objection.quantity], objection.message, *objection.hints)


def _by_trial(table: Table) -> Mapping[str, list[Row]]:
    trials: dict[str, list[Row]] = {}
    for row in table.rows:
        if not row.text("trial"):
            raise row.error("trial", "is required, but empty")
        trials.setdefault(row.text("trial"), []).append(row)
    return trials


def _recording_from(label: str, rows: list[Row], prefix: str) -> Recording:
    """One trial's rows as arrays."""
    first = rows[0]
    time = np.array([row.value("time_s") for row in rows])
    for row, step in zip(rows[1:], np.diff(time), strict=True):
        if step <= 0.0:
            raise row.error("time_s", f"does not increase within trial {label}")
    if time[-1] - time[0] > _LONGEST:
        what = f"trial {label} lasts {time[-1] - time[0]:g} s"
        raise rows[-1].error("time_s", what, "is it in milliseconds? the column is in seconds")
    if len(rows) < LEAST_SAMPLES:
        what = f"trial {label} has {len(rows)} samples, expected {LEAST_SAMPLES} or more"
        raise first.error("trial", what)
    for row in rows[1:]:
        for column in ("moved", "repetition"):
            if row.text(column) != first.text(column):
                raise row.error(column, f"is not the same all through trial {label}")
    moved = first.text("moved").casefold()
    if moved not in ("slide", "topple") and (moved or not first.text("tilt_deg")):
        found = short_quote(first.text("moved"))
        raise first.error("moved", f"found {found}, expected slide or topple in a recording")
    repetition = first.number_or_none("repetition") or 0.0
    if repetition != int(repetition) or not 0 <= repetition < 1e6:
        raise first.error("repetition", f"found {repetition:g}, expected a whole number from 0 on")
    return Recording(
        time=time,
        force=np.array([row.vector(FORCE) for row in rows]),
        tip=np.array([row.vector(CONTACT) for row in rows]),
        yaw=_angle_column(rows, "yaw_deg", 180.0),
        tilt=_angle_column(rows, "tilt_deg", 90.0),
        moved=cast(Moved, moved) if moved else None,
        repetition=int(repetition),
        source=f"{prefix}trial {label}",
    )


def _angle_column(rows: list[Row], column: str, most: float) -> Array | None:
    """A column of angles, counted from the first; None if it is empty there [rad]."""
    if not rows[0].text(column):
        return None
    degrees = np.array([row.value(column) for row in rows])
    for row, value in zip(rows, degrees, strict=True):
        if abs(value) > most:
            raise row.error(column, f"found {value:g}, expected −{most:g} to {most:g} degrees")
    return np.asarray(np.unwrap(np.radians(degrees - degrees[0])))


def _push_direction(recording: Recording) -> Array:
    """Unit direction of the finger's travel, or of the mean force if it hardly travels."""
    way = recording.tip[-1] - recording.tip[0]
    if np.linalg.norm(way) < LEAST_TRAVEL:
        way = recording.force.mean(axis=0)
    length = float(np.linalg.norm(way))
    if length == 0.0:
        raise ModelError("bad_array", "there is neither force nor travel in it")
    return np.asarray(way / length)


def _samples_after_onset(travel: Array, begin: int) -> slice:
    """Samples from the onset on, over the way that is looked at."""
    beyond = np.flatnonzero(travel[begin:] > travel[begin] + _WAY)
    return slice(begin, max(begin + int(beyond[0]) if beyond.size else len(travel), begin + 3))


def _turn_rate(
    recording: Recording, travel: Array, way: slice
) -> tuple[float | None, float | None]:
    """Slope of the turn over the travel after the onset, and its standard deviation [rad/m]."""
    if recording.yaw is None:
        return None, None
    x, y = travel[way] - travel[way].mean(), recording.yaw[way] - recording.yaw[way].mean()
    size = float(x @ x)
    if size <= 0.0:
        return None, None
    rate = float(x @ y) / size
    rest = y - rate * x
    scatter = float(np.sqrt(rest @ rest / max(len(x) - 2, 1) / size))
    # A small share of the whole angle's own error: cameras drift.
    return rate, float(np.hypot(scatter, 0.2 * _ANGLE_SD / max(float(np.ptp(travel[way])), 1e-3)))


def _held_tilt(recording: Recording) -> bool:
    return recording.tilt is not None and float(recording.tilt[-1]) > LEAST_TILT


def _vector_tuple(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return (x, y, z)
