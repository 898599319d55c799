"""Control-C and SIGTERM at random times over `say`, `explore` and `map`.

Each run must end with the exit code of its signal (or as usual, if it was done before), with one
document of code `interrupted`, and leave neither a process nor a file behind. A signal is sent once
the program takes signals: until then they are Python's.
"""

from __future__ import annotations

import collections
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nlcontrol.interruption import EXIT_CODES
from nlcontrol.parallel_tasks import run_all
from tests.patience import PATIENCE

COMMANDS: tuple[tuple[float, tuple[str, ...]], ...] = (
    (8.0, ("say", "push the ice tea box away", "--json", "--replay", "run.html")),
    (12.0, ("say", "lift the mug and set it down", "--json")),
    (30.0, ("explore", "ice tea box", "--trials", "1", "--json", "--output", "box.yaml")),
    (10.0, ("map", "ice tea box", "--face", "front", "--experiment", "--workers", "2",
            "--spacing", "30", "--json", "--output", "map.json")),
)  # fmt: skip
"""Commands, and times within which signals are sent [s]."""

WRITTEN = {"run.html", "box.yaml", "map.json", "map.touches.jsonl"}
"""Files that the commands may leave, each of them whole."""


@dataclass(frozen=True)
class Ending:
    """How a command ended.

    Attributes:
        exit_code: of the command; −9 after SIGKILL.
        document: that it printed; None if there was none.
        error: what it wrote on standard error.
        wall_time: from the last signal to the end [s].
        orphans: processes of its session that do not end.
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
    at_once: bool = False,
) -> Ending:
    """A command of the program that gets signals.

    Args:
        arguments: of the command.
        numbers: of the signals, a tenth of a second apart.
        delay: until the first one, from when the program takes signals [s].
        folder: in which it runs.
        after: words on standard error that must have come before the delay begins.
        at_once: the signals, none of them twice, come while the program is halted.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "nlcontrol", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        start_new_session=True,
    )
    try:
        assert process.stderr is not None
        _wait_until_taken(process)
        told = ""
        while after and after not in told and (line := process.stderr.readline()):
            told += line
        time.sleep(delay)
        sent = time.monotonic()
        if at_once:
            numbers = (signal.SIGSTOP, *numbers, signal.SIGCONT)
        for number in numbers:
            if process.poll() is None:
                process.send_signal(number)
                sent = time.monotonic()
                time.sleep(0.0 if at_once else 0.1)
        out, error = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
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
    """Processes of a session that do not end."""
    end = time.monotonic() + PATIENCE
    while True:
        left = tuple(
            entry.name
            for entry in Path("/proc").iterdir()
            if entry.name.isdigit() and _session_of(entry.name) == session
        )
        if not left or time.monotonic() > end:
            return left
        time.sleep(0.1)


def _session_of(process: str) -> int | None:
    try:
        return os.getsid(int(process))
    except ProcessLookupError:
        return None


@dataclass(frozen=True)
class Case:
    """One run: its command, signals and delay [s]."""

    command: int
    numbers: tuple[signal.Signals, ...]
    delay: float


def cases(runs: int, seed: int) -> list[Case]:
    """Random cases, the commands in turns; every fifth gets a second signal."""
    rng = random.Random(seed)
    drawn = []
    for k in range(runs):
        longest, _ = COMMANDS[k % len(COMMANDS)]
        numbers = (rng.choice(list(EXIT_CODES)),) * (2 if k % 5 == 4 else 1)
        drawn.append(Case(k % len(COMMANDS), numbers, rng.uniform(0.0, longest)))
    return drawn


def run(case: Case) -> tuple[Ending, tuple[str, ...]]:
    """Ending of a case, and what was wrong with it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ending = interrupted(COMMANDS[case.command][1], case.numbers, case.delay, folder=folder)
        left = {path.name for path in folder.iterdir()}
    return ending, tuple(faults(case, ending, left))


def faults(case: Case, ending: Ending, left: set[str]) -> Iterator[str]:
    """Everything about an ending that is not as documented."""
    finished = ending.document is not None and ending.code is None
    allowed = {EXIT_CODES[number] for number in case.numbers}
    if not finished and (ending.exit_code not in allowed or ending.code != "interrupted"):
        yield f"exit {ending.exit_code}, {(ending.document or {}).get('error')}"
    if "Traceback" in ending.error:
        yield "a traceback"
    if ending.orphans:
        yield f"processes {', '.join(ending.orphans)} left"
    if left - WRITTEN:
        yield f"files {', '.join(sorted(left - WRITTEN))} left"


def prove_commands_end(runs: int, seed: int, workers: int | None = None) -> bool:
    """Interrupts commands and prints what came of it; False if an end was not as documented."""
    drawn = cases(runs, seed)
    times: dict[int, list[float]] = collections.defaultdict(list)
    failed, finished = 0, 0
    for case, (ending, wrong) in zip(drawn, run_all(run, drawn, workers=workers), strict=True):
        times[case.command].append(ending.wall_time)
        failed += bool(wrong)
        finished += ending.code is None
        if wrong:
            print(f"{case}: {'; '.join(wrong)}\n{ending.error[-500:]}", flush=True)
    for number, ends in sorted(times.items()):
        told = " ".join(COMMANDS[number][1][:2])
        middle = sorted(ends)[len(ends) // 2]
        print(f"{told}: to the end {middle:.1f} s, at most {max(ends):.1f} s")
    print(f"{len(drawn)} runs, {finished} done before the signal, {failed} not as documented")
    return not failed
