"""Tasks for an agent, drawn by a seed from families: scene, object, kind and numbers.

Ten families are feasible. What is pushed makes sense by belief and plain geometry
(`benchmarks.goals.sense`); what takes the hand stands where the scene is made for that, with
numbers that a person would say, and what is poured is surely there by belief. In ten others one
number is surely too much, or too little. No outcome of the robot decides what is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from benchmarks.goals.sense import sensible
from nlcontrol.session.controller import Controller
from planner.types.defaults import DEFAULTS

Generator = np.random.Generator
Drawn = tuple[str, str]
"""Name of a scene, and a sentence."""
Family = Callable[[Generator], Drawn]

PUSHED = (
    ("kitchen", ("ice tea box", "cereal box", "coffee box")),
    ("counter", ("soup can", "tea tin", "mug")),
    ("breakfast", ("ice tea box", "cereal box", "coffee box", "sugar box")),
    ("workbench", ("ice tea box", "cereal box", "coffee box", "sugar box", "tea tin")),
)
BOXES = tuple(
    (scene, boxes)
    for scene, names in PUSHED
    if (boxes := tuple(name for name in names if name.endswith("box")))
)
HELD = (
    ("kitchen", ("mug", "ice tea", "ice tea cup")),
    ("counter", ("mug",)),
    ("breakfast", ("mug",)),
    ("pantry", ("mug", "ice tea cup")),
)
LIDDED = (("kitchen", ("ice tea cup",)), ("pantry", ("jar", "ice tea cup", "fixed bottle")))
SIDES = ("away", "toward me", "to the left", "to the right")
BESIDE = ("to the left of", "to the right of", "behind", "in front of")
DRAWS = 100
"""Tries to draw something that makes sense; about one in three does."""


class Task(NamedTuple):
    """A task, on the table of a scene; some are to be refused as they are said first."""

    scene: str
    text: str
    refused_first: bool = False


def _one(rng: Generator, choices: Sequence[str]) -> str:
    return choices[int(rng.integers(len(choices)))]


def _thing(rng: Generator, things: Sequence[tuple[str, tuple[str, ...]]]) -> Drawn:
    scene, names = things[int(rng.integers(len(things)))]
    return scene, _one(rng, names)


@cache
def _controller(scene: str) -> Controller:
    return Controller(scene)


def _sensible(family: Family) -> Family:
    """The family of those of another one that make sense."""

    def drawn(rng: Generator) -> Drawn:
        for scene, text in (family(rng) for _ in range(DRAWS)):
            controller = _controller(scene)
            frames = controller.resolve(controller.parse(text)).frames
            if sensible(frames, controller.look()):
                return scene, text
        raise AssertionError(f"{family.__name__} makes no sense")

    return drawn


# --- feasible ones ---------------------------------------------------------------------------


@_sensible
def _push(rng: Generator) -> Drawn:
    scene, name = _thing(rng, PUSHED)
    return scene, f"push the {name} {rng.integers(4, 16)} cm {_one(rng, SIDES)}"


@_sensible
def _push_in_a_manner(rng: Generator) -> Drawn:
    scene, text = _push(rng)
    limits = (
        f"with at most {rng.integers(8, 16)} N",
        f"in at most {rng.integers(8, 20)} s",
        f"at {rng.integers(3, 13)} cm/s",
        "slowly",
        "without toppling it",
    )
    return scene, f"{text} {_one(rng, limits)}"


@_sensible
def _turn(rng: Generator) -> Drawn:
    scene, name = _thing(rng, BOXES)
    sense = _one(rng, ("clockwise", "counterclockwise"))
    return scene, f"turn the {name} {rng.integers(10, 61)} degrees {sense}"


@_sensible
def _topple(rng: Generator) -> Drawn:
    scene, name = _thing(rng, BOXES)
    return scene, f"topple the {name} {_one(rng, SIDES)}"


@_sensible
def _tilt(rng: Generator) -> Drawn:
    scene, name = _thing(rng, BOXES)
    return scene, f"tilt the {name} by {rng.integers(3, 9)} degrees"


def _lift(rng: Generator) -> Drawn:
    scene, name = _thing(rng, HELD)
    return scene, f"lift the {name} by {rng.integers(4, 16)} cm"


def _put(rng: Generator) -> Drawn:
    return "kitchen", f"put the {_one(rng, ('mug', 'ice tea'))} next to the ice tea cup"


@cache
def _surely_poured() -> int:
    """What the ice tea holds even in the worst case that plans reckon with [cl]."""
    container = _controller("kitchen").look().objects["ice tea"].model.container
    assert container is not None
    surely = container.contents - DEFAULTS.sigmas * container.contents_sd
    return int(surely / 1e-5 + 1e-6)


def _modest_pour(rng: Generator) -> Drawn:
    volume = 10 * rng.integers(2, 1 + _surely_poured())
    return "kitchen", f"pour {volume} ml of the ice tea into the mug"


def _pour(rng: Generator) -> Drawn:
    scene, text = _modest_pour(rng)
    limits = "", " without spilling it", f" at {rng.integers(3, 11)} cm/s"
    return scene, text + _one(rng, limits)


def _open(rng: Generator) -> Drawn:
    scene, name = _thing(rng, LIDDED)
    return scene, f"open the {name}"


def _question(rng: Generator) -> Drawn:
    scene, name = _thing(rng, PUSHED)
    texts = (
        f"how heavy is the {name}?",
        f"will the {name} topple if you push it {_one(rng, SIDES)}?",
        f"how hard do I have to push the {name} to make it slide?",
        f"what happens if you push the {name} with {rng.integers(1, 10)} N?",
    )
    return scene, _one(rng, texts)


# --- too much, or too little -----------------------------------------------------------------


def _weak_push(rng: Generator) -> Drawn:
    scene, text = _push(rng)
    return scene, f"{text} with at most 0.{rng.integers(1, 4)} N"


def _fast_push(rng: Generator) -> Drawn:
    scene, text = _push(rng)
    return scene, f"{text} at {rng.integers(20, 300)} cm/s"


def _far_push(rng: Generator) -> Drawn:
    scene, name = _thing(rng, PUSHED)
    return scene, f"push the {name} {rng.integers(15, 41) / 10} m {_one(rng, SIDES)}"


def _hasty_push(rng: Generator) -> Drawn:
    scene, text = _push(rng)
    return scene, f"{text} in at most 0.{rng.integers(2, 6)} s"


def _far_tilt(rng: Generator) -> Drawn:
    scene, name = _thing(rng, BOXES)
    return scene, f"tilt the {name} by {rng.integers(50, 85)} degrees"


def _high_lift(rng: Generator) -> Drawn:
    scene, name = _thing(rng, HELD)
    return scene, f"lift the {name} by {rng.integers(15, 41) / 10} m"


def _weak_lift(rng: Generator) -> Drawn:
    scene, name = _thing(rng, HELD)
    return scene, f"lift the {name} with at most 0.{rng.integers(1, 4)} N"


def _far_put(rng: Generator) -> Drawn:
    beside = _one(rng, BESIDE)
    return "kitchen", f"put the mug {rng.integers(15, 41) / 10} m {beside} the ice tea box"


def _full_pour(rng: Generator) -> Drawn:
    return "kitchen", f"pour {100 * rng.integers(6, 21)} ml of the ice tea into the mug"


def _hasty_pour(rng: Generator) -> Drawn:
    scene, text = _modest_pour(rng)
    return scene, f"{text} in at most {rng.integers(1, 4)} s"


FEASIBLE = (
    _push,
    _push_in_a_manner,
    _turn,
    _topple,
    _tilt,
    _lift,
    _put,
    _pour,
    _open,
    _question,
)
TOO_MUCH = (
    _weak_push,
    _fast_push,
    _far_push,
    _hasty_push,
    _far_tilt,
    _high_lift,
    _weak_lift,
    _far_put,
    _full_pour,
    _hasty_pour,
)
"""Families that are refused first."""


def tasks(seed: int) -> Iterator[Task]:
    """A task of each family."""
    for number, family in enumerate((*FEASIBLE, *TOO_MUCH)):
        rng = np.random.default_rng((seed, number))
        yield Task(*family(rng), refused_first=family in TOO_MUCH)
