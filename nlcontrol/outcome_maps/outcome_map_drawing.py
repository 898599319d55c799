"""Outcome maps drawn as in the paper's Fig. 7, alone or beside an experiment.

Each contact of a face is a mark whose size is the force that the object needs there: a blue circle
where it slides, an orange triangle where it topples, a grey square where that is undecided; a cross
where nothing moves it; a dot where a push was not carried out. Colours and shapes can be told apart
without red and green. Experiments stand on the left, the prediction on the right, drawn
to one scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nlcontrol.outcome_maps.face_experiment import BY, Comparison, agreement_text
from nlcontrol.outcome_maps.outcome_map_table import legend
from objectmodels.mechanics.outcome_map import COLOURS, OutcomeMap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from objectmodels.geometry.side_faces import Face

MARKERS = {"slide": "o", "topple": "^", "undecided": "s", "none": "x"}
_TITLES = {way: f"experiment by\n{words}" for way, words in BY.items()}
_LARGEST = 190.0  # area of the circle of the largest force [points²]
_FADED = 0.12  # opacity of a circle whose outcome has no more than even odds
_OPAQUE = 0.85
_CROSS = 30.0  # area of the mark where nothing moves it [points²]
_DOT, _PALE = 5.0, "#b0b0b0"  # of the mark where nothing was carried out [points²]


@dataclass(frozen=True)
class _Spots:
    """Marks of n contacts: class, force (inf if none moves it) and opacity, shape (n,) each.

    The class of a push that was not carried out is empty.
    """

    lateral: NDArray[np.float64]
    height: NDArray[np.float64]
    outcome: NDArray[np.str_]
    force: NDArray[np.float64]
    opacity: NDArray[np.float64]

    @property
    def largest(self) -> float:
        """The largest force that moves it [N]; zero if none does."""
        return float(np.max(self.force, where=np.isfinite(self.force), initial=0.0))


def _predicted_spots(chart: OutcomeMap, shaded: bool) -> _Spots:
    opacity = _opacity(chart, shaded)
    return _Spots(chart.lateral, chart.height, chart.outcome, chart.force, opacity)


def _measured_spots(found: Comparison) -> _Spots:
    chart, opaque = found.chart, np.full(len(found.results), _OPAQUE)
    return _Spots(chart.lateral, chart.height, found.outcome, found.force, opaque)


def save_map(
    chart: OutcomeMap, face: str, path: Path, *, solid: bool = False, shaded: bool = False
) -> None:
    """Draws the map: PNG, SVG or PDF by the path's ending.

    A solid one has the force as height; a shaded one fades what is less probable.
    """
    from matplotlib.figure import Figure

    width, tall = (5.4, 5.2) if solid else (2.6 + 22.0 * chart.face.width, _tall(chart.face))
    figure = Figure(figsize=(max(width, 4.6), tall), dpi=160, layout="constrained")
    if solid:
        _draw_solid(figure, chart, shaded)
    else:
        axes, spots = figure.add_subplot(), _predicted_spots(chart, shaded)
        largest = spots.largest or 1.0
        _draw_flat(axes, chart.face, spots, largest)
        axes.set_ylabel("height above the table [mm]")
        axes.set_xlabel("along the face, seen from outside [mm]")
        _explain(figure, axes, chart, shaded=shaded, largest=largest, crossed=_has_crosses(spots))
    figure.suptitle(f"{chart.model.name}, {face} face", fontsize=12, fontweight="bold")
    _save(figure, path)


def save_comparison(experiments: Sequence[Comparison], path: Path, *, shaded: bool = False) -> None:
    """Draws experiments beside the prediction that they share: PNG, SVG or PDF, as `save_map`."""
    from matplotlib.figure import Figure

    first = experiments[0]
    chart, predicted = first.chart, _predicted_spots(first.chart, shaded)
    panels = {_TITLES[found.by]: _measured_spots(found) for found in experiments}
    panels["prediction"] = predicted
    width = 2.4 + 22.0 * len(panels) * chart.face.width
    figure = Figure(
        figsize=(max(width, 6.4), _tall(chart.face) + 0.6), dpi=160, layout="constrained"
    )
    row = figure.subplots(1, len(panels), sharex=True, sharey=True)
    largest = max(spots.largest for spots in panels.values()) or 1.0
    for axes, (title, spots) in zip(row, panels.items(), strict=True):
        _draw_flat(axes, chart.face, spots, largest)
        axes.set_title(title, fontsize=11)
        axes.set_xlabel("along the face [mm]")
    row[0].set_ylabel("height above the table [mm]")
    _explain(
        figure,
        row[-1],
        chart,
        shaded=shaded,
        largest=largest,
        crossed=any(_has_crosses(spots) for spots in panels.values()),
        left_out=any(found.left_out for found in experiments),
        above=_agreements(experiments),
    )
    figure.suptitle(
        f"{first.object}, {first.face} face, seen from outside", fontsize=12, fontweight="bold"
    )
    _save(figure, path)


def _agreements(experiments: Sequence[Comparison]) -> str:
    """Text below the panels: how far each experiment agrees with the prediction."""
    if len(experiments) == 1:
        return agreement_text(experiments[0])
    return "\n".join(f"{BY[found.by]}: {agreement_text(found)}" for found in experiments)


def _tall(face: Face) -> float:
    return 1.9 + 22.0 * face.height


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _opacity(chart: OutcomeMap, shaded: bool) -> NDArray[np.float64]:
    if not shaded:
        return np.full(len(chart.force), _OPAQUE)
    sure = np.maximum(chart.likelihood.slide, chart.likelihood.topple)
    return np.asarray(np.clip(_FADED + (1.0 - _FADED) * (2.0 * sure - 1.0), _FADED, 1.0))


def _undecided_label(chart: OutcomeMap) -> str:
    """Meaning of undecided; where probabilities decide, also what they are computed by."""
    return legend(chart) + ("" if chart.level is None else f" ({chart.likelihood.method})")


def _has_crosses(spots: _Spots) -> bool:
    return bool((spots.outcome == "none").any())


def _draw_flat(axes: Axes, face: Face, spots: _Spots, largest: float) -> None:
    """The contacts of a face; the circle of the largest force has the area `_LARGEST`."""
    area = np.where(np.isfinite(spots.force), _LARGEST * spots.force / largest, _CROSS)
    left_out = spots.outcome == ""
    axes.scatter(
        1e3 * spots.lateral[left_out], 1e3 * spots.height[left_out], s=_DOT, c=_PALE, linewidths=0.0
    )
    for name, colour in COLOURS.items():
        i = spots.outcome == name
        if i.any():
            axes.scatter(
                1e3 * spots.lateral[i],
                1e3 * spots.height[i],
                s=area[i],
                c=colour,
                alpha=spots.opacity[i],
                linewidths=1.0 if name == "none" else 0.0,
                marker=MARKERS[name],
            )
    axes.set_aspect("equal")
    half = 1e3 * face.width / 2
    axes.set_xlim(-half, half)
    axes.set_ylim(min(1e3 * face.bottom, 0.0), 1e3 * face.top)


def _explain(
    figure: Figure,
    axes: Axes,
    chart: OutcomeMap,
    *,
    shaded: bool,
    largest: float,
    crossed: bool,
    left_out: bool = False,
    above: str = "",
) -> None:
    """The legend below the picture, with circles to read areas by, and what is told above it."""
    handles = [
        axes.scatter(
            [],
            [],
            s=60.0,
            c=COLOURS[name],
            alpha=0.85,
            linewidths=0.0,
            label=label,
            marker=MARKERS[name],
        )
        for name, label in (
            ("slide", "slides"),
            ("topple", "topples"),
            ("undecided", _undecided_label(chart)),
        )
    ]
    handles += [
        axes.scatter(
            [],
            [],
            s=_LARGEST * share,
            c="none",
            edgecolors="#555555",
            label=f"needs {share * largest:.2g} N",
        )
        for share in (1.0, 0.5)
    ]
    if crossed:
        handles.append(
            axes.scatter([], [], s=_CROSS, c=COLOURS["none"], marker="x", label="nothing moves it")
        )
    if left_out:
        handles.append(
            axes.scatter([], [], s=_DOT, c=_PALE, linewidths=0.0, label="not carried out")
        )
    if shaded:
        handles.append(
            axes.scatter([], [], s=0.0, label=f"paler: less probable ({chart.likelihood.method})")
        )
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=2,
        fontsize=8,
        frameon=False,
        title=above,
        title_fontsize=10,
    )


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
            label = _undecided_label(chart) if name == "undecided" else f"{name}s"
            axes.scatter(
                x[i],
                y[i],
                z[i],
                c=COLOURS[name],
                alpha=opacity[i],
                s=14,
                linewidths=0.0,
                marker=MARKERS[name],
                label=label,
            )
    axes.set_xlabel("along the face [mm]")
    axes.set_ylabel("height [mm]")
    axes.set_zlabel("force [N]")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(5))
    axes.set_zlim(0.0, None)
    axes.view_init(elev=26.0, azim=52.0)
    axes.set_box_aspect((0.9, 1.6, 0.9), zoom=0.88)
    figure.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
