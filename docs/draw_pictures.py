"""Draws the pictures of the guides and the README with the code of today.

    python -m docs.draw_pictures            # those that take seconds
    python -m docs.draw_pictures pour.png   # by name; some take minutes
    python -m docs.draw_pictures --check    # are those that take seconds what stands in the guides?

Pictures of the page and of replays need a browser: `python -m docs.take_page_pictures` and
`python -m docs.take_replay_pictures` take them. The guide to predictions has the commands of
`map_experiment.png`, which takes ten minutes.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from docs import draw_architecture, draw_free_bodies
from nlcontrol.cli import run

IMAGES = Path(__file__).parent / "images"
SENTENCE = "push the ice tea box away without toppling it"

QUICK: dict[str, tuple[str, ...]] = {
    "explanation.png": ("plan", "-q", SENTENCE, "--explain", "--picture"),
    "plan.png": ("plan", "-q", SENTENCE, "--picture"),
    "map.png": ("map", "ice tea box", "--output"),
    "map_straight.png": ("map", "ice tea box", "--straight", "--output"),
}
"""Commands that draw within seconds, by the name of their picture."""

LONG: dict[str, tuple[str, ...]] = {
    "pour.png": ("say", "pour the contents of the ice tea into the mug", "--picture"),
    "force_curves.png": ("explore", "ice tea box", "--picture"),
}
"""Commands that carry something out in the simulator."""

STEP, ALIKE = 100, 1e-4
"""Pixels of the same differ by less than so much [of 255] but for that share: other versions of a
library draw the rims of letters a little differently, and one new word is a larger share."""


def draw(name: str, folder: Path) -> Path:
    """Draw a picture into a folder and return its path."""
    path = folder / name
    if status := run([*(QUICK | LONG)[name], str(path)]):
        sys.exit(f"{name} was not drawn: exit code {status}")
    return path


def are_alike(one: Path, other: Path) -> bool:
    """Return True if two pictures show the same."""
    a, b = (np.asarray(Image.open(path).convert("RGB"), dtype=int) for path in (one, other))
    return a.shape == b.shape and float((np.abs(a - b).max(axis=2) > STEP).mean()) <= ALIKE


def outdated() -> list[str]:
    """Names of the quick pictures that the code of today draws otherwise."""
    with TemporaryDirectory() as folder:
        found = [name for name in QUICK if not are_alike(draw(name, Path(folder)), IMAGES / name)]
        forces = Path(folder) / draw_free_bodies.PICTURE.name
        draw_free_bodies.draw(forces)
        if not are_alike(forces, draw_free_bodies.PICTURE):
            found.append(forces.name)
    if draw_architecture.PICTURE.read_text("utf-8") != draw_architecture.draw():
        found.append(draw_architecture.PICTURE.name)
    return found


def main(args: list[str]) -> None:
    """Draw pictures by name, the quick ones, or look whether these are of today."""
    if args == ["--check"]:
        if names := outdated():
            sys.exit(f"{', '.join(names)}: draw them anew with `python -m docs.draw_pictures`")
        return
    for name in args or QUICK:
        draw(name, IMAGES)
    if not args:
        draw_free_bodies.draw()
        draw_architecture.PICTURE.write_text(draw_architecture.draw(), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
