"""Rows to carry out: sentences of several kinds over all seeds of a scene, or drawn scenes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice
from typing import Any

SENTENCES = (
    "push the ice tea box away without toppling it",
    "push the mug 7 cm to the left",
    "push the coffee box to the right slowly",
    "turn the ice tea box by 20 degrees",
)
SHORT = "push the mug 3 cm to the left"
"""Carried out in little time."""


def plan_rows(number: int, first_seed: int = 0) -> list[dict[str, Any]]:
    """Rows that are planned: each sentence for each seed, every fifth row in a drawn scene."""
    return list(islice(_plans(first_seed), number))


def _plans(first_seed: int) -> Iterator[dict[str, Any]]:
    for seed in count(first_seed):
        for text in SENTENCES:
            yield {"text": text, "seed": seed, "execute": False}
        scene = {"draw": "table", "seed": seed, "object": "mug"}
        yield {"text": SENTENCES[1], "seed": seed, "scene": scene, "execute": False}


def execution_rows(number: int, first_seed: int = 0) -> list[dict[str, Any]]:
    """Rows that are carried out."""
    return [{"text": SHORT, "seed": first_seed + seed} for seed in range(number)]
