"""Sentences of all kinds, with constraints, about the objects of a world.

A sentence speaks of one object, the target, and where it can of others. What kind it is follows
from the case's number, so that each kind comes equally often; everything else is drawn. Most are
what a person at such a table would say: a share of `SENSIBLE` is drawn again until it makes sense
(see `sense`), `TRIES` times at most, and about a target that fits: what is turned has corners, and
what is tilted or toppled topples before it slides when it is pushed high. The others are drawn
blindly and about anything; most of these should be refused. The words are those of
`docs/language_reference.md`.

In hard worlds settings and their kinds take turns, and every sentence is drawn until it makes
sense. With sentences about several things (`wish_sentences`) the world is drawn again, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from benchmarks.goals.drawn_worlds import (
    LIDDED,
    SETTINGS,
    SMALL_TABLE,
    Setting,
    believed,
    draw_things,
    hard_scene,
    height_below,
    scene_object,
    standing,
)
from benchmarks.goals.sense import sensible, tips
from benchmarks.goals.wish_sense import is_sensible
from benchmarks.goals.wish_sentences import say
from benchmarks.goals.wishes import WISHED, Wish, Wished
from nlcontrol.batches.drawn_scenes import (
    FRAGILE,
    Generator,
    draw_scene_with,
    draw_truth,
    pushable_models,
    scene_of,
)
from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller
from objectmodels import BoxModel, CylinderModel, ObjectModel, Registry
from planner.types.world_state import SeenObject, WorldState
from sim.robots.cell_description import Vision
from sim.simulated_executor import simulation
from sim.truth.scene_file import Scene

PushKind = Literal["displace", "place", "rotate", "tilt", "topple", "until", "steps"]
Kind = Literal[PushKind, "lift", "carry", "open"]
Suite = Literal["roomy", "hard", "several"]
KINDS: tuple[PushKind, ...] = get_args(PushKind)

HARD: dict[Setting, tuple[Kind, ...]] = {
    "narrow": ("displace", "place", "rotate", "topple", "lift", "carry"),
    "fallen": ("displace", "place", "rotate", "until"),
    "many": (*KINDS, "lift", "carry"),
    "wide": (*KINDS, "lift", "carry", "open"),
}
"""Kinds of goals in each setting of a hard world."""

SIDES = ("away", "toward me", "to the left", "to the right")
SENSES = ("clockwise", "counterclockwise", "to the left", "to the right")
REGIONS = ("middle of the table", "left edge", "right edge", "far edge")

SENSIBLE = 0.9
"""Share of sentences that are drawn until they make sense; in hard worlds all are."""
TRIES = 30
"""Sentences that are drawn for a world before the last is taken as it is."""

COMPOUND: tuple[Kind, ...] = ("steps", "carry")
"""What takes several actions."""

_PLAIN = 0.35  # share of goals without any constraint
_SECOND = 0.3  # share of the others with a second one
_UPRIGHT = 0.4  # share of constraints that are "without toppling it"


class Job(NamedTuple):
    """One case.

    Attributes:
        seed, number: which world and sentence.
        suite: usual worlds, hard ones, or sentences about several things.
        executed: whether it is carried out; else it is planned only.
    """

    seed: int
    number: int
    suite: Suite = "roomy"
    executed: bool = True

    def __str__(self) -> str:
        return f"{self.seed}-{self.number}"


@dataclass(frozen=True)
class Sentence:
    """What is said in a world.

    Attributes:
        kind: of its goal.
        target: the object that it is about.
        text: the words.
        sensible: whether it was drawn until it made sense, and did.
        wish: what is meant, if it is about several things.
    """

    kind: Kind | Wished
    target: str
    text: str
    sensible: bool
    wish: Wish | None = None


def kinds_of(job: Job) -> Sequence[Kind | Wished]:
    """Kinds of goals that take turns with a case's."""
    if job.suite == "hard":
        return HARD[setting_of(job)]
    return WISHED if job.suite == "several" else KINDS


