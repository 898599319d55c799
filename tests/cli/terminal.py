"""Commands in a terminal of so many columns, and what stands there at the end.

    python -m tests.cli.terminal

writes the golden files of `tests/data/terminal` anew: look at the difference before it is kept.
Colours are told as their numbers, `<32>` for green, `<1>` for bold, `<0>` for none.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios
from pathlib import Path

GOLDEN = Path(__file__).parents[1] / "data" / "terminal"

COMMANDS = {
    "plan": ("plan", "push the ice tea box away without toppling it"),
    "refusal": ("plan", "push the ice tea box away at the top without toppling it"),
    "affordances": ("affordances", "mug"),
    "object": ("objects", "show", "ice tea box"),
    "defaults": ("defaults", "place"),
    "say": ("say", "-v", "push the mug 3 cm to the left, then push it away"),
}
"""Commands with a golden file at 80 columns, by its name."""


def in_terminal(*args: str, columns: int = 80, **environment: str) -> tuple[int, str]:
    """Exit code of a command, and the text that its terminal shows at the end."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    unset = ("COLUMNS", "NO_COLOR", "FORCE_COLOR")
    kept = {name: value for name, value in os.environ.items() if name not in unset}
    process = subprocess.Popen(
        [sys.executable, "-m", "nlcontrol", *args],
        stdin=theirs, stdout=theirs, stderr=theirs,
        env=kept | {"TERM": "xterm"} | environment,
    )  # fmt: skip
    os.close(theirs)
    told = b""
    try:
        while part := os.read(ours, 65536):
            told += part
    except OSError:  # the other end is closed
        pass
    os.close(ours)
    return process.wait(), shown(told.decode())


def shown(told: str) -> str:
    """The text that stands in a terminal after all this was written, with times left out."""
    lines = [""]
    row = 0
    for part in re.findall(r"\x1b\[[0-9;?]*[a-zA-Z]|\n|[^\x1b\n]+", told.replace("\r", "")):
        if part == "\n":
            row += 1
            lines += [""] * (row + 1 - len(lines))
        elif part == "\x1b[1A":
            row -= 1
        elif part == "\x1b[2K":
            lines[row] = ""
        elif part.endswith("m") and part.startswith("\x1b"):
            lines[row] += f"<{part[2:-1]}>"
        elif not part.startswith("\x1b"):
            lines[row] += part
    text = "\n".join(line.rstrip() for line in lines).rstrip() + "\n"
    return re.sub(r"wall +\d+\.\d s", "wall … s", text)


def main() -> None:
    """Write the golden files."""
    for name, args in COMMANDS.items():
        (GOLDEN / f"{name}.txt").write_text(in_terminal(*args)[1], "utf-8")


if __name__ == "__main__":
    main()
