"""Messages between the service and its worker processes: plain data, answers as JSON in bytes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Call(NamedTuple):
    """A method to be called in the worker.

    Attributes:
        number: of the call, which its answer bears.
        method: name of it.
        arguments: by name, as JSON has them.
    """

    number: int
    method: str
    arguments: Mapping[str, Any]


class Ready(NamedTuple):
    """The worker has loaded what it needs."""


class Answer(NamedTuple):
    """Answer to a call.

    Attributes:
        number: of the call.
        content: a JSON document, or the `ErrorInfo` of what was raised.
        ok: nothing was raised.
    """

    number: int
    content: bytes
    ok: bool


class Told(NamedTuple):
    """Something that the worker tells without being asked.

    Attributes:
        topic: one of its host's.
        content: as JSON.
    """

    topic: str
    content: bytes
