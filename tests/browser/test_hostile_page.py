"""Hostile words and names do nothing to the page, and pages of others nothing with it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

import httpx
import pytest

from tests.browser.open_page import OpenPage
from tests.patience import PATIENCE
from tests.service_process import ServerProcess, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Route

pytestmark = pytest.mark.slow

STATE = "page.state.get"
MARKUP = '<img src=x onerror="globalThis.ran=1"></script><script>globalThis.ran=1</script>'
HOSTILE = {
    "markup": f"push the {MARKUP} away",
    "control": "push the \x00\x07\x1b[31m mug\x7f\n\r\t away",
    "right to left": "push the \u202e\u2066gum\u2069 away\u200f \u0627\u0644\u0643\u0648\u0628",
    "template": "${globalThis.ran=1} {{7*7}} javascript:ran() push the mug",
    "half letter and flags": "push the \U0001f9cb\U0001f3f4\U000e0067 mug away",
}
MARKUP_THERE = "document.querySelectorAll('img, script:not([src])')"
OVERHANG = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
NO_COMPLAINT = ("Failed to load resource",)  # what the browser says of every answer of 4xx


def faults(opened: OpenPage) -> list[str]:
    return [each for each in opened.complaints if not each.startswith(NO_COMPLAINT)]


def test_hostile_sentences_do_nothing(browser: Browser, server: ServerProcess) -> None:
    opened = OpenPage.opened(browser, f"{server.url}/?{urlencode({'say': HOSTILE['markup']})}")
    for said in HOSTILE.values():
        opened.wait(f"{STATE}('session') && !{STATE}('asking')")
        opened.ask(f"page.state.set({{ understanding: null, text: {json.dumps(said)} }})")
        opened.page.press("#say", "Enter")
        opened.wait(f"{STATE}('understanding') || {STATE}('problem')")
        assert opened.ask("globalThis.ran") is None, said[:60]
        assert opened.ask(f"{MARKUP_THERE}.length") == 0
        assert opened.ask(f"{STATE}('run')") is None
        assert opened.ask(OVERHANG) <= 0
    assert faults(opened) == []
    assert {url.split("/")[2] for url in opened.requests if url.startswith("http")} == {
        server.url.split("/")[2]
    }
    opened.page.close()


def test_a_sentence_of_a_link_that_is_too_long_is_told(
    browser: Browser, server: ServerProcess
) -> None:
    link = f"{server.url}/?{urlencode({'say': 'push the mug away ' + 'a' * 10_000})}"
    opened = OpenPage.opened(browser, link)
    opened.wait(f"{STATE}('problem')?.code === 'too_large'")
    assert opened.ask(OVERHANG) <= 0
    assert faults(opened) == []
    opened.page.close()


@pytest.mark.parametrize("link", [{"scene": MARKUP}, {"scene": "../../etc/passwd"}, {"seed": "x"}])
def test_a_hostile_scene_or_seed_is_told(
    browser: Browser, server: ServerProcess, link: dict[str, str]
) -> None:
    opened = OpenPage.opened(browser, f"{server.url}/?{urlencode(link)}")
    opened.wait(f"{STATE}('problem') !== null")
    assert opened.page.is_visible("#problem")
    assert opened.ask(f"{MARKUP_THERE}.length") == 0
    assert faults(opened) == []
    opened.page.close()


def test_hostile_names_of_objects_and_scenes_stand_there_as_text(
    browser: Browser, server: ServerProcess
) -> None:
    names = [MARKUP, "\u202egum", "m\x07ug", "a" * 200]

    def rename(route: Route) -> None:
        answer = route.fetch()
        document: dict[str, Any] = answer.json()
        for key in ("objects", "scenes", "bodies"):
            for item, name in zip(document.get(key, ()), names, strict=False):
                # By the names of bodies frames find them; what is written on them is the object's.
                item["object" if key == "bodies" else "name"] = name
        route.fulfill(response=answer, body=json.dumps(document))

    page = browser.new_page()
    for path in ("look", "geometry", "scenes", "objects"):
        page.route(f"**/v1/**{path}", rename)
    opened = OpenPage(page)
    page.on("pageerror", lambda error: opened.complaints.append(str(error)))
    page.goto(server.url)
    opened.wait("document.documentElement.dataset.ready === 'true'")
    opened.wait("page.view.viewer?.frames > 0 && document.querySelector('#examples li')")
    assert MARKUP in opened.page.inner_text("#examples")
    page.fill("#say", "push the <im")
    assert opened.page.inner_text("#completions li") == MARKUP
    assert opened.ask("globalThis.ran") is None
    assert opened.ask(f"{MARKUP_THERE}.length") == 0
    assert opened.complaints == []
    page.close()


OTHER_PAGE = """<!doctype html><title>other</title><iframe id="inside" src="URL/"></iframe>
<iframe name="posted"></iframe>
<form id="form" method="post" enctype="text/plain" target="posted" action="URL/v1/sessions">
<input name='{"scene":"kitchen","x":"' value='"}'></form>
<script type="module">
const tried = {};
const attempt = async (name, call) => {
  try { tried[name] = await call(); } catch (error) { tried[name] = "refused"; }
};
const json = { "Content-Type": "application/json" };
await attempt("read", async () => (await fetch("URL/v1/sessions")).text());
await attempt("read with cookies", async () =>
  (await fetch("URL/v1/sessions", { credentials: "include" })).text());
