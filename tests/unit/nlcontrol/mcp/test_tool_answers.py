"""Answers of tools are short by rule."""

from __future__ import annotations

import json

from nlcontrol.mcp.agent_tools import MOST_BYTES, ForeignNames, ToolAnswer

NAMES = ForeignNames(("mug",))


def size(content: dict[str, object]) -> int:
    return len(json.dumps(content, ensure_ascii=False).encode())


def test_what_does_not_fit_is_left_out_in_whole_parts_and_told() -> None:
    objects = [{"name": f"öbject {i}", "x": i / 3} for i in range(60)]
    answer = ToolAnswer(
        ok=True,
        status="seen",
        message="60 objects " * 100,
        notes=["a note of some length " * 10] * 20,
        numbers={f"number_{i}": i / 7 for i in range(100)},
        say=["push the mug away"],
        from_others=objects,
    )
    short = answer.structured_content(NAMES)
    assert size(short) <= MOST_BYTES
    assert short["say"] == ["push the “mug” away"]
    assert short["left_out"]["notes"] == 20
    kept = len(short.get("from_others", ()))
    assert kept + short["left_out"].get("from_others", 0) == 60
    whole = answer.structured_content(NAMES, detail=True)
    assert len(whole["from_others"]) == 60
    assert "left_out" not in whole


def test_what_is_empty_is_not_told() -> None:
    assert ToolAnswer(ok=True, status="done").structured_content(NAMES) == {
        "ok": True,
        "status": "done",
        "message": "",
    }


def test_the_summary_has_the_number_and_the_sentence_to_say() -> None:
    answer = ToolAnswer(
        ok=False,
        status="refused",
        code="impossible",
        message="the table ends after 694 mm; " + "and so on " * 60,
        say=["push the mug away by 69 cm"],
        suggestions=["up to 690 mm would do"],
    )
    text = answer.summary(NAMES)
    assert text.startswith("refused (impossible): the table ends after 694 mm")
    assert text.endswith("Say instead: push the “mug” away by 69 cm")
    assert len(text) < 340
