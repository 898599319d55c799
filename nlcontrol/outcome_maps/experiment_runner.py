"""Many pushes carried out in simulation, in parallel, and going on where a run was broken off.

A push is plain data and its result depends on that alone, so that it does not matter which process
carries it out, or in what order. Any executor of `concurrent.futures` will do. A result is known by
a digest of all that determines it: the scene with its truth and time step, the contact, the way of
pushing and what a robot believes then, the seed, and the versions of this package and of the
simulator.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Generator, Iterable, Mapping
from concurrent.futures import BrokenExecutor, Executor
from contextlib import closing
from dataclasses import asdict
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING

from nlcontrol import __version__
from nlcontrol.errors import error, known_errors_raised
from nlcontrol.outcome_maps.experiment_record import Record
from nlcontrol.parallel_tasks import run_all
from nlcontrol.references.object_names import find_by_name, names_on_table
from nlcontrol.text_format import enumeration
from sim import face_experiment as appliedforce
from sim.face_experiment import Contact, FingerTouch, Touch, TouchResult, Way
from sim.simulated_executor import fresh_robot
from sim.truth.scene_file import Scene, built_in_scenes, load_scene

if TYPE_CHECKING:
    from objectmodels import ObjectModel, Registry
    from sim.robots.cell_description import CellDescription, CellObject

Believed = Mapping[str, "ObjectModel"]
"""The robot's models of a scene's objects, by their names in it."""

WAYS: Mapping[Way, Callable[[Believed], Touch]] = {
    "force": lambda believed: appliedforce.touch,
    "robot": lambda believed: FingerTouch(believed, fresh_robot),
}
"""The ways of pushing; a robot goes by what it believes, a force by nothing."""

Report = Callable[[int, int], None]
"""Told how many pushes of how many are done."""


def object_on_table(
    name: str, cell: CellDescription, models: Believed, registry: Registry
) -> CellObject:
    """The object on the table of that name or synonym, of which enough words will do.

    Raises:
        ControlError: `ambiguous_object`, `unknown_object` or `not_on_table`.
    """
    found = find_by_name(name, names_on_table(cell.objects, models))
    if len(found) > 1:
        names = tuple(candidate.name for candidate in found)
        raise error(
            "ambiguous_object", f"{name!r} may be {enumeration(names, 'or')}", suggestions=names
        )
    if found:
        return next(item for item in cell.objects if item.name == found[0].name)
    with known_errors_raised():
        model = registry.find_one(name)
    raise error(
        "not_on_table",
        f"the {model.name} does not stand in the scene {cell.name}, so that nobody "
        "knows how it really is",
        suggestions=(*_scenes_with(model), f"there stand: {enumeration(cell.names)}"),
    )


def _scenes_with(model: ObjectModel) -> list[str]:
    """Options that choose a built-in scene in which an object stands."""
    return [
        f"it stands in another: --scene {name}"
        for name in built_in_scenes()
        if model.name in [item.model for item in load_scene(name).objects]
    ]


class FaceExperiment:
    """Pushes to be carried out, of which some may have been.

    Args:
        scene: the world as it is.
        contacts: the pushes, each a different one.
        by: how an object is pushed.
        believed: what the robot goes by, if it is the one that pushes.
        seed: of everything random.
        record: where results are kept; nowhere if not given.

    Attributes:
        missing: contacts of which no result is known, by key.
    """

    def __init__(
        self,
        scene: Scene,
        contacts: Iterable[Contact],
        *,
        by: Way = "force",
        believed: Believed | None = None,
        seed: int = 0,
        record: Record | None = None,
    ) -> None:
        self._scene, self._by, self._seed, self._record = scene, by, seed, record
        believed = dict(believed or {}) if by == "robot" else {}
        self._touch = WAYS[by](believed)
        beliefs = {name: model.model_dump(mode="json") for name, model in believed.items()}
        drake = version("drake")
        world = _digest(scene.model_dump(mode="json"), by, beliefs, seed, __version__, drake)
        pushes = {contact: _digest(world, asdict(contact)) for contact in contacts}
        self._keys = tuple(pushes.values())
        kept = record.results if record else {}
        self._results = {key: kept[key] for key in self._keys if key in kept}
        self.missing = {key: c for c, key in pushes.items() if key not in kept}

    def run(
        self,
        *,
        executor: Executor | None = None,
        workers: int | None = None,
        report: Report = lambda done, total: None,
    ) -> tuple[TouchResult, ...]:
        """Carries out what is missing; returns the results of all contacts, in their order.

        Args:
            executor: carries out the pushes; it is not shut down. Processes of this machine if not
                given.
            workers: how many processes; as many as there are processors if not given.
            report: told of the progress.

        Raises:
            ControlError: `worker_lost` if the executor has ended, or a push two processes; what was
                done by then is kept.
        """
        total = len(self.missing)
        if total:
            report(0, total)
            with closing(self._carried_out(executor, workers)) as results:
                for done, (key, result) in enumerate(results, start=1):
                    self._results[key] = result
                    report(done, total)
            self.missing = {}
        return tuple(self._results[key] for key in self._keys)

    def _carried_out(
        self, executor: Executor | None, workers: int | None
    ) -> Generator[tuple[str, TouchResult]]:
        """Results in the order of the contacts, kept before they are handed on."""
        touch = partial(self._touch, self._scene, seed=self._seed)
        results = run_all(touch, self.missing.values(), executor=executor, workers=workers)
        try:
            with closing(results):
                for (key, contact), result in zip(self.missing.items(), results, strict=True):
                    if self._record:
                        self._record.add(key, contact, self._by, self._seed, result)
                    yield key, result
        except BrokenExecutor as raised:
            raise error(
                "worker_lost",
                "a process that carried out pushes has ended",
                suggestions=("run it again with --record: what was done is kept there",),
            ) from raised


def _digest(*parts: object) -> str:
    text = json.dumps(parts, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:24]
