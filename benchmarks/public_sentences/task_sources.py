"""Sentences of six more public sources, with labels made by rule before any of them is read.

What can be held or stood on is renamed, by `labels.yaml`, to things that stand in the scene
`kitchen`, so that what is read wrongly could be carried out. Furniture (drawers, stoves, shelves)
keeps its name; no table has any, so what needs it may as well be refused. No text of the sources is
kept here.
"""

from __future__ import annotations

import ast
import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from benchmarks.public_sentences.template_sources import LABELS, Pattern, Sentence

_NAMES: Mapping[str, Mapping[str, str]] = LABELS["names"]
_FURNITURE = re.compile(
    r"\b(stove|cabinet|drawer|microwave|caddy|rack|shelf|machine|faucet|dial|door|window|hole|peg"
    r"|goal|pallet|stand|kit|drying)"
)


def _renamed(text: str, names: Mapping[str, str]) -> str:
    """A text with the names of a source replaced, the longest first."""
    longest = sorted(names, key=len, reverse=True)
    pattern = rf"\b({'|'.join(map(re.escape, longest))})\b"
    return re.sub(pattern, lambda match: names[match[1]], text)


# --- clauses ----------------------------------------------------------------------------------

_PLACES = {
    "on the top of": "on", "on top of": "on", "onto": "on", "on": "on",
    "inside": "in", "into": "in", "in": "in",
    "to the left of": "left_of", "to the right of": "right_of",
    "to the front of": "in_front_of", "near": "next_to", "next to": "next_to", "to": "",
}  # fmt: skip
_OWN_PLACE = r"(?: (?:at the back|at the front|in the middle|on the left|on the right))"
_PUT = re.compile(
    rf"(?:put|place|stack|move|push|pack) (?P<what>.+?){_OWN_PLACE}?"
    rf" (?P<where>{'|'.join(_PLACES)}) (?P<other>.+)"
)
_ASIDE = re.compile(r"move (?P<what>.+) to the (?P<side>left|right) side(?: of the table)?")
_TAKEN = re.compile(r"remove (?P<what>.+) from (?:inside )?(?P<other>.+)")
_PICKED = re.compile(r"pick (?:up )?(?P<what>.+)")
_OPENED = re.compile(r"(?P<verb>open|close) (?P<what>.+)")


class Clause(NamedTuple):
    """What a clause means.

    Attributes:
        meanings: frames, any of which is meant; none if it is out of the domain.
        picked: name of what it only picks up.
    """

    meanings: Sequence[Sequence[Pattern]]
    picked: str = ""


def _bare(words: str) -> str:
    """A name without its article and without the place that tells it apart."""
    name = re.split(r" (?:between|from|in|next to|on|at|near) ", words)[0]
    return re.sub(r"^(both )?(the |an? )", "", name)


def _clause(text: str) -> Clause:
    """The meaning of an imperative clause by its verb and its preposition."""
    if match := _ASIDE.fullmatch(text):
        own: Pattern = {"text": _bare(match["what"])}
        way = match["side"]
        sides = {f"{way}_edge", f"{way}_half"}
        goals: list[Pattern] = [
            {"kind": "place", "reference": sides}, {"kind": "displace", "direction": way},
            {"kind": "displace", "toward": sides},
        ]  # fmt: skip
        return Clause([[{"object": own, "goal": goal}] for goal in goals])
    if match := _TAKEN.fullmatch(text):
        own = {"text": _bare(match["what"])}
        out: Pattern = {"kind": "place", "relation": {"out_of", "off"}}
        return Clause([[{"object": own, "goal": out}]])
    if match := _PUT.fullmatch(text):
        return Clause([_put(match["what"], _PLACES[match["where"]], match["other"])])
    if match := _PICKED.fullmatch(text):
        name = _bare(match["what"])
        return Clause([[{"action": "lift", "object": {"text": name}}]], name)
    if match := _OPENED.fullmatch(text):
        return Clause([[{"goal": {"kind": match["verb"]}}]])
    return Clause(())


