"""The singular of a noun: "boxes" are a box each."""

from __future__ import annotations

import re

_ENDINGS = ((r"ies$", "y"), (r"(?<=x|h|s|z)es$", ""), (r"(?<!s)s$", ""))


def singular(noun: str) -> str:
    """The singular of a noun by the regular endings; any other as it is."""
    for ending, single in _ENDINGS:
        if re.search(ending, noun, re.IGNORECASE):
            return re.sub(ending, single, noun, flags=re.IGNORECASE)
    return noun
