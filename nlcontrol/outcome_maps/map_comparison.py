"""An experiment all over a face beside its prediction: do the classes agree, and the forces?

The prediction is what the robot believes; the experiment is how the simulated world really is, and
what moved there was judged by its observer. Classes are compared where the prediction is decided:
where its two thresholds are too close to call, either class is as predicted. Forces are compared
wherever something moved in both. A face may be pushed in several ways; each is an experiment of its
own beside the same prediction.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nlcontrol.outcome_maps import outcome_map_table as maps
from objectmodels.mechanics.outcome_map import OutcomeMap
from sim.face_experiment import Contact, TouchResult, Way

BY = {"force": "a force applied directly", "robot": "the robot's finger"}
"""Ways of pushing in words."""


@dataclass(frozen=True)
class Comparison:
    """Prediction and experiment over n contacts of a face.

    Attributes:
        chart: the prediction.
        results: the experiment, in the order of the chart's contacts.
        object: the object's name in the scene.
        face: how the face is called.
        scene: name of the scene.
        by: how it was pushed.
        seed: of everything random.
    """

    chart: OutcomeMap
    results: tuple[TouchResult, ...]
    object: str
    face: str
    scene: str
    by: Way
    seed: int

    @cached_property
    def outcome(self) -> NDArray[np.str_]:
        """First motion: `slide`, `topple`, `none`, or empty if not carried out, shape (n,)."""
        return np.array([result.outcome or "" for result in self.results], dtype="<U6")

    @cached_property
    def force(self) -> NDArray[np.float64]:
        """Force at which it moved, inf if it never did, nan if not carried out, shape (n,) [N]."""
        nothing = np.where(self.outcome == "none", np.inf, np.nan)
        measured = np.array([result.force for result in self.results], dtype=float)
        return np.where(np.isnan(measured), nothing, measured)

    @property
    def left_out(self) -> int:
        """Number of pushes that were not carried out."""
        return int((self.outcome == "").sum())

    @cached_property
    def is_comparable(self) -> NDArray[np.bool_]:
        """Contacts whose classes are compared, shape (n,)."""
        return np.asarray((self.outcome != "") & (self.chart.outcome != "undecided"))

    @cached_property
    def agrees(self) -> NDArray[np.bool_]:
        """Those of them where the classes are the same, shape (n,)."""
        return np.asarray(self.is_comparable & (self.outcome == self.chart.outcome))

    @property
    def agreement(self) -> float | None:
        """Share of the compared contacts that agree; None if there are none."""
        count = int(self.is_comparable.sum())
        return float(self.agrees.sum() / count) if count else None

    @cached_property
    def error(self) -> NDArray[np.float64]:
        """Predicted force over the measured one, less one; nan where either is none, shape (n,)."""
        both = np.isfinite(self.force) & np.isfinite(self.chart.force)
        measured = np.where(both, self.force, np.nan)
        return np.asarray(np.where(both, self.chart.force, np.nan) / measured - 1.0)

    @property
    def median_error(self) -> float | None:
        """Median size of the force's error; None if there is none."""
        errors = np.abs(self.error[np.isfinite(self.error)])
        return float(np.median(errors)) if errors.size else None


def contacts_of(chart: OutcomeMap, name: str, face: str) -> list[Contact]:
    """The pushes of a map, to be carried out on the object of that name in the scene."""
    _, normals = chart.face.points_at(chart.lateral, chart.height)
    return [
        Contact(name, face, tuple(p), tuple(n), tuple(u))
        for p, n, u in zip(
            chart.points.tolist(), normals.tolist(), chart.directions.tolist(), strict=True
        )
    ]


def agreement_text(found: Comparison) -> str:
    """Agreement of an experiment with the prediction, in a sentence."""
    share, median, compared = found.agreement, found.median_error, int(found.is_comparable.sum())
    undecided = len(found.results) - compared - found.left_out
    classes = "at none of 0" if share is None else f"at {100 * share:.1f} % of {compared}"
    forces = "none" if median is None else f"median error {100 * median:.1f} %"
    return f"same class {classes} contacts ({undecided} undecided); force: {forces}"


def _reasons(found: Comparison) -> list[str]:
    """Why pushes were not carried out, the most frequent reason first."""
    counted = Counter(r.detail for r in found.results if r.outcome is None)
    return [f"not carried out at {n}: {why}" for why, n in counted.most_common()]


def comparison_lines(experiments: Sequence[Comparison]) -> list[str]:
    """The maps of experiments with the same prediction in letters, and how far they agree.

    They stand side by side, the top row first.
    """
    first = experiments[0]
    chart = first.chart
    titles = [f"experiment by {BY[found.by]}" for found in experiments]
    sides = [*(found.outcome for found in experiments), chart.outcome]
    lines = [
        f"{first.object}, {first.face} face, seen from outside",
        f"from left to right: {', '.join(titles)}, prediction",
        *(
            f"{1e3 * z:5.0f} mm  " + "   |   ".join(maps.letters(chart, o, row) for o in sides)
            for z, row in maps.rows(chart)
        ),
        maps.key(chart),
        f"prediction: {chart.friction} friction",
    ]
    for found in experiments:
        lines += [
            f"experiment: pushed by {BY[found.by]} in the scene {found.scene}, seed {found.seed}",
            *(f"  {line}" for line in (agreement_text(found), *_reasons(found))),
        ]
    return lines


def comparison_document(experiments: Sequence[Comparison]) -> dict[str, Any]:
    """A comparison as plain data: the map, and of each contact what was measured; SI units.

    Of several experiments with the same prediction, the documents by their ways.
    """
    each = {str(found.by): _document(found) for found in experiments}
    return each if len(each) > 1 else each[experiments[0].by]


def _document(found: Comparison) -> dict[str, Any]:
    predicted = maps.map_document(found.chart, found.face)
    rows = zip(
        predicted["contacts"],
        found.results,
        found.is_comparable,
        found.agrees,
        found.error,
        strict=True,
    )
    return predicted | {
        "object": found.object,
        "model": found.chart.model.name,
        "scene": found.scene,
        "by": found.by,
        "seed": found.seed,
        "compared": int(found.is_comparable.sum()),
        "agreement": found.agreement,
        "median_force_error": found.median_error,
        "contacts": [
            contact
            | {
                "measured_outcome": result.outcome,
                "measured_force": result.force,
                "detail": result.detail,
                "agrees": bool(agrees) if compared else None,
                "force_error": float(error) if np.isfinite(error) else None,
            }
            for contact, result, compared, agrees, error in rows
        ],
    }


def save_table(experiments: Sequence[Comparison], path: Path) -> None:
    """Writes comparisons as CSV: one row for each push, units in the header."""
    measured = ("measured_outcome", "measured_force")
    predicted = ("outcome", "force", "slide", "topple")
    maps.write_rows(
        ({"by": found.by} | row for found in experiments for row in _document(found)["contacts"]),
        ("by", *maps.PLACE, *measured, *predicted, "agrees", "force_error"),
        path,
    )
