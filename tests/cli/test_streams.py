"""Standard streams that are full, closed or gone: a documented end, and one document at most."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

NLCONTROL = f"'{sys.executable}' -m nlcontrol"


def shell(line: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("to", [">/dev/full", ">&-"])
@pytest.mark.parametrize("option", ["", "--json"])
@pytest.mark.parametrize("sentence", ["push the mug away", "fnord"])
def test_standard_output_that_takes_nothing(to: str, option: str, sentence: str) -> None:
    if to == ">/dev/full" and (sentence, option) == ("fnord", ""):
        pytest.skip("that error goes to standard error")
    done = shell(f"{NLCONTROL} parse '{sentence}' {option} {to}")
    assert done.returncode == 2
    assert "cannot_write" in done.stderr
    assert "→" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_folder_that_is_gone_is_no_stream_that_takes_nothing(tmp_path: Path) -> None:
    done = shell(f"mkdir {tmp_path}/a; cd {tmp_path}/a; rmdir ../a; {NLCONTROL} objects check a:B")
    assert done.returncode == 1
    assert "system_error" in done.stderr


def test_no_stream_at_all() -> None:
    assert shell(f"{NLCONTROL} parse 'push the mug away' <&- >&- 2>&-").returncode == 2


def test_a_reader_that_goes_is_no_failure() -> None:
    # It is gone before the first line, so that no pipe takes all of them in.
    done = shell(f"{NLCONTROL} sample --count 300 | true; echo ${{PIPESTATUS[0]}}")
    assert done.stdout == "0\n"
    assert not done.stderr


def test_a_shell_without_input() -> None:
    done = shell(f"{NLCONTROL} shell --json <&-")
    assert (done.returncode, json.loads(done.stdout)["error"]["code"]) == (2, "usage")


def test_a_backend_that_is_none_draws_a_map_all_the_same(tmp_path: Path) -> None:
    done = shell(f"MPLBACKEND=nonsense {NLCONTROL} map mug --output '{tmp_path}/map.png' --json")
    assert (done.returncode, json.loads(done.stdout)["ok"]) == (0, True)
    assert (tmp_path / "map.png").stat().st_size > 0


SAY = "say 'push the ice tea box 2 cm away'"


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("plan 'push the ice tea box away' --explain --picture", "words.png"),
        ("map mug --output", "map.svg"),
        ("map mug --output", "map.csv"),
        ("map mug --output", "map.json"),
        pytest.param(f"{SAY} --replay", "replay.html", marks=pytest.mark.slow),
        pytest.param(f"{SAY} --trace", "trace.npz", marks=pytest.mark.slow),
    ],
)
def test_a_disk_that_takes_no_more_leaves_no_half_file(
    command: str, name: str, tmp_path: Path
) -> None:
    """The system refuses what goes beyond 1 kB, as a full disk does in the middle of a file."""
    done = shell(f"ulimit -f 1; {NLCONTROL} {command} '{tmp_path}/{name}' --json")
    assert (done.returncode, json.loads(done.stdout)["error"]["code"]) == (2, "cannot_write")
    assert json.loads(done.stdout)["error"]["suggestions"]
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []
