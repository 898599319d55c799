"""Force curves of an exploration: one panel for each kind of experiment, the onsets marked.

Thin and pale stand the samples, drawn through them their running mean. What a panel tells stands
above it. A rub has a second curve: the force with which the fingertip drags along the face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from planner.touch_experiments import Kind
from sim.exploration.trial_extraction import force_curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sim.exploration.exploration_run import Touched

TELLS: Mapping[Kind, str] = {
    "tilt": "the onset tells weight × lever, the fall the height of the mass",
    "slide": "the level tells friction × weight",
    "off-centre slide": "with the turn, the level tells the friction radius",
    "rub": "dashed over solid, once even, is the friction at the finger",
}
"""What the curves of each experiment say about the object."""

MEAN_OVER = 0.1
"""Time over which the running mean is taken [s]."""

_COLOURS = {"front": "#0072b2", "back": "#d55e00", "left": "#009e73", "right": "#cc79a7"}
_SAMPLES, _MEAN = 0.12, 0.9  # opacity


def save_curves(touches: Sequence[Touched], name: str, path: Path) -> None:
    """Draws the force over the time since the touch: PNG, SVG or PDF by the path's ending."""
    from matplotlib.figure import Figure

    drawn = [touched for touched in touches if len(touched.recording.time)]
    kinds = list(dict.fromkeys(touched.experiment.kind for touched in drawn))
    rows = (len(kinds) + 1) // 2
    figure = Figure(figsize=(8.4, 1.0 + 3.0 * max(rows, 1)), dpi=160, layout="constrained")
    for place, kind in enumerate(kinds, start=1):
        axes = figure.add_subplot(rows, 2 if len(kinds) > 1 else 1, place)
        here = [touched for touched in drawn if touched.experiment.kind == kind]
        _draw(axes, here)
        times = f"{len(here)} touches" if len(here) > 1 else "1 touch"
        axes.set_title(f"{kind}, {times}", fontsize=10, fontweight="bold", loc="left", pad=18)
        axes.annotate(
            TELLS[kind], (0.0, 1.0), (0.0, 4.0), xycoords="axes fraction", fontsize=8,
            textcoords="offset points", va="bottom", color="#444444",
        )  # fmt: skip
    sides = dict.fromkeys(touched.experiment.push.face for touched in drawn)
    handles = [axes.plot([], [], color=_COLOURS[side], label=f"at the {side}")[0] for side in sides]
    if "rub" in kinds:
        handles.append(axes.plot([], [], "--", color="#444444", label="along the face")[0])
    if set(kinds) - {"rub"}:
        handles.append(axes.plot([], [], "o", color="black", label="onset of motion", ms=4)[0])
    figure.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=8, frameon=False)
    figure.suptitle(f"{name}: force felt along each push", fontsize=12, fontweight="bold")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _draw(axes: Axes, touches: Sequence[Touched]) -> None:
    for touched in touches:
        recording, found = touched.recording, force_curve(touched.recording)
        colour = _COLOURS[touched.experiment.push.face]
        rubs = touched.experiment.kind == "rub"
        forces = {"-": found.force} | ({"--": -recording.forces[:, 2]} if rubs else {})
        for style, force in forces.items():
            axes.plot(found.time, force, style, color=colour, alpha=_SAMPLES, linewidth=0.6)
            axes.plot(*_running(found.time, force), style, color=colour, alpha=_MEAN, linewidth=1.0)
        if found.onset is not None and found.onset.moved and not rubs:
            axes.plot(
                found.onset.time, found.onset.force, "o", color="black", ms=4.5, mec="white",
                mew=0.6, zorder=3,
            )  # fmt: skip
    axes.set_xlabel("time since the touch [s]", fontsize=8)
    axes.set_ylabel("force [N]", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.set_xlim(0.0, None)
    axes.set_ylim(0.0, None)
    axes.grid(visible=True, linewidth=0.3, alpha=0.5)


def _running(time: Array, force: Array) -> tuple[Array, Array]:
    """Means over `MEAN_OVER`; all samples if there are too few."""
    if len(time) < 2:
        return time, force
    width = max(1, min(len(time), round(MEAN_OVER / float(np.median(np.diff(time))))))
    window = np.full(width, 1.0 / width)
    return np.convolve(time, window, "valid"), np.convolve(force, window, "valid")
