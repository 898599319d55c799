"""Writing of files: whole or not at all, and on the disk when it is said to be done."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from objectmodels.errors import ModelError
from objectmodels.files.file_reading import error_of_system

PREFIX = ".nlcontrol-"
"""Beginning of the names of temporary files."""

_STALE = 600.0  # age from which on nobody writes a temporary file any more [s]
_PATIENCE, _PAUSE = 60.0, 0.02  # waiting for another process that changes the same folder [s]


@contextlib.contextmanager
def replace_file(path: Path, *, private: bool = False) -> Iterator[Path]:
    """A temporary file beside `path` that takes its place when all went well; makes its folder.

    So nobody ever reads half a file, and a failure leaves an older one as it was. What a process
    that was killed left there is removed by a later one.

    Args:
        path: of the file.
        private: whether nobody else may read it.

    Raises:
        ModelError: `cannot_write`.
    """
    if os.path.lexists(path) and not os.path.isfile(path):
        raise ModelError(
            "cannot_write",
            "is a folder or a device",
            path=str(path),
            suggestions=("give the path of a plain file",),
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_leftovers(path.parent)
        handle, name = tempfile.mkstemp(prefix=PREFIX, suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            # mkstemp lets nobody else read the file; give it what a plain `open` would have.
            umask = os.umask(0)
            os.umask(umask)
            temporary.chmod(0o600 if private else 0o666 & ~umask)
            _sync(temporary)
            temporary.replace(path)
            _sync(path.parent)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be written", path, error) from error


def remove_file(path: Path) -> None:
    """Removes a file for good.

    Raises:
        ModelError: `cannot_write`.
    """
    try:
        path.unlink()
        _sync(path.parent)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be removed", path, error) from error


@contextlib.contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keeps other processes that ask for the same lock out of a folder; it is made if need be.

    Raises:
        ModelError: `cannot_write` if it cannot be made, or another one does not let go of it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise error_of_system("cannot_write", "cannot be written to", folder, error) from error
    try:
        end = time.monotonic() + _PATIENCE
        while not _try_lock(handle):
            if time.monotonic() > end:
                raise ModelError(
                    "cannot_write",
                    f"another process has been changing this folder for {_PATIENCE:g} s",
                    path=str(folder),
                    suggestions=("try again when it is done",),
                )
            time.sleep(_PAUSE)
        yield
    finally:
        os.close(handle)  # which lets go of the lock, as the end of the process would


def _try_lock(handle: int) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _remove_leftovers(folder: Path) -> None:
    """Removes temporary files that nobody writes any more."""
    for left in folder.glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):
            if time.time() - left.stat().st_mtime > _STALE:
                left.unlink()


def _sync(path: Path) -> None:
    """Waits until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
