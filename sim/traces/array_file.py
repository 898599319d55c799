"""Arrays by name in one npz file: written whole or not at all, and read with mistrust.

The file is what `numpy.savez_compressed` writes, so `numpy.load` reads it. Here it is read with
limits of size, without pickle, and without trust in the sizes that it states.
"""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import LIMITS, read_bytes, replace_file

Arrays = Mapping[str, NDArray[Any]]

_SUFFIX = ".npy"
_PLAIN = "fiU"  # kinds of numbers and texts
_BROKEN = (zipfile.BadZipFile, zlib.error, ValueError, EOFError, OSError, RuntimeError)


def write_arrays(arrays: Arrays, path: Path) -> None:
    """Writes arrays by name.

    Raises:
        ModelError: `cannot_write`.
    """
    with replace_file(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays by name, in the order of the file; numbers and texts alone.

    Raises:
        ModelError: `unreadable_file`, or `bad_trace` if it is no such file.
    """
    content = read_bytes(path, "trace_file")
    most = LIMITS["trace_file"].most
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            if sum(each.file_size for each in members.infolist()) > most:
                raise ValueError(f"it unpacks to more than {most:.0f} bytes")
            return {
                each.filename.removesuffix(_SUFFIX): _array(members.read(each))
                for each in members.infolist()
            }
    except (*_BROKEN, NotImplementedError) as error:
        refuse_trace(path, f"no npz file of numbers and texts: {error}", error)


def _array(content: bytes) -> NDArray[Any]:
    """The array of an npy file, of a size that the file really has."""
    file = io.BytesIO(content)
    if np.lib.format.read_magic(file) != (1, 0):
        raise ValueError("another version of npy")
    shape, by_columns, kind = np.lib.format.read_array_header_1_0(file)
    if kind.kind not in _PLAIN:
        raise ValueError(f"an array of {kind}")
    flat = np.frombuffer(content[file.tell() :], kind)
    return flat.reshape(shape, order="F" if by_columns else "C")


def refuse_trace(path: Path, message: str, cause: Exception | None = None) -> NoReturn:
    """Raises `bad_trace` for a file."""
    raise ModelError(
        "bad_trace",
        message,
        path=str(path),
        suggestions=("give a file that `Trace.save` or `say --trace` has written",),
    ) from cause
