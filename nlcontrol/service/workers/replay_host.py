"""Inside a process that makes the replay of a run, and ends."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nlcontrol.reports.replay_story import replay_story
from nlcontrol.results.result import Result, result_with
from sim.traces.trace import Trace
from sim.truth.scene_file import load_scene
from sim.views.html_replay import save_recording, save_replay

if TYPE_CHECKING:
    from nlcontrol.service.workers.worker_host import Tell


class ReplayHost:
    """Makes replays, which takes the engine."""

    urgent: frozenset[str] = frozenset()

    def __init__(self, tell: Tell) -> None:
        pass

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        """Writes the replay of a trace, or its recording; see `Host`.

        Args:
            method: `replay` or `recording`.
            arguments: `trace`, the path of its file, `scene`, its name, `path`, of the file, and
                `result`, of the run as JSON, or None.
        """
        trace, story = Trace.load(Path(arguments["trace"])), None
        if arguments["result"] is not None:
            result = Result.model_validate_json(arguments["result"])
            story = replay_story(result_with(result, trace=trace))
        scene, path = load_scene(arguments["scene"]), Path(arguments["path"])
        save = save_replay if method == "replay" else save_recording
        save(trace, scene, path, story=story)
        return b"{}"