await attempt("move", async () =>
  (await fetch("URL/v1/sessions", { method: "POST", headers: json, body: "{}" })).text());
await attempt("blind move", async () =>
  (await fetch("URL/v1/sessions", { method: "POST", mode: "no-cors", body: "{}" })).type);
await attempt("script", async () => typeof (await import("URL/page/service_api.js")).ServiceApi);
await attempt("events", () => new Promise((done) => {
  const source = new EventSource("URL/v1/runs/x/events");
  source.onerror = () => done("refused");
  source.onopen = () => done("open");
}));
document.getElementById("form").submit();
const opened = window.open("URL/");
await new Promise((done) => setTimeout(done, 1500));
await attempt("window", async () => (opened.closed ? "severed" : opened.document.title));
await attempt("frame", async () => document.getElementById("inside").contentWindow.document.title);
globalThis.tried = tried;
</script>"""


@contextmanager
def other_origin(folder: Path) -> Iterator[str]:
    """Context with a server of another origin, whose files are those of a folder."""
    handler = partial(SimpleHTTPRequestHandler, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as other:
        Thread(target=other.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{other.server_port}"
        other.shutdown()


def test_a_page_of_another_origin_can_neither_read_nor_move(
    browser: Browser, server: ServerProcess, tmp_path: Path
) -> None:
    (tmp_path / "index.html").write_text(OTHER_PAGE.replace("URL", server.url))
    before = httpx.get(f"{server.url}/v1/sessions", timeout=PATIENCE).json()["sessions"]
    with other_origin(tmp_path) as address:
        page = browser.new_page()
        page.goto(address)
        opened = OpenPage(page)
        opened.wait("globalThis.tried !== undefined")
        tried = opened.ask("tried")
        # An opaque answer tells nothing, and the server has refused what was asked.
        assert tried.pop("blind move") in ("opaque", "refused")
        assert tried.pop("window") in ("severed", "refused")
        assert set(tried.values()) == {"refused"}
        page.context.close()
    known = {each["session_id"] for each in before}
    now = httpx.get(f"{server.url}/v1/sessions", timeout=PATIENCE).json()["sessions"]
    # A window that was opened has its own session, as every page of the service has.
    assert len([each for each in now if each["session_id"] not in known]) <= 1
    assert all(each["state"] == "idle" for each in now if each["session_id"] not in known)


def test_a_browser_logs_in_by_the_link_and_its_streams_bear_the_cookie(browser: Browser) -> None:
    token = "a token of some length"
    with serving(environment={"NLCONTROL_TOKEN": token}) as server:
        assert server.process.stdout is not None
        link = server.process.stdout.readline().split()[-1]
        stranger = OpenPage.opened(browser, server.url)
        assert stranger.page.is_visible("#login")
        assert stranger.violations() == []
        stranger.page.fill("#login input", "not this one")
        stranger.page.click("#login button")
        stranger.wait("document.querySelector('#login [role=alert]').textContent !== ''")
        stranger.page.fill("#login input", token)
        with stranger.page.expect_navigation():
            stranger.page.click("#login button")
        stranger.wait("globalThis.page?.state.get('table')")
        opened = OpenPage.opened(browser, link)
        opened.wait(f"{STATE}('pose') !== null")
        assert opened.ask("document.cookie") == ""
        assert opened.ask("location.hash") == ""
        assert opened.complaints == []
        opened.page.close()
        stranger.page.close()
