"""The words of the language: what they mean, and the terminals they make.

The words stand in `lexicon.yaml`; the grammar's rules know only the terminals. A plug-in extends
the language with `Lexicon.extended`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any, TypeVar

T = TypeVar("T")

END = "(?= |$)"
"""What follows a word in the plain form, as a regular expression."""

_GROUP = re.compile(r"\(([^()\[\]]*)\)|\[([^()\[\]]*)\]")


def expand(template: str) -> Iterator[str]:
    """Yields the phrases of a template: `(a|b)` is a choice, `[c]` may be left out."""
    # Innermost groups first, so that groups may stand inside one another.
    group = _GROUP.search(template)
    if group is None:
        yield " ".join(template.split())
        return
    choices = group[1].split("|") if group[1] is not None else ["", *group[2].split("|")]
    for choice in choices:
        yield from expand(template[: group.start()] + choice + template[group.end() :])


@dataclass(frozen=True)
class Verb:
    """What a verb asks for.

    Attributes:
        action: action of the frame.
        goal: kind of the goal.
        amount: how far, if the verb itself says so ("nudge").
    """

    action: str
    goal: str
    amount: str | None = None


@dataclass(frozen=True)
class Lexicon:
    """The language's words.

    Attributes:
        verbs: verb, or verb and particle → what it asks for.
        terminals: terminal → phrase → value.
        later_verbs: verbs that are known but not read.
        later_words: words that begin phrases which are not read.
        question_words: how questions begin.
        requests: questions that are polite requests.
        contractions: contracted word → spelled out.
        labels: terminal → how a message names it.
    """

    verbs: Mapping[str, Verb]
    terminals: Mapping[str, Mapping[str, str]]
    later_verbs: frozenset[str]
    later_words: frozenset[str]
    question_words: tuple[str, ...]
    requests: tuple[str, ...]
    contractions: Mapping[str, str]
    labels: Mapping[str, str]

    @classmethod
    def read(cls, path: Path) -> Lexicon:
        """Reads a lexicon from its YAML file.

        Raises:
            ValueError: if a phrase has two meanings in one terminal.
        """
        import yaml

        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
        return cls.from_data(yaml.load(path.read_text(encoding="utf-8"), Loader=loader))

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Lexicon:
        """Builds a lexicon from the mapping that its file holds."""
        return cls(
            verbs=_verbs(data["verbs"]),
            terminals={name: _phrases(name, v) for name, v in data["terminals"].items()},
            later_verbs=frozenset(data["later_verbs"]),
            later_words=frozenset(data["later_words"]),
            question_words=tuple(data["question_words"]),
            requests=tuple(data["requests"]),
            contractions=data["contractions"],
            labels=data["labels"],
        )

    def extended(
        self,
        *,
        verbs: Iterable[Mapping[str, Any]] = (),
        terminals: Mapping[str, Mapping[str, Iterable[str]]] | None = None,
    ) -> Lexicon:
        """Returns this lexicon with more words, in the form of the lexicon's file.

        Raises:
            ValueError: if a word already means something else, or a terminal is unknown.
        """
        more = {name: _phrases(name, v) for name, v in (terminals or {}).items()}
        if unknown := sorted(more.keys() - self.terminals.keys()):
            raise ValueError(f"no terminal is called {', '.join(unknown)}")
        merged = {
            name: _merged(name, known, more.get(name, {})) for name, known in self.terminals.items()
        }
        all_verbs = _merged("VERB", self.verbs, _verbs(verbs))
        return replace(self, verbs=all_verbs, terminals=merged)

    def value(self, terminal: str, phrase: str) -> str:
        """What a phrase means as this terminal."""
        return self.terminals[terminal][phrase]

    def verb(self, word: str, particle: str | None = None) -> Verb | None:
        """The verb that a word makes, alone or with a particle; None if it makes none."""
        return self.verbs.get(word if particle is None else f"{word} {particle}")

    def verb_words(self) -> set[str]:
        """The words that verbs begin with."""
        return {phrase.split()[0] for phrase in self.verbs}

    def phrases(self, terminal: str) -> list[str]:
        """Everything that a terminal may be, longest first."""
        known = self.verb_words() if terminal == "VERB" else self.terminals[terminal]
        return sorted(known, key=lambda phrase: (-len(phrase), phrase))

    def grammar_terminals(self) -> str:
        """The terminals as text of a lark grammar."""
        words = {name: _choice(self.phrases(name)) for name in ("VERB", *self.terminals)}
        units = "|".join(words[name] for name in self.terminals if name.endswith("_UNIT"))
        number = rf"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?(?={END}|(?:{units}){END})"
        not_a_name = f"{_choice(sorted(self.function_words))}{END}|{number}"
        priorities = self._priorities()
        lines = [f"{name}.{priorities[name]}: /{words[name]}{END}/" for name in words]
        lines += [f"NUMBER.1: /{number}/", f'WORD.-1: /(?!{not_a_name})[^\\W_][^ ,";!?]*/']
        return "\n".join(lines)

    def _priorities(self) -> dict[str, int]:
        """Priorities by which the lexer finds "at the top face" before it finds "at the top".

        Raises:
            ValueError: if two terminals would each have to come before the other.
        """
        prefixes = {
            name: {phrase[:i] for phrase in known for i, c in enumerate(phrase) if c == " "}
            for name, known in self.terminals.items()
        }
        after = {
            name: [other for other in prefixes if other != name and prefixes[other] & known.keys()]
            for name, known in self.terminals.items()
        }
        try:
            order = list(TopologicalSorter(after).static_order())
        except CycleError as error:
            raise ValueError(f"these terminals begin with one another: {error.args[1]}") from None
        return {"VERB": 1, **{name: len(order) - i for i, name in enumerate(order)}}

    @cached_property
    def function_words(self) -> frozenset[str]:
        """Words that never belong to a bare name."""
        terminals = ("THE", "A", "IT", "SEPARATOR", "WITHOUT", "WITH", "TOWARD", "INTO", "AT")
        single = {p for name in terminals for p in self.terminals[name] if " " not in p}
        return self.later_words | single

    @cached_property
    def reserved(self) -> frozenset[str]:
        """Words with which a phrase of the language begins; they end a bare name."""
        phrases = (phrase for known in self.terminals.values() for phrase in known)
        return self.function_words | {phrase.split()[0] for phrase in phrases} | self.verb_words()


def _verbs(entries: Iterable[Mapping[str, Any]]) -> dict[str, Verb]:
    verbs: dict[str, Verb] = {}
    for entry in entries:
        verb = Verb(entry["action"], entry["goal"], entry.get("amount"))
        verbs = _merged("VERB", verbs, {p: verb for t in entry["says"] for p in expand(t)})
    return verbs


def _phrases(name: str, values: Mapping[str, Iterable[str]]) -> dict[str, str]:
    phrases: dict[str, str] = {}
    for value, templates in values.items():
        phrases = _merged(name, phrases, {p: value for t in templates for p in expand(t)})
    return phrases


def _merged(name: str, known: Mapping[str, T], more: Mapping[str, T]) -> dict[str, T]:
    for phrase in known.keys() & more.keys():
        if known[phrase] != more[phrase]:
            raise ValueError(f"{name}: {phrase!r} means both {known[phrase]} and {more[phrase]}")
    return {**known, **more}


def _choice(phrases: Iterable[str]) -> str:
    return "(?:" + "|".join(re.escape(phrase).replace("/", r"\/") for phrase in phrases) + ")"


@cache
def default_lexicon() -> Lexicon:
    """The language that nlcontrol comes with."""
    return Lexicon.read(Path(__file__).with_name("lexicon.yaml"))
