"""Outcome maps as pictures, tables and text: the paper's Fig. 7.

Each contact of a face is a circle whose area is the force that the object needs there: red where it
slides, green where it topples, blue where that is undecided.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from objectmodels.outcomemap import OutcomeMap

COLOURS = {"slide": "#d1342b", "topple": "#2a9d4a", "undecided": "#2f6fd0", "none": "#9a9a9a"}
LETTERS = {"slide": "s", "topple": "T", "undecided": "?", "none": "·"}
_LARGEST = 190.0  # area of the circle of the largest force [points²]
_FADED = 0.12  # opacity of a circle whose outcome has no more than even odds


def document(chart: OutcomeMap, face: str) -> dict[str, Any]:
    """The map as plain data, SI units; what never happens is null."""
    likely = chart.likelihood
    rows = zip(
        chart.lateral, chart.height, chart.points.tolist(), chart.outcome, chart.force,
        chart.slide, chart.topple, likely.slide, likely.topple, strict=True,
    )  # fmt: skip
    return {
        "object": chart.model.name,
        "face": face,
        "normal": chart.face.normal,
        "band": chart.band,
        "level": chart.level,
        "friction": chart.friction,
        "contacts": [
            {
                "lateral": float(y),
                "height": float(z),
                "point": point,
                "outcome": str(outcome),
                "force": _finite(force),
                "slide": _finite(slide),
                "topple": _finite(topple),
                "probability_slide": float(p),
                "probability_topple": float(q),
            }
            for y, z, point, outcome, force, slide, topple, p, q in rows
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def save_table(chart: OutcomeMap, face: str, path: Path) -> None:
    """Writes the map as CSV: one row for each contact, units in the header."""
    rows = document(chart, face)["contacts"]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            ("lateral_m", "height_m", "x_m", "y_m", "z_m", "outcome", "force_n", "slide_n",
             "topple_n", "probability_slide", "probability_topple")
        )  # fmt: skip
        for row in rows:
            writer.writerow(
                (row["lateral"], row["height"], *row["point"], row["outcome"], row["force"],
                 row["slide"], row["topple"], row["probability_slide"], row["probability_topple"])
            )  # fmt: skip


def legend(chart: OutcomeMap) -> str:
    """What undecided means in this map."""
    if chart.level is not None:
        return f"undecided: neither has a probability of {chart.level:g}"
    return f"undecided: thresholds within {100 * chart.band:g} %"


def text(chart: OutcomeMap, face: str) -> list[str]:
    """The map in letters, top row first, and what it says in a sentence."""
    heights = np.unique(chart.height.round(9))[::-1]
    columns = np.unique(chart.lateral.round(9))
    outcome = chart.outcome
    lines = [f"{chart.model.name}, {face} face, seen from outside"]
    for z in heights:
        row = chart.height.round(9) == z
        letters = {
            float(y): LETTERS[str(o)]
            for y, o in zip(chart.lateral[row].round(9), outcome[row], strict=True)
        }
        forces = chart.force[row]
        finite = forces[np.isfinite(forces)]
        span = f"{finite.min():5.2f} … {finite.max():.2f} N" if finite.size else "nothing moves it"
        cells = " ".join(letters.get(float(y), " ") for y in columns)
        lines.append(f"{1e3 * z:5.0f} mm  {cells}  {span}")
    lines.append(f"s slides, T topples, ? {legend(chart)}, · nothing moves it; forces of each row")
    lines.append(f"{chart.friction} friction")
    return lines


def save_map(
    chart: OutcomeMap, face: str, path: Path, *, solid: bool = False, shaded: bool = False
) -> None:
    """Draws the map: PNG, SVG or PDF by the name's ending.

    Args:
        chart: what to draw.
        face: how the face is called.
        path: where to.
        solid: in three dimensions, the force as height.
        shaded: fade circles as their outcome becomes less probable.
    """
    from matplotlib.figure import Figure

    width = 5.4 if solid else 2.6 + 22.0 * chart.face.width
    tall = 5.2 if solid else 1.9 + 22.0 * chart.face.height
    figure = Figure(figsize=(max(width, 4.6), tall), dpi=160, layout="constrained")
    if solid:
        _draw_solid(figure, chart, shaded)
    else:
        _draw_flat(figure, chart, shaded)
    figure.suptitle(f"{chart.model.name}, {face} face", fontsize=12, fontweight="bold")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _opacity(chart: OutcomeMap, shaded: bool) -> np.ndarray:
    if not shaded:
        return np.full(len(chart.force), 0.85)
    sure = np.maximum(chart.likelihood.slide, chart.likelihood.topple)
    return np.asarray(np.clip(_FADED + (1.0 - _FADED) * (2.0 * sure - 1.0), _FADED, 1.0))


def _draw_flat(figure: Figure, chart: OutcomeMap, shaded: bool) -> None:
    axes = figure.add_subplot()
    force, opacity = chart.force, _opacity(chart, shaded)
    finite = np.isfinite(force)
    largest = force[finite].max() if finite.any() else 1.0
    area = _LARGEST * np.where(finite, force, 0.0) / largest
    for name, colour in COLOURS.items():
        i = chart.outcome == name
        if i.any():
            axes.scatter(
                1e3 * chart.lateral[i], 1e3 * chart.height[i], s=np.where(finite[i], area[i], 30.0),
                c=colour, alpha=opacity[i], linewidths=0.0,
                marker="o" if name != "none" else "x",
            )  # fmt: skip
    axes.set_aspect("equal")
    half, low, high = 1e3 * chart.face.width / 2, 1e3 * chart.face.bottom, 1e3 * chart.face.top
    axes.set_xlim(-half, half)
    axes.set_ylim(min(low, 0.0), high)
    axes.set_xlabel("along the face, seen from outside [mm]")
    axes.set_ylabel("height above the table [mm]")
    _explain(figure, axes, chart, shaded, largest)


def _explain(figure: Figure, axes: Axes, chart: OutcomeMap, shaded: bool, largest: float) -> None:
    """The legend below the picture, with circles to read areas by."""
    handles = [
        axes.scatter([], [], s=60.0, c=colour, alpha=0.85, linewidths=0.0, label=label)
        for name, label in (
            ("slide", "slides"),
            ("topple", "topples"),
            ("undecided", legend(chart)),
        )
        if (colour := COLOURS[name])
    ]
    handles += [
        axes.scatter([], [], s=_LARGEST * share, c="none", edgecolors="#555555",
                     label=f"{share * largest:.2g} N")
        for share in (1.0, 0.5)
    ]  # fmt: skip
    if shaded:
        handles.append(axes.scatter([], [], s=0.0, label="paler: less probable"))
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8, frameon=False)


def _draw_solid(figure: Figure, chart: OutcomeMap, shaded: bool) -> None:
    from matplotlib.ticker import MaxNLocator
    from matplotlib.tri import Triangulation
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    axes: Any = figure.add_subplot(projection="3d")
    opacity, outcome = _opacity(chart, shaded), chart.outcome
    x, y, z = 1e3 * chart.lateral, 1e3 * chart.height, chart.force
    moved = np.flatnonzero(np.isfinite(z))
    if moved.size >= 3 and np.ptp(x[moved]) > 0.0 and np.ptp(y[moved]) > 0.0:
        corners = moved[Triangulation(x[moved], y[moved]).triangles]
        # A triangle is as sure as its corners: where they differ it is left grey.
        colours = [
            COLOURS[str(outcome[c[0]])] if len(set(outcome[c])) == 1 else COLOURS["none"]
            for c in corners
        ]
        sheet = Poly3DCollection(
            np.stack((x, y, z), axis=1)[corners], facecolors=colours, edgecolors="none", alpha=0.35
        )
        axes.add_collection3d(sheet)
    for name in ("slide", "topple", "undecided"):
        i = (outcome == name) & np.isfinite(z)
        if i.any():
            axes.scatter(x[i], y[i], z[i], c=COLOURS[name], alpha=opacity[i], s=14, linewidths=0.0,
                         label=legend(chart) if name == "undecided" else f"{name}s")  # fmt: skip
    axes.set_xlabel("along the face [mm]")
    axes.set_ylabel("height [mm]")
    axes.set_zlabel("force [N]")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(5))
    axes.set_zlim(0.0, None)
    axes.view_init(elev=26.0, azim=52.0)
    axes.set_box_aspect((0.9, 1.6, 0.9), zoom=0.88)
    figure.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
