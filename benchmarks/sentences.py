"""The sentences of the test set, for the benchmarks of the language."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import yaml

COMMANDS = Path(__file__).parents[1] / "tests" / "data" / "commands"
REFUSED = frozenset({"refused", "out_of_domain", "typos"})
"""Lists of sentences that are not understood."""


def understood() -> list[str]:
    """The sentences that are understood."""
    return list(_texts(refused=False))


def refused() -> list[str]:
    """The sentences that are refused."""
    return list(_texts(refused=True))


def _texts(*, refused: bool) -> Iterator[str]:
    for path in sorted(COMMANDS.glob("*.yaml")):
        if (path.stem in REFUSED) == refused:
            yield from (case["text"] for case in yaml.safe_load(path.read_text(encoding="utf-8")))
