"""Models beside public logs, in a copy of the repository that holds them, robinzhoucmu/Pushing.

python -m benchmarks.pushing_logs triangles FOLDER [--write OUT]
python -m benchmarks.pushing_logs plates FOLDER
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.commands import run_command
from benchmarks.pushing_logs.logs import (
    LOGS,
    TrackedPush,
    angle_errors,
    finger_friction,
    held_motions,
    pose_errors,
    read_log,
    triangle_model,
    write_recordings,
    write_touches,
)
from nlcontrol.learning.log_fitting import fit_files
from objectmodels import ObjectModel
from objectmodels.registry.model_registry import save_model

_PLATES = Path("differential_flat", "exp_data", "robot_exp_logs")
_WRITERS = {"touches": write_touches, "recordings": write_recordings}


def triangles(folder: Path, write: Path | None = None) -> None:
    """The models beside the ten public logs of zhou-2016.

    Of each log even pushes train and odd ones test. Columns: mean angle [°] of the untrained model
    on its known support, and of the fit that knows neither support nor friction, in both forms of
    data; mean error of the pose at the end [mm] on the known support (of the patch: the fitted one)
    with the finger's friction of the training half, by the loaded points and by the ellipsoid.
    `--write OUT` keeps the data files and models.
    """
    rows: dict[str, dict[str, float]] = {}
    with TemporaryDirectory() as scratch:
        out = write or Path(scratch)
        out.mkdir(parents=True, exist_ok=True)
        for log in LOGS:
            pushes = read_log(folder, log)
            rows[log] = _judged(log, pushes, out)
            _print_row(log, [rows[log]])
    _print_row("three feet", [row for log, row in rows.items() if "3pts" in log])
    _print_row("all", list(rows.values()))


def _judged(log: str, pushes: Sequence[TrackedPush], out: Path) -> dict[str, float]:
    """Mean errors on one log [°], [mm]."""
    train, test = pushes[::2], pushes[1::2]
    known = triangle_model(log)
    fits = {}
    for form, write in _WRITERS.items():
        path = out / f"{log.replace(' ', '_')}_{form}.csv"
        write(path, train)
        blank = triangle_model(log, "uniform")  # which knows shape and mass alone
        fits[form], _ = fit_files(blank, [path], ("friction", "friction_radius"))
        save_model(fits[form], path.with_suffix(".yaml"))
    moved: ObjectModel = fits["touches"] if log.endswith("patch") else known
    mu = finger_friction(moved, train)
    moved = moved.model_copy(update={"finger_friction": mu})
    return {
        "untrained": float(angle_errors(known, pushes).mean()),
        "touches": float(angle_errors(fits["touches"], test).mean()),
        "recordings": float(angle_errors(fits["recordings"], test).mean()),
        "finger": mu,
        "pose": 1e3 * float(pose_errors(moved, pushes).mean()),
        "pose, test": 1e3 * float(pose_errors(moved, test).mean()),
        "ellipsoid": 1e3 * float(pose_errors(moved, pushes, exact=False).mean()),
    }


def _print_row(name: str, rows: Sequence[dict[str, float]]) -> None:
    """Print the mean figures of some logs."""
    means = (f"{label} {np.mean([row[label] for row in rows]):.2f}" for label in rows[0])
    print(f"{name:16}", *means, sep="  ", flush=True)


def plates(folder: Path) -> None:
    """How far plates moved in the frame of the hand whose two fingertips pushed them."""
    for plate in sorted(path for path in (folder / _PLATES).iterdir() if path.is_dir()):
        files = sorted(plate.rglob("log*.txt"))
        found = np.array([motion for file in files for motion in held_motions(file)])
        way, slip, turn = np.median(found, axis=0) * [1e3, 1e3, np.degrees(1.0)]
        print(
            f"{plate.name}: {len(files)} logs, {len(found)} pushes; medians: way {way:.0f} mm, "
            f"slip {slip:.1f} mm, turn {turn:.1f}°"
        )


if __name__ == "__main__":
    sys.exit(run_command(triangles, plates))
