"""What comes of a paraphrase: read as the command, refused, or read as something else.

Of typing errors one that is refused where it stands counts as read, since nothing is guessed. A
name that is none of those on the table is refused when it is looked up, so it counts as refused.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import Any, Literal

from grammar import ParseError, parse
from grammar.frames import command as g

Reading = Literal["same", "refused", "differently"]
_MOVING = ("push", "slide", "move", "pull")


def reading(text: str, plain: str, kind: str, names: Collection[str]) -> Reading:
    """What a paraphrase is read as, beside the plain words of the command.

    Args:
        text: the paraphrase.
        plain: the command in plain words, which are read as it is meant.
        kind: of the paraphrase.
        names: of the objects on the table.
    """
    meant = parse(plain).frames
    try:
        frames = parse(text).frames
    except ParseError as error:
        start, end = error.span or (0, len(text))
        wrong = set(re.findall(r"[a-z]+", text)) - set(re.findall(r"[a-z]+", plain))
        located = any(word in text[max(0, start - 20) : end + 20] for word in wrong)
        return "same" if kind == "typing" and located else "refused"
    said = _meaning(frames)
    if said == _meaning(meant):
        return "same"
    if set(re.findall(r"'text': [\"'](.+?)[\"'][,}]", said)) <= {*names, "it", "its"}:
        return "differently"
    return "same" if kind == "typing" else "refused"


def _meaning(frames: Sequence[g.Frame]) -> str:
    """Frames without the places of their words; constraints in any order, moving in any way.

    All things stand on the table, so that "8 cm above the table" is as high as "8 cm".
    """
    plain = []
    for frame in frames:
        dumped = _without_spans(frame.model_dump(exclude_defaults=True))
        dumped["constraints"] = sorted(map(repr, dumped.get("constraints", ())))
        if frame.goal.kind == "lift" and frame.goal.above == "table":
            del dumped["goal"]["above"]
        if dumped.get("action") in _MOVING and frame.goal.kind != "none":
            dumped["action"] = "move"
        plain.append(dumped)
    return repr(plain)


def _without_spans(value: Any) -> Any:
    """A copy without spans, and with quantities to nine digits."""
    if isinstance(value, dict):
        return {k: _without_spans(v) for k, v in sorted(value.items()) if k != "spans"}
    if isinstance(value, list | tuple):
        return [_without_spans(v) for v in value]
    return round(value, 9) if isinstance(value, float) else value
