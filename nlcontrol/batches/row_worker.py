"""Work of one worker: a row becomes its result, in any process and after any other row.

What a worker keeps from row to row are scenes, models and maps of what the arm reaches: values that
change the time of an answer, never the answer. Each row has a controller of its own and, where it
is carried out, a simulated world of its own.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from nlcontrol.batches.drawn_scenes import draw_scene
from nlcontrol.batches.rows import BatchRow, DrawnScene, RowResult
from nlcontrol.errors import ControlError, error, exception_info, known_errors_raised
from nlcontrol.installed_versions import library_versions
from nlcontrol.results.result import Result, result_with
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import ObjectModel, Registry
from planner.types.defaults import with_settings
from sim.truth.scene_file import Scene, load_scene

KEPT_WORLDS = 8
"""Scenes that a worker keeps."""


class World(NamedTuple):
    """A scene and what is believed in it, as they are shipped.

    Attributes:
        scene: name of a built-in one, a recipe, or what a file says.
        models: those of the registry that are not built in.
    """

    scene: str | DrawnScene | Scene
    models: tuple[ObjectModel, ...] = ()


class Order(NamedTuple):
    """Order of one row, all that a worker has to know.

    Attributes:
        line, key: as in `RowOutcome`.
        row: what is asked.
        world: where; in place of the row's scene.
        versions: of the libraries that are to carry it out.
        brief: whether the result is left out of the answer.
    """

    line: int
    key: str
    row: BatchRow
    world: World
    versions: Mapping[str, str]
    brief: bool = False


def run_row(order: Order | RowResult) -> RowResult:
    """The result of a row; one that could not be ordered has its result already.

    Raises:
        ControlError: `versions_differ`.
    """
    if isinstance(order, RowResult):
        return order
    start = time.perf_counter()
    told = {"line": order.line, "key": order.key, "id": order.row.id}
    _require_versions(order.versions)
    try:
        scene, registry = _opened_world(order.world)
        with known_errors_raised():
            defaults = with_settings(scene.defaults, order.row.settings)
        controller = Controller(scene, registry=registry, seed=order.row.seed, defaults=defaults)
        result = Conversation(controller).say(order.row.said, plan_only=not order.row.execute)
    except Exception as raised:  # one row that breaks must not end a batch of thousands
        info = exception_info(raised)
        foreseen = isinstance(raised, ControlError) and raised.code != "internal"
        status = "bad_row" if foreseen else "crashed"
        return RowResult(ok=False, status=status, error=info, **told)
    executions = [step.execution for step in result.steps if step.execution]
    return RowResult(
        ok=result.ok,
        status=result.status,
        error=result.error,
        not_held=tuple(c.clause for c in result.checks if c.verdict == "not_held"),
        unknown=tuple(c.clause for c in result.checks if c.verdict == "unknown"),
        differs=tuple(c.clause for c in result.checks if c.differs),
        seconds=time.perf_counter() - start,
        simulated=sum(execution.duration for execution in executions),
        digest=result_digest(result),
        result=None if order.brief else _shipped(result),
        **told,
    )


def result_digest(result: Result) -> str:
    """Digest of a result and its trace, the same if and only if both are equal to the digit."""
    told = result.model_dump(mode="json", exclude={"files", "explanation"})
    found = hashlib.sha256(json.dumps(told, sort_keys=True, allow_nan=False).encode())
    arrays = {} if result.trace is None else result.trace.arrays()
    for name, values in sorted(arrays.items()):
        found.update(f"{name} {values.dtype.str} {values.shape}".encode())
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()


def _shipped(result: Result) -> Result:
    """The result without what belongs to the process that found it."""
    steps = tuple(step.model_copy(update={"basis": None}) for step in result.steps)
    return result_with(result, steps=steps, trace=None)


@lru_cache(maxsize=1)
def _own_registry() -> Registry:
    """The built-in models, and kinds and models of the plug-ins installed here."""
    registry = Registry.built_in()
    registry.load_plugins()
    return registry


def _opened_world(world: World) -> tuple[Scene, Registry]:
    """The scene, and the registry in which its objects are known."""
    if isinstance(world.scene, Scene):
        scene = world.scene
    else:
        with known_errors_raised():
            scene = _own_scene(world.scene)
    registry = _own_registry().copy()
    for model in world.models:
        registry.add(model, over=(model.name,))
    return scene, registry


@lru_cache(maxsize=KEPT_WORLDS)
def _own_scene(scene: str | DrawnScene) -> Scene:
    return load_scene(scene) if isinstance(scene, str) else draw_scene(scene)


def _require_versions(versions: Mapping[str, str]) -> None:
    """Refuses to work for another version; raises `versions_differ`."""
    here = library_versions()
    if here != versions:
        others = ", ".join(
            f"{name} {here[name]} for {versions.get(name)}"
            for name in here
            if here[name] != versions.get(name)
        )
        raise error(
            "versions_differ",
            f"a worker has {others}",
            suggestions=("install the same versions on all machines",),
        )
