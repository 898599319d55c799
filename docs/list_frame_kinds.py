"""Writes the list of kinds in `docs/frames.md`: each with its fields and an example.

    python docs/list_frame_kinds.py

Meanings are those of the JSON schema; the frames of an example are read from its sentence.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from grammar import parse
from grammar.frames.constraints import CONSTRAINTS
from grammar.frames.goals import GOALS
from nlcontrol.json_schema import schema

GUIDE = Path(__file__).resolve().parent / "frames.md"
OPENING = "## Kinds\n"

FRAMES = {
    "a command": "push the mug to the left",
    "`predict`": "will the mug topple if you push it at the top?",
    "`possible`": "can you push the mug away?",
    "`how_hard`": "how hard must you push the mug to make it slide?",
    "`where`": "where must you push the mug to make it slide?",
    "`why`": "why?",
    "`value`": "what is the mass of the mug?",
    "`affordances`": "what can you do with the mug?",
    "`compare`": "is the coffee box heavier than the cereal box?",
    "`capable`": "which of them can you topple?",
    "`seen`": "what do you see?",
    "`did`": "what did you do?",
    "`repeat`": "again",
    "`more`": "a bit more",
    "`same`": "do the same with the coffee box",
    "`reverse`": "the other way",
    "`do`": "do it",
    "`thank`": "thank you",
    "`correct`": "no, the coffee box",
    "`undo`": "undo that",
    "`stop`": "stop",
}
PARTS = {
    "ObjectRef": "push the nearest red box away",
    "RelativeLength": "push the mug away by twice its width",
    "Point": "put the mug to x 0.5 y -0.1",
    "ContactHeight": "push the mug away at 3 cm above the table",
}
GOAL_SENTENCES = {
    "displace": "push the mug away and to the left by at least 10 cm",
    "place": "put the mug 5 cm to the left of the coffee box",
    "rotate": "turn the coffee box to the left by 30 degrees",
    "tilt": "tilt the ice tea box by 5 degrees",
    "topple": "topple the ice tea box",
    "upright": "stand the ice tea box upright",
    "lift": "lift the ice tea by 5 cm",
    "set_down": "set the ice tea down",
    "open": "open the ice tea cup",
    "close": "close the ice tea cup",
    "pour": "pour 50 ml of the ice tea into the mug",
    "hand_over": "hand over the mug",
    "parameters": "find out the mass of the mug",
    "none": "press the ice tea box",
}
CLAUSES = {
    "no_topple": "without toppling it",
    "no_tilt": "without tilting it",
    "no_turn": "without turning it",
    "no_slide": "without sliding it",
    "no_lift": "without lifting it",
    "no_spill": "without spilling it",
    "no_touch": "keeping 5 cm away from the mug",
    "max_tilt": "without tilting it more than 5 degrees",
    "max_turn": "without turning it more than 5 degrees",
    "max_force": "with at most 5 N",
    "min_force": "with at least 2 N",
    "force": "with 6 N",
    "max_speed": "at most 5 cm/s",
    "min_speed": "at least 1 cm/s",
    "speed": "at 3 cm/s",
    "max_duration": "within 10 s",
    "duration": "for 8 s",
    "max_distance": "without moving it more than 10 cm",
    "gentle": "gently",
    "hard": "hard",
    "slow": "slowly",
    "fast": "quickly",
    "contact": "at the bottom from the front",
    "effector": "with two fingers",
    "until": "until it touches the cereal box",
}


def kinds_text() -> str:
    """The list, in Markdown."""
    return "\n".join(_lines())


def _lines() -> Iterator[str]:
    definitions: Any = schema()["$defs"]
    yield from ("", "### A frame", "", *_fields(definitions["Frame"]), "")
    for name, sentence in FRAMES.items():
        yield f"- {name}: “{sentence}” {_code(_frame(sentence))}"
    yield from ("", "### Objects, lengths and places", "")
    for name, sentence in PARTS.items():
        yield from (f"**{name}**: {definitions[name]['description']} As in “{sentence}”:", "")
        yield from (_code(_frame(sentence)), "", *_fields(definitions[name]), "")
    yield from ("### Goals", "")
    for kind, cls in GOALS.items():
        sentence, name = GOAL_SENTENCES[kind], cls.__name__
        own = definitions.get(name) or definitions[f"grammar__frames__goals__{name}"]
        yield from (f"**`{kind}`**: {own['description']} “{sentence}”", "")
        yield from (_code(_frame(sentence)), "")
        yield from _list(own)
    told = definitions["MaxForce"]["properties"]["value"]["description"]
    yield from ("### Constraints", "", f"Where there is a `value`, it is {told}", "")
    for kind, of_kind in CONSTRAINTS.items():
        verb = "tilt" if kind == "no_slide" else "push"
        sentence, own = f"{verb} the ice tea box {CLAUSES[kind]}", definitions[of_kind.__name__]
        found = _frame(sentence)["constraints"]
        yield from (f"**`{kind}`**: {own['description']} “{sentence}” {_code(found[0])}", "")
        yield from _list(own, ("value",))


def _list(part: dict[str, Any], told: tuple[str, ...] = ()) -> list[str]:
    """The fields with an empty line behind them; nothing if there are none."""
    fields = list(_fields(part, told))
    return [*fields, ""] if fields else []


def _fields(part: dict[str, Any], told: tuple[str, ...] = ()) -> Iterator[str]:
    for key, field in part["properties"].items():
        if key not in ("kind", "spans", *told):
            values = [v for option in (field, *field.get("anyOf", ())) for v in _values(option)]
            one_of = f" One of {', '.join(f'`{value}`' for value in values)}." if values else ""
            yield f"- `{key}`: {field['description'].rstrip('.')}.{one_of}"


def _values(option: dict[str, Any]) -> list[str]:
    found: list[str] = option.get("enum") or option.get("items", {}).get("enum", [])
    return found


def _frame(sentence: str) -> Any:
    """The one frame of a sentence as it may be written by hand."""
    (frame,) = parse(sentence).frames
    return _without_what_is_open(frame.model_dump(mode="json"))


def _without_what_is_open(value: Any) -> Any:
    if isinstance(value, list):
        return [_without_what_is_open(part) for part in value]
    if not isinstance(value, dict):
        return value
    nothing = (None, [], False, "", "exact", {"kind": "none", "spans": []})
    return {
        key: _without_what_is_open(part)
        for key, part in value.items()
        if key != "spans" and part not in nothing
    }


def _code(value: Any) -> str:
    return f"`{json.dumps(value)}`"


if __name__ == "__main__":
    kept = GUIDE.read_text("utf-8").partition(OPENING)[0]
    GUIDE.write_text(f"{kept}{OPENING}{kinds_text()}", "utf-8")
