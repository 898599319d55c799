"""The page on limits has the table of limits."""

from __future__ import annotations

import re
from pathlib import Path

from objectmodels.files.yaml_documents import LIMITS

PAGE = (Path(__file__).parents[2] / "docs" / "limits.md").read_text(encoding="utf-8")


def test_the_table_is_the_one_in_the_code() -> None:
    rows = [
        f"| {limit.what} | {limit.least:.12g} | {limit.most:.12g} | {limit.unit} |"
        for limit in LIMITS.values()
    ]
    assert re.findall(r"^\| \w.*$", PAGE, re.M) == rows
