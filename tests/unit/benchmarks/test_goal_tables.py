"""What came of cases is counted as it should be."""

from __future__ import annotations

import pytest

from benchmarks.goals.__main__ import chosen, parsed
from benchmarks.goals.cases import Done
from benchmarks.goals.sentences import Job
from benchmarks.goals.tables import amiss, counts, refusals, report, times


def case(number: int, status: str, **came: object) -> Done:
    job = Job(0, number, executed=status not in ("planned", "refused"))
    said = {"job": job, "kind": "displace", "text": "push the mug away", "sensible": number != 2}
    return Done.model_validate({**said, "status": status, **came})


DONE = {"accepted": True, "executed": True, "satisfied": True, "met": True}
RESULTS = [
    case(0, "done", **DONE),
    case(1, "failed", accepted=True, executed=True, reason="failed", message="executed, but"),
    case(2, "refused", reason="too_uncertain", seconds=0.2),
    case(3, "unsupported", reason="unsupported"),
    case(4, "failed", reason="blocked"),
    case(5, "crashed"),
]


def test_what_a_usual_world_asks_beyond_abilities_counts_neither_way() -> None:
    whole = counts(RESULTS).splitlines()[-1].split()
    # 6 cases, 1 lacking; 2 of 5 accepted, 1 of 2 satisfied; of the sensible ones 2 of 4.
    assert whole[:12] == ["in", "all", "6", "1", "2", "of", "5", "40.0%", "1", "of", "2", "50.0%"]
    assert whole[12:16] == ["2", "of", "4", "50.0%"]
    hard = [done.model_copy(update={"job": Job(0, 0, "hard")}) for done in RESULTS]
    (narrow,) = (line for line in counts(hard).splitlines() if line.startswith("narrow"))
    assert narrow.split()[3:7] == ["2", "of", "6", "33.3%"]


def test_refusals_by_reason_with_their_numbers() -> None:
    assert [done.refused for done in RESULTS] == ["", "", "too_uncertain", "", "blocked", ""]
    _, *lines = refusals(RESULTS).splitlines()
    assert [line.split() for line in lines] == [
        ["blocked", "1", "0-4"],
        ["too_uncertain", "1", "0-2"],
    ]


def test_what_is_said_to_be_done_and_is_not_is_false() -> None:
    missed = case(6, "done", **DONE | {"met": False})
    unknown = case(7, "done", **DONE | {"met": None})
    assert [done.falsely_done for done in (missed, unknown, *RESULTS)] == [True] + [False] * 7
    assert counts([missed, unknown]).splitlines()[-1].split()[-2:] == ["1", "0"]
    assert "done, truly missed" in amiss(missed)
    assert not amiss(unknown)


def test_times_of_what_was_planned_and_what_went_wrong() -> None:
    assert times(RESULTS).splitlines()[1].split()[:5] == ["one", "action", "1", "0.20", "s"]
    told = [amiss(done).split(" ")[0] for done in RESULTS if amiss(done)]
    assert told == ["0-1", "0-5"]
    assert counts(RESULTS) in report(RESULTS)


def test_what_was_planned_only_is_accepted_and_counts_as_neither_satisfied_nor_failed() -> None:
    only = case(1, "planned", accepted=True)
    assert counts([RESULTS[0], only]).splitlines()[-1].split()[4:12] == (
        ["2", "of", "2", "100.0%", "1", "of", "1", "100.0%"]
    )


def test_cases_to_be_carried_out_are_drawn_by_seed() -> None:
    asked = ["hard", "--seed", "3", "--cases", "400", "--execute-every", "2"]
    jobs = chosen(parsed(asked))
    assert 160 < sum(job.executed for job in jobs) < 240  # 200 ± 4 standard deviations of 10
    assert jobs == chosen(parsed(asked))


def test_a_suite_is_asked_for_its_own_kinds_alone() -> None:
    assert parsed(["hard", "--kinds", "lift, open"]).kinds == ["lift", "open"]
    with pytest.raises(SystemExit):
        parsed(["--kinds", "lift"])


def test_nothing_at_all_is_no_failure() -> None:
    assert report([])
