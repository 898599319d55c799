"""Words that other packages bring: entry points of the group `nlcontrol.lexicon`.

What an entry point names may be

- a mapping with `verbs`, `terminals`, `adjectives` and `names`, in the form of the lexicon's own
  file (see `Lexicon.extended`);
- a path of a YAML file that holds such a mapping;
- a function without arguments that returns one of these.

A plug-in that fails, or that would change what a word means, is reported and skipped; it never
takes the language down.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import entry_points
from os import PathLike
from pathlib import Path
from typing import Any

from grammar.words.lexicon import Lexicon, default_lexicon
from objectmodels.files.plugin_loading import PluginError, package_name, place_of, taken_in

GROUP = "nlcontrol.lexicon"

MOST_BYTES = 1_000_000
"""Largest file of words that is read [bytes]."""

_KEYS = frozenset({"verbs", "terminals", "adjectives", "names"})


@cache
def installed_lexicon() -> tuple[Lexicon, tuple[str, ...]]:
    """The lexicon with the words of the installed plug-ins, and what is wrong with the others."""
    lexicon, problems = default_lexicon(), []
    for point in sorted(entry_points(group=GROUP), key=lambda p: (package_name(p), p.name)):
        try:
            words = taken_in(point, _plug_in_words)
            _require_own_words(lexicon, words.get("names", ()))
            lexicon = lexicon.with_words(**words)
        except (PluginError, ValueError, TypeError, KeyError) as failure:
            told = failure if isinstance(failure, PluginError) else _told(failure)
            problems.append(f"{place_of(point)}: {told}")
    return lexicon, tuple(problems)


def _require_own_words(lexicon: Lexicon, names: Iterable[str]) -> None:
    """Refuses names that have no word of their own: no sentence would be read as before."""
    plain = lexicon.reserved_words
    if taken := sorted(name for name in names if plain.issuperset(name.casefold().split())):
        raise ValueError(f"words of the language are no names: {', '.join(taken)}")


def _told(failure: Exception) -> str:
    return f"{type(failure).__name__}: {failure}"


def _plug_in_words(thing: object) -> Mapping[str, Any]:
    """The words in what an entry point names.

    Raises:
        ValueError: if they have a key that no lexicon has.
    """
    if isinstance(thing, Mapping):
        if unknown := sorted(set(thing) - _KEYS):
            raise ValueError(f"a lexicon's words have no {', '.join(unknown)}")
        return thing
    if isinstance(thing, str | PathLike):
        return _plug_in_words(_yaml_content(Path(thing)))
    if callable(thing):
        return _plug_in_words(thing())
    raise TypeError(f"expected a mapping, a path or a function, found {type(thing).__name__}")


def _yaml_content(path: Path) -> object:
    """Contents of a file of words: a regular one of at most `MOST_BYTES`, in UTF-8.

    Raises:
        ValueError: it is none, or has aliases, which may stand for any amount of words.
    """
    import yaml

    if not path.is_file():
        raise ValueError(f"{path} is no regular file")
    with path.open("rb") as file:
        content = file.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise ValueError(f"{path} holds more than {MOST_BYTES} bytes")
    text = content.decode("utf-8-sig")
    if any(isinstance(event, yaml.AliasEvent) for event in yaml.parse(text, yaml.SafeLoader)):
        raise ValueError(f"{path} has aliases (*name): write out what they stand for")
    return yaml.safe_load(text)
