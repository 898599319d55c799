"""Results of experiments, kept in a file of JSON lines, so that a broken run can go on.

The first line names the format and its version, each further one a result with the key of all that
determines it.
Results are added as they come. What a run that was killed left of its last line is ignored, and
overwritten by the next result.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nlcontrol.errors import ControlError, error
from nlcontrol.json_document import SCHEMA_VERSION, is_readable
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import error_of_system, read_bytes
from sim.face_experiment import Contact, TouchResult, Way
from sim.truth.observer import Moved

FORMAT = "touches"

_HEAD = json.dumps({"format": FORMAT, "schema_version": SCHEMA_VERSION}).encode() + b"\n"


class _Line(BaseModel):
    """A result as it stands in the file; what it is the result of is for people."""

    model_config = ConfigDict(defer_build=True, extra="ignore", strict=True, allow_inf_nan=False)

    key: str
    object: str
    face: str
    point: list[float]
    direction: list[float]
    by: Way
    seed: int
    outcome: Moved | None
    force: Annotated[float, Field(ge=0.0)] | None
    detail: str


class Record:
    """Results by key.

    Args:
        path: of the file; it need not exist.

    Raises:
        ControlError: `bad_record` if the file is something else, or damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = _read(path)
        self._size = content.rfind(b"\n") + 1
        _require_head(content, path)
        self._known: dict[str, TouchResult] = {}
        for number, text in enumerate(content[: self._size].splitlines()[1:], start=2):
            line = _parse_line(text, path, number)
            self._known[line.key] = TouchResult(line.outcome, line.force, line.detail)

    @property
    def results(self) -> Mapping[str, TouchResult]:
        """Those known by key, a read-only view."""
        return MappingProxyType(self._known)

    def add(self, key: str, contact: Contact, by: Way, seed: int, result: TouchResult) -> None:
        """Adds a push with its result at the end of the file, by the key of all that decides it."""
        line = _Line(
            key=key,
            object=contact.object,
            face=contact.face,
            point=list(contact.point),
            direction=list(contact.direction),
            by=by,
            seed=seed,
            outcome=result.outcome,
            force=result.force,
            detail=result.detail,
        )
        text = json.dumps(line.model_dump(), ensure_ascii=False, allow_nan=False).encode() + b"\n"
        try:
            with self.path.open("ab") as file:
                file.truncate(self._size)
                file.write(text if self._size else _HEAD + text)
                file.flush()
                os.fsync(file.fileno())
        except OSError as raised:
            raise error_of_system(
                "cannot_write", "cannot be written", self.path, raised
            ) from raised
        self._size += len(text) + (0 if self._size else len(_HEAD))
        self._known[key] = result


def _read(path: Path) -> bytes:
    if not os.path.lexists(path):
        return b""
    try:
        return read_bytes(path, "record_file")
    except ModelError as raised:
        message = f"{raised.path}: {raised.message}"
        raise error("bad_record", message, suggestions=raised.suggestions) from raised


def _require_head(content: bytes, path: Path) -> None:
    """Refuses a file of something else, or of another version."""
    other = ("give another file with --record",)
    version = _version(content.partition(b"\n")[0])
    if version is not None and not is_readable(version):
        message = f"{path} has version {version}, this program reads version {SCHEMA_VERSION}"
        raise error("bad_record", message, suggestions=other)
    if version is None and not _HEAD.startswith(content):
        message = f"{path} is not a record of touches: it does not begin with {_HEAD.decode()!r}"
        raise error("bad_record", message, suggestions=other)


def _version(head: bytes) -> str | None:
    """Version that the first line of a record names; None if it is no such line."""
    try:
        said = json.loads(head)
    except (ValueError, RecursionError):
        return None
    if not isinstance(said, dict) or str(said.get("format")).partition("/")[0] != FORMAT:
        return None
    return str(said.get("schema_version", "1"))


def _parse_line(text: bytes, path: Path, number: int) -> _Line:
    try:
        return _Line.model_validate_json(text)
    except ValidationError as raised:
        raise _damage_error(path, number, raised.errors(include_url=False)[0]) from raised


def _damage_error(path: Path, number: int, fault: Any) -> ControlError:
    where = ".".join(str(part) for part in fault["loc"])
    return error(
        "bad_record",
        f"{path}, line {number}: {f'{where}: ' if where else ''}{fault['msg']}",
        suggestions=("remove that line: its push is then carried out anew", "use another file"),
    )
