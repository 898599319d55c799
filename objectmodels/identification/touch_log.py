"""Logs of a real robot's touches, read into trials: a row for each touch, or recordings over time.

Columns carry their units; docs/fitting.md explains them. All of a file is read or nothing, and what
is wrong is named with its row and column. What a file leaves open takes a stated default: the
noise of forces and angles, which the fit enlarges if its residuals are larger.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot, radians
from pathlib import Path
from typing import cast

import numpy as np

from objectmodels.errors import ModelError, suggest
from objectmodels.files.yaml_documents import LIMITS, read_text
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import vector_tuple
from objectmodels.identification.onset_detection import (
    LEAST_SAMPLES,
    LEAST_TRAVEL,
    Onset,
    Recording,
    tilted_trial,
    trial_from_series,
)
from objectmodels.identification.trial import (
    ContactPath,
    Moved,
    Objection,
    Trial,
    Vector,
    contact_objection,
    force_objection,
)
from objectmodels.models.object_model import ObjectModel

# Tables of measurements in CSV files, read so that every mistake names its row and column.
#
# Separated by commas, or by semicolons (a decimal comma is then a decimal point), in UTF-8. The
# first line that is neither blank nor a comment (#) names the columns. Rows are counted as an
# editor counts lines.

LARGEST = 1e9
"""Larger numbers are not measurements; formulae would overflow with some."""

_GUIDE = "docs/fitting.md explains the columns"

_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        file: the file's name.
        number: line of the file, from 1 on.
        cells: by column, without white space around them.
        decimal_comma: whether a comma in a number is a decimal point.
    """

    file: str
    number: int
    cells: Mapping[str, str]
    decimal_comma: bool = False

    def error(self, column: str, message: str, *suggestions: str) -> ModelError:
        """An error about one of its cells."""
        where = f"{self.file}: row {self.number}: {column}"
        return ModelError("bad_data", message, path=where, suggestions=suggestions or (_GUIDE,))

    def text(self, column: str) -> str:
        """Text in a column; empty if the table has no such column."""
        return self.cells.get(column, "")

    def number_or_none(self, column: str) -> float | None:
        """The number in a column, None if there is none.

        Raises:
            ModelError: `bad_data` if it is not a finite number.
        """
        text = self.text(column)
        if not text:
            return None
        plain = text.replace(",", ".") if self.decimal_comma else text
        value = float(plain) if _NUMBER.fullmatch(plain) else math.nan
        if not abs(value) <= LARGEST:
            expected = f"expected a finite number, at most {LARGEST:g} in size"
            raise self.error(column, f"found {short_quote(text)}, {expected}")
        return value

    def value(self, column: str) -> float:
        """The number that must stand in a column.

        Raises:
            ModelError: `bad_data` if there is none, or it is not a finite number.
        """
        value = self.number_or_none(column)
        if value is None:
            raise self.error(column, "is required here, but empty")
        return value

    def vector(self, columns: tuple[str, str, str]) -> tuple[float, float, float]:
        """The numbers that must stand in three columns; raises as `value` does."""
        x, y, z = map(self.value, columns)
        return (x, y, z)


@dataclass(frozen=True)
class Table:
    """A table of at least one row.

    Attributes:
        file: the file's name.
        columns: their names.
        rows: in the order of the file.
    """

    file: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]

    def error(self, message: str, *suggestions: str) -> ModelError:
        """An error about the table as a whole."""
        return ModelError("bad_data", message, path=self.file, suggestions=suggestions or (_GUIDE,))

    def require_columns(self, columns: tuple[str, ...], known: tuple[str, ...]) -> None:
        """Checks that it has the columns it must have, and no unknown ones.

        Raises:
            ModelError: `bad_data`; what is missing is often there, misspelt.
        """
        for column in self.columns:
            if column not in known:
                near = suggest(column, known)
                hints = tuple(f"did you mean '{name}'?" for name in near[:1])
                raise self.error(
                    f"{short_quote(column)} is not a column of such a file",
                    *(hints or (f"known: {', '.join(known)}",)),
                )
        missing = [column for column in columns if column not in self.columns]
        if missing:
            raise self.error(
                f"lacks the column{'s' * (len(missing) > 1)} {', '.join(missing)}",
                f"it has: {', '.join(self.columns)}",
            )


