"""Executor of a Dask cluster, as Dask itself offers it."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from nlcontrol.errors import error


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Context with the executor of a cluster, and the number of threads that work there now.

    Args:
        address: of its scheduler, as `tcp://host:8786`.

    Raises:
        ControlError: `missing_extra`; `no_service` if no scheduler answers.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError as raised:
        if raised.name not in ("distributed", "dask"):
            raise
        raise error(
            "missing_extra",
            "--dask needs the package distributed, which is not installed",
            suggestions=("install from the checkout: pip install '.[dask]'",),
        ) from raised
    try:
        client = Client(address, set_as_default=False)
    except (OSError, ValueError) as raised:
        raise error(
            "no_service",
            f"no Dask scheduler answers at {address}: {raised}",
            suggestions=(
                "start one with `dask scheduler`, and workers with `dask worker ADDRESS`",
            ),
        ) from raised
    with client:
        client.wait_for_workers(1)
        # A row that is tried once more is another task, and digests of orders cost time.
        yield client.get_executor(pure=False), sum(client.nthreads().values())
