"""One push at one place of an object, and what it did: the experiment of the paper's Fig. 7.

There are several ways of pushing; each is like `Touch`: it builds its own world from plain data, so
that it may run in any process, and its answer depends on its arguments alone, and on what a robot
that pushes believes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from sim.truth.observer import Moved
from sim.truth.scene_file import Scene

Way = Literal["force", "robot"]
"""A force applied directly, or the robot's finger."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Contact:
    """Place and direction of a push on an object; B is its frame in the scene.

    Attributes:
        object: its name in the scene.
        face: how the face is called.
        point: p_BC [m].
        normal: outward unit normal of the face there, in B.
        direction: unit direction of the force in B.
    """

    object: str
    face: str
    point: Vector
    normal: Vector
    direction: Vector


@dataclass(frozen=True)
class TouchResult:
    """The outcome of a push.

    Attributes:
        outcome: what the observer saw move first; None if the push could not be carried out.
        force: at which it began to move [N]; None if nothing moved.
        detail: what else there is to say, such as why it was not carried out.
    """

    outcome: Moved | None
    force: float | None
    detail: str = ""


class Touch(Protocol):
    """A way of pushing."""

    def __call__(self, scene: Scene, contact: Contact, *, seed: int) -> TouchResult:
        """Pushes once in a fresh world of a scene and a seed."""
