"""Sentences of four public sources, and what they mean by their templates.

Labels come from the slots of a template, its family or its task, by the rules below: which frames a
sentence means (any of several, where people differ), or that it asks for what this robot's language
is not about. No text of theirs is kept here.
"""

from __future__ import annotations

import ast
import itertools
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

Pattern = Mapping[str, Any]
"""Part of a frame as JSON: what it says has to be there; of a set, any of its values."""


LABELS: Mapping[str, Any] = yaml.safe_load(
    Path(__file__).with_name("labels.yaml").read_text(encoding="utf-8")
)
"""Names and goals of sources, as data."""


class Sentence(NamedTuple):
    """A sentence with its label.

    Attributes:
        source: where it comes from.
        family: what its template is about.
        text: the sentence.
        meanings: sequences of frames, any of which is meant; none if it is out of the domain.
        refusable: whether a refusal is right as well: what it asks for is not there yet.
    """

    source: str
    family: str
    text: str
    meanings: Sequence[Sequence[Pattern]]
    refusable: bool = False


# --- Language-Table ---------------------------------------------------------------------------

_WAYS = {"up": "away", "down": "toward", "left": "left", "right": "right"}
_BESIDE = {"up": "behind", "down": "in_front_of", "left": "left_of", "right": "right_of"}
_REGIONS = {
    "top": "back_edge", "top_left": "back_left_corner", "top_right": "back_right_corner",
    "center": "center", "center_left": "left_edge", "center_right": "right_edge",
    "bottom": "front_edge", "bottom_left": "front_left_corner",
    "bottom_right": "front_right_corner",
}  # fmt: skip
_BLOCKS = ("red moon", "blue cube", "green star", "yellow pentagon")


def _constants(path: Path) -> dict[str, Any]:
    """The constants of a module whose values are plain data."""
    found: dict[str, Any] = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            try:
                found[node.targets[0].id] = ast.literal_eval(node.value)
            except ValueError:
                continue
    return found


def _place(name: str, *where: tuple[str, Any]) -> list[list[Pattern]]:
    """Meanings: bring a thing to any of these places."""
    goals: list[Pattern] = [{"kind": "place", "relation": r, "reference": ref} for r, ref in where]
    return [[{"object": {"text": name}, "goal": goal}] for goal in goals]


def _named(name: str) -> list[Pattern]:
    return [{"text": name}]


def _language_table(data: Path) -> Iterator[Sentence]:
    rewards = data / "language-table" / "language_table" / "environments" / "rewards"
    sentence = partial(Sentence, "Language-Table")
    common = _constants(rewards / "synonyms.py")
    absolute = _constants(rewards / "block2absolutelocation.py")
    for block, verb in itertools.product(_BLOCKS, common["PUSH_VERBS"]):
        for place, names in absolute["LOCATION_SYNONYMS"].items():
            meant = _place(block, ("at", _REGIONS[place]))
            for name in names:
                if name.startswith("toward"):  # behind "to the": no English
                    continue
                if name in ("left side", "right side"):  # as in "to the left side": to the left
                    meant = [*meant, [_displaced(block, name.split()[0])]]
                yield sentence("to a part of the table", f"{verb} {block} to the {name}", meant)
    pairs = list(itertools.permutations(_BLOCKS, 2))
    for (block, other), verb in itertools.product(pairs, common["PUSH_VERBS"]):
        beside = _place(block, ("next_to", _named(other)))
        toward: Pattern = {"kind": "displace", "toward": {"text": other}}
        for preposition in common["PREPOSITIONS"]:
            meant = [*beside, [{"object": {"text": block}, "goal": toward}]]
            yield sentence("to another block", f"{verb} {block} {preposition} {other}", meant)
    near = _constants(rewards / "block2block_relative_location.py")
    verbs = near["BLOCK2BLOCKRELATIVELOCATION_VERBS"]
    for (block, other), verb in itertools.product(pairs, verbs):
        for way, names in near["DIRECTION_SYNONYMS"].items():
            meant = _place(block, (_side_of_thing(way), _named(other)))
            for name in names:
                yield sentence("beside another block", f"{verb} {block} {name} {other}", meant)
    yield from _language_table_directions(_constants(rewards / "block2relativelocation.py"))
    apart = _constants(rewards / "separate_blocks.py")["SEPARATE_TEMPLATES"]
    for (block, other), template in itertools.product(pairs, apart):
        away: Pattern = {"kind": "displace", "away_from": {"text": other}}
        text = template % (block, other)
        yield sentence("apart", text, [[{"object": {"text": block}, "goal": away}]])
    for block, point in itertools.product(_BLOCKS, common["POINT_PREPOSITIONS"]):
        yield sentence("the arm itself", f"{point} {block}", ())


