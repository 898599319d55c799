"""`nlcontrol mcp` with a counted executor, whose libraries write where they should not."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Mapping

from nlcontrol.mcp.stdio_server import serve, take_standard_output
from nlcontrol.service.session import Session
from objectmodels import ObjectModel
from planner.types.world_state import WorldState
from tests.fakes.counted_executor import CountedExecutor


class NoisyExecutor(CountedExecutor):
    """A counted executor that writes to standard output at each look, in three ways."""

    def look(self, models: Mapping[str, ObjectModel], duration: float = 1.0) -> WorldState:
        print("printed by Python")
        os.write(1, b"written to the descriptor\n")
        ctypes.CDLL(None).puts(b"put by a library")
        return super().look(models, duration)


if __name__ == "__main__":
    own = take_standard_output()
    serve(lambda: Session(executor=NoisyExecutor()), own, allow_motion="--allow-motion" in sys.argv)
