"""How much of what is drawn at random a run takes."""

from __future__ import annotations

import os

ATTACKS = int(os.environ.get("NLCONTROL_ATTACKS", "300"))
"""Number of generated attacks of a run; `.ci/long` takes 20,000."""

ALL = bool(os.environ.get("NLCONTROL_ALL_EXAMPLES"))


def examples(most: int) -> int:
    """Number of random examples: a quarter in a quick run, all of them in `.ci/long`."""
    return most if ALL else max(10, most // 4)
