"""Text that others wrote, marked so that a language model cannot take it for ours.

Names of objects, models and scenes come from files of the host or from a caller's table. In our
sentences each stands in quotes, “so”; nothing inside can end the quotes or begin a line. The
language reads quoted names, so that a marked sentence may be said as it is.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from typing import Any

from grammar.words.lexicon import default_lexicon

_INVISIBLE = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
_QUOTES = str.maketrans(dict.fromkeys('“”„‟"«»', "'"))


def visible_text(text: str) -> str:
    """The text on one line, without control and format characters."""
    shown = (" " if unicodedata.category(sign) in _INVISIBLE else sign for sign in text)
    return " ".join("".join(shown).split())


def quoted_name(name: str) -> str:
    """A name in quotes that it cannot end itself."""
    return f"“{visible_text(name).translate(_QUOTES)}”"


class ForeignNames:
    """Names that others gave, as they stand in our sentences.

    Args:
        names: of objects, models and scenes.
    """

    def __init__(self, names: Iterable[str]) -> None:
        known = sorted({name for name in names if name.strip()}, key=len, reverse=True)
        plain = default_lexicon().reserved_words
        # What is a word of the language as well is a name behind its article alone.
        one_of = "|".join(
            rf"(?<=\bthe ){re.escape(name)}" if name.casefold() in plain else re.escape(name)
            for name in known
        )
        # What is quoted already is left as it is: by us, or by who wrote the sentence.
        quoted = rf"[\"'“](?:{'|'.join(map(re.escape, known))})[\"'”]"
        self._found = re.compile(rf"{quoted}|(?<!\w)(?:{one_of})(?!\w)", re.I) if known else None
        self._names = {name.casefold() for name in known}

    def sentence_with_marks(self, text: str) -> str:
        """The sentence with every name in quotes, on one line."""
        if self._found is None:
            return visible_text(text)
        return visible_text(self._found.sub(self._quoted_match, text))

    def document_with_marks(self, part: Any) -> Any:
        """A JSON document whose sentences are marked; values that are only a name stay as such."""
        if isinstance(part, dict):
            return {key: self.document_with_marks(value) for key, value in part.items()}
        if isinstance(part, list | tuple):
            return [self.document_with_marks(value) for value in part]
        if not isinstance(part, str):
            return part
        is_name = part.casefold() in self._names
        return visible_text(part) if is_name else self.sentence_with_marks(part)

    def _quoted_match(self, found: re.Match[str]) -> str:
        name = found[0]
        return quoted_name(name if name.casefold() in self._names else name[1:-1])