def _side_of_thing(way: str) -> str:
    if not way.startswith("diagonal"):
        return _BESIDE[way]
    _, along, across = way.split("_")
    return f"{'behind' if along == 'up' else 'front'}_{across}_of"


def _language_table_directions(said: Mapping[str, Any]) -> Iterator[Sentence]:
    verbs, ways = said["BLOCK2RELATIVELOCATION_VERBS"], said["DIRECTION_SYNONYMS"]
    sentence = partial(Sentence, "Language-Table", "directions")
    plain: list[tuple[str, list[list[str | list[str]]]]] = []
    plain += [(words, [[_WAYS[w]]]) for w, many in ways.items() for words in many]
    for along, across in itertools.product(("up", "down"), ("left", "right")):
        one, other = _WAYS[along], _WAYS[across]
        for both in itertools.product(ways[along], ways[across]):
            for template in said["DIAGONAL_PREPOSITIONS"]:
                meant: list[list[str | list[str]]] = [[[one, other]]]
                if "then" in template:
                    meant.append([one, other])
                plain.append((template % both, meant))
    little = said["SLIGHTLY_SYNONYMS"]
    for block, verb in itertools.product(_BLOCKS[:2], verbs):
        for words, meant in plain:
            yield sentence(f"{verb} {block} {words}", _moves(block, meant, little=False))
            slightly = [f"slightly {verb} {block} {words}"]
            slightly += [f"{verb} {block} {degree} {words}" for degree in little]
            slightly += [f"{verb} {block} {words} {degree}" for degree in little]
            for text in slightly:
                yield sentence(text, _moves(block, meant, little=True))


def _moves(block: str, ways: list[list[str | list[str]]], *, little: bool) -> list[list[Pattern]]:
    """Meanings: displacements one after the other; a little belongs to any of them."""
    out: list[list[Pattern]] = []
    for way in ways:
        marks = range(len(way)) if little else [-1]
        for mark in marks:
            goals = [{"kind": "displace", "direction": d} for d in way]
            if little:
                goals[mark] = {**goals[mark], "amount": "little"}
            out.append([{"object": {"text": {block, "it"}}, "goal": goal} for goal in goals])
    return out


# --- CALVIN -----------------------------------------------------------------------------------

_HELD = {"action": "lift"}
_TURNS = {"left": "ccw", "right": "cw"}


def _calvin(data: Path) -> Iterator[Sentence]:
    path = data / "calvin" / "calvin_models" / "conf" / "annotations" / "new_playtable.yaml"
    for task, texts in yaml.safe_load(path.read_text(encoding="utf-8")).items():
        for text in dict.fromkeys(texts):
            family, meant, refusable = _calvin_label(task, text)
            yield Sentence("CALVIN", family, text, meant, refusable)


def _calvin_label(task: str, text: str) -> tuple[str, list[list[Pattern]], bool]:
    """Family and meanings of a task's sentence, and whether it may as well be refused."""
    match task.split("_"):
        case ["rotate", colour, "block", way]:
            goal: Pattern = {"kind": "rotate", "sense": _TURNS[way]}
            return "rotate", _perhaps_held(f"{colour} block", goal), False
        case ["push", colour, "block", way]:
            return "push", [[_displaced(f"{colour} block", way)]], False
        case ["move", "slider", way]:
            door = _displaced({"door", "sliding door", "it"}, way)
            if "all the way" in text:
                return "slide", _place("door", ("at", f"{way}_edge")), False
            return "slide", [[door], [_HELD, door]], False
        case ["open" | "close" as what, "drawer"]:
            direct: Pattern = {"goal": {"kind": {what, "displace"}}}
            return "open, close", [[direct], [_HELD, direct]], False
        case ["lift", colour, "block", "table"]:
            lift: Pattern = {"object": {"text": f"{colour} block"}, "goal": {"kind": "lift"}}
            again: Pattern = {"object": {"text": "it"}, "goal": {"kind": "lift"}}
            return "lift", [[lift], [lift, again]], False
        case ["lift", colour, "block", _]:
            held: Pattern = {"object": {"text": f"{colour} block", "relation": {"in", "on"}}}
            out: Pattern = {"goal": {"kind": "place", "relation": {"out_of", "off"}}}
            return "containers", [[{**held, "goal": {"kind": "lift"}}], [out]], True
        case ["place" | "push", "in" | "into", _]:
            inside: Pattern = {"goal": {"kind": "place", "relation": "in"}}
            return "containers", [[inside]], True
        case ["stack", _]:
            return "stacks", [[{"goal": {"kind": "place", "relation": "on"}}]], True
        case ["unstack", _]:
            off: Pattern = {"goal": {"kind": "place", "relation": "off"}}
            toppled: Pattern = {"goal": {"kind": "topple"}}
            return "stacks", [[off], [toppled], [{"goal": {"kind": "lift"}}]], True
    return "lights", [], True


