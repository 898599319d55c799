"""Reading of files that others made: regular files alone, and no more of them than a limit.

What may be wrong with a file, whatever its bytes, ends in a `ModelError` with the file, what was
found, what was expected and what to do.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

from objectmodels.errors import ModelError
from objectmodels.files.limits import LIMITS

_HINTS = {
    errno.ENOENT: "check the path; it begins at the folder that you are in",
    errno.EISDIR: "give the path of a plain file",
    errno.ENOTDIR: "check the path; a part of it is a file and no folder",
    errno.EACCES: "change its permissions, or choose another place",
    errno.EPERM: "change its permissions, or choose another place",
    errno.EROFS: "choose a place on a disk that can be written to",
    errno.ENOSPC: "free some space on the disk, or choose another one",
    errno.EDQUOT: "free some space on the disk, or choose another one",
    errno.EFBIG: "choose a disk that takes files of this size",
    errno.ENAMETOOLONG: "choose a shorter name",
}


def error_of_system(code: str, what: str, path: Path, error: OSError | ValueError) -> ModelError:
    """An error of the system about a file, with a hint.

    Args:
        code: of the error.
        what: failed, like "cannot be read".
        path: of the file.
        error: that the system raised; a `ValueError` for a path that cannot be one.
    """
    number = error.errno if isinstance(error, OSError) else None
    reason = os.strerror(number) if number else str(error)
    hint = _HINTS.get(number or 0, "choose another file")
    return ModelError(code, f"{what}: {reason}", path=str(path), suggestions=(hint,))


def read_bytes(path: Path, kind: str) -> bytes:
    """Contents of a file from outside.

    Args:
        path: of a regular file, or a link to one.
        kind: key of the limit of its size.

    Raises:
        ModelError: `unreadable_file`.
    """
    limit = LIMITS[kind]
    most = int(limit.most)
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            regular = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
            content = file.read(most + 1) if regular else b""
    except (OSError, ValueError) as error:
        raise error_of_system("unreadable_file", "cannot be read", path, error) from error
    if not regular:
        raise ModelError(
            "unreadable_file",
            f"is a device or a pipe, expected a {limit.what}",
            path=str(path),
            suggestions=("give the path of a plain file",),
        )
    if len(content) > most:
        raise ModelError(
            "unreadable_file",
            f"is too large, expected a {limit.what} of at most {most} bytes",
            path=str(path),
            suggestions=("check that this is the file you mean", "leave out what is not needed"),
        )
    return content


def _open_at_once(path: str, flags: int) -> int:
    """Opens a file, and does not wait for the writer of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def read_text(path: Path, kind: str) -> str:
    """Text of a file from outside, in UTF-8; see `read_bytes`."""
    try:
        return read_bytes(path, kind).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError(
            "unreadable_file",
            f"is no text in UTF-8: byte {error.start + 1} is 0x{error.object[error.start]:02x}",
            path=str(path),
            suggestions=("save it in UTF-8",),
        ) from error
