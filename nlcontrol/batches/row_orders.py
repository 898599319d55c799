"""From the rows of a batch to what is shipped to its workers.

Whatever stands in files of this machine is read here, once: scene files with the models beside
them, and the caller's own models. A worker needs the packages alone.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

from pydantic import ValidationError

from nlcontrol.batches.row_worker import Order, World
from nlcontrol.batches.rows import BatchRow, DrawnScene, RowResult
from nlcontrol.errors import ControlError, ErrorInfo, known_errors_raised
from nlcontrol.installed_versions import library_versions
from nlcontrol.json_document import plain_json
from objectmodels import Registry
from objectmodels.errors import printable
from objectmodels.files.yaml_documents import LIMITS, first_fault
from objectmodels.registry.model_registry import model_document
from sim.truth.scene_file import load_scene

Row = BatchRow | Mapping[str, object] | str | bytes
"""A row, or its JSON."""


def rows_in_file(file: BinaryIO) -> Iterator[bytes]:
    """Lines of a file; of one that is too long, no more than shows that."""
    most = int(LIMITS["batch_row"].most)
    while line := file.readline(most + 1):
        rest = line
        while len(rest) > most and not rest.endswith(b"\n"):
            rest = file.readline(most + 1)
        yield line


class RowOrders:
    """Orders of the rows of a batch.

    Args:
        registry: models, on top of those that are built in.
        folder: to which paths of scene files are relative.
        plan_only: whether nothing is carried out, whatever the rows say.
        brief: whether results are left out of the answers.
    """

    def __init__(
        self, registry: Registry, folder: Path, *, plan_only: bool = False, brief: bool = False
    ) -> None:
        self._registry, self._folder = registry, folder
        self._plan_only, self._brief = plan_only, brief
        self._built_in = {model.name: model for model in Registry.built_in()}
        self._file_world = lru_cache(maxsize=64)(self._read_world)
        self._own_world = self._world_with(registry)

    def orders(self, rows: Iterable[Row]) -> Iterator[Order | RowResult]:
        """Orders of rows, or the result of one that is none; blank lines are passed over."""
        for line, row in enumerate(rows, start=1):
            if not isinstance(row, str | bytes) or row.strip():
                yield self._order(line, row)

    def _order(self, line: int, said: Row) -> Order | RowResult:
        try:
            row = _parse_row(said)
            if self._plan_only:
                row = row.model_copy(update={"execute": False})
            world, place = self._world_of(row.scene)
        except ControlError as raised:
            text = said.decode(errors="replace") if isinstance(said, bytes) else said
            key = _digest(repr(plain_json(text)))
            return RowResult(ok=False, line=line, key=key, status="bad_row", error=raised.info)
        key = _digest(row.model_dump(mode="json"), place, library_versions())
        return Order(line, key, row, world, library_versions(), self._brief)

    def _world_of(self, scene: str | DrawnScene) -> tuple[World, str]:
        """A world as it is shipped, and the digest of all that is in it."""
        if isinstance(scene, str) and Path(scene).suffix in {".yaml", ".yml"}:
            return self._file_world(scene)
        world, place = self._own_world
        return world._replace(scene=scene), place

    def _read_world(self, path: str) -> tuple[World, str]:
        registry = self._registry.copy()
        with known_errors_raised():
            scene = load_scene(self._folder / path)
            for model in scene.models:
                registry.load(model)
        scene = scene.model_copy(update={"models": ()})
        world, place = self._world_with(registry)
        document = scene.model_dump(mode="json", exclude={"defaults"})
        return world._replace(scene=scene), _digest(place, document, asdict(scene.defaults))

    def _world_with(self, registry: Registry) -> tuple[World, str]:
        models = tuple(m for m in registry if self._built_in.get(m.name) != m)
        return World("", models), _digest(*map(model_document, models))


def _parse_row(said: Row) -> BatchRow:
    """A row; raises `bad_row` with the place in it."""
    most = int(LIMITS["batch_row"].most)
    try:
        if isinstance(said, BatchRow):
            return said
        if isinstance(said, str | bytes):
            if len(said) > most:
                raise _bad_row(f"it is longer than {most} bytes", "say less in one row")
            said = json.loads(said)
        return BatchRow.model_validate(said)
    except ValidationError as raised:
        fault = first_fault(raised, BatchRow)
        place = f"{fault.key}: " if fault.key else ""
        hints = fault.suggestions if fault.code == "unknown_key" else ()
        raise _bad_row(place + fault.message, *hints) from raised
    except (ValueError, RecursionError) as raised:
        raise _bad_row(f"this is no JSON document: {raised}") from raised


def _bad_row(message: str, *suggestions: str) -> ControlError:
    known = ", ".join(BatchRow.model_fields)
    return ControlError(
        ErrorInfo(
            code="bad_row",
            message=printable(message[:300]),
            suggestions=suggestions or (f"a row has some of {known}; see docs/batch.md",),
        )
    )


def _digest(*parts: object) -> str:
    text = json.dumps(parts, sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]