def _put(what: str, relation: str, other: str) -> list[Pattern]:
    """One frame for each thing that is named."""
    goal: dict[str, object] = {"kind": "place"}
    if relation:
        goal["relation"] = relation
    if not re.search(r"\b(of|in|at|on|and|it)\b", other):
        goal["reference"] = [{"text": _bare(other)}]
    if what.startswith("both ") and " and " not in what:
        return [{"object": {"quantifier": "both"}, "goal": goal}]
    names = map(_bare, what.split(" and "))
    return [{"object": {"text": {n, "it", "them"} if n in ("it", "them") else n}, "goal": goal}
            for n in names]  # fmt: skip


def _labelled(source: str, text: str) -> Sentence:
    """A sentence with the meanings of its clauses, one after the other."""
    plain = re.sub(" inside$", " inside it", text.lower().rstrip("."))
    clauses = [_clause(c) for c in re.split(r" and (?=(?:put|place|close|open|turn)\b)", plain)]
    sentence = partial(Sentence, source)
    if not all(clause.meanings for clause in clauses):
        return sentence("out of the domain", text, ())
    meanings = [
        [*itertools.chain.from_iterable(way)]
        for way in itertools.product(*(c.meanings for c in clauses))
    ]
    if clauses[0].picked and len(clauses) > 1:
        own: Pattern = {"text": clauses[0].picked}
        meanings += [[{**rest[1], "object": own}, *rest[2:]] for rest in meanings]
    if " and put it on the table" in plain or " and place it on the table" in plain:
        down: Pattern = {"goal": {"kind": "set_down"}}
        meanings += [[*frames[:-1], down] for frames in meanings]
        meanings += [frames[:1] for frames in meanings]
    furnished = bool(_FURNITURE.search(plain))
    return sentence("furniture" if furnished else "things", text, meanings, furnished)


# --- LIBERO, SOAR, SimplerEnv -----------------------------------------------------------------


def _libero(data: Path) -> Iterator[Sentence]:
    texts = set()
    for path in (data / "LIBERO").rglob("*.bddl"):
        said = re.search(r"\(:language ([^)]*)\)", path.read_text(encoding="utf-8"))
        if said:
            texts.add(_renamed(said[1].strip().lower(), _NAMES["LIBERO"]))
    for text in sorted(texts):
        yield _labelled("LIBERO", text)


def _soar(data: Path) -> Iterator[Sentence]:
    texts = set()
    for path in (data / "soar").rglob("task_definition.yaml"):
        tasks = yaml.safe_load(path.read_text(encoding="utf-8"))["task_list"]
        texts |= {_renamed(task.strip(), _NAMES["SOAR"]) for task in tasks}
    for text in sorted(texts):
        yield _labelled("SOAR", text)


def _simpler(data: Path) -> Iterator[Sentence]:
    scenes = data / "ManiSkill2_real2sim" / "mani_skill2_real2sim" / "envs" / "custom_scenes"
    grasps = (scenes / "grasp_single_in_scene.py").read_text(encoding="utf-8")
    near = (scenes / "move_near_in_scene.py").read_text(encoding="utf-8")
    held = {_as_name(name) for name in re.findall(r'"model_ids"\] = \["([a-z0-9_]+)"', grasps)}
    held &= set(_NAMES["SimplerEnv"])
    texts = {f"pick {name}" for name in held}
    triplets = ast.literal_eval(_first(r"self\.triplets = (\[.*?\n        \])", near))
    for triplet in triplets:
        pairs = itertools.permutations(map(_as_name, triplet), 2)
        texts |= {f"move {one} near {other}" for one, other in pairs}
    put = (scenes / "put_on_in_scene.py").read_text(encoding="utf-8")
    texts |= set(re.findall(r'return "((?:put|stack) [^"]+)"', put))
    for drawer in ("top", "middle", "bottom"):
        texts |= {f"open {drawer} drawer", f"close {drawer} drawer"}
        texts |= {f"place {name} into {drawer} drawer" for name in ("apple", "sponge")}
    for text in sorted({_renamed(text, _NAMES["SimplerEnv"]) for text in texts}):
        yield _labelled("SimplerEnv", text)


