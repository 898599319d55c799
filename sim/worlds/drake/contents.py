"""Contents that shift: where an object's centre of mass is differs from touch to touch.

Model: whenever the robot begins to touch the object, its contents lie anew: its centre of mass is
the true one plus a normal shift along each axis of B, clipped at two standard deviations and
halved until the object stands by itself. The moments of inertia about it stay as they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sim.random_streams import Stream, clipped_normal, source
from sim.rotations import Array
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_plant import Standing, inertia

if TYPE_CHECKING:
    from pydrake.systems.framework import Context


class ShiftingContents:
    """Draws where contents lie.

    Args:
        model: of the world.
        root: its context, in which the inertia is changed.
        scene: what is true.
        seed: of the world.
    """

    def __init__(self, model: Standing, root: Context, scene: Scene, seed: int) -> None:
        self._model = model
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._truths = {item.name: item.truth for item in scene.objects}
        self._present = dict(self._truths)
        self._rng = source(seed, Stream.CONTENTS)

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: shifts the contents of what is touched anew, wherever it stands."""
        del poses
        for name in touched:
            truth = self._truths[name]
            shift = truth.contents_shift_m * clipped_normal(self._rng, 3)
            self._present[name] = truth.shifted(shift)
            self._model.bodies[name].SetSpatialInertiaInBodyFrame(
                self._context, inertia(self._present[name].uncovered)
            )

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object with its centre of mass where it is now."""
        return truth.model_copy(
            update={"centre_of_mass_m": self._present[name].centre_of_mass},
        )
