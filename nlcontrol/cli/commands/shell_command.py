"""`shell`: one sentence after another, at a prompt or line by line from a pipe.

At a terminal lines can be edited, completed and found again, and the exit code is 0. From a pipe
each line is answered in turn, and the exit code is that of the last sentence that failed; a signal
ends the shell with the sentence.
"""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
from collections.abc import Generator, Iterable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import click

from nlcontrol.cli.console.command_options import (
    Placed,
    Settings,
    motion_option,
    open_controller,
    put_option,
    time_limit_option,
    world_options,
)
from nlcontrol.cli.console.console_output import (
    Detail,
    LiveAnswer,
    detail_options,
    print_skipped_with_words,
)
from nlcontrol.cli.console.robot_stop import exit_code_of, stop_on_signal
from nlcontrol.errors import OK, exception_info
from nlcontrol.interruption import EXIT_CODES
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import read_bytes, replace_file

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation
    from nlcontrol.session.executor import Motion


# Lines typed at a prompt: edited, completed, and kept for the next time.
#
# The history is a text file of the user's own, one line each, in the folder for state that the
# XDG base directories name.


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


LEAVING = {"exit", "quit", "bye"}
REMARKS = ("again", "a bit more", "no, to the left", "undo that", "why?")
WORDS = ("help", *sorted(LEAVING), "again", "a bit more", "undo that", "why")
"""What the shell completes at the start of a line, besides verbs."""


@click.command(name="shell")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document per line.")
@world_options
@put_option
@time_limit_option
@detail_options
@click.option("--plan-only", is_flag=True, help="Plan, and execute nothing.")
@motion_option
def command(
    as_json: bool,
    scene: str,
    seed: int,
    settings: Settings,
    put: tuple[Placed, ...],
    time_limit: float | None,
    detail: Detail | None,
    plan_only: bool,
    motion: Motion | None,
) -> int:
    """Carry out one sentence after another.

    Later ones may refer to earlier ones: "push it away", "again", "undo that", "why?".
    """
    from nlcontrol.session.conversation import Conversation

    if sys.stdin is None:
        raise click.UsageError("standard input is closed, so there is no sentence to read")
    if plan_only:
        motion = "never"
    controller = open_controller(scene, seed, settings, time_limit, put)
    print_skipped_with_words(controller.registry.problems)
    conversation = Conversation(controller)
    if sys.stdin.isatty() and sys.stdout.isatty():
        click.echo(
            f"On the table: {_object_list(controller)}. “help” shows examples, “exit” leaves."
        )
        from grammar.words.lexicon_plugins import installed_lexicon

        lexicon, _ = installed_lexicon()
        with closing(
            prompt_lines(
                "nlcontrol> ", controller.cell.names, (*WORDS, *sorted(lexicon.verb_words["VERB"]))
            )
        ) as lines:
            status = _answer_lines(
                conversation, lines, detail, as_json=as_json, motion=motion, at_prompt=True
            )
        return status if status == EXIT_CODES[signal.SIGTERM] else OK
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(errors="replace")  # bytes that are no text end no shell
    return _answer_lines(conversation, sys.stdin, detail, as_json=as_json, motion=motion)


def _answer_lines(
    conversation: Conversation,
    lines: Iterable[str],
    detail: Detail | None,
    *,
    as_json: bool,
    motion: Motion | None,
    at_prompt: bool = False,
) -> int:
    """Answer line after line; return the exit code of the last that failed."""
    status = OK
    for line in lines:
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        word = text.casefold().rstrip(".!")
        if word in LEAVING:
            break
        if word == "help":
            # Standard output carries nothing but documents if they were asked for.
            click.echo(_help_text(conversation.controller), err=as_json)
            continue
        answer = LiveAnswer(detail, as_json=as_json)
        result = _answer_line(conversation, text, motion, answer)
        if as_json:
            click.echo(result.to_json(indent=None))
        else:
            answer.conclude(result)
            click.echo()
        status = exit_code_of(result) or status
        if result.status == "cancelled" and not (at_prompt and status == EXIT_CODES[signal.SIGINT]):
            break
    return status


def _answer_line(
    conversation: Conversation, text: str, motion: Motion | None, answer: LiveAnswer
) -> Result:
    """Result of one sentence, or of frames as JSON, whatever goes wrong."""
    from nlcontrol.results.result import status_of
    from nlcontrol.session.frame_documents import frames_of_json

    try:
        said = frames_of_json(text) if text.startswith(("[", "{")) else text
        with answer, stop_on_signal() as stop:
            return conversation.say(
                said, motion=motion, progress=answer, on_event=answer.take, stop=stop
            )
    except Exception as raised:
        begun, info = conversation.controller.empty_result(text), exception_info(raised)
        return begun.model_copy(update={"error": info, "status": status_of(info)})


def _help_text(controller: Controller) -> str:
    name = controller.cell.names[0] if controller.cell.names else "box"
    examples = (
        f"push the {name} away without toppling it",
        f"push the {name} 5 cm to the left, then topple it",
        f"can you push the {name} at the top?",
        f"what can you do with the {name}?",
        *REMARKS,
    )
    return "\n".join(
        (
            "Say what to do with an object, for example",
            *(f"  {example}" for example in examples),
            f"On the table: {_object_list(controller)}.",
            "“exit”, “quit”, “bye” or control-D leave; control-C ends a sentence.",
        )
    )


def _object_list(controller: Controller) -> str:
    return ", ".join(controller.cell.names) or "nothing"
