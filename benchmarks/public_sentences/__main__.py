"""How sentences of public sources are read, beside what they mean by rule.

    python -m benchmarks.public_sentences DATA [--half develop|judge] [--show]
    python -m benchmarks.public_sentences DATA --half all --sources tasks

DATA holds what was fetched of repositories, each in a folder of its name: of those with `templates`
`language-table` (google-research), `calvin` (mees), `RLBench` (stepjam) and `CommandGenerator`
(RoboCupAtHome); of those of `tasks`, none of which was developed with, `LIBERO`
(Lifelong-Robot-Learning), `Metaworld` (Farama-Foundation), `cliport` (cliport), `VIMABench`
(vimalabs), `soar` (rail-berkeley) and `ManiSkill2_real2sim` (simpler-env, with the instructions of
RT-1 and BridgeData). Half of the sentences with templates, by the hash of the text, is for
developing; the other half is for judging, and of it only the classes of failures are printed.

A sentence of the domain is read as meant, refused, or read wrongly. One outside the domain should
be refused: by its words, by the name of a capability that is missing, or, since some name what no
table has, by the name of an object. What is read is resolved in the scene `kitchen`, as for a user;
nothing moves before every object is found. "Accepted", and "wrong", could be carried out.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from benchmarks.public_sentences import task_sources, template_sources
from benchmarks.public_sentences.template_sources import Sentence
from grammar.errors import ParseError
from grammar.frames.command import Command
from grammar.parser import default_parser
from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller

_MISSING = {"in", "out_of", "off", "on"}
"""Places that are understood, and refused by the name of the capability that is missing."""

_RIGHT = ("as meant", "refused rightly", "refused for a capability", "refused at a name")


def agrees(value: Any, pattern: Any) -> bool:
    """Check that a value of a frame as JSON is what a pattern says."""
    if isinstance(pattern, set):
        return any(agrees(value, one) for one in pattern)
    if isinstance(pattern, Mapping):
        return isinstance(value, dict) and all(agrees(value.get(k), p) for k, p in pattern.items())
    if isinstance(pattern, list):
        same = isinstance(value, list) and len(value) == len(pattern)
        return same and all(map(agrees, value, pattern))
    return bool(value == pattern)


def outcome_of(sentence: Sentence) -> str:
    """How a sentence is read: as meant, refused (with the code), or wrongly."""
    try:
        command = default_parser().parse(sentence.text)
    except ParseError as error:
        right = sentence.refusable or not sentence.meanings
        return "refused rightly" if right else f"refused: {error.code}"
    frames = command.model_dump(mode="json")["frames"]
    for meaning in sentence.meanings:
        if len(meaning) == len(frames) and all(map(agrees, frames, meaning)):
            return "as meant"
    places = {frame["goal"].get("relation") for frame in frames}
    if not sentence.meanings and places & _MISSING:
        return "refused for a capability"
    if sentence.meanings:
        return "wrong" if _finds_objects(command) else "wrong, but refused at a name"
    return "accepted" if _finds_objects(command) else "refused at a name"


@cache
def _kitchen() -> Controller:
    return Controller("kitchen")


def _finds_objects(command: Command) -> bool:
    """Check for a command whose objects all stand in the kitchen."""
    try:
        _kitchen().resolve(command)
    except ControlError:
        return False
    return True


def in_half(text: str, half: str) -> bool:
    """Check that a text belongs to a half of its source; all do to the whole."""
    return half == "all" or sha256(text.encode()).digest()[0] % 2 == (half == "judge")


def tables(sentences: Iterable[Sentence], show: bool) -> Iterator[str]:
    """The lines of a report: each family's outcomes; with `show` each failure."""
    found: dict[tuple[str, str], Counter[str]] = {}
    for sentence in sentences:
        outcome = outcome_of(sentence)
        found.setdefault(sentence[:2], Counter())[outcome] += 1
        if show and outcome not in _RIGHT:
            yield f"  {outcome}: {sentence.text}"
    for (source, family), outcomes in found.items():
        good, count = sum(outcomes[right] for right in _RIGHT), sum(outcomes.values())
        others = ", ".join(f"{what} {n}" for what, n in outcomes.most_common())
        yield f"{source:15} {family:25} {count:5} {100 * good / count:5.1f} %  {others}"


def main() -> None:
    """Read the sentences of a half and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("data", type=Path, help="folder with the fetched repositories")
    parser.add_argument("--sources", choices=("templates", "tasks"), default="templates")
    parser.add_argument("--half", choices=("develop", "judge", "all"), default="develop")
    parser.add_argument("--show", action="store_true", help="print each failure (develop only)")
    options = parser.parse_args()
    module = template_sources if options.sources == "templates" else task_sources
    for source in module.SOURCES:
        chosen = (s for s in source(options.data) if in_half(s.text, options.half))
        for line in tables(chosen, options.show and options.half == "develop"):
            print(line)


if __name__ == "__main__":
    main()
