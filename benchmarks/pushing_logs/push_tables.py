"""Tracked pushes as data files of `nlcontrol fit`, in both of its forms."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from benchmarks.pushing_logs.triangle_logs import CONTACT_HEIGHT, TrackedPush

_APPROACH = 30  # samples before the touch


def write_touches(path: Path, pushes: Sequence[TrackedPush]) -> None:
    """Write a row for each push: its mean force, and the poses before and after."""
    header = ["moved", "x_m", "y_m", "z_m", "fx_n", "fy_n", "fz_n", "turn_deg", "dx_m", "dy_m"]
    _write_rows(path, header, map(_touch_row, pushes))


def write_recordings(path: Path, pushes: Sequence[TrackedPush]) -> None:
    """Write a row for each sample; the last one of a push tells the pose then."""
    header = [
        "trial", "time_s", "fx_n", "fy_n", "fz_n", "x_m", "y_m", "z_m", "moved",
        "dx_m", "dy_m", "yaw_deg",
    ]  # fmt: skip
    rows = (row for number, push in enumerate(pushes, 1) for row in _sample_rows(number, push))
    _write_rows(path, header, rows)


def _touch_row(push: TrackedPush) -> list[object]:
    (x, y), (f_x, f_y) = push.mean_push
    dx, dy, turn = push.pose.tolist()
    return ["slide", x, y, CONTACT_HEIGHT, f_x, f_y, 0.0, np.degrees(turn), dx, dy]


def _sample_rows(number: int, push: TrackedPush) -> Iterable[list[object]]:
    # The end of the approach shows where the force begins to rise.
    size = np.hypot(*push.force.T)
    first = max(int(np.argmax(size > 0.1 * size.max())) - _APPROACH, 0)
    dx, dy, turn = push.pose.tolist()
    for k in range(first, len(size)):
        (f_x, f_y), (x, y) = push.force[k], push.tip[k]
        end = [dx, dy, np.degrees(turn)] if k == len(size) - 1 else ["", "", ""]
        yield [number, push.time[k], f_x, f_y, 0.0, x, y, CONTACT_HEIGHT, "slide", *end]


def _write_rows(path: Path, header: list[str], rows: Iterable[list[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in rows:
            writer.writerow([f"{v:.6f}" if isinstance(v, float) else v for v in row])
