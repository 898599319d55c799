"""The page through edits, lost services, closed tabs, reloads and Back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import httpx
import pytest

from tests.browser.lasting_page import PHASE, PLANNED, RESTING, STATE, plan, session_of
from tests.browser.open_page import OpenPage
from tests.patience import PATIENCE, wait_until
from tests.service_process import MOST_SESSIONS, LastingServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Request, Route

pytestmark = pytest.mark.slow

BUTTON = "document.querySelector('#banner button')"
AWAY = "push the ice tea box 3 cm away"
TOPPLE = "topple the ice tea box"


@pytest.fixture(scope="module")
def lasting(browser_path: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[LastingServer]:
    server = LastingServer(tmp_path_factory.mktemp("store"))
    server.start()
    yield server
    server.close()


@pytest.fixture
def opened(browser: Browser, lasting: LastingServer) -> Iterator[OpenPage]:
    found = OpenPage.opened(
        browser, lasting.url, few_frames=True, viewport={"width": 1100, "height": 750}
    )
    found.wait(f"{STATE}('table') !== null && page.view.viewer?.frames > 0")
    yield found
    leave(found, lasting)


def leave(opened: OpenPage, lasting: LastingServer) -> None:
    """Leaves a page as one does who closes its tab, and waits until its session is given back."""
    session = session_of(opened)
    opened.page.unroute_all()
    opened.page.goto("about:blank")
    # A context of Playwright that closes takes its last requests with it; a browser sends them.
    wait_until(lambda: session not in lasting.session_ids(), "a session that is given back")
    opened.page.close()


def run_through(opened: OpenPage, text: str) -> str:
    """Plans a sentence, has it done, and returns the run."""
    plan(opened, text)
    opened.page.click("#do-it")
    opened.wait(f"{STATE}('result') !== null && {STATE}('run').ended_at !== null")
    found: str = opened.ask(f"{STATE}('run').run_id")
    return found


def begun_runs(opened: OpenPage) -> list[Any]:
    """Bodies of the requests that begin a run, from now on."""
    bodies: list[Any] = []

    def note(request: Request) -> None:
        if request.method == "POST" and request.url.endswith(("/runs", "/say")):
            bodies.append(request.post_data_json)

    opened.page.on("request", note)
    return bodies


# --- what is approved is what is shown ----------------------------------------------------------


def test_an_edit_after_the_plan_lets_nothing_be_done(opened: OpenPage) -> None:
    plan(opened, AWAY)
    opened.wait("document.querySelectorAll('.view-label').length > 0")
    bodies = begun_runs(opened)
    assert opened.page.is_enabled("#do-it")
    opened.page.fill("#say", TOPPLE)
    opened.wait("document.querySelectorAll('.view-label').length === 0")
    assert opened.ask("page.view.viewer.ghosts.children.length") == 0
    assert opened.page.is_disabled("#do-it")
    assert opened.page.get_attribute("#prediction", "data-stale") == "true"
    assert "has changed" in opened.page.inner_text("#approval")
    opened.page.click("#do-it", force=True)
    opened.ask("document.querySelector('#do-it').onclick()")
    opened.page.wait_for_timeout(300)
    assert bodies == []
    opened.page.press("#say", "Enter")
    opened.wait(f"{STATE}('said') === {TOPPLE!r} && {STATE}('offer') !== null")
    assert opened.page.get_attribute("#approval", "data-stale") == "false"
    plan(opened, AWAY)
    opened.page.click("#do-it")
    opened.wait(f"{STATE}('run') !== null")
    assert [each["text"] for each in bodies] == [AWAY]
    opened.page.keyboard.press("Escape")
    opened.wait(f"{STATE}('result') !== null")


def test_an_edit_while_it_is_planned_lets_nothing_be_done_at_once(opened: OpenPage) -> None:
    held: list[Route] = []
    opened.page.route("**/plans", lambda route: held.append(route))  # noqa: PLW0108 - no method
    bodies = begun_runs(opened)
    opened.page.check("#at-once")
    opened.say(AWAY)
    wait_until(lambda: opened.ask("0") == 0 and held, "the plan is asked for")
    opened.page.fill("#say", TOPPLE)
    held.pop().continue_()
    opened.wait(PLANNED)
    opened.page.wait_for_timeout(300)
    assert bodies == []
    assert opened.page.is_disabled("#do-it")


# --- sessions heal ------------------------------------------------------------------------------


def test_a_tab_that_closes_gives_its_session_back(browser: Browser, lasting: LastingServer) -> None:
    for _ in range(MOST_SESSIONS + 1):
        found = OpenPage.opened(browser, lasting.url)
        found.wait(f"{STATE}('session') !== null")
        session = session_of(found)
        assert session in lasting.session_ids()
        leave(found, lasting)


def test_a_page_from_the_cache_of_the_browser_opens_a_new_session(opened: OpenPage) -> None:
    plan(opened, AWAY)
    before = session_of(opened)
    for kind in ("pagehide", "pageshow"):
        opened.ask(f"dispatchEvent(new PageTransitionEvent({kind!r}, {{ persisted: true }}))")
    opened.wait(f"{STATE}('session') && {STATE}('session').session_id !== {before!r}")
    opened.wait(f"{PLANNED} && {RESTING}")
    assert opened.page.input_value("#say") == AWAY


def test_a_restarted_service_is_found_again_with_the_sentence(
    opened: OpenPage, lasting: LastingServer
) -> None:
    plan(opened, AWAY)
    before = session_of(opened)
    lasting.kill()
    opened.wait("!document.querySelector('#banner').hidden")
    assert "does not answer" in opened.page.inner_text("#banner")
    assert not opened.page.is_visible("#problem")
    assert opened.page.is_disabled("#do-it")
    lasting.start()
    opened.wait(f"{STATE}('session')?.session_id !== {before!r} && {PLANNED} && {RESTING}")
    assert not opened.page.is_visible("#banner")
    assert opened.page.input_value("#say") == AWAY
    assert opened.page.is_enabled("#do-it")
    assert session_of(opened) in lasting.session_ids()


def test_a_closed_session_is_replaced_when_the_next_sentence_is_said(
    opened: OpenPage, lasting: LastingServer
) -> None:
    before = session_of(opened)
    httpx.delete(f"{lasting.url}/v1/sessions/{before}", timeout=PATIENCE).raise_for_status()
    wait_until(lambda: before not in lasting.session_ids())
    plan(opened, AWAY)
    assert session_of(opened) in lasting.session_ids()
    assert "new one" in opened.page.inner_text("#problem")
    opened.page.click("#problem button")
    assert not opened.page.is_visible("#problem")


def test_a_lost_session_heals_without_doing_anything(
    opened: OpenPage, lasting: LastingServer
) -> None:
    before = session_of(opened)
    httpx.delete(f"{lasting.url}/v1/sessions/{before}", timeout=PATIENCE).raise_for_status()
    wait_until(lambda: before not in lasting.session_ids())
    runs = len(lasting.get("runs")["runs"])
    opened.page.check("#at-once")
    opened.say(AWAY)
    opened.wait(f"{PLANNED} && {RESTING}")
    opened.page.wait_for_timeout(300)
    assert len(lasting.get("runs")["runs"]) == runs
    assert opened.page.is_enabled("#do-it")


def test_a_run_that_was_cut_off_is_settled(opened: OpenPage, lasting: LastingServer) -> None:
    plan(opened, AWAY)
    opened.page.click("#do-it")
    opened.wait(f"{PHASE} !== undefined")
    assert opened.page.is_visible("#stop")
    lasting.kill()
    opened.wait("!document.querySelector('#banner').hidden")
    assert not opened.page.is_visible("#stop")
    lasting.start()
    opened.wait(f"{STATE}('run')?.state === 'cut_off' && {RESTING} && {PLANNED}")
    assert opened.page.inner_text("#run .badge") == "cut off"
    assert not opened.page.is_visible("#stop")
    assert not opened.page.is_visible("#banner")
    assert opened.page.input_value("#say") == AWAY
    assert opened.page.is_enabled("#do-it")


def test_a_run_goes_on_after_a_gap_in_the_line(opened: OpenPage) -> None:
    plan(opened, AWAY)
    opened.page.click("#do-it")
    opened.wait(f"{PHASE} !== undefined")
    opened.page.context.set_offline(True)
    opened.ask("page.api.onGap()")
    opened.wait("!document.querySelector('#banner').hidden")
    opened.page.context.set_offline(False)
    opened.wait("document.querySelector('#banner').hidden")
    opened.wait(f"{STATE}('result') !== null")
    assert opened.page.inner_text("#run .badge") == "done"


def test_if_all_sessions_are_taken_the_page_says_so_and_tries_again(
    browser: Browser, lasting: LastingServer
) -> None:
    with httpx.Client(base_url=f"{lasting.url}/v1", timeout=PATIENCE) as others:
        taken = []
        while (made := others.post("/sessions", json={})).status_code == 201:
            taken.append(made.json()["session_id"])
        found = OpenPage.opened(browser, f"{lasting.url}/?say={AWAY.replace(' ', '+')}")
        found.wait(f"{STATE}('connection') === 'full'")
        assert "All sessions" in found.page.inner_text("#banner")
        assert not found.page.is_visible("#problem")
        assert found.page.input_value("#say") == AWAY
        found.page.click("#banner button")
        found.wait(f"{STATE}('connection') === 'full'")
        for session in taken:
            others.delete(f"/sessions/{session}")
        wait_until(lambda: lasting.session_ids().isdisjoint(taken))
        found.ask(f"{BUTTON}.offsetParent && {BUTTON}.click()")  # what was asked before may do
        found.wait(f"{PLANNED} && {RESTING}")
        assert not found.page.is_visible("#banner")
        leave(found, lasting)


# --- history and addresses ----------------------------------------------------------------------


def test_history_shows_a_run_beside_nothing_of_another_sentence(opened: OpenPage) -> None:
    run = run_through(opened, AWAY)
    opened.say("how heavy is the mug?")
    opened.wait(f"{STATE}('answer') !== null")
    assert "mug" in opened.page.inner_text("#understood")
    opened.page.click("#history summary")
    opened.wait("document.querySelectorAll('.runs li').length > 0")
    first = opened.page.locator(".runs li").first
    assert "kitchen, seed 0" in first.inner_text()
    assert "done" in first.inner_text()
    first.locator(".run").click()
    opened.wait(f"{STATE}('run')?.run_id === {run!r}")
    assert opened.page.input_value("#say") == AWAY
    assert opened.ask(f"{STATE}('answer')") is None
    assert "mug" not in opened.page.inner_text("#story").split("HISTORY")[0]
    opened.wait("document.querySelectorAll('#lights [data-part]').length > 0")


def test_history_and_run_say_stopped_alike(opened: OpenPage) -> None:
    plan(opened, AWAY)
    opened.page.click("#do-it")
    opened.wait(f"{PHASE} !== undefined")
    opened.page.keyboard.press("Escape")
    opened.wait(f"{STATE}('result') !== null")
    told = opened.page.inner_text("#run .badge")
    opened.page.click("#history summary")
    opened.wait("document.querySelectorAll('.runs li').length > 0")
    assert opened.page.locator(".runs li").first.inner_text().split("\n")[1].startswith(told)
    assert told == "stopped"


def test_a_reload_keeps_a_plan_and_back_leads_to_the_one_before(opened: OpenPage) -> None:
    session = session_of(opened)
    plan(opened, AWAY)
    opened.page.reload()
    opened.wait(f"globalThis.page && {PLANNED}")
    assert opened.page.input_value("#say") == AWAY
    assert session_of(opened) == session
    plan(opened, TOPPLE)
    opened.page.go_back()
    opened.wait(f"{STATE}('said') === {AWAY!r} && {PLANNED} && {RESTING}")
    assert opened.page.input_value("#say") == AWAY
    opened.page.go_forward()
    opened.wait(f"{STATE}('said') === {TOPPLE!r} && {PLANNED} && {RESTING}")


def test_a_run_has_an_address_that_a_reload_back_and_others_keep(
    opened: OpenPage, browser: Browser, lasting: LastingServer
) -> None:
    run = run_through(opened, AWAY)
    address = opened.page.url
    assert run in address
    opened.page.reload()
    opened.wait(f"globalThis.page?.state.get('run')?.run_id === {run!r}")
    assert opened.page.inner_text("#run .badge") == "done"
    assert opened.page.input_value("#say") == AWAY
    opened.wait("!document.querySelector('#controls').hidden")
    plan(opened, TOPPLE)
    opened.page.go_back()
    opened.wait(f"{STATE}('run')?.run_id === {run!r} && {STATE}('offer') === null")
    assert opened.page.url == address
    opened.page.go_back()
    opened.wait(f"{STATE}('run') === null && {STATE}('said') === {AWAY!r} && {PLANNED}")
    found = OpenPage.opened(browser, address)
    found.wait(f"{STATE}('run')?.run_id === {run!r} && {STATE}('session') !== null")
    assert found.page.inner_text("#run .badge") == "done"
    assert found.complaints == []
    leave(found, lasting)


def test_another_scene_has_an_address_and_back_opens_the_one_before(opened: OpenPage) -> None:
    opened.page.select_option("#scene", "workbench")
    opened.wait(f"{STATE}('session')?.spec.scene === 'workbench'")
    opened.wait("location.search.includes('scene=workbench')")
    opened.page.go_back()
    opened.wait(f"{STATE}('session')?.spec.scene === 'kitchen'")
    assert opened.page.input_value("#scene") == "kitchen"
    assert "scene=kitchen" in opened.page.url


def test_the_address_of_a_run_that_is_gone_says_so(
    opened: OpenPage, lasting: LastingServer
) -> None:
    opened.page.goto(f"{lasting.url}/?say=hello&run=run-0")
    opened.wait(f"globalThis.page?.state.get('problem') !== null && {STATE}('session') !== null")
    assert "no longer stored" in opened.page.inner_text("#problem")
