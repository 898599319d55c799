"""Imported once by the process from which workers are forked: they begin as warm as it is.

Nothing here may start a thread: those that are forked would miss it.
"""

import gc
from contextlib import suppress

from nlcontrol.service.workers.session_host import SessionHost, warm_up

__all__ = ["SessionHost"]

with suppress(Exception):  # each worker tries again, and tells its own service what is wrong
    warm_up()
gc.collect()
gc.freeze()  # what all share is not looked at again, which would copy its pages