def kind_of(job: Job) -> Kind | Wished:
    """Kind of the goal of a case."""
    kinds = kinds_of(job)
    turn = job.number // len(SETTINGS) if job.suite == "hard" else job.number
    return kinds[turn % len(kinds)]


def setting_of(job: Job) -> Setting:
    """Setting of a case in a hard world."""
    return SETTINGS[job.number % len(SETTINGS)]


def beliefs_of(job: Job) -> Registry:
    """What the robot believes in the world of a case."""
    return believed(wide=job.suite == "hard" and setting_of(job) == "wide")


def said(job: Job) -> tuple[Scene, Sentence]:
    """The world of a case, and what is said in it."""
    if job.suite == "several":
        return _wished(job)
    rng, kind, hard = (
        np.random.default_rng((job.seed, job.number)),
        kind_of(job),
        job.suite == "hard",
    )
    blind = not hard and bool(rng.random() >= SENSIBLE)
    among = _among(job, kind, blind)
    if hard:
        scene = hard_scene(str(job), setting_of(job), rng, among)
    else:
        scene = draw_scene_with(str(job), rng, among, alone=False)
    target, *others = (item.name for item in scene.objects)
    words = _Words(standing(scene)[target].model, others, rng)
    text = _GOALS[kind](words)
    if blind:
        return scene, Sentence(kind, target, text, sensible=False)
    robot = Controller(scene, registry=beliefs_of(job))
    for _ in range(TRIES - 1):
        if _sensible(text, robot):
            break
        text = _GOALS[kind](words)
    return scene, Sentence(kind, target, text, sensible=_sensible(text, robot))


def _wished(job: Job) -> tuple[Scene, Sentence]:
    """The world of a sentence about several things, drawn by seed, kind and its number alone."""
    kind = WISHED[job.number % len(WISHED)]
    number = job.number // len(WISHED)
    rng = np.random.default_rng((job.seed, number, *kind.encode()))
    blind = bool(rng.random() < 1.0 - SENSIBLE)
    for _ in range(1 if blind else TRIES):
        things = draw_things(kind, rng)
        text, wish = say(kind, things, rng)
        truths = [draw_truth(seen.standing_model, rng) for seen in things]
        named = (*wish.moved, *wish.told)
        objects = [
            scene_object(
                seen,
                truth,
                z=height_below(seen, things),
                fragile=seen.name not in named and bool(rng.random() < FRAGILE),
            )
            for seen, truth in zip(things, truths, strict=True)
        ]
        scene = scene_of(f"{job.seed}-{kind}-{number}", objects, Vision())
        if kind == "edge":
            scene = scene.model_copy(update={"table": SMALL_TABLE})
        if makes_sense := is_sensible(wish, standing(scene)):
            break
    target = wish.moved[0] if wish.moved else things[0].name
    return scene, Sentence(kind, target, text, makes_sense, wish)


def _among(job: Job, kind: Kind | Wished, blind: bool) -> list[ObjectModel]:
    """Models, one of which is that of the target."""
    if kind == "open":
        return [Registry.built_in().get(name) for name in LIDDED]
    if job.suite == "hard" and setting_of(job) == "fallen":
        return [model for model in pushable_models() if isinstance(model, BoxModel)]
    return [model for model in pushable_models() if blind or fits(kind, model)]


def _sensible(text: str, robot: Controller) -> bool:
    state = WorldState(standing(simulation(robot.executor).scene), robot.table)
    try:
        frames = robot.resolve(robot.parse(text)).frames
    except ControlError:
        return False
    return sensible(frames, state)


def fits(kind: Kind | Wished, model: ObjectModel) -> bool:
    """Whether a kind of goal may make sense for an object, by its shape."""
    if kind in ("rotate", "steps"):
        return not isinstance(model, CylinderModel)
    return kind not in ("tilt", "topple") or tips(model)


def sentence_about(target: SeenObject, kind: Kind, others: Sequence[str], rng: Generator) -> str:
    """A sentence of a kind, drawn blindly.

    Args:
        target: the object that it is about, by its name in the scene.
        kind: of its goal.
        others: names of what it may speak of besides.
        rng: to draw from.
    """
    return _GOALS[kind](_Words(target.model, others, rng, target.name))