def _as_name(model: str) -> str:
    return re.sub(r"^(baked_)?(opened_)?", "", model).replace("_", " ")


def _meant(goal: Mapping[str, Any] | None) -> list[list[Pattern]]:
    """The meanings of a label: a frame with its goal, of any of several values; none without."""
    if goal is None:
        return []
    return [[{"goal": {k: set(v) if isinstance(v, list) else v for k, v in goal.items()}}]]


def _first(pattern: str, text: str) -> str:
    found = re.search(pattern, text, re.DOTALL)
    return found[1] if found else ""


# --- Meta-World -------------------------------------------------------------------------------


def _meta_world(data: Path) -> Iterator[Sentence]:
    path = next((data / "Metaworld").rglob("task_descriptions.md"))
    tasks = re.findall(r"^## (.+)\n([^.]+\.)", path.read_text(encoding="utf-8"), re.MULTILINE)
    for task, said in tasks:
        text, meant = _renamed(said, _NAMES["Meta-World"]), _meant(LABELS["Meta-World"].get(task))
        meant += [[{"action": "lift"}, *meant[0]]] if meant else []
        family = "furniture" if meant else "out of the domain"
        yield Sentence("Meta-World", family, text, meant, refusable=True)


# --- CLIPort ----------------------------------------------------------------------------------


def _cliport(data: Path) -> Iterator[Sentence]:
    for task, labelled in LABELS["CLIPort"].items():
        label = labelled or {}
        path = data / "cliport" / "cliport" / "tasks" / f"{task}.py"
        template = _first(r'self\.lang_template = "([^"]+)"', path.read_text(encoding="utf-8"))
        meant = _meant(label.get("goal"))
        refusable = not meant or "furniture" in label
        family = "out of the domain" if not meant else "furniture" if refusable else "things"
        for slot in label.get("slots", [{}]):
            text = _renamed(template.format(**slot), _NAMES["CLIPort"])
            yield Sentence("CLIPort", family, text, meant, refusable)


# --- VIMA-Bench -------------------------------------------------------------------------------

_VIMA_THINGS = ("coffee box", "mug", "ice tea cup", "ice tea")
_VIMA_ANGLES = (30, 60, 90, 120, 150)
_IN: Pattern = {"kind": "place", "relation": "in"}


def _vima(data: Path) -> Iterator[Sentence]:
    suite = data / "VIMABench" / "vima_bench" / "tasks" / "task_suite"
    sentence = partial(Sentence, "VIMA-Bench")

    def template(path: str) -> str:
        text = (suite / f"{path}.py").read_text(encoding="utf-8")
        return _first(r'prompt_template="([^"]+)"', text)

    put, turn = template("instruction_following/simple_manipulation"), template(
        "instruction_following/rotate")  # fmt: skip
    for one, other in itertools.permutations(_VIMA_THINGS, 2):
        goal: Pattern = {**_IN, "reference": [{"text": other}]}
        text = put.format(dragged_obj=one, base_obj=other)
        yield sentence("things", text, [[{"object": {"text": one}, "goal": goal}]])
    for name, angle in itertools.product(_VIMA_THINGS[:3], _VIMA_ANGLES):
        turned: Pattern = {"kind": "rotate", "angle": {math.radians(angle), angle * math.pi / 180}}
        text = turn.format(dragged_obj=name, angle_in_degree=angle)
        yield sentence("things", text, [[{"object": {"text": name}, "goal": turned}]])
    for kind, det in itertools.product(("touching", "exceeding"), ("all", "two")):
        text = template(f"constraint_satisfaction/without_{kind}").format(
            det=det, swept_obj="boxes", bounds="the ice tea cup", constraint="the mug"
        )
        meant = [[{"goal": _IN, "constraints": [{"kind": "no_touch"}]}]]
        yield sentence("sweep", text, meant if kind == "touching" else (), refusable=True)
    same = template("require_reasoning/same_color").format(base_obj="the mug")
    yield sentence("out of the domain", same, ())
    yield sentence(
        "out of the domain", template("rearrangement/rearrange").format(scene="setup"), ()
    )


SOURCES = (_libero, _soar, _simpler, _meta_world, _cliport, _vima)
