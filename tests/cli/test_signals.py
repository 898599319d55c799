"""Control-C and SIGTERM: always the documented exit, one document, nothing left behind."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from benchmarks.kills.interruptions import Ending, cases, interrupted, run
from nlcontrol.cli.console import robot_stop
from nlcontrol.errors import OK
from nlcontrol.interruption import EXIT_CODES, Interrupted, Signals, Terminated

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")

PUSH = "push the ice tea box away"
MAP = ("map", "ice tea box", "--face", "front", "--experiment", "--workers", "2", "--spacing", "40")


@pytest.fixture(autouse=True)
def terminal() -> Iterator[None]:
    """A terminal whose end is heard, also where the tests were started without one."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


def test_the_end_of_a_terminal_stays_ignored_under_nohup() -> None:
    kept = {number: signal.getsignal(number) for number in EXIT_CODES}
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        Signals().hold()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        Signals().hold()
        assert signal.getsignal(signal.SIGHUP) not in (signal.SIG_IGN, signal.SIG_DFL)
    finally:
        for number, handler in kept.items():
            signal.signal(number, handler)


def ended(arguments: Sequence[str], *others: Any, **options: Any) -> Ending:
    """The ending of a command; another try where it was done before the signal came."""
    for _ in range(10):
        ending = interrupted(arguments, *others, **options)
        if ending.exit_code != OK:
            break
    return ending


@pytest.mark.parametrize("number", EXIT_CODES)
@pytest.mark.parametrize("delay", [0.0, 0.3])
def test_a_command_that_moves_nothing_ends_at_once(number: signal.Signals, delay: float) -> None:
    ending = ended(["plan", PUSH, "--json"], [number], delay)
    assert (ending.exit_code, ending.code) == (EXIT_CODES[number], "interrupted")
    assert "Traceback" not in ending.error


@pytest.mark.slow
def test_a_push_lets_go_first(tmp_path: Path) -> None:
    number = signal.SIGTERM
    say = ["say", PUSH, "--json", "--replay", "run.html"]
    ending = ended(say, [number], 0.3, folder=tmp_path, after="touch:")
    assert (ending.exit_code, ending.code) == (EXIT_CODES[number], "interrupted")
    assert ending.document is not None
    assert ending.document["status"] == "cancelled"
    assert ending.document["execution"]["end"] == "stopped"
    assert "stopping, letting go" in ending.error
    assert "settle" in ending.error
    assert [path.name for path in tmp_path.iterdir()] == ["run.html"]


@pytest.mark.slow
def test_the_second_signal_ends_it_at_once(tmp_path: Path) -> None:
    explore = ["explore", "ice tea box", "--json", "--output", "box.yaml"]
    both = [signal.SIGINT, signal.SIGTERM]
    ending = ended(explore, both, 0.3, folder=tmp_path, after="touch:", at_once=True)
    assert (ending.exit_code, ending.code) == (130, "interrupted")
    assert "settle" not in ending.error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_no_worker_outlives_its_parent(number: signal.Signals, tmp_path: Path) -> None:
    ending = ended([*MAP, "--json"], [number], 0.1, folder=tmp_path, after=" of ")
    assert ending.exit_code in (EXIT_CODES[signal.SIGINT], -signal.SIGKILL)
    assert (ending.orphans, list(tmp_path.iterdir())) == ((), [])


@pytest.mark.slow
def test_random_times() -> None:
    assert [wrong for case in cases(5, seed=1) for wrong in run(case)[1]] == []


def test_a_signal_waits_then_asks_and_then_ends() -> None:
    signals, asked = Signals(), list[str]()
    signals.hold()
    try:
        signal.raise_signal(signal.SIGTERM)
        with pytest.raises(Terminated):
            signals.release()
        with signals.ask_first(lambda: asked.append("please")):
            signal.raise_signal(signal.SIGINT)
            assert (asked, signals.exit_code) == (["please"], 130)
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        signals.ignore()
        signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


IN_EXEC = """
import signal
from nlcontrol.interruption import SIGNALS
SIGNALS.hold()
SIGNALS.release()
try:
    exec("signal.raise_signal(signal.SIGINT)")
except KeyboardInterrupt:
    raise SystemExit(SIGNALS.exit_code)
"""


@pytest.mark.parametrize(
    ("number", "raised"), [(signal.SIGINT, Interrupted), (signal.SIGTERM, Terminated)]
)
def test_a_signal_in_the_midst_of_a_callback_ends_its_event_loop(
    number: signal.Signals, raised: type[BaseException]
) -> None:
    signals = Signals()
    signals.received = [number]

    async def wait() -> None:
        asyncio.get_running_loop().call_soon(signals.end)
        await asyncio.sleep(2.0)  # ends by itself where the signal is lost

    with pytest.raises(raised):
        asyncio.run(wait())


def test_python_does_not_end_by_a_signal_that_was_caught(tmp_path: Path) -> None:
    (tmp_path / "in_exec.py").write_text(IN_EXEC, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "in_exec"], cwd=tmp_path, check=False)
    assert done.returncode == 130


@pytest.mark.parametrize(("moves", "signals"), [(True, 2), (False, 1)])
def test_what_a_library_made_of_a_signal_does_not_count(
    moves: bool, signals: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    signals_of_process = Signals()
    monkeypatch.setattr(robot_stop, "SIGNALS", signals_of_process)
    with pytest.raises(KeyboardInterrupt), robot_stop.stop_on_signal(moves=moves):
        signals_of_process.received += [signal.SIGINT] * signals


@pytest.mark.slow
def test_a_stopped_exploration_tells_what_it_has_found(tmp_path: Path) -> None:
    explore = ["explore", "ice tea box", "--parameters", "mass", "--json", "--output", "box.yaml"]
    ending = ended(explore, [signal.SIGINT], 0.0, folder=tmp_path, after="believed")
    assert (ending.exit_code, ending.code) == (130, "interrupted")
    document = ending.document or {}
    assert (document["ok"], document["saved"]) == (False, None)
    mass = document["parameters"]["mass"]
    assert mass["sd"] < mass["believed_sd"]
    assert f"stopped after {len(document['touches'])} touches" in (tmp_path / "box.yaml").read_text(
        encoding="utf-8"
    )