class _Words:
    """Draws words about a target among others."""

    def __init__(
        self, target: ObjectModel, others: Sequence[str], rng: Generator, name: str = ""
    ) -> None:
        self.target, self.others, self.rng = target, others, rng
        self.it = f"the {name or target.name}"

    def one(self, choices: Sequence[str]) -> str:
        return choices[int(self.rng.integers(len(choices)))]

    def whole(self, low: int, high: int, step: int = 1) -> int:
        """One of low, low + step, … up to high."""
        return low + step * int(self.rng.integers((high - low) // step + 1))

    def other(self) -> str:
        return f"the {self.one(self.others)}"

    def fingers(self) -> str:
        return self.one(("with one finger", "with two fingers"))

    def with_(self, goal: str, constraints: Sequence[str]) -> str:
        """The goal with up to two constraints."""
        if self.rng.random() < _PLAIN:
            return goal
        upright = ["without toppling it"] if "without toppling it" in constraints else []
        chosen = upright if self.rng.random() < _UPRIGHT else []
        left = [c for c in constraints if c not in upright]
        while left and len(chosen) < 1 + (self.rng.random() < _SECOND):
            chosen.append(left.pop(int(self.rng.integers(len(left)))))
        return " ".join([goal, *chosen])

    def sliding(self) -> list[str]:
        """What may be asked of the way over the table."""
        model = self.target
        needed = model.friction * model.weight
        force = max(0.5, round(2.0 * needed * float(self.rng.uniform(0.8, 3.0))) / 2.0)
        asked = [
            "without toppling it", "without tilting it", "without turning it", "slowly", "gently",
            f"with at most {force:g} N", f"no faster than {self.whole(2, 6)} cm/s",
            "at the bottom", "in the middle", "near the top", "3 cm above the table",
            self.fingers(), f"within {self.whole(4, 20)} s",
            f"without tilting it more than {self.whole(3, 8)} degrees", "without touching anything",
        ]  # fmt: skip
        if self.others:
            asked += [f"without touching {self.other()}"] * 2
            asked.append(f"and stay {self.whole(2, 5)} cm away from {self.other()}")
        return asked


def _displace(words: _Words) -> str:
    it, side, d = words.it, words.one(SIDES), words.whole(5, 30)
    goals = [f"push {it} {d} cm {side}"] * 3
    goals += [
        f"push {it} {d} cm {words.one(('away', 'toward me'))} and {words.one(SIDES[2:])}",
        f"push {it} {d} cm heading {words.whole(0, 350, 10)} degrees",
        f"push {it} a {words.one(('little', 'lot'))} {side}",
        f"push {it} at {words.one(('least', 'most'))} {d} cm {side}",
        f"slide {it} {d} cm {side}",
        f"pull {it} {d} cm toward me",
        f"push {it} {words.one(('half', 'twice'))} its {words.one(('width', 'height'))} {side}",
    ]
    if words.others:
        goals += [
            f"push {it} {words.whole(5, 12)} cm toward {words.other()}",
            f"push {it} {words.whole(5, 20)} cm away from {words.other()}",
            f"push {it} {words.one(('halfway', 'a third of the way'))} to {words.other()}",
        ]
    return words.with_(words.one(goals), words.sliding())


def _place(words: _Words) -> str:
    it = words.it
    x, y = words.whole(42, 68) / 100, words.whole(-30, 30) / 100
    goals = [f"push {it} to x {x:g} y {y:g}"] * 2
    goals.append(f"push {it} to the {words.one(REGIONS)}")
    if words.others:
        other, gap = words.other(), words.whole(3, 10)
        goals += [
            f"push {it} next to {other}", f"push {it} behind {other}",
            f"push {it} in front of {other}", f"push {it} left of {other}",
            f"push {it} right of {other}", f"push {it} {gap} cm behind {other}",
            f"push {it} {gap} cm left of {other}", f"push {it} {gap} cm from {other}",
            f"push {it} against {other}",
        ]  # fmt: skip
    if len(words.others) > 1:
        i = words.whole(0, len(words.others) - 2)
        goals.append(f"push {it} between the {words.others[i]} and the {words.others[i + 1]}")
    return words.with_(words.one(goals), words.sliding())


def _rotate(words: _Words) -> str:
    goals = [f"turn {words.it} {words.whole(10, 180, 5)} degrees {words.one(SENSES)}"] * 3
    goals += [
        f"turn {words.it} a quarter turn {words.one(SENSES)}",
        f"turn {words.it} half a turn",
    ]
    asked = ["without toppling it", "slowly", "gently", "with one finger", "at the bottom"]
    if words.others:
        asked.append(f"without touching {words.other()}")
    return words.with_(words.one(goals), asked)


def _tilt(words: _Words) -> str:
    goal = f"tilt {words.it} by {words.whole(5, 15)} degrees"
    if words.rng.random() < 0.7:
        goal += f" {words.one(SIDES)}"
    return words.with_(goal, ["without toppling it", "slowly", "gently", "with one finger"])


def _topple(words: _Words) -> str:
    goal = f"topple {words.it}"
    if words.rng.random() < 0.8:
        goal += f" {words.one(SIDES)}"
    asked = ["at the top", "slowly", words.fingers()]
    asked.append(f"with at most {words.whole(1, 6)} N")
    if words.others:
        asked.append(f"without touching {words.other()}")
    return words.with_(goal, asked)


def _until(words: _Words) -> str:
    it, side = words.it, words.one(SIDES)
    goals = [
        f"push {it} {side} until it moves",
        f"push {it} {side} until it is about to tip",
        f"push {it} {side} until it tips",
    ]
    if words.others:
        other = words.other()
        goals += [f"push {it} toward {other} until it touches {other}"] * 2
        goals.append(f"push {it} {side} until it is in line with {other}")
    asked = ["without toppling it"] if "tip" not in (goal := words.one(goals)) else []
    return words.with_(goal, [*asked, "slowly", "gently", "with one finger"])


def _steps(words: _Words) -> str:
    first = f"push {words.it} {words.whole(5, 20)} cm {words.one(SIDES)}"
    turn = f"turn it {words.whole(15, 90, 15)} degrees {words.one(SENSES)}"
    push = f"push it {words.whole(5, 15)} cm {words.one(SIDES)}"
    topple = f"topple it {words.one(SIDES)}"
    first = words.with_(first, ["without toppling it", "slowly", "with two fingers"])
    then = [[turn], [push], [topple], [turn, push], [turn, topple], [push, topple]]
    return ", then ".join([first, *then[words.whole(0, len(then) - 1)]])


def _lift(words: _Words) -> str:
    it, high = words.it, words.whole(5, 20)
    goals = [f"lift {it} by {high} cm", f"lift {it}", f"pick up {it}", f"raise {it} {high} cm"]
    return words.with_(words.one(goals), ["slowly", "gently", "without touching anything"])


def _carry(words: _Words) -> str:
    x, y = words.whole(42, 68) / 100, words.whole(-30, 30) / 100
    goals = [f"put it at x {x:g} y {y:g}"]
    if words.others:
        other, gap = words.other(), words.whole(4, 12)
        goals += [
            f"put it next to {other}", f"put it behind {other}", f"put it left of {other}",
            f"put it {gap} cm right of {other}", f"put it in front of {other}",
        ]  # fmt: skip
    return f"pick up {words.it} and {words.one(goals)}"


def _open(words: _Words) -> str:
    return words.with_(f"open {words.it}", ["slowly", "gently"])


_GOALS: dict[Kind | Wished, Callable[[_Words], str]] = {
    "displace": _displace,
    "place": _place,
    "rotate": _rotate,
    "tilt": _tilt,
    "topple": _topple,
    "until": _until,
    "steps": _steps,
    "lift": _lift,
    "carry": _carry,
    "open": _open,
}
