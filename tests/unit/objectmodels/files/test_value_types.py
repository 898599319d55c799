"""Names as files may have them."""

from __future__ import annotations

import re
import sys
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from objectmodels.files.yaml_documents import Name

NAMES: TypeAdapter[str] = TypeAdapter(Name)


@pytest.mark.parametrize("name", ["mug", "Kanne für Tee", "box-2"])
def test_names_are_taken_as_they_are(name: str) -> None:
    assert NAMES.validate_python(name) == name


@pytest.mark.parametrize("name", ["", " mug", "a\nb", "-rf", "--json"])
def test_names_that_a_command_would_misread_are_refused(name: str) -> None:
    with pytest.raises(ValidationError):
        NAMES.validate_python(name)


def test_no_character_is_in_a_name_that_cannot_be_seen() -> None:
    """By the categories of Unicode; surrogates are no text."""
    every = [chr(code) for code in range(sys.maxunicode + 1) if not 0xD800 <= code <= 0xDFFF]
    unseen = {
        sign for sign in every if unicodedata.category(sign) in ("Cc", "Cf", "Zl", "Zp", "Zs")
    }
    pattern = re.compile(NAMES.json_schema()["pattern"])
    for sign in every:
        seen = pattern.fullmatch(f"a{sign}b") is not None
        assert seen or not sign.isprintable()
        assert not seen or sign == " " or sign not in unseen


@given(st.text(max_size=4))
def test_what_fits_the_document_is_a_name(text: str) -> None:
    schema = NAMES.json_schema()
    fits = schema["minLength"] <= len(text) and re.fullmatch(schema["pattern"], text) is not None
    if fits:
        assert NAMES.validate_python(text) == text
    else:
        with pytest.raises(ValidationError):
            NAMES.validate_python(text)
