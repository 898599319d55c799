"""`python -m benchmarks.pushing_logs FOLDER`: the models beside the ten public logs of zhou-2016.

FOLDER is a copy of the repository that holds them, robinzhoucmu/Pushing. Of each log even pushes
train and odd ones test. Columns: mean angle [°] of the untrained model on its known support, and of
the fit that knows neither support nor friction, in both forms of data; mean error of the pose at
the end [mm] on the known support (of the patch: the fitted one) with the finger's friction of the
training half, by the loaded points and by the ellipsoid. `--write OUT` keeps the data files and
models, `--training` judges by training halves alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.pushing_logs.log_errors import angle_errors, finger_friction, pose_errors
from benchmarks.pushing_logs.push_tables import write_recordings, write_touches
from benchmarks.pushing_logs.triangle_logs import LOGS, TrackedPush, read_log, triangle_model
from nlcontrol.learning.log_fitting import fit_files
from objectmodels import ObjectModel
from objectmodels.registry.model_registry import save_model

SOUGHT = ("friction", "friction_radius")


def judge_log(log: str, pushes: Sequence[TrackedPush], out: Path) -> dict[str, float]:
    """Mean errors on one log [°, m]."""
    train, test = pushes[::2], pushes[1::2]
    known = triangle_model(log)
    fits = {
        form: fitted_model(log, train, out / f"{log.replace(' ', '_')}_{form}.csv")
        for form in ("touches", "recordings")
    }
    moved: ObjectModel = fits["touches"] if log.endswith("patch") else known
    mu = finger_friction(moved, train)
    moved = moved.model_copy(update={"finger_friction": mu})
    return {
        "untrained": float(angle_errors(known, pushes).mean()),
        "touches": float(angle_errors(fits["touches"], test).mean()),
        "recordings": float(angle_errors(fits["recordings"], test).mean()),
        "finger": mu,
        "pose": float(pose_errors(moved, pushes).mean()),
        "pose, test": float(pose_errors(moved, test).mean()),
        "ellipsoid": float(pose_errors(moved, pushes, exact=False).mean()),
    }


def fitted_model(log: str, pushes: Sequence[TrackedPush], path: Path) -> ObjectModel:
    """Model that knows shape and mass alone, fitted to a data file that is written for it."""
    (write_touches if "touches" in path.name else write_recordings)(path, pushes)
    model, _ = fit_files(triangle_model(log, "uniform"), [path], SOUGHT)
    save_model(model, path.with_suffix(".yaml"))
    return model


def main() -> None:
    """Print a table of all logs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--training", action="store_true")
    given = parser.parse_args()
    rows: dict[str, dict[str, float]] = {}
    with TemporaryDirectory() as scratch:
        out = given.write or Path(scratch)
        out.mkdir(parents=True, exist_ok=True)
        for log in LOGS:
            pushes = read_log(given.folder, log)[:: 2 if given.training else 1]
            rows[log] = judge_log(log, pushes, out)
            print_row(log, rows[log])
    feet = [row for log, row in rows.items() if "3pts" in log]
    print_row("three feet", {name: float(np.mean([row[name] for row in feet])) for name in feet[0]})
    both = list(rows.values())
    print_row("all", {name: float(np.mean([row[name] for row in both])) for name in both[0]})


def print_row(name: str, row: dict[str, float]) -> None:
    """Print the figures of a log, poses in millimetres."""
    shown = (
        f"{label} {1e3 * value if 'pose' in label or label == 'ellipsoid' else value:.2f}"
        for label, value in row.items()
    )
    print(f"{name:16}", *shown, sep="  ", flush=True)


if __name__ == "__main__":
    main()
