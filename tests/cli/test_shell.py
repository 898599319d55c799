"""The shell: lines from a pipe, and a terminal with completion and history."""

from __future__ import annotations

import json
import os
import pty
import re
import select
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st

from nlcontrol.cli.commands import shell_command as lines
from nlcontrol.cli.commands.shell_command import command
from nlcontrol.results.result import Result as Answer
from nlcontrol.session.conversation import Conversation
from tests.patience import PATIENCE, wait_until

NAMES = ("ice tea box", "cereal box", "coffee box")


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "nlcontrol" / "history"


def shell(said: str | bytes, *args: str) -> tuple[int, Result]:
    result = CliRunner().invoke(command, ["--plan-only", *args], said, standalone_mode=False)
    assert result.exception is None
    return result.return_value, result


def test_each_line_is_answered(state: Path) -> None:
    status, told = shell("push the ice tea box away\n\n# a remark\nslide the coffee box away")
    assert status == 0
    assert told.stdout.count("I understood:") == 2
    assert "nlcontrol>" not in told.stdout
    assert not state.exists()  # what a pipe says was not typed


@pytest.mark.parametrize("word", ["exit", "Quit", "bye."])
def test_nothing_after_the_word_that_leaves_is_read(word: str) -> None:
    status, told = shell(f"{word}\nfrobnicate")
    assert (status, told.output) == (0, "")


def test_the_exit_code_is_that_of_the_last_sentence_that_failed() -> None:
    status, told = shell(
        "frobnicate it\npush the ice tea box at the top without toppling it\n"
        "push the ice tea box away\n"
    )
    assert status == 4
    assert "unknown_verb" in told.stderr
    assert "Refused" in told.stdout


def test_json_lines() -> None:
    status, told = shell("push the ice tea box away\nhelp\nfrobnicate\n", "--json", "--seed", "3")
    assert status == 3
    first, second = [Answer.model_validate(json.loads(x)) for x in told.stdout.splitlines()]
    assert (first.status, first.seed) == ("planned", 3)
    assert second.status == "not_understood"


def test_a_line_may_be_frames() -> None:
    push = '[{"action": "push", "object": {"text": "coffee box"}, "goal": {"kind": "displace"}}]'
    lines = f'{push}\n[{{"dialogue": "repeat"}}]\npush it away\n[{{"dialogue"\n'
    status, told = shell(lines, "--json")
    *planned, broken = [Answer.model_validate(json.loads(x)) for x in told.stdout.splitlines()]
    assert [result.plan and result.plan.object for result in planned] == ["coffee box"] * 3
    assert (status, broken.status) == (3, "not_understood")
    assert broken.error
    assert broken.error.code == "bad_frame"


def test_help_shows_sentences_and_objects() -> None:
    _, told = shell("help\n", "--scene", "counter")
    assert "push the soup can away" in told.stdout
    assert "soup can, mug, tea tin" in told.stdout


def test_bytes_that_are_no_text_are_answered() -> None:
    status, told = shell(b"push \xff\xfe away\npush the ice tea box away\n")
    assert status == 3
    assert "I understood: push the ice tea box away" in told.stdout


def test_a_defect_ends_the_sentence_and_not_the_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    say = Conversation.say

    def broken(self: Conversation, text: str, **rest: Any) -> Answer:
        if text == "break":
            raise ZeroDivisionError("broken")
        return say(self, text, **rest)

    monkeypatch.setattr(Conversation, "say", broken)
    status, told = shell("break\npush the ice tea box away\n")
    assert status == 1
    assert "ZeroDivisionError: broken" in told.stderr
    assert "Traceback" not in told.output
    assert "I understood: push the ice tea box away" in told.stdout


def test_a_scene_that_cannot_be_read_is_told_before_the_first_line() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "nlcontrol", "shell", "--scene", "kichen"],
        input="", capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (run.returncode, run.stdout) == (2, "")
    assert "unknown_scene" in run.stderr


# --- lines -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "text", "found"),
    [
        ("pu", "pu", ["pull ", "push "]),
        ("undo", "undo", ["undo that "]),
        ("undo th", "th", ["that "]),
        ("push the i", "i", ["ice tea box "]),
        ("push the c", "c", ["cereal box ", "coffee box "]),
        ("push the ice te", "te", ["tea box "]),
        ("push the Ice ", "", ["tea box "]),
        ("push the slice", "slice", []),
        ("push ", "", []),
    ],
)
def test_completions(line: str, text: str, found: list[str]) -> None:
    assert lines.completions(line, text, NAMES, ("pull", "push", "undo that")) == found


