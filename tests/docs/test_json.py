"""The guide to the JSON documents: its examples have the form of what is printed."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import BaseModel

from nlcontrol.checks.verdicts import Check
from nlcontrol.cli import run
from nlcontrol.json_document import SCHEMA_VERSION
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types import actions, plan
from planner.types.end_reasons import END_REASONS
from tests.docs.guide_blocks import code_blocks
from tests.plan_conversion import old_document

GUIDE = (Path(__file__).parents[2] / "docs" / "json.md").read_text(encoding="utf-8")
ADDED = {"kind", "task", "committed"}

PLAN = {"status", "aim", "probability", "defaults", "considered", "satisfying", "notes"}
PUSHES = PLAN | {"push", "prediction", "margins", "displacement", "later"}
HANDLING = PLAN | {
    "kind", "action", "object", "grasp", "held", "steps", "prediction", "speed", "clear_of",
}  # fmt: skip


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


def _examples() -> list[Any]:
    blocks = code_blocks(GUIDE, "jsonc")
    return [json.loads(re.sub(r"\s//.*$", "", block, flags=re.MULTILINE)) for block in blocks]


def _form(value: Any) -> Any:
    """Names in a document, without its values; what is left out with “…” has none."""
    if isinstance(value, dict):
        return None if "…" in value else {key: _form(part) for key, part in value.items()}
    return (
        [_form(part) for part in value if isinstance(part, dict)] if isinstance(value, list) else 0
    )


def _shows(example: Any, form: Any) -> bool:
    if isinstance(example, dict) and isinstance(form, dict):
        return list(example) == list(form) and all(_shows(example[k], form[k]) for k in example)
    if isinstance(example, list) and isinstance(form, list):
        return all(_shows(a, b) for a, b in zip(example, form, strict=True))
    return example is None or type(example) is type(form)


def test_a_plan_and_a_result_have_the_form_of_the_examples(kitchen: Controller) -> None:
    (sentence,) = re.findall(r'nlcontrol plan "(.*?)" --json` has', GUIDE)
    plan, guide, result, *_ = _examples()
    printed = json.loads(Conversation(kitchen).say(sentence, plan_only=True).to_json())
    assert _shows(_form(plan), _form(printed["plan"]))
    assert _shows(_form(guide), _form(printed["guide"]))
    assert guide["contact_W"] == pytest.approx(printed["guide"]["contact_W"], abs=1e-4)
    assert _shows(_form(result), _form(printed))
    assert result["text"] == printed["text"]
    assert result["schema_version"] == SCHEMA_VERSION
    assert plan["actions"][0]["stroke"] == printed["plan"]["actions"][0]["stroke"]


def test_a_verdict_has_the_fields_of_the_example() -> None:
    *_, check, _ = _examples()
    assert list(check) == list(Check.model_fields)
    assert Check.model_validate(check).verdict == "unknown"


def test_an_error_has_the_form_of_the_example(capsys: pytest.CaptureFixture[str]) -> None:
    *_, shown = _examples()
    assert run(["parse", shown["text"], "--json"]) == 3
    printed = json.loads(capsys.readouterr().out)
    assert _form(shown) == _form(printed)
    assert shown["error"]["code"] == printed["error"]["code"]


def _kinds() -> dict[str, type[BaseModel]]:
    union, _ = get_args(actions.Action)
    return {kind.model_fields["kind"].default: kind for kind in get_args(union)}


def test_the_table_of_actions_names_every_kind_and_field() -> None:
    table, _, _ = GUIDE.partition("| kind |")[2].partition("\n\n")
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)\|$", table, re.MULTILINE))
    for kind, model in _kinds().items():
        fields = [name for name in model.model_fields if name != "kind"]
        assert re.findall(r"`(\w+)`", rows[kind]) == fields, kind


def test_the_tables_of_guides_name_every_kind_and_field() -> None:
    kinds, _, rest = GUIDE.partition("| guide |")[2].partition("\n\n")
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)\|$", kinds, re.MULTILINE))
    union, _ = get_args(plan.MotionGuide)
    for model in get_args(union):
        fields = [name for name in model.model_fields if name != "kind"]
        assert re.findall(r"`(\w+)`", rows[model.model_fields["kind"].default]) == fields
    ends, _, _ = rest.partition("| when |")[2].partition("\n\n")
    told = re.findall(r"^\| `(\w+)` \|", ends, re.MULTILINE)
    never, _, _ = rest.partition("No guide has ")[2].partition(".")
    untold = set(re.findall(r"`(\w+)`", never))
    assert told == [end for end in END_REASONS if end not in untold]
    assert untold < END_REASONS.keys()


# -- nothing is lost against version 1 ------------------------------------------------------------


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every number, word and null in a document, with the name that it stands under."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(part, key)
    elif isinstance(value, list):
        for part in value:
            yield from _leaves(part, name)
    else:
        yield name, value


@pytest.mark.parametrize(
    ("sentence", "fields"),
    [
        ("push the ice tea box 20 cm away without touching the mug", PUSHES),
        ("push the coffee box to the left until it is next to the ice tea box", PUSHES),
        ("turn the coffee box a quarter turn", PUSHES),
        ("tilt the ice tea box by 5 degrees", PUSHES),
        ("lift the ice tea by 5 cm without touching the mug", HANDLING),
        ("open the ice tea cup", HANDLING),
        ("pour the ice tea into the mug", HANDLING),
    ],
)
def test_a_plan_says_all_that_it_said_in_version_1(
    kitchen: Controller, sentence: str, fields: set[str]
) -> None:
    plan = json.loads(Conversation(kitchen).say(sentence, plan_only=True).to_json())["plan"]
    old = old_document(plan)
    assert set(old) == fields
    said = set(_leaves(old))
    lost = [(name, x) for name, x in _leaves(plan) if (name, x) not in said and x is not None]
    assert {name for name, _ in lost} <= ADDED
