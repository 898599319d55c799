"""The sentences of the test set, and what is read compared, for the benchmarks of the language."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

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


def without_spans(value: Any) -> Any:
    """A copy of frames as data, without where their words stand, and quantities to nine digits."""
    if isinstance(value, dict):
        return {k: without_spans(v) for k, v in sorted(value.items()) if k != "spans"}
    if isinstance(value, list | tuple):
        return [without_spans(v) for v in value]
    return round(value, 9) if isinstance(value, float) else value
