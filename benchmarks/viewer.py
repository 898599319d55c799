"""Frames per second of a replay while it plays, drawn in software, and the weight of the page.

Runs Chromium without a display at 1280 × 800 with the kitchen and a push made by hand; prints
frames per second, the time of our script in a frame, and how coarsely the page chose to draw. Then
opens the page of a service: when something is painted first, and how much was sent for it.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from sim import load_scene
from sim.views.viewer_recording import save_replay
from tests.browser.open_page import FLAGS, NAMES, OpenPage
from tests.fakes.pushed_trace import pushed_trace
from tests.service_process import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SECONDS = 4.0
"""Over which is counted, three times."""

COUNT = """(async (seconds) => {
  const { viewer, player } = replay;
  const scripts = [];
  const show = viewer.onframe;
  viewer.onframe = (now) => {
    scripts.push(viewer.scriptTime);
    const moves = show(now);
    if (!moves) player.play();
    return true;
  };
  const [first, began] = [viewer.frames, performance.now()];
  await new Promise((done) => setTimeout(done, 1e3 * seconds));
  viewer.onframe = show;
  scripts.sort((a, b) => a - b);
  return {
    rate: (1e3 * (viewer.frames - first)) / (performance.now() - began),
    script: scripts[scripts.length >> 1],
    most: scripts[Math.floor(0.95 * scripts.length)],
    worst: scripts[scripts.length - 1],
    level: viewer.quality.level,
  };
})"""

PAINTED = """[
  performance.getEntriesByName("first-contentful-paint")[0].startTime,
  [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
    .filter(({ name }) => !name.includes("/v1/"))
    .reduce((sum, { transferSize }) => sum + transferSize, 0),
]"""


def main() -> None:
    """Measures and prints."""
    from playwright.sync_api import sync_playwright

    browser_path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if browser_path is None:
        sys.exit(f"no browser: none of {', '.join(NAMES)} is installed")
    scene = load_scene("kitchen")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder) / "run.html"
        save_replay(pushed_trace(scene, "ice tea box"), scene, path)
        print(f"size {path.stat().st_size / 1e3:.0f} kB")
        browser = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        began = time.monotonic()
        page.goto(path.as_uri())
        while not page.evaluate("document.documentElement.dataset.ready"):
            time.sleep(0.02)
        print(f"ready after {time.monotonic() - began:.2f} s")
        for _ in range(3):
            found = page.evaluate(COUNT, SECONDS)
            print(
                f"{found['rate']:5.1f} frames/s, script {found['script']:.1f} ms "
                f"(95 % below {found['most']:.1f} ms, all below {found['worst']:.1f} ms), "
                f"quality level {found['level']}"
            )
        page.close()
        _print_page(browser)
        browser.close()


def _print_page(browser: Browser) -> None:
    """Prints when the page of a service is painted first, and its weight."""
    with serving() as server:
        opened = OpenPage.opened(browser, server.url, viewport={"width": 1280, "height": 800})
        painted, sent = opened.ask(PAINTED)
        print(
            f"page of the service: first painted after {painted:.0f} ms, {sent / 1e3:.0f} kB sent"
        )
        opened.wait("page.view.viewer?.frames > 0")
        began = opened.ask("performance.now()")
        print(f"table drawn after {began:.0f} ms")


if __name__ == "__main__":
    main()
