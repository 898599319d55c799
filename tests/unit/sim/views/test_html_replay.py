"""The file of a replay: one page that asks no address, with what others wrote as plain text."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import re
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

from sim import load_scene
from sim.truth.scene_file import Scene
from sim.views.run_story import RunStory, StoryWord
from sim.views.viewer_recording import MODULES, replay_page, save_replay
from tests.fakes.pushed_trace import pushed_trace

PAGE = resources.files("sim.views") / "page"
HOSTILE = "</title></script><script>alert(1)</script><img src=x onerror=alert(2)>\u202e\x00\ud800"


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("kitchen")


def _content(page: str) -> dict[str, Any]:
    (packed,) = re.findall(r'<script id="packed" type="text/plain">([^<]*)</script>', page)
    return dict(json.loads(gzip.decompress(base64.b64decode(packed))))


def test_one_small_page_without_addresses(scene: Scene, tmp_path: Path) -> None:
    path = tmp_path / "run.html"
    save_replay(pushed_trace(scene, "ice tea box"), scene, path)
    page = path.read_text("utf-8")
    assert page.startswith("<!doctype html>")
    assert len(page) < 1_000_000
    shown = re.sub(r'(?s)<script id="packed".*?</script>', "", page)
    assert not re.findall(r"https?:|\bsrc=|\bhref=|@import|url\(", shown)


def test_the_policy_admits_this_script_and_style_alone(scene: Scene) -> None:
    page = replay_page(pushed_trace(scene, "mug"), scene)
    (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', page)
    assert policy.startswith("default-src 'none'")
    assert "unsafe" not in policy
    for tag in ('script type="module"', "style"):
        (text,) = re.findall(rf"(?s)<{tag}>(.*?)</{tag.split()[0]}>", page)
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy


def test_what_others_wrote_stays_text(scene: Scene) -> None:
    story = RunStory(title=HOSTILE, words=(StoryWord(HOSTILE, "", 0, len(HOSTILE)),))
    page = replay_page(pushed_trace(scene, "mug"), scene, story)
    assert "alert(1)" not in page.replace("&lt;script&gt;alert(1)&lt;/script&gt;", "")
    assert len(re.findall("<script", page)) == 2
    assert _content(page)["run"]["story"]["title"].startswith(HOSTILE[:20])


def test_the_same_run_gives_the_same_page(scene: Scene) -> None:
    trace = pushed_trace(scene, "mug")
    assert replay_page(trace, scene) == replay_page(trace, scene)


def test_modules_stand_after_those_that_they_import() -> None:
    known: set[str] = set()
    for name in MODULES:
        source = (PAGE / name).read_text("utf-8")
        wanted = {path.rpartition("/")[2] for path in re.findall(r'from\s*"\./([^"]+)"', source)}
        assert wanted <= known
        known.add(name.rpartition("/")[2])


def test_what_comes_from_elsewhere_is_as_it_was_published() -> None:
    vendor = PAGE / "vendor"
    told = json.loads((vendor / "vendor.json").read_text("utf-8"))
    files = {file.name for file in vendor.iterdir()} - {"vendor.json"}
    assert set(told["sha256"]) == files
    for name, digest in told["sha256"].items():
        assert hashlib.sha256((vendor / name).read_bytes()).hexdigest() == digest
    assert told["version"].split(".")[1] in (vendor / "three.core.min.js").read_text("utf-8")
