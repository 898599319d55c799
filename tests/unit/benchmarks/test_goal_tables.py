"""What came of cases is counted as it should be."""

from __future__ import annotations

import pytest

from benchmarks.goals.__main__ import _options, chosen
from benchmarks.goals.cases import Done, Stage
from benchmarks.goals.tables import (
    counts,
    failures,
    refusals,
    report,
    times,
)
from benchmarks.goals.worlds import Job


def stage(
    status: str = "done",
    *,
    probability: float | None = 0.98,
    reason: str | None = None,
) -> Stage:
    return Stage(
        goal="displace",
        status=status,
        planned=probability is not None,
        reason=reason,
        probability=probability,
        planning=0.2,
        plans=1,
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


RESULTS = [
    case(0, stage()),
    case(1, stage("failed", probability=0.96)),
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


def test_refusals_by_reason_with_their_numbers() -> None:
    lines = refusals(RESULTS).splitlines()
    assert lines[1].split() == ["blocked", "1", "4"]
    assert lines[2].split() == ["too_uncertain", "1", "2"]
    assert "flying" in lines[3]


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
