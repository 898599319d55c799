"""`say`, `plan` and `parse`: what is done with a sentence."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
    FILE,
    Command,
    Detail,
    LiveAnswer,
    columns_of,
    detail_options,
    json_option,
    print_answer,
    print_error,
    print_json,
    print_lines,
    print_skipped_with_words,
    require_writable,
)
from nlcontrol.cli.console.robot_stop import exit_code_of, stop_on_signal
from nlcontrol.errors import ControlError
from objectmodels.files.yaml_documents import replace_file

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Motion
    from nlcontrol.session.frame_documents import Frames


_explain = click.option("--explain", is_flag=True, help="Show which words became which parameters.")
_picture = click.option(
    "--picture",
    type=FILE,
    help="Draw the run (PNG or GIF) or the plan; with --explain, the explanation; for a question "
    "about places, the outcome map (PNG, SVG or PDF).",
)


def _sentence_options(command: Command) -> Command:
    for option in (
        _picture,
        _explain,
        time_limit_option,
        put_option,
        world_options,
        detail_options,
        json_option,
    ):
        command = option(command)
    return _said_options(command)


def _said_options(command: Command) -> Command:
    """Add the task, as `sentence` or `frames`."""
    frames = click.option(
        "--frames",
        type=click.Path(dir_okay=False, path_type=Path, allow_dash=True),
        help="Read frames (JSON, docs/frames.md) instead of a sentence; - is standard input.",
    )
    return click.argument("sentence", nargs=-1)(frames(command))


def _said(words: tuple[str, ...], frames: Path | None) -> str | Frames:
    """The task: a sentence, in quotes or as several words, or the frames of a file."""
    if frames is not None and words:
        raise click.UsageError("give SENTENCE or --frames, not both")
    if frames is not None:
        from nlcontrol.session.frame_documents import read_frames

        found: Frames = read_frames(frames)
        return found
    if not words:
        raise click.UsageError("Missing argument 'SENTENCE'; or give --frames.")
    return " ".join(words)


@click.command()
@_sentence_options
@click.option("--plan-only", is_flag=True, help="Plan, and execute nothing.")
@click.option("--replay", type=FILE, help="Save a replay of the run as one HTML file.")
@click.option("--trace", type=FILE, help="Save the trace as arrays (npz).")
@click.option("--bundle", type=FILE, help="Save the whole run in one file, which `rerun` repeats.")
@motion_option
def say(
    plan_only: bool,
    motion: Motion | None,
    replay: Path | None,
    trace: Path | None,
    bundle: Path | None,
    **options: Any,
) -> int:
    """Carry out SENTENCE in simulation, and check every clause.

    Questions are answered.
    """
    if plan_only:
        motion = "never"
    of_run = {"replay": replay, "trace": trace, "bundle": bundle}
    for kind, path in of_run.items():
        if motion == "never" and path:
            raise click.UsageError(f"--{kind} needs a run; leave out --plan-only")
    return _answer_sentence(**options, motion=motion, of_run=of_run)


@click.command()
@_sentence_options
def plan(**options: Any) -> int:
    """Plan SENTENCE, and move nothing.

    A plan states the contact, the largest force and the predicted outcome.
    """
    return _answer_sentence(**options, motion="never", of_run={})


@click.command()
@_said_options
@json_option
def parse(sentence: tuple[str, ...], frames: Path | None, as_json: bool) -> int:
    """Read SENTENCE, and print it as frames.

    With --frames, check that they make sense.
    """
    from grammar.parser import default_parser
    from nlcontrol.reports.result_report import understanding_lines
    from nlcontrol.session.frame_documents import command_of, text_of
    from nlcontrol.text_format import frame_lines

    said = _said(sentence, frames)
    print_skipped_with_words()
    try:
        command = command_of(said, default_parser())
    except ControlError as raised:
        print_error(raised.info, as_json=as_json, text=None if frames else text_of(said))
        return raised.info.status.exit
    lines = [*understanding_lines(command.paraphrase, command.left_out)]
    for number, frame in enumerate(command.frames, start=1):
        lines += [f"{number}."] if len(command.frames) > 1 else []
        lines += frame_lines(frame, command.text)
    return print_answer(command.model_dump(mode="json"), lines, as_json=as_json)


def _require_names(
    ctx: click.Context, param: click.Parameter, nouns: tuple[str, ...]
) -> tuple[str, ...]:
    for noun in nouns:
        if re.fullmatch(r"\w[\w' -]*", noun) is None:
            message = f"{noun!r} is no name: letters, digits, blanks and hyphens make one"
            raise click.BadParameter(message, ctx, param)
    return nouns


@click.command()
@click.option(
    "--count", default=10, show_default=True, type=click.IntRange(1), help="Number of sentences."
)
@click.option(
    "--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the random words."
)
@click.option(
    "--noun",
    "nouns",
    multiple=True,
    callback=_require_names,
    help="Object name to use. May be repeated.",
)
@json_option
def sample(count: int, seed: int, nouns: tuple[str, ...], as_json: bool) -> int:
    """Make up random sentences, each with its frames."""
    from itertools import islice

    from grammar.paraphrasing.sentence_sampler import NOUNS, random_sentences
    from grammar.words.lexicon_plugins import installed_lexicon

    lexicon, _ = installed_lexicon()
    print_skipped_with_words()
    made = list(islice(random_sentences(seed, lexicon=lexicon, nouns=nouns or NOUNS), count))
    rows = [
        {"text": one.text, "frames": [frame.model_dump(mode="json") for frame in one.frames]}
        for one in made
    ]
    return print_answer({"sentences": rows}, [one.text for one in made], as_json=as_json)


def _answer_sentence(
    *,
    sentence: tuple[str, ...],
    frames: Path | None,
    scene: str,
    seed: int,
    settings: Settings,
    put: tuple[Placed, ...],
    time_limit: float | None,
    as_json: bool,
    detail: Detail | None,
    explain: bool,
    picture: Path | None,
    motion: Motion | None,
    of_run: Mapping[str, Path | None],
) -> int:
    """Carry out, plan or answer a sentence, write its files and print the result."""
    from nlcontrol.session.conversation import Conversation

    wanted = {**of_run, "picture": picture}
    for path in wanted.values():
        require_writable(path)
    said = _said(sentence, frames)
    controller = open_controller(scene, seed, settings, time_limit, put)
    print_skipped_with_words(controller.registry.problems)
    told: list[Event] = []
    with (
        LiveAnswer(detail, as_json=as_json) as answer,
        stop_on_signal(moves=motion != "never") as stop,
    ):

        def take(event: Event) -> None:
            answer.take(event)
            if wanted.get("bundle"):
                told.append(event)

        result = Conversation(controller).say(
            said, motion=motion, progress=answer, on_event=take, stop=stop
        )
    files = _write_files(controller, result, wanted, explain=explain, told=told)
    result = result.model_copy(
        update={"files": files, "explanation": result.explanation_rows() if explain else None}
    )
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        answer.conclude(result)
        print_lines(_further_lines(result, files, explain=explain))
    return exit_code_of(result)


def _further_lines(result: Result, files: Mapping[str, str], *, explain: bool) -> Iterator[str]:
    """Lines below the answer: where its words went, and the files that were written."""
    if explain and (rows := result.explanation_rows()):
        from nlcontrol.reports.word_explanation import WIDTH, table

        yield ""
        yield table(rows, width=columns_of() or WIDTH)
    yield from (f"{what.capitalize()}: {where}" for what, where in files.items())


def _write_files(
    controller: Controller,
    result: Result,
    wanted: Mapping[str, Path | None],
    *,
    explain: bool,
    told: Sequence[Event],
) -> dict[str, str]:
    """Write the files that were asked for, as far as the sentence got."""
    files: dict[str, str] = {}
    for what, path in wanted.items():
        if path is None:
            continue
        if save := _writer(controller, result, what, explain=explain, told=told):
            with replace_file(path) as temporary:
                save(temporary)
            files[what] = str(path)
    return files


def _writer(
    controller: Controller, result: Result, what: str, *, explain: bool, told: Sequence[Event]
) -> Callable[[Path], None] | None:
    """Function that writes a file of some kind about a result; None if there is nothing to show."""
    answer = result.answer
    if what == "picture" and explain and result.frames:
        from nlcontrol.reports.word_explanation import save_explanation

        return partial(save_explanation, result)
    if what == "bundle":
        from nlcontrol.service.bundle import bundle_run
        from nlcontrol.service.documents import NumberedEvent

        events = [NumberedEvent(number=n, event=event) for n, event in enumerate(told, start=1)]
        return partial(bundle_run, controller, result, events=events)
    if result.trace and what == "trace":
        return result.trace.save
    if result.trace:
        from nlcontrol.reports.replay_story import replay_story
        from sim import save_picture, save_replay
        from sim.simulated_executor import simulation

        scene = simulation(controller.executor).scene
        if what == "replay":
            return partial(save_replay, result.trace, scene, story=replay_story(result))
        return partial(save_picture, result.trace, scene, title=result.text)
    if what == "picture" and answer and answer.chart and answer.map:
        from nlcontrol.outcome_maps.outcome_map_drawing import save_map

        return partial(save_map, answer.map, answer.chart.face)
    state = controller.last_look.state
    if what == "picture" and result.plan and state is not None:
        from nlcontrol.reports.plan_drawing import save_plan

        return partial(save_plan, result, state)
    return None
