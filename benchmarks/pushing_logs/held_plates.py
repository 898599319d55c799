"""`python -m benchmarks.pushing_logs.held_plates FOLDER`: plates that two fingertips pushed.

Logs of closed-loop pushes along curves. A row is time [s], x, y [mm], heading [rad] of the plate,
the same of the hand, and the number of the action. FOLDER is a copy of robinzhoucmu/Pushing. What
two fingers hold stays where it is in the hand's frame: told is how far it moved there, from when it
has come a centimetre to the end of each action.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.rotations import rotate

_FOLDER = Path("differential_flat", "exp_data", "robot_exp_logs")
_SETTLED = 0.010  # way of the plate after which the fingers surely touch [m]


def held_motions(file: Path) -> Iterator[tuple[float, float, float]]:
    """Way of the plate [m], its slip [m] and its turn [rad] in the hand's frame, by action."""
    rows = np.loadtxt(file, delimiter=",", ndmin=2)
    for action in np.unique(rows[:, 7]):
        plate, hand = (poses_of(rows[rows[:, 7] == action, k : k + 3]) for k in (1, 4))
        gone = np.hypot(*(plate - plate[0])[:, :2].T)
        start = int(np.argmax(gone > _SETTLED))
        if gone[start] <= _SETTLED:
            continue
        seen = rotate(plate[:, :2] - hand[:, :2], -hand[:, 2])
        turn = np.unwrap(plate[:, 2] - hand[:, 2])
        slip = np.hypot(*(seen[-1] - seen[start]))
        yield float(gone[-1] - gone[start]), float(slip), float(abs(turn[-1] - turn[start]))


def poses_of(columns: Array) -> Array:
    """x, y [m], heading [rad] of rows in millimetres, shape (n, 3)."""
    return np.column_stack((columns[:, :2] / 1e3, columns[:, 2]))


def main() -> None:
    """Print a line for each plate."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    root = parser.parse_args().folder / _FOLDER
    for plate in sorted(path for path in root.iterdir() if path.is_dir()):
        files = sorted(plate.rglob("log*.txt"))
        found = np.array([motion for file in files for motion in held_motions(file)])
        way, slip, turn = np.median(found, axis=0) * [1e3, 1e3, np.degrees(1.0)]
        print(f"{plate.name}: {len(files)} logs, {len(found)} pushes; medians: way {way:.0f} mm, "
              f"slip {slip:.1f} mm, turn {turn:.1f}°")  # fmt: skip


if __name__ == "__main__":
    main()
