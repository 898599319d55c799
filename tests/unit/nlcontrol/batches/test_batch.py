"""Batches: the same results on any executor, after any rows, and after a run was broken off."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import pytest

from benchmarks.batches.proof import local_cluster
from nlcontrol import Registry, batch
from nlcontrol.batches import BatchRow, DrawnScene
from nlcontrol.batches import batch as batches
from nlcontrol.batches.batch import BatchProgress, dask_executor, read_outcomes, summarise
from nlcontrol.batches.drawn_scenes import draw_scene
from nlcontrol.batches.row_worker import Order, result_digest, run_row
from nlcontrol.batches.rows import RowResult
from nlcontrol.errors import ControlError
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from sim.truth.scene_file import load_scene

P = ParamSpec("P")
T = TypeVar("T")

AWAY = "push the ice tea box away without toppling it"
ROWS: tuple[dict[str, Any], ...] = tuple(
    {"text": text, "seed": seed, "execute": False, "scene": scene}
    for seed in range(2)
    for text, scene in (
        (AWAY, "kitchen"),
        ("push the mug 7 cm to the left", {"draw": "table", "seed": seed, "object": "mug"}),
        ("dance", "kitchen"),
        ("push the soup can away", "counter"),
        ("what would happen if I pushed the mug at the top?", "kitchen"),
    )
)
"""Ten rows, planned, answered or not understood."""


class Inline(Executor):
    """Carries out everything at once in this process, and keeps the bundles that it was given."""

    def __init__(self) -> None:
        self.bundles: list[tuple[Order | RowResult, ...]] = []

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        self.bundles += [arg for arg in args if isinstance(arg, tuple)]
        future: Future[T] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def run(rows: Any, **options: Any) -> list[RowResult]:
    given: dict[str, Any] = {"executor": Inline(), "workers": 1} | options
    return list(batch(rows, **given))


@pytest.fixture(scope="module")
def expected() -> list[RowResult]:
    return run(ROWS)


def digests(results: list[RowResult]) -> list[str | None]:
    return [result.digest for result in results]


def test_a_row_comes_to_the_result_of_its_sentence(expected: list[RowResult]) -> None:
    result = Conversation(Controller("kitchen")).say(AWAY, plan_only=True)
    assert expected[0].digest == result_digest(result)
    assert expected[0].result is not None
    assert expected[0].result.to_json() == result.to_json()
    assert [each.line for each in expected] == list(range(1, 11))
    assert [each.status for each in expected[:3]] == ["planned", "planned", "not_understood"]


def test_a_result_does_not_depend_on_what_was_done_before(expected: list[RowResult]) -> None:
    assert digests(run(ROWS[::-1])[::-1]) == digests(expected)


def test_processes_come_to_the_same_digests(expected: list[RowResult]) -> None:
    assert digests(run(ROWS[:3], executor=None, workers=1)) == digests(expected[:3])


def test_plans_go_together_and_fewer_at_their_end_executions_alone() -> None:
    executor = Inline()
    dance = {"text": "dance"}
    run([dance, *ROWS[2:3] * 40, dance, dance], executor=executor, workers=2)
    assert [each.line for bundle in executor.bundles for each in bundle] == list(range(1, 44))
    sizes = [len(bundle) for bundle in executor.bundles]
    assert sizes[:1] + sizes[-2:] == [1, 1, 1]
    plans = sizes[1:-2]
    assert plans[0] == batches.PLANS_TOGETHER
    assert plans == sorted(plans, reverse=True)
    assert plans[-4:] == [1, 1, 1, 1]  # two workers, and the next one of each


def test_other_seeds_are_other_results(expected: list[RowResult]) -> None:
    planned = {each.digest for each in expected if each.status == "planned"}
    assert len(planned) == sum(each.status == "planned" for each in expected)


@pytest.mark.parametrize(
    ("row", "code"),
    [
        (b"{", "bad_row"),
        (b'{"text": "push it", "speed": 1}', "bad_row"),
        (b'{"scene": "kitchen"}', "bad_row"),
        (b'{"text": "push it", "frames": []}', "bad_row"),
        (b'{"text": "push it", "seed": -1}', "bad_row"),
        (b'{"text": "push it", "scene": {"draw": "circus", "seed": 1}}', "bad_row"),
        (b'{"text": "push it", "scene": {"draw": "alone", "seed": 1, "object": "yeti"}}', None),
        (b'{"text": "push it", "scene": "nowhere"}', "unknown_scene"),
        (b'{"text": "push it", "scene": "nowhere.yaml"}', "unknown_scene"),
        (b'{"text": "push it", "settings": {"x": 1}}', "bad_default"),
        (b'"' + b"x" * 2_000_000 + b'"', "bad_row"),
    ],
)
def test_a_bad_row_is_told_or_ends_the_batch(row: bytes, code: str | None) -> None:
    good = json.dumps(ROWS[2]).encode()
    found = run([good, b"\n", row, good])
    assert [each.line for each in found] == [1, 3, 4]
    assert [each.has_result for each in found] == [True, False, True]
    bad = found[1].error
    assert found[1].status == "bad_row"
    assert bad is not None
    assert bad.suggestions
    assert bad.code == (code or "unknown_object")
    with pytest.raises(ControlError, match="line 3") as raised:
        run([good, b"\n", row, good], on_error="stop")
    assert raised.value.code == bad.code


def test_a_scene_file_is_shipped_with_its_models(tmp_path: Path) -> None:
    source = Path(__file__).parents[4] / "sim" / "scenes" / "kitchen.yaml"
    (tmp_path / "own.yaml").write_text(source.read_text("utf-8"), "utf-8")
    row = {"text": AWAY, "scene": "own.yaml", "execute": False}
    executor = Inline()
    first = run([row], folder=tmp_path, executor=executor)
    assert first[0].status == "planned"
    (tmp_path / "own.yaml").unlink()
    assert run_row(executor.bundles[0][0]).digest == first[0].digest
    # What stands in the file is a part of the key, the name of the file is not all of it.
    heavier = source.read_text("utf-8").replace("mass_kg: ", "mass_kg: 1", 1)
    (tmp_path / "own.yaml").write_text(heavier, "utf-8")
    assert run([row], folder=tmp_path)[0].key != first[0].key


def test_models_of_the_caller_are_shipped() -> None:
    registry = Registry.built_in()
    box = registry.get("ice tea box")
    registry.add(box.model_copy(update={"mass": 2 * box.mass}), over=(box.name,))
    mine, others = run(ROWS[:1], registry=registry), run(ROWS[:1], registry=Registry.built_in())
    assert mine[0].key != others[0].key
    assert mine[0].digest != others[0].digest


def test_recipes_draw_scenes_by_seed() -> None:
    scenes = [draw_scene(DrawnScene(draw="table", seed=seed, object="mug")) for seed in range(20)]
    assert scenes == [
        draw_scene(DrawnScene(draw="table", seed=seed, object="mug")) for seed in range(20)
    ]
    assert {scene.objects[0].name for scene in scenes} == {"mug"}
    assert {len(scene.objects) for scene in scenes} >= {1, 3, 5}
    assert len({scene.model_dump_json() for scene in scenes}) == 20
    alone = draw_scene(DrawnScene(draw="alone", seed=0))
    assert len(alone.objects) == 1


@pytest.mark.parametrize("cut", [0, 1, 20])
def test_a_batch_that_was_killed_goes_on(
    cut: int, tmp_path: Path, expected: list[RowResult]
) -> None:
    path = tmp_path / "results.jsonl"
    results = batch(ROWS, executor=Inline(), workers=1, output=path)
    for _ in range(4):
        next(results)
    results.close()
    # As if it had been killed while it wrote the fourth.
    os.truncate(path, path.stat().st_size - cut)
    done = 4 if cut == 0 else 3
    again = run(ROWS, output=path, resume=True)
    assert [each.line for each in again] == list(range(done + 1, 11))
    assert [each.digest for each in read_outcomes(path)] == digests(expected)
    assert run(ROWS, output=path, resume=True) == []


def test_results_of_other_rows_are_not_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    run(ROWS[2:3], output=path)
    for rows, resume, code in (
        (ROWS[2:3], False, "cannot_write"),
        (ROWS[:1], True, "bad_record"),
        ([], True, "bad_record"),
    ):
        with pytest.raises(ControlError) as raised:
            run(rows, output=path, resume=resume)
        assert raised.value.code == code
    path.write_text("{}\n", encoding="utf-8")
    with pytest.raises(ControlError) as raised:
        run(ROWS[2:3], output=path, resume=True)
    assert raised.value.code == "bad_record"


def _end_at_second(order: Order | RowResult) -> RowResult:
    if order.line == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return run_row(order)


def test_a_row_that_ends_its_workers_is_told(
    monkeypatch: pytest.MonkeyPatch, expected: list[RowResult]
) -> None:
    monkeypatch.setattr(batches, "run_row", _end_at_second)
    found = run(ROWS[2:3] * 4, executor=None, workers=1)
    assert [each.status == "lost" for each in found] == [False, True, False, False]
    assert found[1].error is not None
    assert found[1].error.code == "worker_lost"
    assert {found[i].digest for i in (0, 2, 3)} == {expected[2].digest}


@pytest.mark.slow
def test_a_row_that_ends_its_workers_is_told_on_a_cluster(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, expected: list[RowResult]
) -> None:
    pytest.importorskip("distributed")

    def end_at_second(order: Order | RowResult) -> RowResult:
        if order.line == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        return run_row(order)

    monkeypatch.setattr(batches, "run_row", end_at_second)
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "1")
    with local_cluster(tmp_path) as address, dask_executor(address) as (executor, _):
        found = run(ROWS[2:3] * 12, executor=executor, workers=2)
    assert [each.line for each in found if each.status == "lost"] == [2]
    assert found[1].error is not None
    assert found[1].error.code == "worker_lost"
    assert {each.digest for each in found if each.line != 2} == {expected[2].digest}


def test_a_defect_in_a_row_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Conversation, "say", fail)
    assert [(each.status, each.ok) for each in run(ROWS[:1])] == [("crashed", False)]


def test_a_worker_of_another_version_ends_the_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    here = "nlcontrol.batches.row_worker.library_versions"
    monkeypatch.setattr(here, lambda: {"nlcontrol": "0.0.0"})

    with ThreadPoolExecutor(1) as executor, pytest.raises(ControlError) as raised:
        run(ROWS[:1], executor=executor)
    assert raised.value.code == "versions_differ"


def test_progress_is_told_after_each_row() -> None:
    told: list[BatchProgress] = []
    run([*ROWS[2:3] * 3, "{"], on_event=told.append)
    assert [(event.done, event.total, event.without_result) for event in told] == [
        (1, 4, 0), (2, 4, 0), (3, 4, 0), (4, 4, 1),
    ]  # fmt: skip
    assert told[-1].left == 0.0
    assert all(event.rate > 0.0 for event in told)

    def endless() -> Iterator[dict[str, Any]]:
        while True:
            yield ROWS[2]

    results = batch(endless(), executor=Inline(), workers=1, on_event=told.append)
    next(results)
    results.close()
    assert told[-1].total is None
    assert told[-1].left is None


def test_a_summary_counts(expected: list[RowResult]) -> None:
    summary = summarise(expected)
    assert (summary.ok, summary.rows) == (True, 10)
    assert summary.statuses["not_understood"] == 2
    assert sum(summary.statuses.values()) == 10
    assert summary.seconds is not None
    times = sorted(each.seconds for each in expected)
    assert summary.seconds.most == times[-1]
    assert times[4] <= summary.seconds.p50 <= times[5]
    assert summary.simulated is None
    assert summarise([]).seconds is None


@pytest.mark.slow
def test_executions_are_the_same_after_other_rows() -> None:
    alone = DrawnScene(draw="alone", seed=0, object="mug")  # what stands beside it takes time
    push = BatchRow(text="push the mug 2 cm to the left", scene=alone)
    first = run([push, BatchRow(text=AWAY, execute=False), push])
    second = run([push], executor=None, workers=1)
    assert first[0].digest == first[2].digest == second[0].digest
    assert first[0].simulated > 0.0
    assert load_scene("kitchen").objects  # the shared scene is as it was
