"""Saves of models, killed or by many processes at once: nothing is lost, nothing is half."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from collections.abc import Callable
from functools import partial
from multiprocessing import get_context
from multiprocessing.process import BaseProcess
from pathlib import Path

import numpy as np

from objectmodels import BoxModel, Registry
from objectmodels.files.yaml_documents import PREFIX
from objectmodels.registry.model_registry import FOLDER_VARIABLE, remove_model, store_model

LONGEST_LIFE = 0.05
"""Time after which a saving process has been killed [s]; a save takes a tenth of it."""

WRITERS = 10
"""Processes that write at once."""


def box(name: str, mass: float = 1.0) -> BoxModel:
    """A model of that name and mass [kg]."""
    return BoxModel(name=name, size=(0.1, 0.1, 0.1), mass=mass, friction=0.4)


def kill_saves(folder: Path, kills: int, seed: int) -> int:
    """Kills processes at random times while they save; every file must stay whole.

    Returns:
        Temporary files that were left, and removed by a later save.
    """
    os.environ[FOLDER_VARIABLE] = str(folder)
    rng = np.random.default_rng(seed)
    store_model(Registry.default(), box("victim"))
    for _ in range(kills):
        process = _start(_save_forever)
        time.sleep(float(rng.uniform(0.0, LONGEST_LIFE)))
        assert process.pid is not None
        os.kill(process.pid, signal.SIGKILL)
        process.join()
        registry = Registry.default()
        assert registry.problems == (), registry.problems
        assert registry.get("victim").mass >= 1.0
    left = list(folder.glob(f"{PREFIX}*"))
    for file in left:
        os.utime(file, (0.0, 0.0))
    store_model(Registry.default(), box("last"))
    assert sorted(file.name for file in folder.iterdir()) == ["last.yaml", "victim.yaml"]
    return len(left)


def write_at_once(folder: Path, writes: int) -> int:
    """Adds and removes models in several processes at once.

    Returns:
        Models that must be there, and are.
    """
    os.environ[FOLDER_VARIABLE] = str(folder)
    rounds = max(1, writes // (3 * WRITERS))
    processes = [_start(partial(_add_and_remove, n, rounds)) for n in range(WRITERS)]
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0] * WRITERS
    registry = Registry.default()
    assert registry.problems == (), registry.problems
    own = set(registry.names()) - set(Registry.built_in().names())
    assert own == {f"own {n} {k}" for n in range(WRITERS) for k in range(rounds)}
    return len(own)


def _start(work: Callable[[], object]) -> BaseProcess:
    process = get_context("fork").Process(target=work)
    process.start()
    return process


def _save_forever() -> None:
    mass = 1.0
    while True:
        mass += 0.001
        store_model(Registry.default(), box("victim", mass), replace=True)


def _add_and_remove(number: int, rounds: int) -> None:
    for k in range(rounds):
        store_model(Registry.default(), box(f"own {number} {k}"))
        store_model(Registry.default(), box(f"own_{number}_{k}"))
        remove_model(f"own_{number}_{k}")


def prove_saves_whole(kills: int, seed: int) -> bool:
    """Kills so many saves, makes five times as many at once, and prints what came of it.

    Raises:
        AssertionError: something is lost or half.
    """
    writes = 5 * kills
    with tempfile.TemporaryDirectory() as folder:
        left = kill_saves(Path(folder), kills, seed)
        print(f"{kills} saves killed: all files whole, {left} temporary files left and removed")
    with tempfile.TemporaryDirectory() as folder:
        kept = write_at_once(Path(folder), writes)
        print(f"{writes} writes by {WRITERS} processes: {kept} models, none lost")
    return True