def read_table(path: Path) -> Table:
    """Reads a CSV file.

    Raises:
        ModelError: `unreadable_file`; `bad_data` if it is no table, or has no rows.
    """
    lines = _numbered_lines(path)
    if not lines:
        raise ModelError("bad_data", "holds no table", path=str(path), suggestions=(_GUIDE,))
    separator = ";" if ";" in lines[0][1] else ","
    (first, header), *rest = ((n, _line_cells(path, n, line, separator)) for n, line in lines)
    most = int(LIMITS["data_columns"].most)
    if len(header) > most:
        raise _too_large(f"{path}: row {first}", f"{len(header)} columns, at most {most}", _GUIDE)
    columns = tuple(" ".join(name.casefold().split()) for name in header)
    odd = next((name for name in columns if not name or columns.count(name) > 1), None)
    if odd is not None:
        what = f"the column {short_quote(odd)} is given twice" if odd else "a column has no name"
        hint = "give each column a name of its own"
        raise ModelError("bad_data", what, path=f"{path}: row {first}", suggestions=(hint,))
    rows = []
    for number, cells in rest:
        if not any(cells):
            continue  # spreadsheets write blank rows so
        if len(cells) != len(columns):
            raise ModelError(
                "bad_data",
                f"has {len(cells)} cells, the header {len(columns)}",
                path=f"{path}: row {number}",
                suggestions=("separate them by commas, or all by semicolons",),
            )
        rows.append(
            Row(str(path), number, dict(zip(columns, cells, strict=True)), separator == ";")
        )
    table = Table(str(path), columns, tuple(rows))
    if not rows:
        raise table.error("has no rows below its header", _GUIDE)
    return table


