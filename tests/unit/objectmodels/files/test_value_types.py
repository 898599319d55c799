"""Names as files may have them."""

from __future__ import annotations

import pytest
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
