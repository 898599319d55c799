"""Takes the pictures of replays in the guides, each from a run that is carried out for it.

python -m docs.take_replay_pictures              # all of them, in some minutes
python -m docs.take_replay_pictures replay.png   # by name
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Literal, NamedTuple

from PIL import Image

from docs.take_page_pictures import DESKTOP, IMAGES, PHONE, new_browser
from nlcontrol.cli import run
from tests.browser.open_page import OpenPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser, ViewportSize

GAP = 20
"""Between pictures that stand side by side [pixels]."""


class View(NamedTuple):
    """One look at a replay.

    Attributes:
        sentence: that is carried out.
        time: of the replay [s].
        scheme: of the colours of the page.
        size: of the page.
        scene: in which.
    """

    sentence: str
    time: float
    scheme: Literal["light", "dark"] = "light"
    size: ViewportSize = DESKTOP
    scene: str = "kitchen"


PICTURES: dict[str, tuple[View, ...]] = {
    "replay.png": (View("push the ice tea box away without toppling it", 8.5),),
    "replay_pour.png": (View("pour the contents of the ice tea into the mug", 22.5, "dark"),),
    "replay_stand_up.png": (
        View("stand the sugar box up", 11.5, scene="examples/fallen_sugar_box.yaml"),
    ),
    "replay_swap.png": (View("swap the sugar box and the tea tin", 75.0, scene="workbench"),),
    "replay_clear.png": (
        View("clear the left half of the table", 12.0, scene="workbench"),
        View("clear the left half of the table", 300.0, scene="workbench"),
    ),
    "replay_facing.png": (View("turn the ice tea to face the mug", 22.0),),
    "replay_stack.png": (
        View("put the tea tin on the book", 82.0, scene="examples/flat_book.yaml"),
    ),
    "replay_into.png": (
        View("put the soup can into the bin", 15.5, scene="examples/storage_bin.yaml"),
    ),
    "replay_edge.png": (
        View("push the book over the left edge by 5 cm", 18.5, scene="examples/flat_book.yaml"),
    ),
    "replay_phone.png": (
        View("open the jar", 8.4, size=PHONE, scene="pantry"),
        View("topple the ice tea box", 10.3, "dark", PHONE),
    ),
}
"""Views that stand side by side, by the name of their picture."""


def take(browser: Browser, name: str, folder: Path) -> Path:
    """Take a picture into a folder and return its path."""
    with TemporaryDirectory() as work:
        views = [_taken(browser, view, Path(work, str(k))) for k, view in enumerate(PICTURES[name])]
    width = sum(view.width for view in views) + GAP * (len(views) - 1)
    whole = Image.new("RGB", (width, max(view.height for view in views)), "white")
    left = 0
    for view in views:
        whole.paste(view, (left, 0))
        left += view.width + GAP
    path = folder / name
    whole.save(path)
    return path


def _taken(browser: Browser, view: View, path: Path) -> Image.Image:
    """What a browser shows of the replay of a run."""
    replay = path.with_suffix(".html")
    if status := run(["say", "-q", view.sentence, "--scene", view.scene, "--replay", str(replay)]):
        sys.exit(f"“{view.sentence}” ended with exit code {status}")
    opened = OpenPage.opened(
        browser,
        replay.as_uri(),
        viewport=view.size,
        color_scheme=view.scheme,
        reduced_motion="reduce",
    )
    opened.ask(f"replay.viewer.quality.level = 0, replay.player.seek({view.time})")
    opened.wait("replay.viewer.holder.dataset.settled === String(replay.viewer.frames)")
    picture = path.with_suffix(".png")
    opened.page.screenshot(path=picture)
    opened.page.close()
    with Image.open(picture) as found:
        return found.convert("RGB")


def main(names: list[str]) -> None:
    """Take the pictures of these names, or all."""
    with new_browser() as browser:
        for name in names or PICTURES:
            take(browser, name, IMAGES)


if __name__ == "__main__":
    main(sys.argv[1:])
