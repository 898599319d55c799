"""From an English sentence to frames: a lark grammar, a lexicon, and the frames themselves."""

from __future__ import annotations

from grammar.errors import ParseError
from grammar.frames import Command, Frame, ObjectRef

__all__ = ["Command", "Frame", "ObjectRef", "ParseError"]
