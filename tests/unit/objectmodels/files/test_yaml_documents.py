"""YAML is read to a limit: no tags, no aliases that multiply, nothing that steers a terminal."""

from __future__ import annotations

import pytest

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import parse_yaml
from tests.patience import hang_ended

BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)
TAGS = ["!!int abc", "!!float abc", "!!bool maybe", "!!timestamp x", "!!timestamp 2001-99-99",
        "!!int ''", "!!float ''", "!!float 1:x", "!!set {a}", "!!binary x", "!own 1", "! x",
        "!!python/object:os.system {}", "!!merge x", "!!str 1"]  # fmt: skip


@pytest.mark.parametrize(
    "text",
    [f"mass_kg: {tag}" for tag in TAGS]
    + ["&a [*a]", "a: &a {b: *a}", "a: *b", BOMB, "- " * 10_000 + "x", "[" * 900_000, "{" * 900_000]
    + ['"\\e[31m": 1', "a: \"\\0\"", 'a: "\\u202e"', 'a: "\\x9b"', "a: \u202e", "a: \ud800", "\x00"]
    + ["a: " + "x" * 20_000, "[" + "1," * 20_000 + "]", "a: {b: 1, b: 2}", "? [a]\n: b", "1: 2"],
    ids=lambda text: ascii(text[:20]),
)  # fmt: skip
def test_refused(text: str) -> None:
    with pytest.raises(ModelError) as raised, hang_ended():  # the bomb would take for ever
        parse_yaml(text)
    assert raised.value.code == "bad_yaml"
    assert raised.value.suggestions
    assert raised.value.message.isprintable()
    assert len(raised.value.message) < 300


def test_aliases_are_read_as_long_as_they_are_few() -> None:
    data = parse_yaml("a: &a {x: [1, 2]}\nb: *a\nc: [*a, *a]\n")
    assert data == {"a": {"x": [1, 2]}, "b": {"x": [1, 2]}, "c": [{"x": [1, 2]}] * 2}


def test_text_may_have_lines_and_spaces_of_all_kinds() -> None:
    assert parse_yaml("a: |\n  b\u00a0c\n  μ ≥ 2\nd: '017'\n") == {
        "a": "b\u00a0c\nμ ≥ 2\n",
        "d": "017",
    }


def test_numbers_of_too_many_digits_are_text() -> None:
    assert parse_yaml("[123, 1e3, .inf]") == [123, 1000.0, float("inf")]
    assert parse_yaml("9" * 5000) == "9" * 5000
