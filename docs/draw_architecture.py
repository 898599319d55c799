"""Draws `docs/images/architecture.svg`: packages, rooms, and the way of a sentence.

    python docs/draw_architecture.py

Rooms are read from the folders, their order from the import contracts in `pyproject.toml`, so that
the picture shows what is there. The numbers of the way are those of the table in
`docs/architecture.md`.
"""

from __future__ import annotations

import re
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs" / "images" / "architecture.svg"

# Packages from the top of the picture, each with what it does and the seam on its lower edge.
BANDS = (
    ("nlcontrol", "the front", "Executor, Perception, Planner"),
    ("sim", "the robot and its world", "Robot"),
    ("planner", "from a frame to a plan", "ObjectModel, Frame"),
    ("objectmodels", "physics of an object", ""),
    ("grammar", "words to frames", ""),
)
WIDTH, COLUMNS, BOX_HEIGHT, GAP, MARGIN, LABEL = 1000, 6, 34, 8, 12, 150
BOX_WIDTH = (WIDTH - LABEL - MARGIN - (COLUMNS - 1) * GAP) / COLUMNS
COLOURS = ("#dce9f7", "#e3f1dd", "#fdf0d5", "#f6e0dd", "#ece3f3")


def steps() -> dict[str, str]:
    """The numbers of the steps of a sentence by the room that does them, from the page's table."""
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    found: dict[str, list[str]] = {}
    for number, modules in re.findall(r"^\| (\d+) \| .* \| (.*) \|$", page, re.M):
        for room in dict.fromkeys(re.findall(r"`(\w+/\w+)/", modules)):
            found.setdefault(room.replace("/", "."), []).append(number)
    return {room: " ".join(numbers) for room, numbers in found.items()}


def rooms(package: str) -> list[str]:
    """The rooms of a package, the highest layer first."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    (layers,) = [c["layers"] for c in contracts["contracts"] if c["id"] == f"rooms_{package}"]
    names = [name.strip(" ()") for layer in layers for name in layer.replace("|", ":").split(":")]
    return [name for name in names if (ROOT / package / name / "__init__.py").exists()]


def draw() -> str:
    """The picture as SVG text."""
    shapes: list[str] = []
    numbers = steps()
    top = float(MARGIN)
    for (package, purpose, seam), colour in zip(BANDS, COLOURS, strict=True):
        names = rooms(package)
        lines = -(-len(names) // COLUMNS)
        height = lines * (BOX_HEIGHT + GAP) + GAP
        shapes += [
            f'<rect x="0" y="{top}" width="{WIDTH}" height="{height}" rx="6" fill="{colour}"/>',
            _text(MARGIN, top + height / 2 - 2, package, "package"),
            _text(MARGIN, top + height / 2 + 13, purpose, "small"),
        ]
        for i, name in enumerate(names):
            x = LABEL + i % COLUMNS * (BOX_WIDTH + GAP)
            y = top + GAP + i // COLUMNS * (BOX_HEIGHT + GAP)
            shapes += _box(x, y, name, numbers.get(f"{package}.{name}", ""))
        top += height + 2
        if seam:
            top += 18
            shapes.append(_text(LABEL, top - 5, f"▼ {seam}", "seam"))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {top + MARGIN:.0f}" '
        'font-family="sans-serif">\n<style>.package{font-size:15px;font-weight:bold}'
        ".small,.seam{font-size:11px;fill:#555}.seam{font-style:italic}.room{font-size:13px}"
        ".way{font-size:12px;font-weight:bold;fill:#b03020}</style>\n"
        '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(shapes) + "\n</svg>\n"
    )


def _box(x: float, y: float, name: str, way: str) -> list[str]:
    return [
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{BOX_WIDTH:.1f}" height="{BOX_HEIGHT}" rx="4" '
        'fill="white" stroke="#888"/>',
        _text(x + 8, y + 22, name, "room"),
        *([_text(x + BOX_WIDTH - 8, y + 22, way, "way", anchor="end")] if way else []),
    ]


def _text(x: float, y: float, text: str, style: str, anchor: str = "start") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" class="{style}" text-anchor="{anchor}">'
        f"{escape(text)}</text>"
    )


if __name__ == "__main__":
    PICTURE.write_text(draw(), "utf-8")
