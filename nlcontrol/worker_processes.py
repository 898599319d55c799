"""Processes that carry out a part of the work, and none of which outlives its parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager


@contextmanager
def worker_processes(
    workers: int | None = None, initializer: Callable[[], object] | None = None
) -> Iterator[ProcessPoolExecutor]:
    """Context with fresh processes; one that is forked beside threads may hang.

    Whatever breaks the context off ends them at once.

    Args:
        workers: how many; as many as there are processors if not given.
        initializer: called once in each of them.
    """
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        workers or os.cpu_count(),
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_begin,
        initargs=(initializer,),
    )
    try:
        yield pool
    except BaseException:
        for child in set(multiprocessing.active_children()) - others:
            child.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(initializer: Callable[[], object] | None) -> None:
    """Ends this process with its parent, and with nothing else; libraries start no threads."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    if initializer is not None:
        initializer()


def end_with_parent() -> None:
    """Ends this process, from now on, as soon as its parent has ended."""
    threading.Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None, "a worker has a parent"
    parent.join()
    os._exit(1)
