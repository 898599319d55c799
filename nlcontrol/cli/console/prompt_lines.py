"""Lines typed at a prompt: edited, completed, and kept for the next time.

The history is a text file of the user's own, one line each, in the folder for state that the XDG
base directories name.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Generator, Sequence
from pathlib import Path

import click

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import read_bytes, replace_file

KEPT = 1000
"""Lines of history that are kept."""


def history_file() -> Path:
    """File that keeps the history."""
    state = Path(os.environ.get("XDG_STATE_HOME", ""))
    # The specification has relative paths ignored.
    folder = state if state.is_absolute() else Path.home() / ".local" / "state"
    return folder / "nlcontrol" / "history"


def prompt_lines(
    prompt: str, names: Sequence[str], beginnings: Sequence[str]
) -> Generator[str, None, None]:
    """The lines that are typed, until control-D; names and beginnings as for `completions`."""
    try:
        import readline
    except ImportError:  # Windows: lines without completion and history
        yield from _typed_lines(prompt)
        return

    def complete(text: str, state: int) -> str | None:
        line = readline.get_line_buffer()[: readline.get_endidx()]
        found = completions(line, text, names, beginnings)
        return found[state] if state < len(found) else None

    readline.set_completer_delims(" ")
    readline.set_completer(complete)
    libedit = "libedit" in (readline.__doc__ or "")
    readline.parse_and_bind("bind ^I rl_complete" if libedit else "tab: complete")
    # The history is added to line by line here, the same with both libraries.
    readline.set_auto_history(False)
    for line in read_history():
        readline.add_history(line)
    typed: list[str] = []
    try:
        for line in _typed_lines(prompt):
            if line.strip() and [line] != typed[-1:]:
                readline.add_history(line)
                typed.append(line)
            yield line
    finally:
        with contextlib.suppress(
            OSError, ModelError
        ):  # a history that cannot be kept is no reason to fail
            write_history(typed)


def _typed_lines(prompt: str) -> Generator[str, None, None]:
    while True:
        try:
            yield input(prompt)
        except EOFError:
            click.echo()
            return
        except KeyboardInterrupt:
            click.echo()


def completions(line: str, text: str, names: Sequence[str], beginnings: Sequence[str]) -> list[str]:
    """Words that may stand in the place of the last word of a line.

    Args:
        line: up to the cursor.
        text: the word before the cursor, the end of `line`.
        names: of objects, completed over all their words.
        beginnings: words that are completed at the start of a line.
    """
    before = line[: len(line) - len(text)]
    found = []
    if text or not before:
        found = [word for word in beginnings if word.startswith(line.lstrip())]
        # The library replaces the last word alone, and adds no space.
        found = [word[len(before.lstrip()) :] + " " for word in found]
    for name in names:
        said = _length_at_end(name, line)
        if said and (text or said > 1):
            found.append(name[said - len(text) :] + " ")
    return sorted(set(found))


def _length_at_end(name: str, line: str) -> int:
    """Number of characters of a name that a line ends with, begun at the start of a word."""
    for length in range(len(name), 0, -1):
        start = len(line) - length
        if line.casefold().endswith(name[:length].casefold()) and (
            start == 0 or line[start - 1] == " "
        ):
            return length
    return 0


def read_history() -> list[str]:
    """The lines of earlier sessions; none if there are none to be read."""
    try:
        return read_bytes(history_file(), "history_file").decode(errors="replace").splitlines()
    except ModelError:
        return []


def write_history(typed: Sequence[str]) -> None:
    """Add lines to the history, which nobody else may read.

    It is read once more before, since another shell may have written meanwhile, and takes its place
    in one go, so that nobody ever reads half of it.

    Raises:
        OSError, ModelError: it cannot be written.
    """
    if not typed:
        return
    path = history_file()
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    lines = [*read_history(), *typed][-KEPT:]
    with replace_file(path, private=True) as temporary:
        text = "".join(f"{line}\n" for line in lines)
        temporary.write_text(text, encoding="utf-8", errors="replace")
