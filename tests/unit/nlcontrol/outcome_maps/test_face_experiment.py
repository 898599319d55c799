"""Many pushes: in any executor the same, and going on where a run was broken off."""

from __future__ import annotations

import dataclasses
import pickle
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.outcome_maps.face_experiment import FaceExperiment, Record, object_on_table
from nlcontrol.session.controller import Controller
from sim import SimError, load_scene
from sim.face_experiment import Contact, TouchResult, Way
from sim.robots.cell_description import CellObject
from sim.truth.scene_file import Scene

SCENE = load_scene("kitchen")
CONTACTS = [
    Contact("coffee box", "front", (-0.031, y, z), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    for y in (-0.03, 0.01)
    for z in (0.03, 0.16)
]
LOW = [Contact("coffee box", "front", (-0.031, 0.0, 0.005), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))]
"""Nearer to the table than a finger gets."""
P = ParamSpec("P")
T = TypeVar("T")


class Inline(Executor):
    """Carries out everything at once in this process, and breaks after so many pushes."""

    def __init__(self, most: int = 1000) -> None:
        self.done, self.most = 0, most

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()
        if self.done < self.most:
            self.done += 1
            future.set_result(fn(*args, **kwargs))
        else:
            future.set_exception(BrokenExecutor("poisoned"))
        return future


def experiment(
    record: Record | None = None, scene: Scene = SCENE, **changes: Any
) -> FaceExperiment:
    return FaceExperiment(scene, CONTACTS, record=record, **changes)


@pytest.fixture(scope="module")
def expected() -> tuple[TouchResult, ...]:
    return experiment().run(executor=Inline())


@pytest.mark.slow
def test_results_are_in_the_order_of_the_contacts(expected: tuple[TouchResult, ...]) -> None:
    # b/μ is 113 mm, and the left one is off the middle.
    assert [result.outcome for result in expected] == ["slide", "slide", "slide", "topple"]
    backwards = FaceExperiment(SCENE, CONTACTS[::-1]).run(executor=Inline())
    assert backwards == expected[::-1]


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_processes_find_the_same_bit_for_bit(
    expected: tuple[TouchResult, ...], workers: int
) -> None:
    told: list[tuple[int, int]] = []
    found = experiment().run(workers=workers, report=lambda *progress: told.append(progress))
    assert found == expected
    assert told == [(k, 4) for k in range(5)]


def test_any_executor_will_do(expected: tuple[TouchResult, ...]) -> None:
    with ThreadPoolExecutor(1) as executor:
        assert experiment().run(executor=executor) == expected
        assert executor.submit(int).result() == 0  # it is the caller's, and still open


def test_a_run_that_breaks_goes_on(tmp_path: Path, expected: tuple[TouchResult, ...]) -> None:
    path = tmp_path / "touches.jsonl"
    with pytest.raises(ControlError) as raised:
        experiment(Record(path)).run(executor=Inline(most=3))
    assert raised.value.code == "worker_lost"
    # As if it had been killed while it wrote the third.
    path.write_bytes(path.read_bytes()[:-20])
    again, executor = experiment(Record(path)), Inline()
    assert len(again.missing) == 2
    assert again.run(executor=executor) == expected
    assert executor.done == 2
    complete, idle = experiment(Record(path)), Inline(most=0)
    assert not complete.missing
    assert complete.run(executor=idle) == expected


def test_a_defect_is_not_hidden(tmp_path: Path) -> None:
    class Defective(Inline):
        def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
            future: Future[T] = Future()
            future.set_exception(ZeroDivisionError())
            return future

    path = tmp_path / "touches.jsonl"
    with pytest.raises(ZeroDivisionError):
        experiment(Record(path)).run(executor=Defective())
    assert not path.exists()


def heavier() -> Scene:
    first, *others = SCENE.objects
    truth = first.truth.model_copy(update={"mass_kg": 2.0})
    return SCENE.model_copy(
        update={"objects": (first.model_copy(update={"truth": truth}), *others)}
    )


def test_results_of_something_else_are_not_taken(
    tmp_path: Path, expected: tuple[TouchResult, ...]
) -> None:
    record = Record(tmp_path / "touches.jsonl")
    experiment(record).run(executor=Inline())
    assert not experiment(record).missing
    finer = SCENE.model_copy(update={"time_step_s": 0.001})
    for other in (
        experiment(record, seed=1),
        experiment(record, heavier()),
        experiment(record, finer),
    ):
        assert len(other.missing) == len(CONTACTS)


def test_a_new_version_computes_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record = Record(tmp_path / "touches.jsonl")
    experiment(record).run(executor=Inline())
    monkeypatch.setattr("nlcontrol.outcome_maps.face_experiment.__version__", "0.0.1")
    assert len(experiment(record).missing) == len(CONTACTS)


def test_only_what_the_robot_does_depends_on_what_it_believes(tmp_path: Path) -> None:
    record, believed = Record(tmp_path / "touches.jsonl"), Controller(SCENE).models
    lighter = believed | {"coffee box": believed["coffee box"].model_copy(update={"mass": 0.1})}
    ways: tuple[tuple[Way, bool], ...] = (("force", True), ("robot", False))
    for by, shared in ways:
        first, second = (
            FaceExperiment(SCENE, LOW, by=by, believed=models, record=record)
            for models in (believed, lighter)
        )
        assert (first.missing.keys() == second.missing.keys()) is shared


def test_the_robot_pushes_in_any_process(tmp_path: Path) -> None:
    believed = Controller(SCENE).models
    found = FaceExperiment(SCENE, LOW, by="robot", believed=believed).run(workers=1)
    assert found == FaceExperiment(SCENE, LOW, by="robot", believed=believed).run(executor=Inline())
    assert [result.outcome for result in found] == [None]
    assert "table" in found[0].detail


def test_an_error_of_a_push_comes_home_from_its_process() -> None:
    stranger = dataclasses.replace(CONTACTS[0], object="unicorn")
    with pytest.raises(KeyError, match="unicorn"):
        FaceExperiment(SCENE, [stranger]).run(workers=1)
    raised = SimError("bad_scene", "no table", ("add one",))
    copied = pickle.loads(pickle.dumps(raised))
    assert (type(copied), vars(copied)) == (SimError, vars(raised))


def _on_table(name: str) -> CellObject:
    controller = Controller(SCENE)
    return object_on_table(name, controller.cell, controller.models, controller.registry)


@pytest.mark.parametrize("name", ["coffee box", "Coffee Box", "the coffee", "coffee"])
def test_an_object_by_its_name(name: str) -> None:
    assert _on_table(name).name == "coffee box"


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("box", "ambiguous_object", "ice tea box"),
        ("soup can", "not_on_table", "--scene counter"),
        ("mugg", "unknown_object", "mug"),
    ],
)
def test_an_object_that_is_not_there(name: str, code: str, words: str) -> None:
    with pytest.raises(ControlError) as raised:
        _on_table(name)
    assert raised.value.code == code
    assert words in " ".join(raised.value.info.suggestions)
