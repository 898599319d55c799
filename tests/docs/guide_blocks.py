"""The blocks of code of a guide."""

from __future__ import annotations

import re

_PROMPT = re.compile(r"^\$ nlcontrol (.*)\n", re.MULTILINE)


def code_blocks(guide: str, language: str) -> list[str]:
    """All blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)


def only_block(guide: str, language: str) -> str:
    """The block of a language that has one."""
    (block,) = code_blocks(guide, language)
    return block


def console_runs(guide: str) -> list[tuple[str, str]]:
    """Each command of the consoles, and what is shown of its answer."""
    found = []
    for block in code_blocks(guide, "console"):
        _, *parts = _PROMPT.split(block)
        found += list(zip(parts[::2], parts[1::2], strict=True))
    return found
