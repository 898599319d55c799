"""Words of one refusal; each kind of obstacle has its constructor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from planner.types.refusal import RefusalReason


@dataclass(frozen=True)
class Sentence:
    """Words of a refusal.

    Attributes:
        reason: the kind of obstacle.
        text: one plain sentence with the deciding numbers in it.
        instead: what would be possible, as plain phrases.
        capability: what is missing, if the reason is `unsupported`.
    """

    reason: RefusalReason
    text: str
    instead: tuple[str, ...]
    capability: str | None = None


impossible = partial(Sentence, "impossible")
out_of_reach = partial(Sentence, "out_of_reach")
blocked = partial(Sentence, "blocked")
too_uncertain = partial(Sentence, "too_uncertain")
out_of_time = partial(Sentence, "out_of_time")
too_small = partial(Sentence, "too_small")
unsupported = partial(Sentence, "unsupported")
