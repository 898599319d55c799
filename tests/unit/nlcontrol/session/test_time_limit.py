"""A limit of the time on the wall ends a search with a code of its own."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from nlcontrol.cli.command_line import cli
from nlcontrol.errors import NO_PLAN, ControlError
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

SENTENCES = ["push the ice tea box away", "could you push the ice tea box away?"]


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_time_limit_ends_a_search(sentence: str) -> None:
    result = Conversation(Controller(time_limit=1e-9)).say(sentence, plan_only=True)
    assert result.status == "refused"
    assert result.error is not None
    assert (result.error.code, result.error.status.exit) == ("time_limit", NO_PLAN)
    assert result.error.numbers["spent"] > result.error.numbers["time_limit"]


def test_a_time_limit_that_suffices_changes_nothing() -> None:
    plans = [
        Conversation(Controller(seed=2, time_limit=limit)).say(SENTENCES[0], plan_only=True).plan
        for limit in (None, 500.0)
    ]
    assert plans[0] is not None
    assert plans[0] == plans[1]


def test_the_command_line_takes_a_limit() -> None:
    options = ["plan", SENTENCES[0], "--time-limit", "1e-9", "--json"]
    found = CliRunner().invoke(cli, options, standalone_mode=False)
    assert found.return_value == NO_PLAN
    assert '"time_limit"' in found.stdout


def test_affordances_take_no_longer_than_the_limit() -> None:
    with pytest.raises(ControlError) as raised:
        Controller(time_limit=1e-9).affordances("ice tea box")
    assert raised.value.code == "time_limit"
