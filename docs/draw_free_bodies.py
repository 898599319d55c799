"""Draws all forces on a box that is pushed: as it begins to slide, and as it begins to topple.

    python -m docs.draw_free_bodies   # writes docs/images/free_bodies.png

Its numbers are those of the model of the ice tea box, as `nlcontrol predict` has them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

from nlcontrol import BoxModel, Registry

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PICTURE = Path(__file__).parent / "images" / "free_bodies.png"
LOW, HIGH = 0.06, 0.18
"""Heights of the two pushes [m]: below and above where the ice tea box topples instead."""

PUSH, WEIGHT, TABLE = "#0072b2", "#555555", "#d55e00"
NEWTON = 0.009
"""Length of an arrow for each newton [m]."""


def draw(path: Path = PICTURE) -> None:
    """Draw both into a file."""
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    model = Registry.built_in().get("ice tea box")
    assert isinstance(model, BoxModel)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 4.4), sharey=True)
    _draw_push(left, model, LOW, "Pushed low, it slides")
    _draw_push(right, model, HIGH, "Pushed high, it topples")
    figure.tight_layout()
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _draw_push(axes: Axes, model: BoxModel, height: float, title: str) -> None:
    """The forces on the box as a push at a height [m] begins to move it, seen from its side."""
    depth, _, top = model.size
    half, centre = depth / 2, model.com[2]
    onset = model.thresholds([[-half, 0.0, height]], [[1.0, 0.0, 0.0]], exact=True)
    force, weight = float(onset.onset[0]), 9.81 * model.mass
    bears = force * height / weight  # where the table's force acts, so that no torque is left
    friction = model.friction * weight
    axes.add_patch(matplotlib.patches.Rectangle((-half, 0.0), depth, top, fc="#f3efe6", ec="black"))
    axes.axhline(0.0, color="black", lw=1.2)
    axes.plot([0.0], [centre], "o", color=WEIGHT)
    _arrow(axes, (-half - NEWTON * force, height), (NEWTON * force, 0.0), PUSH)
    _arrow(axes, (0.0, centre), (0.0, -NEWTON * weight), WEIGHT)
    _arrow(axes, (bears, -NEWTON * weight), (0.0, NEWTON * weight), TABLE)
    _arrow(axes, (half + NEWTON * force, 0.004), (-NEWTON * force, 0.0), TABLE)
    axes.text(-half - 0.004, height + 0.008, f"f = {force:.1f} N", color=PUSH, ha="right")
    axes.text(half + 0.006, centre, f"m g = {weight:.1f} N", color=WEIGHT)
    axes.text(bears - 0.004, -0.055, f"N = {weight:.1f} N", color=TABLE, ha="right")
    of_all = "= μ N, all there is" if force > 0.999 * friction else f"of at most {friction:.1f} N"
    axes.text(half + 0.006, 0.014, f"friction {force:.1f} N,\n{of_all}", color=TABLE)
    at_edge = bears > 0.98 * half
    where = "at the edge: no torque is left to hold it" if at_edge else "within the base"
    axes.set_title(f"{title}: N acts {1e3 * bears:.0f} mm from the middle,\n{where}", fontsize=10)
    axes.set_xlim(-0.15, 0.17)
    axes.set_ylim(-0.10, top + 0.02)
    axes.set_aspect("equal")
    axes.axis("off")


def _arrow(axes: Axes, start: tuple[float, float], along: tuple[float, float], color: str) -> None:
    end = start[0] + along[0], start[1] + along[1]
    style = {"arrowstyle": "-|>", "color": color, "lw": 2.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", xy=end, xytext=start, arrowprops=style)


if __name__ == "__main__":
    draw()
