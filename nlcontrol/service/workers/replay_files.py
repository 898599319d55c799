"""Replays and recordings of runs, which a worker writes: they take the engine."""

from __future__ import annotations

from pathlib import Path

from nlcontrol.reports.replay_story import replay_story
from nlcontrol.results.result import Result, result_with
from sim.traces.trace import Trace
from sim.truth.scene_file import load_scene
from sim.views.viewer_recording import save_recording, save_replay


def write_view(kind: str, trace: str, scene: str, path: str, result: str | None) -> None:
    """Writes the replay of a trace, or its recording.

    Args:
        kind: `replay` or `recording`.
        trace: path of its file.
        scene: name of it.
        path: of the file that is written.
        result: of the run as JSON, or None.
    """
    shown, story = Trace.load(Path(trace)), None
    if result is not None:
        known = Result.model_validate_json(result)
        story = replay_story(result_with(known, trace=shown))
    save = save_replay if kind == "replay" else save_recording
    save(shown, load_scene(scene), Path(path), story=story)
