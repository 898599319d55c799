"""From an English sentence to frames: a lark grammar, a lexicon, and the frames themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from grammar.errors import ParseError
from grammar.frames.command import Command, Frame, ObjectRef

if TYPE_CHECKING:
    from collections.abc import Sequence

    from grammar.words.lexicon import Lexicon

__all__ = ["Command", "Frame", "ObjectRef", "ParseError", "paraphrase", "parse"]


def parse(text: str) -> Command:
    """Reads an English command; see `grammar.parser.Parser.parse`.

    Raises:
        ParseError: if the sentence, or a part of it, is not understood.
    """
    # lark and the lexicon are loaded with the first sentence, not with the frames.
    from grammar import parser

    return parser.parse(text)


def paraphrase(said: Frame | Sequence[Frame], lexicon: Lexicon | None = None) -> str:
    """Return frames in plain words; see `command_wording.paraphrase`."""
    from grammar.paraphrasing import command_wording as wording

    return wording.paraphrase(said, lexicon)
