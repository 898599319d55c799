"""What came of cases is counted as it should be."""

from __future__ import annotations

import math

import pytest

from benchmarks.goals.__main__ import _options, chosen
from benchmarks.goals.cases import Done, Stage
from benchmarks.goals.sentences import Kind
from benchmarks.goals.tables import (
    beyond,
    clauses,
    counts,
    errors,
    failures,
    objects,
    refusals,
    reliability,
    report,
    times,
    wilson,
)
from benchmarks.goals.worlds import Job


def stage(
    status: str = "done",
    *,
    goal: str = "displace",
    probability: float | None = 0.98,
    reason: str | None = None,
    clauses: tuple[tuple[str, bool], ...] = (),
    errors: dict[str, float] | None = None,
) -> Stage:
    return Stage(
        goal=goal,
        status=status,
        planned=probability is not None,
        reason=reason,
        probability=probability,
        planning=0.2,
        plans=1,
        clauses=clauses,
        errors=errors or {},
    )


def case(number: int, *stages: Stage, status: str | None = None, capability: str = "") -> Done:
    return Done(
        job=Job(0, number),
        kind="displace",
        target="mug",
        text="push the mug away",
        sensible=number != 2,
        objects=1,
        status=status or stages[-1].status,
        capability=capability,
        stages=stages,
        wall=3.0,
        simulated=10.0,
    )


KEPT = (("displace", True), ("displace", True), ("no_topple", True))
BROKEN = (("displace", False), ("displace", True), ("no_topple", True))

RESULTS = [
    case(0, stage(clauses=KEPT, errors={"along": 0.001, "yaw": math.radians(-1.0)})),
    case(1, stage("failed", clauses=BROKEN, errors={"along": -0.005}, probability=0.96)),
    case(2, stage("refused", probability=None, reason="too_uncertain")),
    case(3, stage("unsupported", probability=None, reason="unsupported"), capability="flying"),
    case(4, stage(), stage("refused", probability=None, reason="blocked")),
    case(5, status="crashed"),
]


def test_accepted_is_what_had_a_plan_for_every_step() -> None:
    assert [done.accepted for done in RESULTS] == [True, True, False, False, False, False]
    assert [done.refused for done in RESULTS] == [
        None, None, "too_uncertain", None, "blocked", None,
    ]  # fmt: skip


def test_what_the_robot_lacks_counts_neither_way() -> None:
    whole = counts(RESULTS).splitlines()[-1].split()
    # 6 cases, 1 lacking; 2 of 5 accepted; 1 of 2 satisfied.
    assert whole == ["all", "6", "1", "2", "of", "5", "40.0%", "1", "of", "2", "50.0%"]


def test_a_clause_is_violated_if_one_of_its_checks_is() -> None:
    text = clauses(RESULTS)
    assert "displace            1 of 2  50.0%" in text
    assert "without toppling held: 2 of 2 100.0%" in text


def test_refusals_by_reason_with_their_numbers() -> None:
    lines = refusals(RESULTS).splitlines()
    assert lines[1].split() == ["blocked", "1", "4"]
    assert lines[2].split() == ["too_uncertain", "1", "2"]
    assert "flying" in lines[3]


def test_errors_are_sizes_in_the_unit_of_their_bound() -> None:
    along, yaw = errors(RESULTS).splitlines()[1:]
    assert along.split()[:5] == ["displace", "along", "2", "3.00", "mm"]
    assert "3 mm: 1 of 2" in along
    assert yaw.split()[:5] == ["displace", "yaw", "1", "1.00", "°"]


def alone(number: int, target: str, kind: Kind, errors: dict[str, float]) -> Done:
    """A case of an object that stood alone."""
    made = case(number, stage(goal=kind, errors=errors))
    job = Job(0, number, alone=True)
    return made.model_copy(update={"job": job, "target": target, "kind": kind})


def test_each_object_by_itself() -> None:
    refused = case(9, stage("refused", probability=None, reason="blocked"))
    results = [
        alone(0, "mug", "displace", {"along": 0.001, "yaw": math.radians(1.0)}),
        alone(1, "mug", "displace", {"along": -0.004, "yaw": 0.0}),
        alone(2, "mug", "place", {"off": 0.002}),
        alone(3, "bottle", "topple", {"side": 0.1}),
        alone(4, "bottle", "topple", {"side": 1.0}),
        alone(5, "bottle", "topple", {}),
        refused.model_copy(update={"job": Job(0, 9, alone=True), "target": "mug"}),
    ]
    _, mug, every, placed, _, toppled, _ = objects([*RESULTS, *results]).splitlines()
    # Median and 95th percentile of 1 and 4 mm; one of three runs was refused.
    assert mug.split()[:5] == ["mug", "displace", "3", "2", "2"]
    assert mug.endswith("along 2.50, 3.85 mm; yaw 0.50, 0.95 °")
    assert every.split()[1:] == mug.split()[1:]
    assert placed.endswith("off 2.00, 2.00 mm")
    # What did not fall fell to no side.
    assert "side right 1 of 3" in toppled
    assert [line.split(":")[0] for line in beyond([*RESULTS, *results]).splitlines()] == [
        "case 0-1 along -4.0 mm",
        "case 0-4 side 57.3 °",
    ]
    assert objects(RESULTS) == ""


def test_reliability_by_what_was_stated() -> None:
    low, high = reliability(RESULTS).splitlines()[1:]
    assert low.split()[:4] == ["0.95–0.97", "1", "0.960", "0.000"]
    assert high.split()[:4] == ["0.97–0.99", "2", "0.980", "1.000"]


def test_times_and_failures() -> None:
    assert "0.3" in times(RESULTS).splitlines()[-1]
    assert [line.split()[:2] for line in failures(RESULTS).splitlines()] == [
        ["case", "1"],
        ["case", "5"],
    ]
    assert counts(RESULTS) in report(RESULTS)


def test_what_was_planned_only_is_accepted_and_counts_as_neither_satisfied_nor_failed() -> None:
    done = case(0, stage())
    only = done.model_copy(update={"job": Job(0, 1, executed=False), "status": "planned"})
    assert counts([done, only]).splitlines()[-1].split()[3:] == (
        ["2", "of", "2", "100.0%", "1", "of", "1", "100.0%"]
    )


def test_cases_to_be_carried_out_are_drawn_by_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "sys.argv", ["goals", "--hard", "--seed", "3", "--cases", "400", "--execute-every", "2"]
    )
    jobs = chosen(_options())
    assert 160 < sum(job.executed for job in jobs) < 240  # 200 ± 4 standard deviations of 10
    assert jobs == chosen(_options())


def test_nothing_at_all_is_no_failure() -> None:
    assert "all" in report([])


def test_wilson_against_a_published_interval() -> None:
    # Newcombe 1998, table I: 81 of 263 gives 0.2553 to 0.3662.
    low, high = wilson(81, 263)
    assert (low, high) == pytest.approx((0.2553, 0.3662), abs=5e-5)
