"""A robot that moves while control-C is pressed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from nlcontrol.interruption import SIGNALS
from sim.supervision import Stopped, StopToken

if TYPE_CHECKING:
    from nlcontrol.results.result import Result


class SignalToken(StopToken):
    """A stop that the first signal asks for; at the second the motion is left as it is."""

    @property
    def requested(self) -> bool:
        """A stop was asked for.

        Raises:
            Interrupted: again, and impatiently.
            Terminated: the same by SIGTERM.
        """
        if len(SIGNALS.received) > 1:
            SIGNALS.end()
        return super().requested


@contextmanager
def stop_on_signal(*, moves: bool = True) -> Iterator[SignalToken]:
    """Context with a token by which the first signal stops the robot, if that moves at all.

    Raises:
        Interrupted: control-C has stopped it, or was pressed twice.
        Terminated: the same by SIGTERM.
    """
    token = SignalToken()

    def ask() -> None:
        token.request()
        # A stream may be in the midst of a line, and must not be entered twice.
        os.write(sys.stderr.fileno(), b"\nstopping, letting go ...\n")

    with SIGNALS.ask_first(ask if moves else None):
        try:
            yield token
        except Stopped:
            SIGNALS.end()
    # What a signal raises, a library may have turned into something else.
    if len(SIGNALS.received) > int(moves):
        SIGNALS.end()


def exit_code_of(result: Result) -> int:
    """Exit code of a sentence, which is the signal's if that has stopped it."""
    return SIGNALS.exit_code if result.status == "cancelled" else result.exit_status
