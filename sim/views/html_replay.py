"""A trace as one self-contained HTML file that replays in a browser, without a network.

The page is `page/replay.html` with its style and one small script in it. That script unpacks the
modules of the viewer and the data, which stand in the page compressed. A content-security policy
admits this script and what it unpacks, and no address at all.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Mapping
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

from sim.traces.trace import Trace
from sim.truth.scene_file import Scene
from sim.views.run_story import RunStory, StoryWord
from sim.views.viewer_recording import scene_and_recording

MODULES = (
    "vendor/three.core.min.js", "vendor/three.module.min.js", "frame_track.js", "body_shapes.js",
    "force_markers.js", "orbit_camera.js", "render_quality.js", "viewer.js", "player.js",
    "force_chart.js", "timeline.js", "play_controls.js", "replay.js",
)  # fmt: skip
"""Modules of the page; each stands after those that it imports."""


def save_replay(
    trace: Trace, scene: Scene, path: Path | str, *, story: RunStory | None = None
) -> None:
    """Writes a replay of a trace and its scene to an HTML file.

    Args:
        trace: what happened.
        scene: in which.
        path: of the file.
        story: what the page tells besides; without one it shows the motion alone.
    """
    Path(path).write_text(replay_page(trace, scene, story), encoding="utf-8")


def replay_page(trace: Trace, scene: Scene, story: RunStory | None = None) -> str:
    """The replay as the text of an HTML document."""
    told = story or _bare_story(trace)
    packed = _packed({
        "modules": [(name.rpartition("/")[2], _page_file(name)) for name in MODULES],
        "run": _replay_content(trace, scene, told),
    })  # fmt: skip
    loader = f"\n{_page_file('replay_loader.js')}"
    style = f"\n{_page_file('look.css')}{_page_file('replay.css')}"
    return Template(_page_file("replay.html")).substitute(
        policy=_policy(loader, style),
        title=escape(told.title.encode("utf-8", "replace").decode()),
        style=style,
        packed=base64.b64encode(packed).decode(),
        loader=loader,
    )


def save_recording(
    trace: Trace, scene: Scene, path: Path | str, *, story: RunStory | None = None
) -> None:
    """Writes what a replay shows, for another page with the same viewer: JSON, compressed (gzip).

    The object has a `scene` (see `sim.views.viewer_scene`), its `recording` (see
    `sim.views.viewer_recording`) and the `story`; the arguments are those of `save_replay`.
    """
    content = _replay_content(trace, scene, story or _bare_story(trace))
    Path(path).write_bytes(_packed(content))


def _replay_content(trace: Trace, scene: Scene, story: RunStory) -> dict[str, Any]:
    drawn, recording = scene_and_recording(trace, scene)
    return {"scene": drawn, "recording": recording, "story": story.document()}


def _packed(content: Mapping[str, Any]) -> bytes:
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
    return gzip.compress(text.encode("utf-8", "replace"), mtime=0)


def _bare_story(trace: Trace) -> RunStory:
    title = f"A run with the {trace.pushed}"
    return RunStory(title=title, words=(StoryWord(title, "", 0, len(title)),))


def _page_file(name: str) -> str:
    return (resources.files("sim.views") / "page" / name).read_text("utf-8")


def _policy(script: str, style: str) -> str:
    """The policy that admits one script, what it unpacks, and one style."""
    rules = {
        "default-src": "'none'",
        "script-src": f"'{_digest(script)}' blob:",
        "style-src": f"'{_digest(style)}'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(f"{rule} {allowed}" for rule, allowed in rules.items())


def _digest(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode('utf-8')).digest()).decode()}"