@given(st.sampled_from(NAMES), st.data())
def test_any_beginning_of_a_name_can_be_completed(name: str, data: st.DataObject) -> None:
    line = "push the " + name[: data.draw(st.integers(1, len(name)))]
    text = line.rpartition(" ")[2]
    before = line[: len(line) - len(text)]
    found = [before + end for end in lines.completions(line, text, NAMES, ())]
    assert f"push the {name} " in found


def test_the_history_is_the_user_s_own_and_bounded(state: Path) -> None:
    lines.write_history([f"line {i}" for i in range(lines.KEPT)])
    lines.write_history(["the last"])
    assert state.stat().st_mode & 0o777 == 0o600
    assert state.parent.stat().st_mode & 0o777 == 0o700
    kept = lines.read_history()
    assert (len(kept), kept[0], kept[-1]) == (lines.KEPT, "line 1", "the last")
    assert [p.name for p in state.parent.iterdir()] == ["history"]


def test_a_relative_state_folder_is_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", "state")
    assert lines.history_file() == Path.home() / ".local" / "state" / "nlcontrol" / "history"


# --- a terminal ------------------------------------------------------------------------------


# The terminal must be the session's own, or control-C does not arrive.
AT_ITS_TERMINAL = """
import fcntl, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
from nlcontrol.cli import main
main(["shell", "--plan-only"])
"""


class Terminal:
    """A shell at a terminal of its own."""

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        environment = {**os.environ, "TERM": "dumb", "INPUTRC": os.devnull}
        self.process = subprocess.Popen(
            [sys.executable, "-c", AT_ITS_TERMINAL],
            stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True,
        )  # fmt: skip
        os.close(slave)
        self.shown = ""

    def prompt(self) -> str:
        """What is shown until a line can be edited."""
        before = self.until("nlcontrol> ")
        # Until then the terminal itself echoes, and control-C comes before there is a line.
        while termios.tcgetattr(self.master)[3] & termios.ICANON:
            time.sleep(0.01)
        return before

    def waits_for_a_key(self) -> bool:
        """Check whether the shell sleeps."""
        told = Path(f"/proc/{self.process.pid}/stat").read_text()
        return told.rpartition(")")[2].split()[0] == "S"

    def type(self, text: str) -> None:
        os.write(self.master, text.encode())

    def until(self, text: str) -> str:
        """What is shown until a text is."""
        while text not in self.shown:
            ready, _, _ = select.select([self.master], [], [], PATIENCE)
            assert ready, f"{text!r} is not shown, but {self.shown!r}"
            self.shown += os.read(self.master, 4096).decode()
        before, _, self.shown = self.shown.partition(text)
        return before


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    opened = Terminal()
    yield opened
    if opened.process.poll() is None:
        opened.process.kill()
    opened.process.wait()
    os.close(opened.master)


def test_a_terminal_completes_keeps_and_leaves_quietly(terminal: Terminal, state: Path) -> None:
    terminal.prompt()
    terminal.type("push the ice tea b\taway\r")
    assert "ice tea box away" in terminal.until("I understood: push the ice tea box away")
    terminal.prompt()
    terminal.type("push the")
    terminal.until("push the")
    # Python's readline misses a signal between a key and its wait for the next; nobody is so fast.
    wait_until(terminal.waits_for_a_key)
    terminal.type("\x03")  # control-C: the line is dropped, the shell stays
    terminal.prompt()
    terminal.type("frobnicate\r")
    terminal.until("unknown_verb")
    terminal.prompt()
    terminal.type("\x04")
    assert terminal.process.wait(PATIENCE) == 0
    assert [line.rstrip() for line in state.read_text().splitlines()] == [
        "push the ice tea box away",
        "frobnicate",
    ]


def test_earlier_lines_are_found_again(state: Path, terminal: Terminal) -> None:
    terminal.prompt()
    terminal.type("help\r")
    assert re.search("On the table: .*coffee box", terminal.prompt())
    terminal.type("\x10\r")  # control-P: the line before
    assert "push the ice tea box away" in terminal.prompt()
    terminal.type("bye\r")
    assert terminal.process.wait(PATIENCE) == 0
    assert state.read_text().splitlines() == ["help", "bye"]
