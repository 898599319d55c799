"""Turns are drawn by what truly stands where, and judged by what truly came of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.goals.drawn_turns import HOPELESS, Job, Turn, draw_scene, draw_turn
from benchmarks.goals.drawn_worlds import SETTINGS
from benchmarks.goals.judge import BELOW, FELL, MOVED, TruePlace, fallen, moved, true_places
from benchmarks.goals.refusal_judge import Finding
from benchmarks.goals.refusal_judge import Verdict as RefusalVerdict
from benchmarks.goals.talks import Said, Talk, is_told, report, verdict
from nlcontrol import Registry
from nlcontrol.errors import ErrorInfo
from nlcontrol.results.result import Result, ResultStatus
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels.geometry.rotations import rot_x, rot_z

TIN = TruePlace(Registry.built_in().get("tea tin"), np.eye(3), np.array([0.5, 0.1, 0.0]))
FEASIBLE = Turn("displace", "push it away", "tin", feasible=True)
HOPELESS_TURN = replace(FEASIBLE, kind="hopeless", feasible=False)


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen", seed=1)


@pytest.mark.parametrize("setting", SETTINGS)
def test_seed_and_number_say_how_a_conversation_begins(setting: str) -> None:
    job = Job(7, SETTINGS.index(setting))
    assert job.setting == setting
    begun = []
    for _ in range(2):
        talk = Conversation(Controller(draw_scene(job), seed=7))
        begun.append(draw_turn(job, 0, talk, true_places(talk.controller.executor), None))
    assert begun[0] == begun[1]


@pytest.mark.parametrize("text", HOPELESS)
def test_what_is_labelled_hopeless_is_refused(text: str, kitchen: Controller) -> None:
    result = Conversation(kitchen).say(text.format("the ice tea box"), plan_only=True)
    assert result.status == "refused"


def test_only_what_leans_much_more_or_is_off_the_table_fell() -> None:
    step = 0.01  # rad and m: well above rounding
    for lean, below, falls in ((FELL - step, 0.0, False), (FELL + step, 0.0, True)):
        now = replace(TIN, R_WB=rot_x(lean), p_WB=np.add(TIN.p_WB, [0.0, 0.0, below]))
        assert fallen({"tin": TIN}, {"tin": now}) == ["tin"] * falls
    drop = TIN.middle[2] - BELOW
    for further, falls in ((-step, False), (step, True)):
        now = replace(TIN, p_WB=TIN.p_WB - [0.0, 0.0, drop + further])
        assert fallen({"tin": TIN}, {"tin": now}) == ["tin"] * falls


def test_what_moves_less_than_is_told_stays() -> None:
    for way, moves in ((0.9 * MOVED, False), (1.1 * MOVED, True)):
        now = replace(TIN, p_WB=np.add(TIN.p_WB, [way, 0.0, 0.0]))
        assert moved({"tin": TIN}, {"tin": now}) == ["tin"] * moves


def test_a_turn_is_told_whole_turns_apart() -> None:
    turned = replace(TIN, R_WB=rot_z(-0.3))
    assert turned.turned_against(TIN) == pytest.approx(0.3)  # exact but for rounding
    assert turned.leans_against(TIN) == pytest.approx(0.0, abs=1e-6)  # arccos near 1


def result(status: ResultStatus, message: str = "", notes: tuple[str, ...] = ()) -> Result:
    error = ErrorInfo(code="blocked", message=message) if message else None
    return Result(
        ok=status == "done", status=status, text="", notes=notes, error=error, scene="", seed=0
    )


@pytest.mark.parametrize(
    ("turn", "status", "good", "stirred", "expected"),
    [
        (FEASIBLE, "done", True, True, "satisfied"),
        (FEASIBLE, "done", False, True, "false"),
        (FEASIBLE, "failed", False, True, "failed"),
        (FEASIBLE, "refused", True, False, "refused"),
        (HOPELESS_TURN, "refused", True, False, "rightly refused"),
        (HOPELESS_TURN, "refused", True, True, "refused"),
        (HOPELESS_TURN, "done", False, True, "false"),
    ],
)
def test_verdicts(
    turn: Turn, status: ResultStatus, good: bool, stirred: bool, expected: str
) -> None:
    assert verdict(turn, result(status), good, stirred) == expected


def test_what_fell_is_told_by_its_name() -> None:
    assert is_told(result("failed", "executed, but the tin lies"), "tin")
    assert is_told(result("refused", "no", ("the tin is at x 1 now",)), "tin")
    assert not is_told(result("failed", "executed, but the jar lies"), "tin")
    assert not is_told(result("done"), "tin")


def test_the_report_counts_what_is_good_and_tells_the_rest() -> None:
    said = Said(kind="displace", text="a", target="tin", feasible=True, verdict="satisfied")
    bad = replace(said, text="b", verdict="failed", stranded=("tin",), untold=("tin",))
    text = report([Talk(job=Job(5, 0), turns=(said, bad))])
    total = text.splitlines()[3].split()
    assert total == ["in", "all", "1", "0", "0", "1", "0", "0", "1", "of", "2", "50.0%", "1", "1"]
    assert "5-0.1 failed “b”; stranded tin, untold tin" in text
    assert "5-0.0" not in text


@pytest.mark.parametrize(
    ("judged", "expected"),
    [
        ("confirmed", "rightly refused"),
        ("unlikely", "refused"),
        ("unconfirmed", "refused"),
        ("not looked for", "refused"),
    ],
)
def test_only_what_is_confirmed_is_rightly_refused_and_all_is_told(
    judged: RefusalVerdict, expected: str
) -> None:
    said = Said(kind="displace", text="a", target="tin", feasible=True, verdict="refused")
    turn = said.with_finding(Finding(judged, "by a search"))
    text = report([Talk(job=Job(5, 0, 30), turns=(turn,))])
    good = "1 of 1 100.0%" if expected == "rightly refused" else "0 of 1 0.0%"
    assert turn.verdict == expected
    assert good in text
    assert f"refusals judged: {'1 confirmed' if good[0] == '1' else '0 confirmed'}" in text
    assert f"5-0.0 {expected} “a”" in text
    assert f"  {judged}: by a search" in text


def test_without_a_judge_nothing_is_told_of_one() -> None:
    said = Said(kind="displace", text="a", target="tin", feasible=True, verdict="refused")
    assert "judged" not in report([Talk(job=Job(5, 0), turns=(said,))])
