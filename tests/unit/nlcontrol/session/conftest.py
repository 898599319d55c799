"""A conversation in the kitchen, and one whose pushes are played."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from tests.fakes.played_executor import PlayedExecutor, played
from tests.unit.nlcontrol.pushes import Happens


@pytest.fixture
def conversation() -> Conversation:
    """In the kitchen."""
    return Conversation(Controller("kitchen", seed=1))


@pytest.fixture
def stage(
    conversation: Conversation, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> PlayedExecutor:
    """Where every push goes as predicted."""
    return played(conversation.controller, goes())
