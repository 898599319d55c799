"""Control-C, SIGTERM and the end of the terminal (SIGHUP) on the command line.

A signal ends the command where it is. Where that would leave a robot in the midst of something, the
first one asks for a stop, and only the second ends it. One that comes before the program is loaded
waits for that; one that comes once the answer is printed changes nothing any more.
"""

from __future__ import annotations

import signal
from contextlib import contextmanager

TYPE_CHECKING = False  # `typing` is not imported before signals are held
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType
    from typing import NoReturn

EXIT_CODES = {signal.SIGINT: 130, signal.SIGTERM: 143} | (
    {signal.SIGHUP: 129} if hasattr(signal, "SIGHUP") else {}
)
"""Exit codes of a command that a signal has ended, as shells expect them."""


class Interrupted(KeyboardInterrupt):
    """Raised where control-C ends a command.

    Of a plain `KeyboardInterrupt` that comes out of `exec` Python remembers for ever that it should
    end by the signal, also if it is caught.
    """


class Terminated(SystemExit):
    """Raised where SIGTERM ends a command.

    Any other kind of exception would be kept by an event loop, which then goes on for ever.
    """


class Signals:
    """These signals in one process.

    Attributes:
        received: those that came since they were last waited for.
    """

    def __init__(self) -> None:
        self.received: list[int] = []
        self._wait = self._held = False
        self._ask: Callable[[], None] | None = None

    @property
    def exit_code(self) -> int:
        """Exit code of a command that the first signal has ended."""
        return EXIT_CODES[signal.Signals(self.received[0])] if self.received else 130

    def hold(self) -> None:
        """Takes all of them from now on, and lets them wait.

        The end of the terminal stays ignored where the command was started so, as by nohup.
        """
        self._wait = self._held = True
        for number in EXIT_CODES:
            hangs_up = number not in (signal.SIGINT, signal.SIGTERM)
            if not (hangs_up and signal.getsignal(number) is signal.SIG_IGN):
                signal.signal(number, self._take)

    def release(self) -> None:
        """Ends the command if a signal waits, and from now on with the next one.

        Raises:
            Interrupted: control-C was pressed.
            Terminated: SIGTERM came.
        """
        self._wait = False
        if self.received:
            self.end()

    def ignore(self) -> None:
        """Lets no signal change anything any more, also while Python ends."""
        if self._held:
            for number in EXIT_CODES:
                signal.signal(number, signal.SIG_IGN)

    @contextmanager
    def ask_first(self, ask: Callable[[], None] | None) -> Iterator[None]:
        """Context in which the first signal asks for a stop.

        Args:
            ask: called in the midst of anything else, so that it takes no lock; the first signal
                ends the command if there is none.
        """
        self.received.clear()
        self._ask = ask
        try:
            yield
        finally:
            self._ask = None

    def end(self) -> NoReturn:
        """Ends the command.

        Raises:
            Interrupted: control-C was pressed last.
            Terminated: SIGTERM came last.
        """
        raise Interrupted if self.received[-1] == signal.SIGINT else Terminated

    def _take(self, number: int, frame: FrameType | None) -> None:
        self.received.append(number)
        if self._ask is not None and len(self.received) == 1:
            self._ask()
        elif not self._wait:
            self.end()


SIGNALS = Signals()
"""Those of this process; nothing happens to them before `Signals.hold`."""
