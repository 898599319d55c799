"""Commands to which signals are sent."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PATIENCE = 60.0
"""Longest time that a command may take to end [s]."""


@dataclass(frozen=True)
class Ending:
    """How a command ended.

    Attributes:
        exit_code: of the command; −9 after SIGKILL.
        document: that it printed; None if there was none.
        error: what it wrote on standard error.
        wall_time: from the last signal to the end [s].
        orphans: processes of its session that were left a little later.
    """

    exit_code: int
    document: dict[str, Any] | None
    error: str
    wall_time: float
    orphans: tuple[str, ...]

    @property
    def code(self) -> str | None:
        """The code of its error, if any."""
        error = (self.document or {}).get("error")
        return error and str(error["code"])


def interrupted(
    arguments: Sequence[str],
    numbers: Sequence[signal.Signals],
    delay: float,
    *,
    folder: Path | None = None,
    after: str = "",
) -> Ending:
    """A command of the program that gets signals.

    Args:
        arguments: of the command.
        numbers: of the signals, a tenth of a second apart.
        delay: until the first one, from when the program takes signals [s].
        folder: in which it runs.
        after: words on standard error that must have come before the delay begins.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "nlcontrol", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        start_new_session=True,
    )
    assert process.stderr is not None
    _wait_until_taken(process)
    told = ""
    while after and after not in told and (line := process.stderr.readline()):
        told += line
    time.sleep(delay)
    sent = time.monotonic()
    for number in numbers:
        if process.poll() is None:
            process.send_signal(number)
            sent = time.monotonic()
            time.sleep(0.1)
    out, error = process.communicate(timeout=PATIENCE)
    wall_time = time.monotonic() - sent
    return Ending(
        process.returncode,
        json.loads(out) if out else None,
        told + error,
        wall_time,
        _left_in_session(process.pid),
    )


def _wait_until_taken(process: subprocess.Popen[str]) -> None:
    """Waits until Python has started and the program has said what signals do."""
    mask = 1 << (signal.SIGTERM - 1)
    while process.poll() is None:
        status = Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
        caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
        if int(caught.split()[1], 16) & mask:
            return
        time.sleep(0.002)


def _left_in_session(session: int) -> tuple[str, ...]:
    """Processes of a session that do not end within seconds."""
    for _ in range(50):
        left = tuple(
            entry.name
            for entry in Path("/proc").iterdir()
            if entry.name.isdigit() and _session_of(entry.name) == session
        )
        if not left:
            return ()
        time.sleep(0.1)
    return left


def _session_of(process: str) -> int | None:
    try:
        return os.getsid(int(process))
    except ProcessLookupError:
        return None
