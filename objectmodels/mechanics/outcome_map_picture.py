"""An outcome map as a picture for notebooks: the face seen from outside, a square for each contact.

Blue slides, orange topples, grey is undecided; the darker, the less force the object needs.
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from objectmodels.mechanics.outcome_map import OutcomeMap

COLOURS = {"slide": "#0072b2", "topple": "#d55e00", "undecided": "#7f7f7f", "none": "#9a9a9a"}
"""Colours of the outcomes, which people with colour blindness tell apart."""

_PALEST = 0.35  # opacity where the most force is needed
_WIDE = 5.0  # of a square that is alone in its row and column [mm]


def map_svg(chart: OutcomeMap) -> str:
    """The map as a drawing in millimetres; pointing at a square tells its figures."""
    y, z = 1e3 * chart.lateral, 1e3 * chart.height
    side = min(np.diff(np.unique(v.round(3))).min(initial=np.inf) for v in (y, z))
    side = side if np.isfinite(side) else _WIDE
    left, top = y.min() - side, z.max() + side
    most = np.max(chart.force, where=np.isfinite(chart.force), initial=0.0)
    opacity = 1.0 - (1.0 - _PALEST) * np.minimum(chart.force / max(most, 1e-9), 1.0)
    squares = (
        f'<rect x="{a - left - 0.45 * side:.1f}" y="{top - b - 0.45 * side:.1f}" '
        f'width="{0.9 * side:.1f}" height="{0.9 * side:.1f}" fill="{COLOURS[name]}" '
        f'fill-opacity="{shade:.2f}"><title>{a:z.0f}, {b:.0f} mm: {name}, {f:.2f} N</title></rect>'
        for a, b, name, f, shade in zip(y, z, chart.outcome, chart.force, opacity, strict=True)
    )
    names, counts = np.unique(chart.outcome, return_counts=True)
    key = ", ".join(f"{n} {name}" for name, n in zip(names, counts, strict=True))
    by = "" if chart.level is None else f"; probabilities: {chart.likelihood.method}"
    width, height = np.ptp(y) + 2.0 * side, top
    return "\n".join(
        [
            f"<p>{escape(chart.model.name)}: {key}; with up to {most:.2f} N{by}</p>",
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.1f} {height:.1f}" '
            f'width="{2.0 * width:.0f}" height="{2.0 * height:.0f}" role="img">',
            *squares,
            f'<line x2="{width:.1f}" y1="{height:.1f}" y2="{height:.1f}" stroke="#808080"/>',
            "</svg>",
        ]
    )
