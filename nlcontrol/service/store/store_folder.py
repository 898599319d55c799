"""Folder of a store: its database, a lock, and a folder of files for each run.

Nothing that a caller says becomes a part of a path: the folder of a run is named by its number in
the database. One process at a time has a store open; the lock ends with the process.
"""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from nlcontrol.errors import error
from objectmodels.files.yaml_documents import PREFIX, error_of_system

STORE_VARIABLE = "NLCONTROL_STORE"
"""Environment variable that names the folder of the store."""

FileKind = Literal["trace", "replay", "recording", "request", "bundle"]

FILE_NAMES: Mapping[FileKind, str] = MappingProxyType(
    {
        "trace": "trace.npz",
        "replay": "replay.html",
        "recording": "recording.json.gz",
        "request": "request.json",
        "bundle": "bundle.zip",
    }
)


def default_folder() -> Path:
    """The user's own store, unless the environment names another one."""
    named = os.environ.get(STORE_VARIABLE)
    if named:
        return Path(named)
    state = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_STATE_HOME")
    home = Path(state) if state else Path.home() / ".local" / "state"
    return home / "nlcontrol" / "service"


class StoreFolder:
    """The folder of a store, locked until it is closed; it is made if need be.

    Args:
        path: of it.

    Raises:
        ControlError: `store_in_use`.
        ModelError: `cannot_write`.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.database = path / "runs.sqlite"
        self._runs = path / "runs"
        try:
            path.mkdir(parents=True, exist_ok=True, mode=0o700)  # what people said is theirs
            self._runs.mkdir(exist_ok=True)
            self._lock = (path / "lock").open("a")
        except OSError as raised:
            raise error_of_system("cannot_write", "cannot be written to", path, raised) from raised
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as raised:
            self._lock.close()
            raise error(
                "store_in_use",
                f"another process has the store {path} open",
                suggestions=("end that one first", "give another folder with --store"),
            ) from raised

    def close(self) -> None:
        """Lets go of the lock."""
        self._lock.close()

    def file(self, number: int, kind: FileKind) -> Path:
        """Place of a file of a run, there or not."""
        return self._runs / str(number) / FILE_NAMES[kind]

    def file_bytes(self, number: int) -> int:
        """Size of all files of a run [bytes]."""
        return sum(file.stat().st_size for file in (self._runs / str(number)).glob("*"))

    def remove_files(self, number: int) -> None:
        """Removes the files of a run."""
        shutil.rmtree(self._runs / str(number), ignore_errors=True)

    def clean(self, numbers: Collection[int]) -> None:
        """Removes what belongs to no run, and temporary files that nobody writes any more.

        Args:
            numbers: of the runs that there are.
        """
        names = {str(number) for number in numbers}
        for folder in self._runs.iterdir():
            if folder.name not in names:
                shutil.rmtree(folder, ignore_errors=True)
        for left in self._runs.glob(f"*/{PREFIX}*"):
            left.unlink(missing_ok=True)
