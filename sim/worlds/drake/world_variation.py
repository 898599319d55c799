"""Friction of the table that differs from place to place and from touch to touch.

Model: the coefficient of each foot of an object is

    μ_foot = μ · f(x, y) · k

μ is the object's own, f a smooth field over the table and k a factor of the trial, drawn anew for
an object whenever the robot begins to touch it. Both are log-normal with mean one, so friction
stays positive. The field is Gaussian in its logarithm, with the correlation exp(−r²/2ℓ²), made of
random waves (Rahimi and Recht 2007, Random features for large-scale kernel machines) and scaled to
the stated spread and to mean one over the table itself.

An object whose feet stand on different friction turns when it is pushed straight, as real ones do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array
from sim.random_streams import RandomStream, clipped_normal, source
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene, VaryingTable
from sim.worlds.drake.drake_bodies import surface
from sim.worlds.drake.drake_plant import Standing, inertia

if TYPE_CHECKING:
    from pydrake.systems.framework import Context

_LOW = 0.01  # feet higher than this stand on nothing [m]


class FrictionField:
    """Friction of a table at its places, relative to the mean over it."""

    def __init__(self, table: VaryingTable, seed: int) -> None:
        rng = source(seed, RandomStream.TABLE_FRICTION)
        variation = table.friction_variation
        waves, points = 64, 60  # points along each side of the table, over which it is scaled
        self._waves = rng.standard_normal((2, waves)) / variation.length_m
        self._phases = rng.uniform(0.0, 2.0 * np.pi, waves)
        self._log_sd = _log_deviation(variation.over_table)
        grid = [
            centre + size * (np.arange(points) / (points - 1) - 0.5)
            for centre, size in zip(table.centre_m, table.size_m, strict=True)
        ]
        over_table = self._sum(np.stack(np.meshgrid(*grid), axis=-1))
        self._middle, self._scale = float(over_table.mean()), float(over_table.std())
        standard = (over_table - self._middle) / self._scale
        self._mean = float(np.exp(self._log_sd * standard).mean())

    def at(self, p_W: Array) -> Array:
        """Relative friction at places in W's x, y, shape (...) for shape (..., 2) [m]."""
        standard = (self._sum(p_W) - self._middle) / self._scale
        return np.asarray(np.exp(self._log_sd * standard) / self._mean)

    def _sum(self, p_W: Array) -> Array:
        return np.asarray(np.cos(p_W @ self._waves + self._phases).sum(axis=-1))


class VaryingFriction:
    """Keeps the friction of all feet at what it is where they stand."""

    def __init__(self, model: Standing, root: Context, scene: Scene, seed: int) -> None:
        self._model = model
        self._context = model.scene_graph.GetMyMutableContextFromRoot(root)
        self._field = FrictionField(scene.table, seed)
        self._own = {item.name: item.truth.friction_table for item in scene.objects}
        self._log_sd = _log_deviation(scene.table.friction_variation.per_trial)
        self._rng = source(seed, RandomStream.TRIAL_FRICTION)
        self._factors = dict.fromkeys(scene.names, 1.0)
        self._before: dict[str, tuple[Array, Array]] = {}
        self._present = {
            name: np.full(len(feet.geometries), self._own[name])
            for name, feet in model.feet.items()
        }

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: draws for what is touched anew, follows what moved."""
        for name in touched:
            drawn = self._log_sd * self._rng.standard_normal()
            self._factors[name] = float(np.exp(drawn - self._log_sd**2 / 2.0))
            self._before.pop(name, None)
        for name, (R_WB, p_WB) in poses.items():
            if name in self._before:
                turned, shifted = (
                    np.abs(now - before).max()
                    for before, now in zip(self._before[name], (R_WB, p_WB), strict=True)
                )
                if turned <= 1e-3 and shifted <= 1e-4:
                    continue  # its feet are where they were
            self._before[name] = (R_WB, p_WB)
            self._follow(name, R_WB, p_WB)

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object with the mean friction of the feet on which it stands now."""
        R_WB, p_WB = self._before[name]
        low = (self._model.feet[name].p_B @ R_WB.T + p_WB)[:, 2] < _LOW
        mean = float(self._present[name][low].mean()) if low.any() else self._own[name]
        return truth.model_copy(update={"friction_table": mean})

    def _follow(self, name: str, R_WB: Array, p_WB: Array) -> None:
        from pydrake.geometry import RoleAssign

        feet = self._model.feet[name]
        p_WF = feet.p_B @ R_WB.T + p_WB
        wanted = self._own[name] * self._factors[name] * self._field.at(p_WF[:, :2])
        known = self._present[name]
        changed = (np.abs(wanted / known - 1.0) > 1e-3) & (p_WF[:, 2] < _LOW)
        for i in np.flatnonzero(changed):
            self._model.scene_graph.AssignRole(
                self._context,
                self._model.plant.get_source_id(),
                feet.geometries[i],
                surface(float(wanted[i]) / 2),
                RoleAssign.kReplace,
            )
            known[i] = wanted[i]


def _log_deviation(relative: float) -> float:
    """Deviation of the logarithm of a log-normal number with this relative deviation."""
    return float(np.sqrt(np.log1p(relative**2)))


class ShiftingContents:
    """Draws where contents lie."""

    def __init__(self, model: Standing, root: Context, scene: Scene, seed: int) -> None:
        self._model = model
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._truths = {item.name: item.truth for item in scene.objects}
        self._present = dict(self._truths)
        self._rng = source(seed, RandomStream.CONTENTS)

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: shifts the contents of what is touched anew, wherever it stands."""
        del poses
        for name in touched:
            truth = self._truths[name]
            shift = truth.contents_shift_m * clipped_normal(self._rng, 3)
            self._present[name] = truth.with_shift(shift)
            self._model.bodies[name].SetSpatialInertiaInBodyFrame(
                self._context, inertia(self._present[name].without_lid)
            )

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object with its centre of mass where it is now."""
        return truth.model_copy(update={"centre_of_mass_m": self._present[name].centre_of_mass})
