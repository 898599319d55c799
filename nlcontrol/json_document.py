"""The form that all JSON documents of the program share: a version, and whether all went well.

A later minor version adds fields, and old readers go on. A later major one renames or removes some.
"""

from __future__ import annotations

import inspect
import json
import math
import re
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, field_validator

from objectmodels.short_repr import ShortRepr

SCHEMA_VERSION = "3.0"
"""Version of the form; documents that bear none are of version 1."""


def document_text(content: Mapping[str, Any], indent: int | None = 2) -> str:
    """Document as text; on one line if `indent` is None."""
    document = {"schema_version": SCHEMA_VERSION, "ok": True, **content}
    return json.dumps(document, indent=indent, ensure_ascii=False, allow_nan=False)


def finite_or_none(value: float) -> float | None:
    """The number as JSON has it: None if it is infinite or not a number."""
    return float(value) if math.isfinite(value) else None


def plain_json(part: Any) -> Any:
    """The part as JSON has it, with all the documents in it."""
    if isinstance(part, BaseModel):
        return part.model_dump(mode="json")
    if isinstance(part, Mapping):
        return {key: plain_json(value) for key, value in part.items()}
    if isinstance(part, list | tuple):
        return [plain_json(each) for each in part]
    return part


def docstring_parts(docstring: str) -> tuple[str, dict[str, str]]:
    """The text of a docstring before its sections, and what it says of each attribute."""
    summary, _, rest = inspect.cleandoc(docstring).partition("\n\nAttributes:\n")
    found = re.findall(r"^    ([\w, ]+): (.*(?:\n {8}.*)*)", rest, re.MULTILINE)
    described = {
        name: " ".join(said.split()) for names, said in found for name in names.split(", ")
    }
    return summary, described


class DocumentPart(ShortRepr):
    """Part of a document: nothing unknown, nothing changed later, and finite numbers."""

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Document(ShortRepr):
    """Answer that programs save and read back.

    Attributes:
        schema_version: of the form in which it stands.
    """

    model_config = ConfigDict(defer_build=True, frozen=True)

    schema_version: str = SCHEMA_VERSION

    @field_validator("schema_version")
    @classmethod
    def _require_same_major(cls, version: str) -> str:
        if not is_readable(version):
            raise ValueError(f"version {version}; this program reads version {SCHEMA_VERSION}")
        return version


def is_readable(version: str) -> bool:
    """True if this program reads what was saved under a version: under the same major one."""
    return version.partition(".")[0] == SCHEMA_VERSION.partition(".")[0]
