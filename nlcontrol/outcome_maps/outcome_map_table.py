"""Outcome maps as data, tables and text; `outcome_maps.outcome_map_drawing` draws them."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nlcontrol.json_document import finite_or_none

if TYPE_CHECKING:
    from objectmodels.mechanics.outcome_map import OutcomeMap

PLACE = ("lateral", "height", "x", "y", "z")
"""Columns of a table that say where a contact is."""

UNITS = dict.fromkeys(PLACE, "_m") | dict.fromkeys(
    ("force", "slide", "topple", "measured_force"), "_n"
)
"""Ends of the headers of columns that have a unit: metres and newtons."""

LETTERS = {"slide": "s", "topple": "T", "undecided": "?", "none": "·"}


def map_document(chart: OutcomeMap, face: str) -> dict[str, Any]:
    """The map as plain data, SI units; what never happens is null."""
    likely = chart.likelihood
    rows = zip(
        chart.lateral,
        chart.height,
        chart.points.tolist(),
        chart.outcome,
        chart.force,
        chart.slide,
        chart.topple,
        likely.slide,
        likely.topple,
        strict=True,
    )
    return {
        "object": chart.model.name,
        "face": face,
        "normal": chart.face.normal,
        "band": chart.band,
        "level": chart.level,
        "friction": chart.friction,
        "probabilities": likely.method,
        "contacts": [
            {
                "lateral": float(y),
                "height": float(z),
                "point": point,
                "outcome": str(outcome),
                "force": finite_or_none(force),
                "slide": finite_or_none(slide),
                "topple": finite_or_none(topple),
                "probability_slide": float(p),
                "probability_topple": float(q),
            }
            for y, z, point, outcome, force, slide, topple, p, q in rows
        ],
    }


def save_table(chart: OutcomeMap, face: str, path: Path) -> None:
    """Writes the map as CSV: one row for each contact, units in the header."""
    columns = ("outcome", "force", "slide", "topple", "probability_slide", "probability_topple")
    write_rows(map_document(chart, face)["contacts"], (*PLACE, *columns), path)


def write_rows(rows: Iterable[dict[str, Any]], columns: Sequence[str], path: Path) -> None:
    """Writes columns of the contacts of documents as CSV; `UNITS` completes the headers."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([column + UNITS.get(column, "") for column in columns])
        for row in rows:
            cells = row | dict(zip("xyz", row["point"], strict=True))
            writer.writerow([cells[column] for column in columns])


def legend(chart: OutcomeMap) -> str:
    """Meaning of undecided in this map."""
    if chart.level is not None:
        return f"undecided: neither has a probability of {chart.level:g}"
    return f"undecided: thresholds within {100 * chart.band:g} %"


def map_lines(chart: OutcomeMap, face: str) -> list[str]:
    """The map in letters, top row first, and what it says in a sentence."""
    outcome, force = chart.outcome, chart.force
    return [
        f"{chart.model.name}, {face} face, seen from outside",
        *(
            f"{1e3 * z:5.0f} mm  {letters(chart, outcome, row)}  {_span(force[row])}"
            for z, row in rows(chart)
        ),
        f"{key(chart)}; forces of each row",
        f"{chart.friction} friction; probabilities: {chart.likelihood.method}",
    ]


def rows(chart: OutcomeMap) -> Iterator[tuple[float, NDArray[np.bool_]]]:
    """Heights of the rows of contacts, the top one first, and which contacts are in them."""
    heights = chart.height.round(9)
    for z in np.unique(heights)[::-1].tolist():
        yield z, heights == z


def letters(chart: OutcomeMap, outcome: NDArray[np.str_], row: NDArray[np.bool_]) -> str:
    """Outcomes of a row in letters, in columns that all rows share."""
    lateral = chart.lateral.round(9)
    found = dict(zip(lateral[row].tolist(), outcome[row].tolist(), strict=True))
    return " ".join(LETTERS.get(found.get(y, ""), " ") for y in np.unique(lateral).tolist())


def key(chart: OutcomeMap) -> str:
    """Meaning of the letters."""
    return f"s slides, T topples, ? {legend(chart)}, · nothing moves it"


def _span(forces: NDArray[np.float64]) -> str:
    finite = forces[np.isfinite(forces)]
    if not finite.size:
        return "nothing moves it"
    least, most = f"{finite.min():5.2f}", f"{finite.max():5.2f}"
    return f"{least} N" if least == most else f"{least} … {most.strip()} N"
