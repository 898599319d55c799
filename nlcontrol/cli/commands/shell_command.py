"""`shell`: one sentence after another, at a prompt or line by line from a pipe.

At a terminal lines can be edited, completed and found again, and the exit code is 0. From a pipe
each line is answered in turn, and the exit code is that of the last sentence that failed; a signal
ends the shell with the sentence.
"""

from __future__ import annotations

import io
import signal
import sys
from collections.abc import Iterable
from contextlib import closing
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
from nlcontrol.cli.console.console_output import Detail, print_skipped_with_words
from nlcontrol.cli.console.live_answer import LiveAnswer, detail_options
from nlcontrol.cli.console.prompt_lines import prompt_lines
from nlcontrol.cli.console.robot_stop import exit_code_of, stop_on_signal
from nlcontrol.errors import OK, exception_info
from nlcontrol.interruption import EXIT_CODES

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation
    from nlcontrol.session.executor import Motion

LEAVING = {"exit", "quit", "bye"}
REMARKS = ("again", "a bit more", "no, to the left", "undo that", "why?")
WORDS = ("help", *sorted(LEAVING), "again", "a bit more", "undo that", "why")
"""What the shell completes at the start of a line, besides verbs."""


@click.command(name="shell")
@click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document per line.")
@world_options
@put_option
@time_limit_option
@detail_options
@click.option("--plan-only", is_flag=True, help="Stop before anything is executed.")
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
    """Do one sentence after another.

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
        with closing(
            prompt_lines("nlcontrol> ", controller.cell.names, _line_beginnings())
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
    from nlcontrol.results.step_endings import status_of
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
            "Say what should become of an object, for example",
            *(f"  {example}" for example in examples),
            f"On the table: {_object_list(controller)}.",
            "“exit”, “quit”, “bye” or control-D leave; control-C ends a sentence.",
        )
    )


def _object_list(controller: Controller) -> str:
    return ", ".join(controller.cell.names) or "nothing"


def _line_beginnings() -> tuple[str, ...]:
    from grammar.words.lexicon_plugins import installed_lexicon

    lexicon, _ = installed_lexicon()
    return (*WORDS, *sorted(lexicon.verb_words["VERB"]))
