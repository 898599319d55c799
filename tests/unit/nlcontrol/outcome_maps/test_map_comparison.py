"""How far an experiment and its prediction agree."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from nlcontrol.outcome_maps import face_experiment as comparison
from nlcontrol.outcome_maps.face_experiment import Comparison, agreement_text, contacts_of
from objectmodels import BoxModel
from objectmodels.mechanics.outcome_map import OutcomeMap, outcome_map
from sim.face_experiment import TouchResult, Way

CRATE = BoxModel(name="crate", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4, support="corners")
CHART = outcome_map(CRATE, CRATE.faces()[0], spacing=0.01)


def as_predicted(chart: OutcomeMap = CHART, scale: float = 1.0) -> list[TouchResult]:
    """The prediction as results, its forces scaled."""
    first = np.where(chart.slide < chart.topple, "slide", "topple")
    return [
        TouchResult(outcome, force)
        for outcome, force in zip(first.tolist(), (scale * chart.force).tolist(), strict=True)
    ]


def compared(results: list[TouchResult], by: Way = "force") -> Comparison:
    return Comparison(CHART, tuple(results), "crate", "front", "table", by, 0)


def other(result: TouchResult) -> TouchResult:
    return TouchResult("topple" if result.outcome == "slide" else "slide", result.force)


def test_the_chart_has_something_to_decide() -> None:
    assert set(CHART.outcome) == {"slide", "topple", "undecided"}


def test_a_prediction_agrees_with_itself() -> None:
    found = compared(as_predicted())
    assert (found.agreement, found.median_error) == (1.0, 0.0)


def test_the_error_is_that_of_the_prediction() -> None:
    # Measured a quarter less than predicted: the prediction is a third too much.
    found = compared(as_predicted(scale=0.75))
    assert found.agreement == 1.0
    assert found.median_error == pytest.approx(1.0 / 3.0)
    assert (found.error > 0.0).all()


def test_each_wrong_class_counts_unless_it_is_undecided() -> None:
    results = as_predicted()
    undecided = np.flatnonzero(CHART.outcome == "undecided")
    decided = np.flatnonzero(CHART.outcome != "undecided")
    for i in undecided:
        results[i] = other(results[i])
    assert compared(results).agreement == 1.0
    results[decided[0]] = other(results[decided[0]])
    results[decided[-1]] = TouchResult("none", None)
    found = compared(results)
    assert found.agreement == pytest.approx(1.0 - 2.0 / len(decided))
    # What did not move has no force to compare.
    assert np.isnan(found.error[decided[-1]])
    assert np.isfinite(found.error).sum() == len(results) - 1


def test_what_was_not_carried_out_is_left_out_and_told() -> None:
    results = as_predicted()
    results[:3] = [TouchResult(None, None, why) for why in ("too far", "too low", "too low")]
    found = compared(results)
    assert (found.agreement, found.left_out) == (1.0, 3)
    assert not found.is_comparable[:3].any()
    assert "same class at 100.0 % of" in agreement_text(found)
    undecided = (found.chart.outcome[3:] == "undecided").sum()
    assert f"({undecided} undecided)" in agreement_text(found)
    reasons = [line for line in comparison.comparison_lines([found]) if "not carried out" in line]
    assert reasons == ["  not carried out at 2: too low", "  not carried out at 1: too far"]
    row = comparison.comparison_document([found])["contacts"][0]
    assert (row["measured_outcome"], row["agrees"], row["force_error"]) == (None, None, None)


def test_nothing_carried_out_is_nothing_compared() -> None:
    found = compared([TouchResult(None, None, "out of reach")] * len(CHART.force))
    assert (found.agreement, found.median_error) == (None, None)
    assert agreement_text(found).startswith("same class at none of")
    assert comparison.comparison_document([found])["agreement"] is None


def test_what_moved_but_was_not_felt_has_no_force() -> None:
    results = as_predicted()
    results[0] = TouchResult(results[0].outcome, None, "the fingertip slipped off")
    found = compared(results)
    assert found.agreement == 1.0
    assert np.isnan(found.error[0])


def test_several_experiments_stand_beside_one_prediction(tmp_path: Path) -> None:
    both = [compared(as_predicted()), compared(as_predicted(scale=0.5), by="robot")]
    document = comparison.comparison_document(both)
    assert document.keys() == {"force", "robot"}
    assert document["robot"] == comparison.comparison_document(both[1:])
    assert document["force"]["median_force_error"] == 0.0
    assert document["robot"]["median_force_error"] == pytest.approx(1.0)
    lines = comparison.comparison_lines(both)
    assert sum(line.count("   |   ") == 2 for line in lines) == len(np.unique(CHART.height))
    assert [line for line in lines if "the robot's finger" in line]
    comparison.save_table(both, tmp_path / "face.csv")
    with (tmp_path / "face.csv").open(encoding="utf-8") as file:
        ways = [row["by"] for row in csv.DictReader(file)]
    assert ways == ["force"] * len(CHART.force) + ["robot"] * len(CHART.force)


def test_contacts_are_those_of_the_chart() -> None:
    contacts = contacts_of(CHART, "my crate", "front")
    assert [c.point for c in contacts] == [tuple(p) for p in CHART.points.tolist()]
    for contact in contacts:
        assert (contact.object, contact.face) == ("my crate", "front")
        assert np.allclose(contact.direction, -np.array(contact.normal))


def test_the_table_has_a_row_for_each_contact(tmp_path: Path) -> None:
    found = compared(as_predicted(scale=0.5))
    comparison.save_table([found], tmp_path / "face.csv")
    with (tmp_path / "face.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(CHART.force)
    for row, force in zip(rows, CHART.force.tolist(), strict=True):
        assert float(row["measured_force_n"]) == pytest.approx(0.5 * force)
        assert float(row["force_error"]) == pytest.approx(1.0)


def test_the_two_maps_in_letters_stand_side_by_side() -> None:
    results = as_predicted()
    results[0] = other(results[0])
    lines = comparison.comparison_lines([compared(results)])
    rows = [tuple(line.split("mm  ")[1].split("   |   ")) for line in lines if "   |   " in line]
    heights = len(np.unique(CHART.height.round(9)))
    assert len(rows) == heights
    differ = [row for row in rows if any("?" != b != a for a, b in zip(*row, strict=True))]
    assert differ == [rows[-1]]
