"""Files of a run: its trace, its replay, and all of it in one bundle; made when asked for."""

from __future__ import annotations

import threading
from contextlib import suppress
from pathlib import Path
from typing import Literal, NoReturn

from nlcontrol.errors import ControlError, error
from nlcontrol.service.store.run_store import RunStore
from nlcontrol.service.store.store_schema import unwritable
from nlcontrol.service.store.stored_bundle import bundle_file
from nlcontrol.service.workers.session_host import SessionHost
from nlcontrol.service.workers.worker_process import WorkerProcess

_OF_DAMAGE = ("bad_trace", "unreadable_file")
"""Codes of a trace that cannot be read; it was written here, so that no caller is to blame."""

_OF_DISK = ("system_error", "cannot_write")
"""Codes of a process that could not write its file into the store."""


class RunFiles:
    """Files of the runs of a store.

    Args:
        store: of the runs.
        time_limit: for a replay to be made [s].
    """

    def __init__(self, store: RunStore, time_limit: float) -> None:
        self._store, self._time_limit = store, time_limit
        self._making = threading.Lock()

    def trace(self, run_id: str) -> Path:
        """File of the trace of a run, an npz file; see `sim.traces.trace`.

        Raises:
            ControlError: `unknown_run`, `no_file`.
        """
        return self._store.file(run_id, "trace") or _refuse(run_id, "nothing has moved in it")

    def replay(self, run_id: str) -> Path:
        """File of the replay of a run, an HTML file; it is made the first time.

        Raises:
            ControlError: `unknown_run`, `no_file`.
        """
        return self._made(run_id, "replay")

    def recording(self, run_id: str) -> Path:
        """File of what a replay shows, for the page's viewer; it is made the first time.

        Raises:
            ControlError: `unknown_run`, `no_file`.
        """
        return self._made(run_id, "recording")

    def _made(self, run_id: str, kind: Literal["replay", "recording"]) -> Path:
        trace = self.trace(run_id)
        with self._making:
            made = self._store.file(run_id, kind)
            if made is not None:
                return made
            run = self._store.run(run_id)
            session = self._store.session_spec(run.session_id)
            if session is None:
                return _refuse(run_id, "its session is not known any more")
            process = WorkerProcess(SessionHost)
            try:
                with self._store.write_file(run_id, kind) as path:
                    process.call(
                        kind, trace=str(trace), scene=session.scene, path=str(path),
                        result=run.result and run.result.model_dump_json(),
                    ).result(self._time_limit)  # fmt: skip
            except ControlError as raised:
                if raised.code in _OF_DAMAGE:
                    return _refuse(run_id, f"its trace is damaged: {raised.info.message}")
                if raised.code in _OF_DISK:
                    raise unwritable(raised.info.message) from raised
                raise
            finally:
                process.kill()
        return self._store.file(run_id, kind) or _refuse(run_id, "it was deleted")

    def bundle(self, run_id: str) -> Path:
        """All of a run in one zip file, made the first time; see `nlcontrol.service.bundles`.

        Raises:
            ControlError: `unknown_run`, `run_under_way`.
        """
        if self._store.file(run_id, "bundle") is None and self._store.file(run_id, "trace"):
            with suppress(ControlError):  # a bundle without it is better than none
                self.replay(run_id)
        return bundle_file(self._store, run_id)


def _refuse(run_id: str, why: str) -> NoReturn:
    raise error(
        "no_file",
        f"the run {run_id} has no such file: {why}",
        suggestions=("read the run itself, and its events",),
    )