def _displaced(name: str | set[str], way: str) -> Pattern:
    return {"object": {"text": name}, "goal": {"kind": "displace", "direction": way}}


def _perhaps_held(name: str, goal: Pattern) -> list[list[Pattern]]:
    """Meanings: something done to a thing, or to it once it is held."""
    own: Pattern = {"object": {"text": name}}
    return [[{**own, "goal": goal}], [{**own, **_HELD}, {"object": {"text": "it"}, "goal": goal}]]


# --- RLBench ----------------------------------------------------------------------------------

_TAKEN: Pattern = {"goal": {"kind": "place", "relation": {"off", "out_of"}}}
"""What a thing stands in or on it is taken from first: "slide it out of the block, and …"."""

_SLOTS = {"%s": "red", "%d": "2"}


def _rlbench(data: Path) -> Iterator[Sentence]:
    for path in sorted((data / "RLBench" / "rlbench" / "tasks").glob("*.py")):
        texts = {_filled(text) for text in _returned_texts(path)}
        for text in sorted(texts):
            goals = _goals_of_task(path.stem)
            meant: list[list[Pattern]] = [[{"goal": {"kind": goals}}]] if goals else []
            if goals:
                meant += [[_HELD, *meant[0]], [_TAKEN, *meant[0]]]
            family = "in the domain" if goals else "out of the domain"
            yield Sentence("RLBench", family, text, meant, refusable=not goals)


def _goals_of_task(task: str) -> set[str]:
    verb, _, thing = task.partition("_")
    if verb in ("open", "close") and thing in LABELS["RLBench"]["opened"]:
        return {verb, "displace"}
    return set(LABELS["RLBench"]["goals"].get(task, ()))


def _returned_texts(path: Path) -> Iterator[str]:
    """The texts in the lists that the functions of a module return, with their slots."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Return) and isinstance(node.value, ast.List):
            for element in node.value.elts:
                filled = isinstance(element, ast.BinOp) and isinstance(element.op, ast.Mod)
                text = element.left if isinstance(element, ast.BinOp) and filled else element
                if isinstance(text, ast.Constant) and isinstance(text.value, str):
                    yield text.value


def _filled(template: str) -> str:
    return re.sub("%[sd]", lambda match: _SLOTS[match.group()], template)


# --- GPSR -------------------------------------------------------------------------------------

_GPSR_COUNT = 600
_GPSR_OBJECTS = ("mug", "soup can", "tea box", "bottle")
_GPSR_PLACES = ("shelf", "desk", "side table", "counter")


def _gpsr(data: Path) -> Iterator[Sentence]:
    path = data / "CommandGenerator" / "src" / "robocupathome_generator" / "gpsr_commands.py"
    module: dict[str, Any] = {}
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), module)
    names = (["Ada", "Max"], list(_GPSR_PLACES), list(_GPSR_PLACES), ["kitchen", "office"],
             list(_GPSR_OBJECTS), ["drinks"], ["drink"])  # fmt: skip
    generator = module["CommandGenerator"](*names)
    random.seed(0)
    texts = {generator.generate_command_start("objects") for _ in range(_GPSR_COUNT)}
    texts |= {generator.generate_command_start("people") for _ in range(_GPSR_COUNT)}
    for text in sorted(texts):
        yield _gpsr_label(text)


def _gpsr_label(text: str) -> Sentence:
    """In the domain is what takes a thing from a place, or puts or hands it somewhere."""
    taken = re.match(r"(get|grasp|take|fetch) an? ([a-z ]+) from the", text)
    told = re.match(r"(tell|bring|give) me (what is the|an? )", text)
    sentence = partial(Sentence, "GPSR")
    if taken and text.endswith("me"):
        handed: Pattern = {"goal": {"kind": {"hand_over", "displace"}}}
        return sentence("take and hand over", text, [[{"object": {"text": taken[2]}}, handed]])
    if taken and re.search(r"(put|place) it on the [a-z ]+$", text):
        put: Pattern = {"goal": {"kind": "place", "relation": "on"}}
        return sentence("take and place", text, [[{"object": {"text": taken[2]}}, put]])
    if told and text.startswith(("bring", "give")):
        goal: Pattern = {"goal": {"kind": {"hand_over", "displace"}}}
        return sentence("bring", text, [[goal]])
    return sentence("out of the domain", text, (), refusable=True)


SOURCES = (_language_table, _calvin, _rlbench, _gpsr)
