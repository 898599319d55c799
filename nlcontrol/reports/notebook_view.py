"""A result as a notebook shows it: sentence, verdicts, picture of the words, report."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from nlcontrol.reports.result_report import check_line, report
from nlcontrol.reports.word_explanation import save_explanation

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

# Okabe and Ito's colours, which people with colour blindness tell apart.
_HELD, _MISSED, _GREY = "#00805C", "#C1121F", "#7A7A7A"


def result_html(result: Result) -> str:
    """The result as a fragment of HTML that loads nothing from elsewhere."""
    return "\n".join(_fragments(result))


def _fragments(result: Result) -> Iterator[str]:
    colour = _HELD if result.ok else _GREY if result.status == "undecided" else _MISSED
    yield '<div style="max-width: 60em">'
    yield (
        f'<p><b style="color: {colour}">{escape(result.status.replace("_", " "))}</b> '
        f'<span style="color: {_GREY}">“{escape(result.text)}”</span></p>'
    )
    if result.answer:
        yield f"<p>{escape(result.answer.text)}</p>"
    if result.error:
        yield f"<p>{escape(result.error.code)}: {escape(result.error.message)}</p>"
        yield from (f"<p>→ {escape(hint)}</p>" for hint in result.error.suggestions)
    if result.checks:
        yield '<ul style="list-style: none; padding-left: 0">'
        for check in result.checks:
            mark = {"held": _HELD, "not_held": _MISSED, "unknown": _GREY}[check.verdict]
            yield f'<li style="color: {mark}">{escape(check_line(result.text, check).strip())}</li>'
        yield "</ul>"
    if result.frames:
        yield f'<img alt="words and parameters" style="width: 100%" src="{_picture(result)}">'
    yield '<details open><summary>report</summary><pre style="white-space: pre-wrap">'
    yield f"{escape(report(result))}</pre></details>"
    yield "</div>"


def _picture(result: Result) -> str:
    """The explanation of the words as an address that holds the picture itself."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "words.svg"
        save_explanation(result, path)
        return f"data:image/svg+xml;base64,{base64.b64encode(path.read_bytes()).decode()}"
