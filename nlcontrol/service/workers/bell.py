"""Bell that wakes tasks of event loops, rung from any thread."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress


class Bell:
    """Those who listen, and a way to wake them all."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._listeners: dict[asyncio.Event, asyncio.AbstractEventLoop] = {}

    @property
    def listeners(self) -> int:
        """Number of those who listen."""
        return len(self._listeners)

    def ring(self) -> None:
        """Wakes all that listen."""
        with self._lock:
            listeners = dict(self._listeners)
        for heard, loop in listeners.items():
            with suppress(RuntimeError):  # its loop is closed, so that nobody waits there
                loop.call_soon_threadsafe(heard.set)

    @contextmanager
    def heard(self) -> Iterator[asyncio.Event]:
        """Context of one who listens, in a task; the event is set by every ring."""
        heard = asyncio.Event()
        with self._lock:
            self._listeners[heard] = asyncio.get_running_loop()
        try:
            yield heard
        finally:
            with self._lock:
                del self._listeners[heard]
