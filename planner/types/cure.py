"""What would do in place of what is refused, as data that a program can act on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

CureKind = Literal[
    "advice",  # for people: the language has no words for it
    "change",  # a remark on the sentence, such as “no, 69 cm”
    "first",  # a command to be carried out before
    "move",  # the same, which takes something out of the way: a person may do that as well
    "leave_out",  # the words that cannot be satisfied
    "other_way",  # some other direction, whichever
]


@dataclass(frozen=True)
class Cure:
    """Something that would do in place of what is refused.

    Attributes:
        kind: how it changes the sentence.
        text: it as a plain phrase.
        command: the remark or the command that asks for it, in the language of commands; empty
            where the kind says all.
    """

    kind: CureKind
    text: str
    command: str = ""


def first(command: str, text: str | None = None) -> Cure:
    """A command to be carried out before."""
    return Cure("first", text or f"{command} first", command)


def move(names: str) -> Cure:
    """What is in the way, moved before by the robot or by a person."""
    return Cure("move", f"move {names} first", f"move {names}")


def change(text: str, said: str) -> Cure:
    """The sentence with a change; `said` is what a person says for it after “no”."""
    return Cure("change", text, f"no, {said}")


def up_to(amount: str) -> Cure:
    """The sentence with a smaller amount."""
    return change(f"up to {amount} would do", amount)
