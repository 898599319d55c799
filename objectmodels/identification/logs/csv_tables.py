"""Tables of measurements in CSV files, read so that every mistake names its row and column.

Separated by commas, or by semicolons (a decimal comma is then a decimal point), in UTF-8. The first
line that is neither blank nor a comment (#) names the columns. Rows are counted as an editor
counts lines.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from objectmodels.errors import ModelError, suggest
from objectmodels.files.file_reading import read_text
from objectmodels.files.limits import LIMITS

LARGEST = 1e9
"""Larger numbers are not measurements; formulae would overflow with some."""

_GUIDE = "docs/fitting.md explains the columns"

_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        file: the file's name.
        number: line of the file, from 1 on.
        cells: by column, without white space around them.
        decimal_comma: whether a comma in a number is a decimal point.
    """

    file: str
    number: int
    cells: Mapping[str, str]
    decimal_comma: bool = False

    def error(self, column: str, message: str, *suggestions: str) -> ModelError:
        """An error about one of its cells."""
        where = f"{self.file}: row {self.number}: {column}"
        return ModelError("bad_data", message, path=where, suggestions=suggestions or (_GUIDE,))

    def text(self, column: str) -> str:
        """Text in a column; empty if the table has no such column."""
        return self.cells.get(column, "")

    def number_or_none(self, column: str) -> float | None:
        """The number in a column, None if there is none.

        Raises:
            ModelError: `bad_data` if it is not a finite number.
        """
        text = self.text(column)
        if not text:
            return None
        plain = text.replace(",", ".") if self.decimal_comma else text
        value = float(plain) if _NUMBER.fullmatch(plain) else math.nan
        if not abs(value) <= LARGEST:
            expected = f"expected a finite number, at most {LARGEST:g} in size"
            raise self.error(column, f"found {short_quote(text)}, {expected}")
        return value

    def value(self, column: str) -> float:
        """The number that must stand in a column.

        Raises:
            ModelError: `bad_data` if there is none, or it is not a finite number.
        """
        value = self.number_or_none(column)
        if value is None:
            raise self.error(column, "is required here, but empty")
        return value

    def vector(self, columns: tuple[str, str, str]) -> tuple[float, float, float]:
        """The numbers that must stand in three columns; raises as `value` does."""
        x, y, z = map(self.value, columns)
        return (x, y, z)


@dataclass(frozen=True)
class Table:
    """A table of at least one row.

    Attributes:
        file: the file's name.
        columns: their names.
        rows: in the order of the file.
    """

    file: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]

    def error(self, message: str, *suggestions: str) -> ModelError:
        """An error about the table as a whole."""
        return ModelError("bad_data", message, path=self.file, suggestions=suggestions or (_GUIDE,))

    def require_columns(self, columns: tuple[str, ...], known: tuple[str, ...]) -> None:
        """Checks that it has the columns it must have, and no unknown ones.

        Raises:
            ModelError: `bad_data`; what is missing is often there, misspelt.
        """
        for column in self.columns:
            if column not in known:
                near = suggest(column, known)
                hints = tuple(f"did you mean '{name}'?" for name in near[:1])
                raise self.error(
                    f"{short_quote(column)} is not a column of such a file",
                    *(hints or (f"known: {', '.join(known)}",)),
                )
        missing = [column for column in columns if column not in self.columns]
        if missing:
            raise self.error(
                f"lacks the column{'s' * (len(missing) > 1)} {', '.join(missing)}",
                f"it has: {', '.join(self.columns)}",
            )


def read_table(path: Path) -> Table:
    """Reads a CSV file.

    Raises:
        ModelError: `unreadable_file`; `bad_data` if it is no table, or has no rows.
    """
    lines = _numbered_lines(path)
    if not lines:
        raise ModelError("bad_data", "holds no table", path=str(path), suggestions=(_GUIDE,))
    separator = ";" if ";" in lines[0][1] else ","
    (first, header), *rest = ((n, _line_cells(path, n, line, separator)) for n, line in lines)
    most = int(LIMITS["data_columns"].most)
    if len(header) > most:
        raise _too_large(f"{path}: row {first}", f"{len(header)} columns, at most {most}", _GUIDE)
    columns = tuple(" ".join(name.casefold().split()) for name in header)
    odd = next((name for name in columns if not name or columns.count(name) > 1), None)
    if odd is not None:
        what = f"the column {short_quote(odd)} is given twice" if odd else "a column has no name"
        hint = "give each column a name of its own"
        raise ModelError("bad_data", what, path=f"{path}: row {first}", suggestions=(hint,))
    rows = []
    for number, cells in rest:
        if not any(cells):
            continue  # spreadsheets write blank rows so
        if len(cells) != len(columns):
            raise ModelError(
                "bad_data",
                f"has {len(cells)} cells, the header {len(columns)}",
                path=f"{path}: row {number}",
                suggestions=("separate them by commas, or all by semicolons",),
            )
        rows.append(
            Row(str(path), number, dict(zip(columns, cells, strict=True)), separator == ";")
        )
    table = Table(str(path), columns, tuple(rows))
    if not rows:
        raise table.error("has no rows below its header", _GUIDE)
    return table


def short_quote(text: str) -> str:
    """A text in quotes, cut if it is long."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _numbered_lines(path: Path) -> list[tuple[int, str]]:
    """The lines with something in them, and their numbers."""
    text, most = read_text(path, "data_file"), int(LIMITS["data_rows"].most)
    if text.count("\n") + text.count("\r") > 2 * most:  # before they are cut apart
        raise _too_large(path, f"more than {most} lines", "cut it into several files")
    lines = [
        (number, line)
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) > most:
        raise _too_large(path, f"{len(lines)} rows, at most {most}", "cut it into several files")
    return lines


def _too_large(path: Path | str, what: str, hint: str) -> ModelError:
    return ModelError("bad_data", f"has {what}", path=str(path), suggestions=(hint,))


def _line_cells(path: Path, number: int, line: str, separator: str) -> list[str]:
    try:
        (cells,) = csv.reader([line], delimiter=separator, strict=True)
    except csv.Error as error:
        raise ModelError(
            "bad_data",
            f"is not CSV: {error}",
            path=f"{path}: row {number}",
            suggestions=("text with a comma in it stands in quotes, closed in the same line",),
        ) from error
    return [cell.strip() for cell in cells]
