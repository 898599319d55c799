"""Callers who mean harm, and callers who mean nothing: short runs of two benchmarks."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.attacks.schema_fuzzing import fuzz
from benchmarks.attacks.service_attacks import ATTACKS, attacker_of_service
from benchmarks.attacks.tool_attacks import attack_tools
from tests.fakes.counted_executor import FOLDER_VARIABLE


@pytest.mark.slow
def test_nothing_moves_without_a_fresh_plan(tmp_path: Path) -> None:
    with attacker_of_service(tmp_path, seed=0) as attacker:
        attacker.attack(150)
        for attack in ATTACKS:
            if attack.name in ("flood of requests", "more listeners than there may be"):
                attacker.attempt(attack)
        attacker.settle("floods")
        assert attacker.motions() > 0
    tally = attacker.tally
    assert not tally.faults, tally.examples
    assert tally.answers["flood of requests"].keys() == {"ok", "queue_full"}
    assert tally.answers["more listeners than there may be"].keys() == {"ok", "too_many_requests"}


@pytest.mark.slow
def test_no_tool_of_an_agent_moves_anything_without_a_fresh_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
    tally = attack_tools(tmp_path, 50, seed=0)
    assert not tally.faults, tally.examples
    assert tally.answers["tool: fresh plan"]["ok"] > 0


@pytest.mark.slow
def test_answers_are_what_the_document_says() -> None:
    found = fuzz(100, seed=0, briefly=True)
    assert found.passed, found.report
    assert found.requests >= 1000  # most of them at the limits of the fields