def short_quote(text: str) -> str:
    """A text in quotes, cut if it is long."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _numbered_lines(path: Path) -> list[tuple[int, str]]:
    """The lines with something in them, and their numbers."""
    text, most = read_text(path, "data_file"), int(LIMITS["data_rows"].most)
    if text.count("\n") + text.count("\r") > 2 * most:  # before they are cut apart
        raise _too_large(path, f"more than {most} lines", "cut it into several files")
    lines = [
        (number, line)
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) > most:
        raise _too_large(path, f"{len(lines)} rows, at most {most}", "cut it into several files")
    return lines


def _too_large(path: Path | str, what: str, hint: str) -> ModelError:
    return ModelError("bad_data", f"has {what}", path=str(path), suggestions=(hint,))


def _line_cells(path: Path, number: int, line: str, separator: str) -> list[str]:
    try:
        (cells,) = csv.reader([line], delimiter=separator, strict=True)
    except csv.Error as error:
        raise ModelError(
            "bad_data",
            f"is not CSV: {error}",
            path=f"{path}: row {number}",
            suggestions=("text with a comma in it stands in quotes, closed in the same line",),
        ) from error
    return [cell.strip() for cell in cells]


FORCE_SHARE = 0.02
"""Standard deviation of a force as a share of it, if none is stated; residuals may enlarge it."""

ANGLE_SD = radians(0.5)
"""Standard deviation of a tilt or a turn, if none is stated [rad]."""

CONTACT = ("x_m", "y_m", "z_m")
FORCE = ("fx_n", "fy_n", "fz_n")
DIRECTION = ("ux", "uy", "uz")
NORMAL = ("nx", "ny", "nz")
SHIFT = ("dx_m", "dy_m")

COLUMNS = (
    "moved",
    *CONTACT,
    *FORCE,
    "force_n",
    *DIRECTION,
    "force_sd_n",
    "tilt_deg",
    "tilt_sd_deg",
    "turn_deg",
    "turn_sd_deg",
    "travel_m",
    *SHIFT,
    *NORMAL,
    "repetition",
    "note",
)
"""Columns that a table of touches may have."""

_MOVED: tuple[Moved, ...] = ("slide", "topple", "slip")
_SHORTEST, _LONGEST = 0.001, 1.0  # travel over which a turn is measured [m]
_STRAIGHT = 0.01  # friction below which nothing is
_FINEST_ANGLE = 0.001  # and none of angles than this [°]

RECORDING_COLUMNS = (
    "trial",
    "time_s",
    *FORCE,
    *CONTACT,
    "moved",
    "yaw_deg",
    "tilt_deg",
    *SHIFT,
    "repetition",
    "note",
)
"""Columns that a table of recordings may have."""


@dataclass(frozen=True)
class Reading:
    """Contents of data files.

    Attributes:
        trials: the touches.
        assumed: for each of them whether the deviation of its force was assumed.
        unused: what was left out, and why.
    """

    trials: tuple[Trial, ...]
    assumed: tuple[bool, ...]
    unused: tuple[str, ...] = ()


def read_data(paths: Sequence[Path], model: ObjectModel) -> Reading:
    """Reads data files of either form.

    The model of the object that was touched gives its shape, and how large forces may be.

    Raises:
        ModelError: `unreadable_file`, `bad_data`.
    """
    trials: list[Trial] = []
    assumed: list[bool] = []
    unused: list[str] = []
    for path in paths:
        prefix = f"{path.name}: " if len(paths) > 1 else ""
        table = read_table(path)
        if "time_s" in table.columns:
            found, left = read_recordings(table, model, prefix)
            unused += left
            assumed += [False] * len(found)  # theirs is the scatter of their samples
        else:
            by_size = any(column in table.columns for column in ("force_n", *DIRECTION))
            if by_size and any(column in table.columns for column in FORCE):
                raise table.error(
                    f"has both {', '.join(FORCE)} and force_n with {', '.join(DIRECTION)}",
                    "leave one of the two out",
                )
            force = ("force_n", *DIRECTION) if by_size else FORCE
            table.require_columns(("moved", *CONTACT, *force), COLUMNS)
            found = [_touch_trial(row, model, prefix, by_size) for row in table.rows]
            assumed += [not row.text("force_sd_n") for row in table.rows]
        trials += found
    return Reading(tuple(trials), tuple(assumed), tuple(unused))


def _touch_trial(row: Row, model: ObjectModel, prefix: str, by_size: bool) -> Trial:
    moved = _motion_kind(row)
    point = row.vector(CONTACT)
    require_none(row, contact_objection(model, point))
    force = _sized_force(row) if by_size else row.vector(FORCE)
    size = hypot(*force)
    tilt, tilt_sd = _tilt_angle(row, moved)
    turn_rate, turn_rate_sd, drift = _slide_motion(row, moved, point, force)
    # No sensor of forces is better than this share.
    trial = Trial(
        moved=moved,
        point=point,
        force=force,
        # No sensor of forces is better than a ten-thousandth of what it reads.
        force_sd=_deviation_or_default(row, "force_sd_n", FORCE_SHARE * size, 1e-4 * size),
        tilt=tilt,
        tilt_sd=tilt_sd,
        turn_rate=turn_rate,
        turn_rate_sd=turn_rate_sd,
        drift=drift,
        normal=_face_normal(row, force) if moved == "slip" else None,
        repetition=_repetition_number(row),
        source=f"{prefix}row {row.number}",
    )
    largest = FORCE[int(np.argmax(np.abs(force)))]
    require_none(row, force_objection(model, trial), "force_n" if by_size else largest)
    return trial


def _motion_kind(row: Row) -> Moved:
    text = row.text("moved").casefold()
    for moved in _MOVED:
        if text == moved:
            return moved
    hints = tuple(f"did you mean '{name}'?" for name in suggest(text, _MOVED)[:1])
    expected = "expected slide, topple or slip"
    raise row.error("moved", f"found {short_quote(row.text('moved'))}, {expected}", *hints)


def _sized_force(row: Row) -> Vector:
    """A force given by its size and direction [N]."""
    size = row.value("force_n")
    if size <= 0.0:
        raise row.error("force_n", f"found {size:g}, expected a size above 0", "turn its direction")
    x, y, z = _unit_vector(row, DIRECTION)
    return (size * x, size * y, size * z)


def _unit_vector(row: Row, columns: tuple[str, str, str]) -> Vector:
    x, y, z = row.vector(columns)
    length = hypot(x, y, z)
    # A direction's length may be off by so much, then it is made one.
    if not abs(length - 1.0) <= 0.02:
        raise row.error(columns[0], f"the direction has length {length:.3g}, expected 1")
    return (x / length, y / length, z / length)


def _deviation_or_default(row: Row, column: str, default: float, least: float) -> float:
    """A standard deviation, or its default."""
    value = row.number_or_none(column)
    if value is not None and value < least:
        raise row.error(column, f"found {value:g}, expected at least {least:.3g}")
    return default if value is None else value


def _tilt_angle(row: Row, moved: Moved) -> tuple[float, float]:
    """Tilt and its standard deviation [rad]."""
    tilt = row.number_or_none("tilt_deg") or 0.0
    sd = _deviation_or_default(row, "tilt_sd_deg", 0.0, _FINEST_ANGLE)
    if tilt and moved != "topple":
        raise row.error("tilt_deg", f"what did {moved} has no tilt", "leave the cell empty")
    if not 0.0 <= tilt < 90.0:
        raise row.error("tilt_deg", f"found {tilt:g}, expected 0 to 90 degrees")
    if not tilt:
        return 0.0, 0.0  # at the onset it stands
    return radians(tilt), radians(sd) or ANGLE_SD


def _slide_motion(
    row: Row, moved: Moved, point: Vector, force: Vector
) -> tuple[float | None, float | None, float | None]:
    """Turn for each metre of the contact's travel, its deviation [rad/m], and the drift."""
    turn = row.number_or_none("turn_deg")
    if turn is None:
        return None, None, None
    if moved != "slide":
        raise row.error("turn_deg", f"only a slide turns, not a {moved}", "leave the cell empty")
    if abs(turn) > 180.0:
        raise row.error("turn_deg", f"found {turn:g}, expected −180 to 180 degrees")
    sd = radians(_deviation_or_default(row, "turn_sd_deg", 0.0, _FINEST_ANGLE)) or ANGLE_SD
    if row.text(SHIFT[0]):
        shift = row.value(SHIFT[0]), row.value(SHIFT[1])
        path = ContactPath.between_poses(point, force, (*shift, radians(turn)))
        require_way(row, SHIFT[0], path.travel, "the force and the poses do not fit together")
        return path.turn / path.travel, sd / path.travel, path.drift
    travel = row.number_or_none("travel_m")
    if travel is None:
        raise row.error("travel_m", "is required beside turn_deg, but empty")
    require_way(row, "travel_m", travel)
    return radians(turn) / travel, sd / travel, None


