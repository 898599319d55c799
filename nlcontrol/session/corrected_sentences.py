"""Whole sentences in place of one that was refused or not understood, by what its error suggests.

What would do comes with a refusal as data: "up to 690 mm would do" is the remark "no, 690 mm". It
is put into the frames as a conversation does that, and the frames are said in full: "push the ice
tea box away by 69 cm". What the language has no words for is advice, and is left to people.

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
from nlcontrol.session.foresight import BudgetedPlanner, Foresight
from nlcontrol.session.remarks.follow_up_frames import correct_frame
from nlcontrol.session.remarks.follow_up_targets import without_spans
from planner.affordances import frame_with_less
from planner.types.cure import Cure
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

_WHOLE = re.compile(r'[^"“]+: "(.+)"')
"""What the grammar suggests as a whole sentence: 'this would do: "push the mug away"'."""


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
        found |= dict.fromkeys(each.text for each in info.cures if each.kind == "other_way")
    say = tuple(dict.fromkeys(filter(None, found.values())))[:MOST]
    kept = [each for each in info.suggestions if each not in found or each in as_suggested]
    better = [f"say “{said}”" for said in say if said not in as_suggested]
    if "" in found and not say:
        kept += _nothing_near(frames[0])
    suggestions = tuple(better + kept) or info.suggestions
    changes = {"say": say, "suggestions": suggestions, "cures": ()}
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
        # A plan that is found with less effort is the one that is found with all of it: at most
        # 30 grasps are tried for each.
        most = min(controller.defaults.most_grasps, 30)
        defaults = replace(controller.defaults, most_grasps=most)
        # The robot is asked anew for each sentence, whose time counts by itself.
        self._planner = BudgetedPlanner(
            controller, controller.robot, MOST_WORK, MOST_EACH, defaults=defaults
        )

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
        for cure in refused.cures if chain else ():
            if cure.kind == "change":
                with suppress(ControlError):
                    changed = _corrected(self._controller.parse, cure.command, rest)
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
            robot = CancellableRobot(
                self._controller.robot, self._stop, self._controller.time_limit
            )
            foresight = Foresight(partial(self._planner, robot=robot))
            refused = foresight.dead_end(command.frames, self._state, self._explored)
            return None if refused is None else (refused[0], refusal_error(refused[1]))
        except ControlError as raised:
            return 0, raised.info
        except Stopped:
            return 0, ErrorInfo(code="interrupted", message="it was told to stop")

    def _explored(self, frame: Frame, state: WorldState) -> WorldState:
        """The belief after a touch."""
        from nlcontrol.session.exploration_commands import state_once_explored

        return state_once_explored(self._controller, frame, state)


def _cures_of(info: ErrorInfo) -> tuple[Cure, ...]:
    """What would do; errors of reading have phrases alone, of which some leave words out."""
    return info.cures or tuple(
        Cure("leave_out" if each.startswith(("leave out ", "leave that out")) else "advice", each)
        for each in info.suggestions
    )


def _from_frames(parse: Parse, info: ErrorInfo, frames: Frames) -> Iterator[tuple[str, Frames]]:
    if info.code in ("ambiguous_object", "unknown_object"):
        yield from _with_other_names(parse, info, frames)
        return
    for cure in _cures_of(info):
        with suppress(ControlError):
            match cure.kind:
                case "leave_out":
                    yield from ((cure.text, rest) for rest in _without_words(frames, info.span))
                case "change":
                    yield cure.text, _corrected(parse, cure.command, frames)
                case "first":
                    before = parse(cure.command).frames
                    yield cure.text, (*before, *map(without_spans, frames))


def _other_ways(parse: Parse, info: ErrorInfo, frames: Frames) -> Iterator[Frames]:
    """The frames after what is in the way is moved, and with other directions of the first."""
    for cure in info.cures:
        if cure.kind == "move":
            with suppress(ControlError):
                yield (*parse(cure.command).frames, *frames)
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
    for cure in _cures_of(info):
        name = _meant_words(cure.text)
        # What else stands on the table is meant only if the name fits it, or nearly so.
        fits = name != cure.text or info.code == "ambiguous_object"
        if cure.kind == "leave_out" or not fits:
            continue
        name = name.removeprefix("the ")
        with suppress(ControlError):
            yield cure.text, _corrected(parse, f'no, the "{name}"', frames, info.span)


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
    for cure in _cures_of(info):
        left_out = cure.kind == "leave_out"
        if is_read and not left_out:
            continue
        whole = _WHOLE.fullmatch(cure.text)
        instead = "" if left_out else _meant_words(cure.text)
        said = whole[1] if whole else f"{text[:start]}{instead}{text[end:]}"
        with suppress(ControlError):
            yield cure.text, parse(said).frames


def _meant_words(suggestion: str) -> str:
    """The words in quotes, if there are any: of "did you mean 'push'?" the verb."""
    quoted = re.search(r"[“\"'](.+)[”\"']", suggestion)
    return quoted[1] if quoted else suggestion
