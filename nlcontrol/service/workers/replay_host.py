"""Inside a process that makes the replay of a run, and ends."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.traces.trace import Trace
from sim.truth.scene_file import load_scene
from sim.views.html_replay import save_replay

if TYPE_CHECKING:
    from nlcontrol.service.workers.worker_host import Tell


class ReplayHost:
    """Makes replays, which takes the engine."""

    def __init__(self, tell: Tell) -> None:
        pass

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        """Writes the replay of a trace; see `Host`.

        Args:
            method: is not looked at, since there is one.
            arguments: `trace`, the path of its file, `scene`, its name, and `path`, of the replay.
        """
        trace, path = Path(arguments["trace"]), Path(arguments["path"])
        save_replay(Trace.load(trace), load_scene(arguments["scene"]), path)
        return b"{}"