def require_way(
    row: Row, column: str, travel: float, hint: str = "the column is in metres"
) -> None:
    """Raise an error if a contact went against the force, or hardly or impossibly far along it.

    Raises:
        ModelError: `bad_data`.
    """
    if not _SHORTEST <= travel <= _LONGEST:
        hints = ("is it in millimetres? the column is in metres",) if travel > _LONGEST else (hint,)
        expected = f"expected {_SHORTEST:g} to {_LONGEST:g} m"
        raise row.error(
            column, f"the contact went {travel:g} m along the force, {expected}", *hints
        )


def _face_normal(row: Row, force: Vector) -> Vector:
    """Outward normal of the face on which the finger slipped."""
    normal = _unit_vector(row, NORMAL)
    pressing = -float(np.dot(normal, force))
    if pressing <= 0.0:
        what = "the force does not press on the face of this normal"
        raise row.error(NORMAL[0], what, "the normal points out of the object")
    if not np.linalg.norm(np.cross(normal, force)) > _STRAIGHT * pressing:
        raise row.error(NORMAL[0], "the force goes straight into the face: so no finger slips")
    return normal


def _repetition_number(row: Row) -> int:
    value = row.number_or_none("repetition") or 0.0
    if value != int(value) or not 0 <= value < 1e6:
        raise row.error("repetition", f"found {value:g}, expected a whole number from 0 on")
    return int(value)


