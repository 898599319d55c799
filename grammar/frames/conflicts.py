"""Kinds of goals and constraints that cannot be had together.

One table for two readers: a sentence that contradicts itself is refused, and a remark ("no,
gently") takes the place of the constraints that it cannot stand beside.
"""

from __future__ import annotations

FORBIDS: dict[str, frozenset[str]] = {
    "topple": frozenset({"no_topple", "no_tilt", "max_tilt"}),
    "tilt": frozenset({"no_tilt"}),
    "rotate": frozenset({"no_turn"}),
    "lift": frozenset({"no_lift"}),
    "pour": frozenset({"no_tilt"}),
    "upright": frozenset({"no_tilt", "max_tilt"}),
    "displace": frozenset({"no_slide"}),
    "place": frozenset({"no_slide"}),
}
"""Goal → constraints that forbid it, whatever their values are."""

FORBIDS_BELOW: dict[str, tuple[str, str]] = {
    "tilt": ("angle", "max_tilt"),
    "rotate": ("angle", "max_turn"),
    "displace": ("distance", "max_distance"),
}
"""Goal → the field that says how much of it, and the constraint that forbids it below that."""

FORBIDS_EVENT: dict[str, frozenset[str]] = {
    "tips": frozenset({"no_topple", "no_tilt"}),
    "about_to_tip": frozenset({"no_tilt"}),
}
"""Event to stop at → constraints that forbid it."""

EXCLUSIVE: frozenset[tuple[str, str]] = frozenset({
    ("gentle", "hard"), ("slow", "fast"), ("effector", "effector"), ("force", "force"),
    ("speed", "speed"), ("duration", "duration"), ("until", "until"),
})  # fmt: skip
"""Pairs of constraints that exclude each other; a kind beside itself is said with two values."""

ORDERED: frozenset[tuple[str, str]] = frozenset({
    ("force", "max_force"), ("min_force", "force"), ("min_force", "max_force"),
    ("speed", "max_speed"), ("min_speed", "speed"), ("min_speed", "max_speed"),
    ("duration", "max_duration"),
})  # fmt: skip
"""Pairs of constraints of which the first value is at most the second."""

SAME_MATTER: tuple[frozenset[str], ...] = (
    frozenset({"gentle", "hard"}),
    frozenset({"force", "min_force", "max_force", "hard"}),
    frozenset({"speed", "min_speed", "max_speed", "slow", "fast"}),
    frozenset({"duration", "max_duration"}),
)
"""Constraints of one matter: in a remark a new one takes the place of those said before."""

HOW_FAR = frozenset({"max_distance", "until"})
"""Constraints that say how far; in a remark a new distance takes their place."""
