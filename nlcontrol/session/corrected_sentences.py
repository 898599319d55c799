"""Whole sentences in place of one that was refused or not understood, by what its error suggests.

A suggestion is a phrase for people: "up to 690 mm would do". Here it becomes the remark that a
person would make ("no, 690 mm"), is put into the frames as a conversation does that, and the frames
are said in full: "push the ice tea box away by 69 cm". What the language has no words for is left
to people.

Each sentence is planned before it is offered, from where things were seen last, step by step as far
as it is foreseen where they stand then. Where there is no plan for it, or nothing is suggested that
could be said, a smaller amount is looked for; then what is in the way is moved, or it goes another
way. If there is no plan for that either, the error says so.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, get_args

import grammar
from grammar.frames.vocabulary import Direction
from nlcontrol.errors import ControlError, ErrorInfo, refusal_error
from nlcontrol.results.result import Result, result_with
from nlcontrol.session.executor import CancellableRobot
from nlcontrol.session.remarks.follow_up_frames import correct_frame
from nlcontrol.session.remarks.remark_aims import without_spans
from planner import plan
from planner.affordances import frame_with_less
from planner.problem.planning_problem import SearchBudget
from planner.problem.predicted_states import state_after
from planner.types.refusal import Refusal
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from grammar.frames.command import Command, Frame, Span
    from nlcontrol.session.controller import Controller
    from planner.types.world_state import WorldState

    Parse = Callable[[str], Command]
    Frames = tuple[Frame, ...]

MOST = 3
"""Sentences for one error."""

MOST_WORK, MOST_EACH = 1500, 500
"""Work of all plans by which sentences are tried, and of each: about a second of a quiet core."""


CHAIN = 2
"""How often what the refusal of a change suggests is followed."""

REMARKS: tuple[tuple[str, str], ...] = (
    (r"up to (.+) would do", r"no, \1"),
    (r"(.+) or more would do", r"no, \1"),
    (r"(at .+ mm/s)", r"no, \1"),
    (r"allow (.+ N)", r"no, with at most \1"),
    (r"allow (.+ s)", r"no, in at most \1"),
    (r"ask for no more than (.+ N)", r"no, with at least \1"),
    (r"pour up to ([^,]+ ml).*", r"no, pour \1 of it"),
    (r"say “(.+)”, or leave it out", r"no, \1"),
    (r"(?:push|pull|move|turn|tilt|topple) it (.+)", r"no, \1"),
)
"""Suggestions of a change, and the remark that asks for it."""

BEFORE = (r"(.+) first", r"(put .+ down)(?:,.*)?")
"""Suggestions of what is to be done before."""

IN_THE_WAY = r"(move the .+) first"
"""Suggestions to move something else before, which a person may do as well."""

LEFT_OUT = r"leave (?:out .+|that out)"
"""Suggestions to leave out the words that the error is about."""

WHOLE = r'[^"“]+: "(.+)"'
"""Suggestions of a whole sentence: 'this would do: "push the mug away"'."""

OTHER_WAY = r"(?:say |(?:tilt|topple) it to )?another (?:direction|side)"
"""Suggestions of no direction in particular."""


def result_with_corrections(
    result: Result, controller: Controller, stop: StopToken | None = None
) -> Result:
    """The result with sentences that would do in place of the one that was said.

    A suggestion that leads to no plan gives way to a sentence for which there is one.

    Args:
        result: result of the sentence; what was carried out already is not said again.
        controller: controller that reads and plans sentences.
        stop: asked whether to go on.
    """
    info = result.error
    if info is None or len(info.suggestions) > MOST:
        return result  # of everything that is known nothing is meant more than the rest
    begun = result.steps[-1].frame if result.steps else 0
    frames, trials = result.frames[begun:], _Trials(controller, stop)
    found: dict[str, str | None] = {}
    as_suggested: set[str] = set()
    for suggestion, offered in _offers(controller.parse, result, info, frames):
        said = trials.words(offered)
        if said is not None and not found.get(suggestion):
            found[suggestion] = trials.sentence(offered)
            if found[suggestion] == said:
                as_suggested |= {suggestion, said}
    if frames and result.status in ("refused", "unsupported") and not any(found.values()):
        plain = tuple(map(without_spans, frames))
        less = trials.sentence_with_less(plain)
        found[""] = less or trials.first_planned(_other_ways(controller.parse, info, plain))
        found |= dict.fromkeys(each for each in info.suggestions if re.fullmatch(OTHER_WAY, each))
    say = tuple(dict.fromkeys(filter(None, found.values())))[:MOST]
    kept = [each for each in info.suggestions if each not in found or each in as_suggested]
    better = [f"say “{said}”" for said in say if said not in as_suggested]
    if "" in found and not say:
        kept += _nothing_near(frames[0])
    changes = {"say": say, "suggestions": tuple(better + kept) or info.suggestions}
    return result_with(result, error=info.model_copy(update=changes))


def _nothing_near(frame: Frame) -> Iterator[str]:
    """That no sentence was found, and the question that tells what can be done instead."""
    if frame.object is not None:
        question = type(frame)(query="affordances", object=without_spans(frame).object)
        asked = grammar.paraphrase(question)
        yield f"nothing like it was found that has a plan; ask “{asked}”"


def _offers(
    parse: Parse, result: Result, info: ErrorInfo, frames: Frames
) -> Iterator[tuple[str, Frames]]:
    """Suggestions, each with frames that do what it says."""
    if frames:
        yield from _from_frames(parse, info, frames)
    if not result.steps:
        yield from _from_words(parse, info, result.text, is_read=bool(frames))


def error_with_corrections(info: ErrorInfo, text: str, parse: Parse) -> ErrorInfo:
    """The error of a sentence that could not be read, with sentences that can."""
    found = _from_words(parse, info, text, is_read=False) if len(info.suggestions) <= MOST else ()
    say = dict.fromkeys(said for _, frames in found if (said := _in_words(parse, frames)))
    return info.model_copy(update={"say": tuple(say)[:MOST]})


def _in_words(parse: Parse, frames: Frames) -> str | None:
    """The frames said so that they are read again; None if the language has no words."""
    with suppress(ControlError, ValueError):
        said = grammar.paraphrase(frames)
        parse(said)
        return said
    return None


class _Trials:
    """Sentences planned from where things were seen last.

    If something was done since, whatever can be said is taken to do.
    """

    def __init__(self, controller: Controller, stop: StopToken | None) -> None:
        self._controller, self._stop = controller, stop
        self._state = controller.last_look.state
        self._left = MOST_WORK
        # A plan that is found with less effort is the one that is found with all of it: at most
        # 30 grasps are tried for each.
        most = min(controller.defaults.most_grasps, 30)
        self._defaults = replace(controller.defaults, most_grasps=most)

    def words(self, frames: Frames) -> str | None:
        """The frames said so that they are read again; None if the language has no words."""
        return _in_words(self._controller.parse, frames)

    def sentence(self, frames: Frames, chain: int = CHAIN) -> str | None:
        """The frames in words if there is a plan, else changed so that there is one.

        Args:
            frames: frames to try.
            chain: number of suggestions in a chain that are followed.
        """
        said = self.words(frames)
        dead_end = self._dead_end(said) if said is not None else None
        if dead_end is None:
            return said
        step, refused = dead_end
        before, rest = frames[:step], frames[step:]
        for suggestion in refused.suggestions if chain else ():
            if remark := _first_match(REMARKS, suggestion):
                with suppress(ControlError):
                    changed = _corrected(self._controller.parse, remark, rest)
                    if better := self.sentence((*before, *changed), chain - 1):
                        return better
        return self.sentence_with_less(frames, step)

    def sentence_with_less(self, frames: Frames, step: int = 0) -> str | None:
        """The frames in words with a smaller amount for which there is a plan.

        Args:
            frames: frames that have none.
            step: the first of them that may ask too much.
        """
        moving = (i for i, each in enumerate(frames) if i >= step and each.action != "explore")
        place = next(moving, None)
        if self._state is None or place is None:
            return None

        def with_frame(frame: Frame) -> Frames:
            return (*frames[:place], frame, *frames[place + 1 :])

        less = frame_with_less(frames[place], lambda frame: self._is_planned(with_frame(frame)))
        return None if less is None else self.words(with_frame(less))

    def first_planned(self, ways: Iterable[Frames]) -> str | None:
        """The first of some ways in words that has a plan as it is."""
        return next((self.words(frames) for frames in ways if self._is_planned(frames)), None)

    def _is_planned(self, frames: Frames) -> bool:
        said = self.words(frames)
        return said is not None and self._dead_end(said) is None

    def _dead_end(self, said: str) -> tuple[int, ErrorInfo] | None:
        """The step of a sentence that has no plan, and why; None as far as all have."""
        if self._state is None:
            return None
        try:
            with self._controller.last_look.kept():
                command = self._controller.resolve(self._controller.parse(said))
            return self._dead_end_of(command.frames, self._state)
        except ControlError as raised:
            return 0, raised.info
        except Stopped:
            return 0, ErrorInfo(code="interrupted", message="it was told to stop")

    def _dead_end_of(self, frames: Frames, state: WorldState) -> tuple[int, ErrorInfo] | None:
        """The first frame without a plan, and why; None if there is none before what is unknown."""
        robot = CancellableRobot(self._controller.robot, self._stop, self._controller.time_limit)
        for step, frame in enumerate(frames):
            if frame.action == "explore":
                from nlcontrol.session.exploration_commands import state_once_explored

                state = state_once_explored(self._controller, frame, state)
            elif frame.query is None:
                budget = SearchBudget(min(self._left, MOST_EACH))
                planner = self._controller.planner or partial(plan, budget=budget)
                made = planner(frame, state, robot, defaults=self._defaults)
                self._left -= budget.done
                if isinstance(made, Refusal):
                    return step, refusal_error(made)
                foreseen = state_after(made, state)
                if foreseen is None:
                    return None
                state = foreseen
        return None


def _from_frames(parse: Parse, info: ErrorInfo, frames: Frames) -> Iterator[tuple[str, Frames]]:
    if info.code in ("ambiguous_object", "unknown_object"):
        yield from _with_other_names(parse, info, frames)
        return
    for suggestion in info.suggestions:
        with suppress(ControlError):
            if re.fullmatch(LEFT_OUT, suggestion):
                yield from ((suggestion, rest) for rest in _without_words(frames, info.span))
            elif remark := _first_match(REMARKS, suggestion):
                yield suggestion, _corrected(parse, remark, frames)
            elif re.fullmatch(IN_THE_WAY, suggestion):
                continue
            elif before := _first_match([(each, r"\1") for each in BEFORE], suggestion):
                yield suggestion, (*parse(before).frames, *map(without_spans, frames))


def _other_ways(parse: Parse, info: ErrorInfo, frames: Frames) -> Iterator[Frames]:
    """The frames after what is in the way is moved, and with other directions of the first."""
    for suggestion in info.suggestions:
        if moved := re.fullmatch(IN_THE_WAY, suggestion):
            with suppress(ControlError):
                yield (*parse(moved[1]).frames, *frames)
    first, *rest = frames
    said = getattr(first.goal, "direction", None)
    for other in get_args(Direction) if isinstance(said, str) else ():
        if other != said:
            goal = first.goal.model_copy(update={"direction": other})
            yield (first.model_copy(update={"goal": goal}), *rest)


def _with_other_names(
    parse: Parse, info: ErrorInfo, frames: Frames
) -> Iterator[tuple[str, Frames]]:
    """The frames with the object that may be meant."""
    for suggestion in info.suggestions:
        name = _meant_words(suggestion)
        # What else stands on the table is meant only if the name fits it, or nearly so.
        if re.fullmatch(LEFT_OUT, suggestion) or (
            name == suggestion and info.code != "ambiguous_object"
        ):
            continue
        name = name.removeprefix("the ")
        with suppress(ControlError):
            yield suggestion, _corrected(parse, f'no, the "{name}"', frames, info.span)


def _first_match(table: Iterable[tuple[str, str]], suggestion: str) -> str | None:
    for pattern, said in table:
        if found := re.fullmatch(pattern, suggestion):
            return found.expand(said)
    return None


def _corrected(parse: Parse, remark: str, frames: Frames, wrong: Span | None = None) -> Frames:
    """The frames with what a remark says in place of what was."""
    said = parse(remark).frames[0].model_copy(update={"dialogue": None})
    # "Pour 200 ml of it" is about the object that was named.
    if said.object is not None and said.object.pronoun:
        said = said.model_copy(update={"object": None})
    return correct_frame(frames, said, wrong)


def _without_words(frames: Frames, span: Span | None) -> Iterator[Frames]:
    """The frames without the clauses that stand in a place of the sentence."""
    first, rest = frames[0], map(without_spans, frames[1:])
    kept = tuple(
        clause
        for clause in first.constraints
        if span is None or not any(span[0] <= a and b <= span[1] for a, b in clause.spans)
    )
    if len(kept) < len(first.constraints):
        yield (without_spans(first.model_copy(update={"constraints": kept})), *rest)


def _from_words(
    parse: Parse, info: ErrorInfo, text: str, *, is_read: bool
) -> Iterator[tuple[str, Frames]]:
    """The sentence without the words in question, or if it is not read at all, with others."""
    if info.span is None:
        return
    start, end = info.span
    for suggestion in info.suggestions:
        left_out = re.fullmatch(LEFT_OUT, suggestion)
        if is_read and not left_out:
            continue
        whole = re.fullmatch(WHOLE, suggestion)
        instead = "" if left_out else _meant_words(suggestion)
        said = whole[1] if whole else f"{text[:start]}{instead}{text[end:]}"
        with suppress(ControlError):
            yield suggestion, parse(said).frames


def _meant_words(suggestion: str) -> str:
    """The words in quotes, if there are any: of "did you mean 'push'?" the verb."""
    quoted = re.search(r"[“\"'](.+)[”\"']", suggestion)
    return quoted[1] if quoted else suggestion
