"""What was said and not understood since the last sentence that was, and what it may have meant.

A remark that leaves open what it is about may be about that, so it is asked back. Of a sentence
that is not read as a whole its longest part that is a command is offered; "yes" has it done.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from nlcontrol.session.remarks import remark_aims as aims

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from nlcontrol.errors import ErrorInfo
    from nlcontrol.references.reference_resolution import Context
    from nlcontrol.results.result import Result
    from objectmodels import ObjectModel
    from sim.robots.cell_description import CellDescription


@dataclass(frozen=True)
class UnreadTurns:
    """Turns that were not understood since one was.

    Attributes:
        some: whether there are any.
        asked: whether the last was a question.
        offered: the part of the last that is a command.
    """

    some: bool = False
    asked: bool = False
    offered: Command | None = None

    def may_be_meant(self, command: Command) -> bool:
        """Check for a remark, which may be about one of these turns: "slower", "and the mug?"."""
        return self.some and aims.is_remark(command)

    def accepted_command(self, command: Command) -> Command | None:
        """The part that was offered, if a remark accepts it; else None."""
        return self.offered if aims.only_agrees(command) else None

    def with_turn(self, text: str, offered: Command | None) -> UnreadTurns:
        """These turns, and one more."""
        return UnreadTurns(some=True, asked=aims.asks(text), offered=offered)


def is_of_other(text: str, named: list[str], context: Context) -> bool:
    """Check for a turn, not understood, about another object than the last that was."""
    other = len(named) > 1 or (bool(named) and named != [*context.latest])
    return not aims.asks(text) and other


def context_with_unread(context: Context, text: str, named: list[str]) -> Context:
    """What was spoken of after a turn that was not understood but names objects."""
    last = tuple(dict.fromkeys((*named, *context.last)))
    unnamed = aims.asks_which(text) or (not named and aims.tells_of_one(text))
    among = tuple(named) if len(named) > 1 else None  # "the mug, not the jar"
    doubt = () if unnamed else among if named else context.doubt
    return replace(context, last=last, doubt=doubt)


def context_with_refused(
    context: Context, result: Result, cell: CellDescription, models: Mapping[str, ObjectModel]
) -> Context:
    """What was spoken of after a sentence that names a place that is not there.

    "Put the mug in the bin" is about the mug, although not even that was looked for.
    """
    bound = any(frame.object and frame.object.id for frame in result.frames)
    if result.status != "not_understood" or bound or context.doubt is not None:
        return context
    named = aims.names_said(result.text, cell, models)
    return context_with_unread(context, result.text, named) if named else context


def with_offer(info: ErrorInfo, offered: Command | None) -> ErrorInfo:
    """A refusal that offers the part of a sentence that is a command."""
    if offered is None:
        return info
    told = f'to have what is understood done, say "yes": "{offered.paraphrase}"'
    kept = tuple(s for s in info.suggestions if not s.startswith("this much is understood"))
    return info.model_copy(update={"suggestions": (*kept, told)})
