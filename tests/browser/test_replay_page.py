"""The replay file in a real browser: it opens from a file, asks nothing, plays, can be scrubbed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from sim import load_scene
from sim.truth.scene_file import Scene
from sim.views.run_story import ContactMark, Ghost, RunStory, StoryClause, StoryLine, StoryWord
from sim.views.viewer_recording import save_replay
from tests.browser.open_page import OpenPage
from tests.fakes.pushed_trace import DURATION, FORCE, pushed_trace

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.slow

BOX = "ice tea box"
SENTENCE = "push the box away"
HOSTILE = "<img src=x onerror=ran()></script><script>ran()</script>\u202e\x07" + "a" * 10_000

STORY = RunStory(
    title=SENTENCE,
    words=(
        StoryWord("push", "push controller", 0, 4),
        StoryWord(" the ", "", 4, 9),
        StoryWord("box", "object model", 9, 12),
        StoryWord(" ", "", 12, 13),
        StoryWord("away", "wanted outcome", 13, 17),
    ),
    status="failed",
    prediction=(StoryLine("Plan:", "push it"),),
    clauses=(
        StoryClause("held", "away", ((13, 17),), "moved", "100 mm", "asked: 100 mm ± 10 mm"),
        StoryClause("not_held", "", (), "tilt", "9°", "asked: at most 5°"),
    ),
    ghosts=(Ghost(BOX, (1.0, 0.0, 0.0, 0.0, 0.55, 0.0, 0.0)),),
    contacts=(ContactMark(0.0, BOX, (-0.045, 0.0, 0.03), (-1.0, 0.0, 0.0)),),
)


def _open(browser: Browser, path: Path, *, still: bool = True) -> OpenPage:
    size = {"width": 900, "height": 600}
    motion = "reduce" if still else None
    return OpenPage.opened(browser, path.as_uri(), viewport=size, reduced_motion=motion)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("kitchen")


@pytest.fixture(scope="module")
def replay(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "run.html"
    save_replay(pushed_trace(scene, BOX), scene, path, story=STORY)
    return path


@pytest.fixture(scope="module")
def opened(browser: Browser, replay: Path) -> Iterator[OpenPage]:
    found = _open(browser, replay)
    yield found
    found.page.close()


def test_it_asks_no_address_and_complains_of_nothing(opened: OpenPage, replay: Path) -> None:
    addresses = [url for url in opened.requests if not url.startswith("blob:")]
    assert addresses == [replay.as_uri()]
    assert opened.complaints == []
    assert opened.page.title() == SENTENCE


def test_the_sentence_stands_in_the_colours_of_its_parts(opened: OpenPage) -> None:
    assert opened.page.inner_text("#sentence") == SENTENCE
    parts = opened.ask("[...document.querySelectorAll('.word')].map((e) => e.dataset.part ?? '')")
    assert parts == ["push controller", "", "object model", "", "wanted outcome"]
    colours = opened.ask(
        "[...document.querySelectorAll('.word')].map((e) => getComputedStyle(e).color)"
    )
    assert len(set(colours)) == 4
    assert opened.violations() == []


def test_each_clause_has_its_verdict_and_lights_its_words(opened: OpenPage) -> None:
    verdicts = "[...document.querySelectorAll('#verdicts li')].map((e) => e.dataset.verdict)"
    assert opened.ask(verdicts) == ["held", "not_held"]
    opened.page.hover("#verdicts li:first-child")
    lit = opened.ask("[...document.querySelectorAll('.lit')].map((e) => e.textContent)")
    assert lit == ["away"]


def test_scrubbing_moves_the_box_and_shows_the_forces(opened: OpenPage) -> None:
    box = f"replay.viewer.bodies[replay.viewer.indexOf('{BOX}')].position.x"
    before = opened.ask(f"replay.player.seek(0), {box}")
    opened.page.locator("#time").fill(str(DURATION * 0.7))
    assert opened.ask("replay.player.time") == pytest.approx(DURATION * 0.7)
    assert opened.ask(box) - before == pytest.approx(0.05, abs=0.003)
    assert opened.ask("replay.viewer.arrows.map((each) => each.group.visible)") == [True, True]
    assert opened.page.inner_text("#newtons") == f"{2.0 * FORCE:.1f} N"
    opened.page.keyboard.press("End")
    assert opened.ask(box) - before == pytest.approx(0.1, abs=1e-3)
    assert opened.ask("replay.viewer.arrows.map((each) => each.group.visible)") == [False, False]
    opened.page.keyboard.press("Home")
    assert opened.ask("replay.player.time") == 0.0


def test_it_plays_slower_if_asked_and_stops_at_the_end(opened: OpenPage) -> None:
    opened.page.select_option("#speed", "0.25")
    opened.ask("replay.player.seek(0), replay.player.play()")
    opened.wait("replay.player.time > 0.1")
    assert opened.ask("replay.player.playing")
    opened.page.keyboard.press("k")
    assert not opened.ask("replay.player.playing")
    opened.page.select_option("#speed", "4")
    opened.ask("replay.player.seek(3.5), replay.player.play()")
    opened.wait("replay.player.time >= replay.player.end && !replay.player.playing")


def test_the_predicted_end_and_the_contact_are_shown(opened: OpenPage) -> None:
    assert opened.ask("replay.viewer.ghosts.children.length") == 1
    assert opened.ask("replay.viewer.rings.length") == 1
    opened.page.uncheck("#ghost")
    assert not opened.ask("replay.viewer.ghosts.visible")
    opened.page.check("#ghost")


def test_something_is_drawn(opened: OpenPage) -> None:
    drawn = opened.ask(
        """(() => {
             const { viewer } = replay;
             viewer.renderer.render(viewer.scene, viewer.orbit.camera);
             const gl = viewer.renderer.getContext();
             const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
             const pixels = new Uint8Array(4 * w * h);
             gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
             const colours = new Set();
             for (let i = 0; i < pixels.length; i += 4) {
               colours.add(pixels[i] * 65536 + pixels[i + 1] * 256 + pixels[i + 2]);
             }
             return colours.size;
           })()"""
    )
    assert drawn > 500  # shaded bodies; a background alone has one


def test_dragging_turns_the_view_and_it_comes_home(opened: OpenPage) -> None:
    home = opened.ask("replay.viewer.orbit.azimuth")
    box = opened.page.locator("canvas").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    opened.page.mouse.move(x, y)
    opened.page.mouse.down()
    opened.page.mouse.move(x + 100, y)
    opened.page.mouse.up()
    assert opened.ask("replay.viewer.orbit.azimuth") == pytest.approx(home - 0.6, abs=0.01)
    opened.page.click("#home")
    assert opened.ask("replay.viewer.orbit.azimuth") == home


def test_it_plays_by_itself_unless_motion_is_unwanted(browser: Browser, replay: Path) -> None:
    found = _open(browser, replay, still=False)
    found.wait("replay.player.time > 0.2")
    assert found.complaints == []
    found.page.close()


def test_live_frames_are_shown_between_those_that_came(opened: OpenPage) -> None:
    moved = opened.ask(
        f"""(async () => {{
              const {{ viewer, player }} = replay;
              const live = new replay.LivePlayer(viewer);
              const index = viewer.indexOf("{BOX}");
              for (let i = 0; i < 20; i++) {{
                const poses = {{ "{BOX}/{BOX}": [1, 0, 0, 0, 0.1 * i, 0, 0] }};
                live.push({{ time: i / 30, poses }});
                await new Promise((done) => setTimeout(done, 33));
              }}
              const place = () => viewer.bodies[index].position.x;
              while (Math.abs(place() - 1.9) > 1e-6) {{
                await new Promise((done) => setTimeout(done, 33));
              }}
              viewer.onframe = (now) => player.tick(now);
              return place();
            }})()"""
    )
    assert moved == pytest.approx(1.9, abs=1e-5)


def test_a_scene_of_bottles_and_lids_is_drawn(browser: Browser, tmp_path: Path) -> None:
    pantry = load_scene("pantry")
    path = tmp_path / "pantry.html"
    save_replay(pushed_trace(pantry, "mug"), pantry, path)
    found = _open(browser, path)
    found.wait("replay.viewer.frames > 0")
    assert found.complaints == []
    found.page.close()


def test_hostile_words_and_names_do_nothing(browser: Browser, scene: Scene, tmp_path: Path) -> None:
    bad = HOSTILE[:60]
    objects = tuple(
        item.model_copy(update={"name": bad}) if item.name == BOX else item
        for item in scene.objects
    )
    path = tmp_path / "hostile.html"
    story = RunStory(
        title=HOSTILE,
        words=(StoryWord(HOSTILE, '"><script>ran()</script>', 0, len(HOSTILE)),),
        understood=HOSTILE,
        status=bad,
        clauses=(StoryClause("held", HOSTILE, ((0, 5),), HOSTILE, HOSTILE, HOSTILE),),
        notes=(HOSTILE,),
    )
    hostile = scene.model_copy(update={"objects": objects})
    save_replay(pushed_trace(hostile, bad), hostile, path, story=story)
    found = _open(browser, path)
    assert found.page.inner_text("#notes p").startswith("<img src=x")
    assert found.ask("document.querySelectorAll('img, script:not(:last-of-type)').length") == 1
    assert found.complaints == []
    assert [url for url in found.requests if not url.startswith("blob:")] == [path.as_uri()]
    wide = found.ask("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert wide <= 0
    found.page.close()
