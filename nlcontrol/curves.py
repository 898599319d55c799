"""Force curves of an exploration: one panel for each kind of experiment, the onsets marked."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.reduction import Curve, curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sim.exploration import Touched

_COLOURS = {"front": "#2a6f97", "back": "#e07a5f", "left": "#6a994e", "right": "#8e6c8a"}
_PALE = 0.75


def save_curves(touches: Sequence[Touched], name: str, path: Path) -> None:
    """Draws the force over the time since the touch: PNG, SVG or PDF by the name's ending.

    Args:
        touches: what was tried.
        name: of the object.
        path: where to.
    """
    from matplotlib.figure import Figure

    drawn = [touched for touched in touches if len(touched.recording.time)]
    kinds = list(dict.fromkeys(touched.experiment.kind for touched in drawn))
    rows = (len(kinds) + 1) // 2
    figure = Figure(figsize=(8.4, 0.8 + 2.7 * max(rows, 1)), dpi=160, layout="constrained")
    for place, kind in enumerate(kinds, start=1):
        axes = figure.add_subplot(rows, 2 if len(kinds) > 1 else 1, place)
        _draw(axes, [t for t in drawn if t.experiment.kind == kind])
        axes.set_title(f"{kind} ({sum(t.experiment.kind == kind for t in drawn)})", fontsize=10)
    sides = dict.fromkeys(touched.experiment.push.face for touched in drawn)
    handles = [axes.plot([], [], color=_COLOURS[side], label=f"at the {side}")[0] for side in sides]
    handles.append(axes.plot([], [], "o", color="black", markersize=4, label="onset of motion")[0])
    figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=8, frameon=False)
    figure.suptitle(f"{name}: force felt along each push", fontsize=12, fontweight="bold")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _draw(axes: Axes, touches: Sequence[Touched]) -> None:
    for touched in touches:
        found: Curve = curve(touched.recording)
        colour = _COLOURS[touched.experiment.push.face]
        axes.plot(found.time, found.force, color=colour, alpha=_PALE, linewidth=0.8)
        if found.onset is not None and found.onset.moved:
            axes.plot(found.onset.time, found.onset.force, "o", color="black", markersize=3.5)
    axes.set_xlabel("time since the touch [s]", fontsize=8)
    axes.set_ylabel("force [N]", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.set_ylim(0.0, None)
    axes.grid(visible=True, linewidth=0.3, alpha=0.5)
