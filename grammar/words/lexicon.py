"""The words of the language: what they mean, and the terminals they make.

The words stand in `lexicon.yaml`; the grammar's rules know only the terminals. A plug-in extends
the language with `Lexicon.with_words`. The file is kept as JSON too, which is read ten times as
fast: `python -m grammar.words.lexicon` writes it anew after a change of the words. One of other
words is not used.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar, cast, get_args

from grammar.frames.command import Action, Quality
from grammar.words.numerals import NumberWords
from grammar.words.phrase_templates import expand_template, with_rules

T = TypeVar("T")

WORDS = Path(__file__).with_name("lexicon.yaml")
STORED = Path(__file__).with_name("lexicon.json")


NAME_TERMINALS = ("VERB", "VERB_ED", "VERB_ING")
"""Terminals that are made of the verbs: infinitives, participles, gerunds."""

OPENERS = frozenset({"CAN", "WILL", "FIND_OUT", "TELL", "STOP", "VOCATIVE"})
"""Terminals that begin something new, so that right behind a name they are a part of it."""


@dataclass(frozen=True)
class Verb:
    """Meaning of a verb.

    Attributes:
        action: action of the frame.
        goal: kind of the goal; `contact` is none unless the sentence says where the object goes.
        amount: how far, if the verb itself says so ("nudge").
        direction: where to, if the verb itself says so ("bring").
        turns: how far it turns, if the verb itself says so ("turn around").
        which: what is found out, if the verb itself says so ("weigh").
        relation: how things stand to each other, if the verb itself says so ("stack").
        kept: whether a place behind its object says where that is kept ("hold").
    """

    action: str
    goal: str
    amount: str | None = None
    direction: str | None = None
    turns: float | None = None
    which: str | None = None
    relation: str | None = None
    kept: bool = False


@dataclass(frozen=True)
class Lexicon:
    """The language's words.

    Attributes:
        verbs: verb, or verb and particle → what it asks for.
        verb_forms: verb → its participle and gerund, where they are not made by rule.
        terminals: terminal → phrase → value.
        adjectives: word of a name → what it tells the object by.
        nobodies: words that stand for an object without naming it.
        robot_parts: what the robot calls its own.
        parts: parts of objects that may be opened.
        handles: parts by which objects are held.
        lids: parts of objects that are taken off and put on.
        names: names of several words that are read as one, whatever their words mean elsewhere.
        numbers: words that number words are made of.
        later_verbs: verbs that are known but not read → verbs that may do instead.
        later_words: words that begin phrases which are not read.
        vague: words and phrases of no clear meaning → what to say instead.
        contractions: contracted word → spelled out.
        asides: where words of courtesy stand, which change nothing → templates of them.
        effects: word with an effect, none of which is ever left out → what it does.
        rewordings: plain words → templates of what is put so where it is not read.
        asking: where words of questions stand that ask nothing → templates of them.
        labels: terminal → how a message names it.
    """

    verbs: Mapping[str, Verb]
    verb_forms: Mapping[str, tuple[str, str]]
    terminals: Mapping[str, Mapping[str, str]]
    adjectives: Mapping[str, Quality]
    nobodies: frozenset[str]
    robot_parts: frozenset[str]
    parts: frozenset[str]
    handles: frozenset[str]
    lids: frozenset[str]
    names: frozenset[str]
    numbers: NumberWords
    later_verbs: Mapping[str, tuple[str, ...]]
    later_words: frozenset[str]
    vague: Mapping[str, tuple[str, ...]]
    contractions: Mapping[str, str]
    asides: Mapping[str, tuple[str, ...]]
    effects: Mapping[str, str]
    rewordings: Mapping[str, tuple[str, ...]]
    asking: Mapping[str, tuple[str, ...]]
    labels: Mapping[str, str]

    __hash__ = object.__hash__  # what is made of its words is remembered by the lexicon itself

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Lexicon:
        """Builds a lexicon from the mapping that its file holds.

        Raises:
            ValueError: if a phrase has two meanings in one terminal.
        """
        data = with_rules(data, data["rules"])
        return cls(
            verbs=_expand_verbs(data["verbs"]),
            verb_forms={verb: (ed, ing) for verb, (ed, ing) in data["verb_forms"].items()},
            terminals={name: _expand_phrases(name, v) for name, v in data["terminals"].items()},
            adjectives=cast(
                "dict[str, Quality]", _expand_phrases("adjectives", data["adjectives"])
            ),
            nobodies=frozenset(data["nobodies"]),
            robot_parts=frozenset(data["robot_parts"]),
            parts=frozenset(data["parts"]),
            handles=frozenset(data["handles"]),
            lids=frozenset(data["lids"]),
            names=frozenset(),
            numbers=NumberWords.from_data(
                data["numbers"], _expand_phrases("numbers", data["numbers"]["phrases"])
            ),
            later_verbs={verb: tuple(like) for verb, like in data["later_verbs"].items()},
            later_words=frozenset(data["later_words"]),
            vague={word: tuple(instead) for word, instead in data["vague"].items()},
            contractions=data["contractions"],
            asides={place: tuple(templates) for place, templates in data["asides"].items()},
            effects=_expand_phrases("effects", data["effects"]),
            rewordings={means: tuple(said) for means, said in data["rewordings"].items()},
            asking={place: tuple(said) for place, said in data["asking"].items()},
            labels=data["labels"],
        )

    def with_words(
        self,
        *,
        verbs: Iterable[Mapping[str, Any]] = (),
        terminals: Mapping[str, Mapping[str, Iterable[str]]] | None = None,
        adjectives: Mapping[str, Iterable[str]] | None = None,
        names: Iterable[str] = (),
    ) -> Lexicon:
        """Returns this lexicon with more words, in the form of the lexicon's file.

        Args:
            verbs: more verbs.
            terminals: more phrases for terminals that there are.
            adjectives: more words for qualities that there are.
            names: names of objects whose words mean something else in the language ("hard drive").

        Raises:
            ValueError: if a word already means something else, or a terminal is unknown.
        """
        more = {name: _expand_phrases(name, v) for name, v in (terminals or {}).items()}
        verbs = list(verbs)
        self._require_verbs(verbs)
        self._require_phrases(more)
        if unknown := sorted(more.keys() - self.terminals.keys()):
            raise ValueError(f"no terminal is called {', '.join(unknown)}")
        merged = {
            name: _merge_words(name, known, more.get(name, {}))
            for name, known in self.terminals.items()
        }
        words = cast("dict[str, Quality]", _expand_phrases("adjectives", adjectives or {}))
        if unknown := sorted(set(words.values()) - set(self.adjectives.values())):
            raise ValueError(f"objects are not told apart by {', '.join(unknown)}")
        plain = {" ".join(name.casefold().replace("-", " ").split()) for name in names}
        return replace(
            self,
            verbs=_merge_words("VERB", self.verbs, _expand_verbs(verbs)),
            terminals=merged,
            adjectives=_merge_words("adjectives", self.adjectives, words),
            names=self.names | plain,
        )

    def _require_verbs(self, entries: Iterable[Mapping[str, Any]]) -> None:
        """Refuses verbs that ask for what no frame can say."""
        goals = {known.goal for known in self.verbs.values()}
        for entry in entries:
            if isinstance(entry["says"], str):
                raise ValueError(f"{entry['says']!r}: what a verb says is a list of phrases")
            if entry["action"] not in get_args(Action) or entry["goal"] not in goals:
                raise ValueError(f"{entry['says']}: no action {entry['action']}, {entry['goal']}")
            for phrase in (
                phrase for template in entry["says"] for phrase in expand_template(template)
            ):
                _, _, particle = phrase.partition(" ")
                if particle and particle not in self.terminals["PARTICLE"]:
                    raise ValueError(f"{phrase!r}: there is no particle {particle!r}")
                _require_plain(phrase)

    def _require_phrases(self, more: Mapping[str, Mapping[str, str]]) -> None:
        """Refuses phrases that could not be found, or whose values mean nothing."""
        for name in more.keys() & self.terminals.keys():
            for phrase, value in more[name].items():
                _require_plain(phrase)
                if value not in self.terminals[name].values() and not _is_factor(name, value):
                    raise ValueError(f"{name}: {value!r}, for {phrase!r}, means nothing")

    def value_of(self, terminal: str, phrase: str) -> str:
        """Value of a phrase as this terminal."""
        return self.terminals[terminal][phrase]

    def find_verb(self, word: str, particle: str | None = None) -> Verb | None:
        """The verb that a word makes, alone or with a particle; None if it makes none."""
        return self.verbs.get(word if particle is None else f"{word} {particle}")

    @cached_property
    def verb_words(self) -> Mapping[str, Mapping[str, str]]:
        """`VERB`, `VERB_ED` and `VERB_ING`: form → the verb that it is a form of."""
        words = sorted({phrase.split()[0] for phrase in self.verbs})
        forms = [(word, *self.verb_forms.get(word, _regular_forms(word))) for word in words]
        return {name: {form[i]: form[0] for form in forms} for i, name in enumerate(NAME_TERMINALS)}

    def words_of(self, terminal: str) -> Mapping[str, str]:
        """Everything that a terminal may be, with the value, or the verb that it is a form of."""
        return self.verb_words.get(terminal) or self.terminals[terminal]

    def phrases_of(self, terminal: str) -> list[str]:
        """Everything that a terminal may be, longest first."""
        return sorted(self.words_of(terminal), key=lambda phrase: (-len(phrase), phrase))

    def phrases_for(self, terminal: str, value: str = "") -> list[str]:
        """The phrases by which a terminal says a value; paraphrases use the first."""
        if terminal not in self._phrases_by_value:
            said: dict[str, list[str]] = {}
            for phrase, meant in self.terminals[terminal].items():
                said.setdefault(meant, []).append(phrase)
            self._phrases_by_value[terminal] = said
        return self._phrases_by_value[terminal].get(value, [])

    @cached_property
    def _phrases_by_value(self) -> dict[str, Mapping[str, list[str]]]:
        """Of the terminals that were asked for."""
        return {}

    def declarations(self) -> str:
        """The terminals, declared for a lark grammar whose lexer finds them itself."""
        made = " ".join((*NAME_TERMINALS, *self.terminals))
        return f"%declare {made} WORD KNOWN QUOTED NUMBER NUMBER_WORD"

    @cached_property
    def first_words(self) -> frozenset[str]:
        """Words that phrases of the language begin with wherever they stand."""
        kinds = (k for name, k in self.terminals.items() if name not in ("CUPS", "QUALITY"))
        return frozenset(p.partition(" ")[0] for known in kinds for p in known)

    @cached_property
    def definite_endings(self) -> frozenset[str]:
        """Ends of phrases behind a "the"."""
        definite = (p for known in self.terminals.values() for p in known if "the " in p)
        phrases = (f" {phrase}".rpartition(" the ") for phrase in definite)
        return frozenset(end for _, the, end in phrases if the) - self.nobodies

    @cached_property
    def joints(self) -> frozenset[str]:
        """Words and marks behind which a new command may begin."""
        known = (*self.terminals["SEPARATOR"], *self.terminals["NEXT"])
        return frozenset(phrase.split()[-1] for phrase in known)

    @cached_property
    def silent_words(self) -> frozenset[str]:
        """Words that may stand before a command without being a part of it."""
        names = ("FILLER", "VOCATIVE", "SEPARATOR", "NEXT", "CAN_YOU", "NO")
        return frozenset(w for n in names for p in self.terminals[n] for w in p.split())

    @cached_property
    def openers(self) -> frozenset[str]:
        """Words that by themselves begin something new and mean nothing else ("soup can")."""
        opening = {p for name in OPENERS for p in self.terminals[name] if " " not in p}
        others = [known for name, known in self.terminals.items() if name not in OPENERS]
        return frozenset(opening.difference(*others))

    @cached_property
    def ends_names(self) -> frozenset[str]:
        """Words that are never a part of a name, unless they stand right behind its article."""
        return self.reserved_words - self.openers - self.verb_words["VERB"].keys()

    @cached_property
    def hesitating_words(self) -> frozenset[str]:
        """Words that may be left out behind an article, so that a name cannot begin with them."""
        said = (p for said in self.asides["hesitations"] for p in expand_template(said))
        return frozenset(phrase.split()[0] for phrase in said)

    @cached_property
    def reserved_words(self) -> frozenset[str]:
        """Words that mean something by themselves; they end a name."""
        fillers = [phrase for said in self.asides["fillers"] for phrase in expand_template(said)]
        # "Heavy" has its own meaning behind "is it" alone.
        known = (phrases for name, phrases in self.terminals.items() if name != "QUALITY")
        phrases = (*known, fillers)
        single = {p for known in phrases for p in known if " " not in p}
        return frozenset(
            single | self.later_words | self.vague.keys() | self.numbers.first_words
            | self.verb_words["VERB"].keys() | self.contractions.keys()
        )  # fmt: skip


def _require_plain(phrase: str) -> None:
    if phrase != phrase.casefold():
        raise ValueError(f"{phrase!r}: words of the language are in lower case")


def _is_factor(name: str, value: str) -> bool:
    """Check for the factor of a unit."""
    if not name.endswith("_UNIT") or name == "ANGLE_UNIT":
        return False
    try:
        return float(value) > 0.0
    except ValueError:
        return False


def _regular_forms(verb: str) -> tuple[str, str]:
    """Participle and gerund of a regular verb."""
    if verb.endswith("e"):
        return f"{verb}d", f"{verb[:-1]}ing"
    return f"{verb}ed", f"{verb}ing"


def _expand_verbs(entries: Iterable[Mapping[str, Any]]) -> dict[str, Verb]:
    verbs: dict[str, Verb] = {}
    for entry in entries:
        verb = Verb(**{key: value for key, value in entry.items() if key != "says"})
        verbs = _merge_words(
            "VERB", verbs, {p: verb for t in entry["says"] for p in expand_template(t)}
        )
    return verbs


def _expand_phrases(name: str, values: Mapping[str, Iterable[str]]) -> dict[str, str]:
    phrases: dict[str, str] = {}
    for value, templates in values.items():
        for phrase in chain.from_iterable(map(expand_template, templates)):
            if (known := phrases.setdefault(phrase, value)) != value:
                raise ValueError(f"{name}: {phrase!r} means both {known} and {value}")
    return phrases


def _merge_words(name: str, known: Mapping[str, T], more: Mapping[str, T]) -> dict[str, T]:
    for phrase in known.keys() & more.keys():
        if known[phrase] != more[phrase]:
            raise ValueError(f"{name}: {phrase!r} means both {known[phrase]} and {more[phrase]}")
    return {**known, **more}


@cache
def default_lexicon() -> Lexicon:
    """The language that nlcontrol comes with: the stored words, if they are those of the file."""
    source = WORDS.read_bytes()
    try:
        stored = json.loads(STORED.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        stored = {}
    if stored.get("digest") != sha256(source).hexdigest():
        stored = words_data(source)
    return Lexicon.from_data(stored["words"])


def words_data(source: bytes) -> dict[str, Any]:
    """The words of a lexicon in YAML as the JSON that is stored."""
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    return {"digest": sha256(source).hexdigest(), "words": yaml.load(source, Loader=loader)}


if __name__ == "__main__":
    data = words_data(WORDS.read_bytes())
    STORED.write_text(json.dumps(data, separators=(",", ":")) + "\n", encoding="utf-8")
