"""All that the field of the page offers is understood."""

from __future__ import annotations

import re

import pytest

from grammar.parser import parse
from nlcontrol.service.http.page_routes import page_files

SCRIPT = page_files()["/page/sentence/phrases.js"].content.decode()
RESTS = {"then": " topple it", "and": " topple it"}


def phrases(name: str) -> list[str]:
    listed = re.search(rf"{name} = \[(.*?)\]", SCRIPT, re.DOTALL)
    assert listed is not None
    return re.findall(r'"([^"]+)"', listed[1])


@pytest.mark.parametrize("phrase", phrases("EXAMPLES"))
def test_examples_are_understood(phrase: str) -> None:
    assert parse(phrase.replace("%", "mug")).frames


@pytest.mark.parametrize("phrase", phrases("BEGINNINGS"))
def test_beginnings_are_understood_with_an_object(phrase: str) -> None:
    assert parse(f"{phrase} mug" if phrase.endswith(" the") else phrase).frames


@pytest.mark.parametrize("phrase", phrases("ENDINGS"))
def test_endings_are_understood_behind_a_push(phrase: str) -> None:
    rest = " box" if phrase.endswith(" the") else RESTS.get(phrase, "")
    assert parse(f"push the mug {phrase}{rest}").frames
