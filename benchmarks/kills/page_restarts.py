"""A page in Chromium whose service is killed in the midst of runs, and started again.

Nobody touches the page but to say a sentence and to approve its plan. All else it does by itself.
"""

from __future__ import annotations

import random
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from tests.browser.lasting_page import PHASE, PLANNED, RESTING, STATE, plan, session_of
from tests.browser.open_page import FLAGS, OpenPage, found_browser
from tests.service_process import LastingServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SENTENCES = (
    "push the ice tea box 3 cm away",
    "push the mug 10 cm to the left",
    "push the ice tea box 4 cm to the right",
    "lift the mug",
)

LONGEST_MOTION = 2.0
"""Time after the first phase of a run in which its service is killed [s]; most runs take longer."""

LONGEST_GAP = 3.0
"""Time for which there is no service [s]."""


class RestartedPage:
    """A page beside a service that is killed.

    Args:
        browser: in which it is opened.
        server: that is killed.
        seed: of what is said, and of the moments.

    Attributes:
        faults: what did not go on by itself, in words.
        told: what became of the runs that were under way.
    """

    def __init__(self, browser: Browser, server: LastingServer, seed: int) -> None:
        self._server, self._rng = server, random.Random(seed)
        self.faults: list[str] = []
        self.told: Counter[str] = Counter()
        self.slowest = 0.0
        self._opened = OpenPage.opened(
            browser, server.url, few_frames=True, viewport={"width": 1100, "height": 750}
        )
        self._opened.wait(f"{STATE}('table') !== null && {STATE}('session') !== null")

    def restart(self) -> None:
        """One run that is begun, killed, and what the page makes of it."""
        opened, server, rng = self._opened, self._server, self._rng
        text = rng.choice(SENTENCES)
        plan(opened, text)
        before = session_of(opened)
        opened.page.click("#do-it")
        opened.wait(f"{STATE}('run') !== null && {PHASE} !== undefined")
        run = opened.ask(f"{STATE}('run').run_id")
        time.sleep(rng.uniform(0.0, LONGEST_MOTION))
        server.kill()
        opened.wait("!document.querySelector('#banner').hidden")
        self._require("does not answer" in opened.page.inner_text("#banner"), "a banner says why")
        self._require(not opened.page.is_visible("#stop"), "no stop that stops nothing")
        time.sleep(rng.uniform(0.0, LONGEST_GAP))
        server.start()
        began = time.monotonic()
        opened.wait(f"{STATE}('session') && {STATE}('session').session_id !== {before!r}")
        opened.wait(f"{RESTING} && {STATE}('run') && {STATE}('run').ended_at !== null")
        self.slowest = max(self.slowest, time.monotonic() - began)
        self._look_at(text, run)

    def _look_at(self, text: str, run: str) -> None:
        """Compares the page with the store."""
        opened, server = self._opened, self._server
        stored = server.get(f"runs/{run}")["state"]
        self.told[stored] += 1
        shown = opened.ask(f"{STATE}('run').state")
        self._require(shown == stored, f"the page shows the run as {shown}, it is {stored}")
        self._require(stored in ("cut_off", "ended"), f"a run that is settled, not {stored}")
        self._require(session_of(opened) in server.session_ids(), "a session that there is")
        self._require(opened.page.input_value("#say") == text, "the sentence is kept")
        self._require(not opened.page.is_visible("#banner"), "the banner has gone")
        if stored == "cut_off":
            opened.wait(f"{PLANNED} && {RESTING}")
            self._require(opened.page.is_enabled("#do-it"), "the plan is offered again")

    def _require(self, holds: bool, what: str) -> None:
        if not holds:
            self.faults.append(what)


def prove_page_goes_on(restarts: int, seed: int) -> bool:
    """Restarts a service so often and prints what came of it; False if the page was at a loss."""
    from playwright.sync_api import sync_playwright

    path = found_browser()
    assert path is not None, "there is no Chromium on this machine: install one"
    with tempfile.TemporaryDirectory() as store, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        server = LastingServer(Path(store))
        server.start()
        try:
            page = RestartedPage(browser, server, seed)
            for number in range(restarts):
                page.restart()
                print(f"{number + 1}: {dict(page.told)}, {page.faults or 'no fault'}", flush=True)
        finally:
            browser.close()
            server.close()
    print(
        f"{restarts} restarts in the midst of runs, seed {seed}: the page went on by itself "
        f"{restarts - len(page.faults)} times, the runs were {dict(page.told)}, slowest "
        f"{page.slowest:.1f} s from the start of the service to a new session and a settled run"
    )
    return not page.faults
