"""The guide to watching and stopping says what the program does."""

from __future__ import annotations

import re
from pathlib import Path

from nlcontrol.interruption import EXIT_CODES
from nlcontrol.session.events import KINDS, Event

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "watching.md").read_text(encoding="utf-8")


def test_table_of_kinds() -> None:
    events, _, _ = GUIDE.partition("## Stopping")
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \| (.*?) ?\|$", events, re.M)
    assert [(kind, when, field) for kind, when, field in rows] == [
        (kind, *meaning) for kind, meaning in KINDS.items()
    ]


def test_fields_of_an_event_are_told() -> None:
    assert all(f"`{name}`" in GUIDE for name in Event.model_fields)


def test_exit_codes_are_told() -> None:
    for code in EXIT_CODES.values():
        assert str(code) in GUIDE
        assert str(code) in (ROOT / "docs" / "command_line.md").read_text(encoding="utf-8")
