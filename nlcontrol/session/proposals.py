"""Proposals: plans of sentences, not yet done; to be approved, then carried out as they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from planner.types.plan import Plan, Reached

if TYPE_CHECKING:
    from grammar.frames.command import Command
    from nlcontrol.results.result import Result
    from nlcontrol.session.remarks.undo_frames import PastPush, WayBack


@dataclass(frozen=True)
class Approval:
    """The first plan of a command, which is carried out as it is.

    Attributes:
        frame: place in the command of the frame that it is for, from 0; only questions stand
            before it.
        made: the plan.
    """

    frame: int
    made: Plan | Reached


@dataclass(frozen=True)
class Intention:
    """The task of a sentence, as it is meant after those before it.

    Attributes:
        command: with each remark replaced by the frames that it means.
        notes: on how a remark was taken.
        joins: whether its objects join those of the sentence before ("and the mug too").
        corrects: whether its object takes the place of one that was not meant.
        exchange: the command before its objects were resolved, if things change places.
        undone: what was pushed, if that is undone.
        back: the way back then.
    """

    command: Command
    notes: tuple[str, ...] = ()
    joins: bool = False
    corrects: bool = False
    exchange: Command | None = None
    undone: tuple[PastPush, ...] = ()
    back: WayBack | None = None


@dataclass(frozen=True)
class Proposal:
    """A sentence that was planned.

    Attributes:
        number: of it in its conversation, from 0.
        result: of the sentence so far.
        intention: what it is to do, its objects resolved; None if nothing is to be carried out.
    """

    number: int
    result: Result
    intention: Intention | None

    @property
    def approval(self) -> Approval | None:
        """The plan that is carried out first; None if a touch decides what comes next."""
        frame = self.result.steps[-1].frame
        if self.result.frames[frame].action == "explore":
            return None
        return Approval(frame, self.result.plan or Reached())