def read_recordings(table: Table, model: ObjectModel, prefix: str) -> tuple[list[Trial], list[str]]:
    """The trials of a table with a row for each sample, and what was left out of it and why.

    The samples of a trial stand in their order; names of trials begin with the prefix in messages.

    Raises:
        ModelError: `bad_data`.
    """
    table.require_columns(("trial", "time_s", *FORCE, *CONTACT), RECORDING_COLUMNS)
    if "moved" not in table.columns and "tilt_deg" not in table.columns:
        raise table.error(
            "lacks the column moved: force and place of the finger do not tell what moved",
            "add `moved` (slide or topple), or the object's tilt_deg over time",
        )
    trials: list[Trial] = []
    unused: list[str] = []
    for label, rows in _by_trial(table).items():
        recording = _recording_from(label, rows, prefix)
        require_none(rows[0], contact_objection(model, vector_tuple(recording.tip[0])))
        try:
            trial, onset = trial_from_series(recording)
        except ModelError as error:
            raise rows[0].error("trial", f"trial {label}: {error.message}") from error
        if trial is None:
            unused.append(f"{recording.source}: {_missing_onset(onset)}")
            continue
        largest = FORCE[int(np.argmax(np.abs(trial.force)))]
        require_none(rows[onset.index], force_objection(model, trial), largest)
        held = tilted_trial(recording, trial, model)
        trials += [trial] if held is None else [trial, held]
    return trials, unused


def _missing_onset(onset: Onset) -> str:
    """Why a recording shows no onset of motion, with figures."""
    way, least = (f"{1e3 * length:.1f} mm" for length in (onset.travel, LEAST_TRAVEL))
    if onset.travel <= LEAST_TRAVEL:
        return (
            f"nothing moved in it: from its touch on the finger travels {way}, with up to "
            f"{onset.force:.2f} N; a motion shows from {least} on"
        )
    return (
        f"no onset is seen in it: from its touch on the finger travels {way} without going faster, "
        f"and the force, {onset.force:.2f} N at most, does not rise once to about that and stay"
    )


def require_none(row: Row, objection: Objection | None, force: str = FORCE[0]) -> None:
    """Raise an objection, if there is one, as an error of the row that it concerns.

    `force` is the column of the force, or of its largest component.

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
    if time[-1] - time[0] > 1000.0:  # a recording that is longer has its times in milliseconds [s]
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
    repetition = _repetition_number(first)
    return Recording(
        time=time,
        force=np.array([row.vector(FORCE) for row in rows]),
        tip=np.array([row.vector(CONTACT) for row in rows]),
        yaw=_angle_column(rows, "yaw_deg", 180.0),
        tilt=_angle_column(rows, "tilt_deg", 90.0),
        end=_end_pose(rows[-1]),
        moved=cast(Moved, moved) if moved else None,
        repetition=repetition,
        source=f"{prefix}trial {label}",
    )


def _end_pose(row: Row) -> Vector | None:
    """Pose of B after a trial, in B at its start [m, rad]; None if the last row does not tell."""
    if not row.text(SHIFT[0]):
        return None
    return (row.value(SHIFT[0]), row.value(SHIFT[1]), radians(row.value("yaw_deg")))


def _angle_column(rows: list[Row], column: str, most: float) -> Array | None:
    """A column of angles, counted from the first; None if it is empty there [rad]."""
    if not rows[0].text(column):
        return None
    degrees = np.array([row.value(column) for row in rows])
    for row, value in zip(rows, degrees, strict=True):
        if abs(value) > most:
            raise row.error(column, f"found {value:g}, expected −{most:g} to {most:g} degrees")
    return np.asarray(np.unwrap(np.radians(degrees - degrees[0])))
