"""Cases by seed: a sentence about an object of a built-in scene, and what is wrong with the world.

Each case depends on its suite and its number alone.

| suite | |
|---|---|
| small | amounts of 0.1 to 3 tolerances; the world as it is believed, or slippery, stuck, too heavy, or with the object out of the camera's sight once the hand works on it |
| agree | usual amounts and clauses in the world as the scene has it |
| covered | slides and topples; all frames after the first look are taken from the robot |
| poured | pours |
| paper | the three sentences of the paper, in turn |
"""  # noqa: E501

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from sim.robots.cell_description import Vision
from sim.truth.scene_file import Scene, load_scene

Suite = Literal["small", "agree", "covered", "poured", "paper"]
SUITES: tuple[Suite, ...] = get_args(Suite)

Trouble = Literal["none", "slippery", "stuck", "heavy", "hidden"]
TROUBLES: tuple[Trouble, ...] = get_args(Trouble)

CAMERAS = {
    "standard": Vision(),
    "rough": Vision(
        position_noise_m=0.008, angle_noise_deg=3.0, position_bias_m=0.002, angle_bias_deg=0.5
    ),
}
"""Data sheets: of the kitchen, and of a camera that is worse by far."""

BOXES = {
    "kitchen": ("ice tea box", "coffee box", "cereal box"),
    "workbench": ("sugar box", "coffee box"),
    "breakfast": ("sugar box", "coffee box"),
}
"""Boxes that are pushed, by the scene in which they stand."""

WAYS = ("away", "to the left", "to the right")

USUAL = (
    "push the {box} {cm} cm {way}",
    "push the {box} {cm} cm {way} without toppling it",
    "push the {box} {cm} cm {way} without turning it",
    "push the {box} {cm} cm {way} without tilting it by more than 3 degrees",
    "push the {box} {cm} cm {way} with at most 6 N",
    "push the {box} gently {cm} cm {way}",
    "push the {box} {cm} cm {way} without touching anything else",
    "slide the {box} {cm} cm {way}",
    "push the {box} at least {cm} cm {way}",
    "push the {box} {way} until it moves",
    "push the {box} {way} until it is about to tip",
    "turn the {box} by {deg} degrees",
    "turn the {box} {deg} degrees to the left",
    "tilt the {box} by {tilt} degrees",
    "topple the {box}",
    "topple the {box} away",
    "lift the {box} by {cm} cm",
)

PAPER = (
    "push the ice tea box away without toppling it",
    "open the ice tea cup",
    "pour the ice tea into the mug",
)

_TOLERANCES = {"mm": 10.0, "deg": 3.0, "tilt": 2.0, "lift": 20.0}
_SMALL = (
    ("push the {box} {mm:.3g} mm {way}", "mm"),
    ("turn the {box} by {mm:.3g} degrees to the left", "deg"),
    ("turn the {box} by {mm:.3g} degrees", "deg"),
    ("tilt the {box} by {mm:.3g} degrees", "tilt"),
    ("lift the {box} by {mm:.3g} mm", "lift"),
)


class Job(NamedTuple):
    """A case of a suite, and what is made of it.

    Attributes:
        suite, number: which case.
        redrawn: how often frames of each camera are drawn anew.
    """

    suite: Suite
    number: int
    redrawn: int = 0


@dataclass(frozen=True)
class Case:
    """What is said, and what is wrong with the world.

    Attributes:
        scene: name of a built-in scene.
        sentence: what is said.
        box: the object of which the world may be wrong.
        trouble: what is wrong.
    """

    scene: str
    sentence: str
    box: str
    trouble: Trouble = "none"

    def world(self) -> Scene:
        """The scene of the case, seen by the standard camera."""
        scene = load_scene(self.scene).model_copy(update={"vision": CAMERAS["standard"]})
        truth = scene.object(self.box).truth
        wrong = {
            "slippery": {"friction_finger": 0.06},
            "stuck": {"friction_table": min(3.0 * truth.friction_table, 1.2)},
            "heavy": {"mass_kg": 4.0 * truth.mass_kg},
        }.get(self.trouble, {})
        objects = tuple(
            item.model_copy(update={"truth": truth.model_copy(update=wrong)})
            if item.name == self.box
            else item
            for item in scene.objects
        )
        return scene.model_copy(update={"objects": objects})


def case(suite: Suite, number: int) -> Case:
    """The case of a suite with a number."""
    rng = np.random.default_rng([SUITES.index(suite), number])
    scene = str(rng.choice(list(BOXES)))
    box, way = str(rng.choice(BOXES[scene])), str(rng.choice(WAYS))
    amounts = {
        "cm": int(rng.integers(3, 13)),
        "deg": int(rng.integers(10, 61)),
        "tilt": int(rng.integers(5, 10)),
    }
    if suite == "paper":
        return Case("kitchen", PAPER[number % 3], "ice tea box")
    if suite == "poured":
        sentence = ("pour the ice tea into the mug", "pour {ml} ml of ice tea into the mug")[
            number % 2
        ]
        said = sentence.format(ml=10 * int(rng.integers(5, 18)))
        return Case("kitchen", said, "ice tea cup")
    if suite == "small":
        form, unit = _SMALL[int(rng.integers(len(_SMALL)))]
        amount = _TOLERANCES[unit] * 10.0 ** rng.uniform(-1.0, np.log10(3.0))
        trouble: Trouble = TROUBLES[int(rng.integers(len(TROUBLES)))]
        said = form.format(box=box, way=way, mm=float(f"{amount:.2g}"))
        return Case(scene, said, box, trouble)
    forms = USUAL if suite == "agree" else (USUAL[0], USUAL[0], "topple the {box} {way}")
    said = forms[int(rng.integers(len(forms)))].format(box=box, way=way, **amounts)
    return Case(scene, said, box)
