"""A sheet to draw boxes, texts and ties on, measured in inches from its upper left corner.

Texts are measured before they are placed, so a layout can give each as much room as it needs.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

LINE = 1.35
"""Distance of lines as a share of the size of the letters."""

_POINT = 1.0 / 72.0  # [in]
_DPI = 150


def line_height(size: float) -> float:
    """Height of a line of text [in], by the size of its letters in points."""
    return LINE * size * _POINT


class Sheet:
    """A sheet of a given width [in]; its height is known when it is saved."""

    def __init__(self, width: float) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._figure = Figure(figsize=(width, width), dpi=_DPI, facecolor="white")
        canvas: Any = FigureCanvasAgg(self._figure)
        self._renderer = canvas.get_renderer()
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        self._axes.set_xlim(0.0, width)
        self._width = width

    def length(self, text: str, size: float, *, bold: bool = False) -> float:
        """Length of a text in one line [in]."""
        from matplotlib.font_manager import FontProperties

        font = FontProperties(size=size, weight="bold" if bold else "normal")
        return float(self._renderer.get_text_width_height_descent(text, font, False)[0]) / _DPI

    def lines_of(self, text: str, width: float, size: float, *, bold: bool = False) -> list[str]:
        """The lines of a text that is not to be longer than `width` [in].

        A word that is too long by itself is divided.
        """
        lines = [""]
        for word in text.split():
            rest = word
            if not self._fits(f"{lines[-1]} {rest}".strip(), width, size, bold):
                lines.append("")
            while not self._fits(rest, width, size, bold):
                most = next(
                    n for n in range(len(rest) - 1, 0, -1)
                    if n == 1 or self._fits(rest[:n], width, size, bold)
                )  # fmt: skip
                lines[-1:] = [rest[:most], ""]
                rest = rest[most:]
            lines[-1] = f"{lines[-1]} {rest}".strip()
        return [line for line in lines if line] or [""]

    def _fits(self, text: str, width: float, size: float, bold: bool) -> bool:
        return len(text) < 2 or self.length(text, size, bold=bold) <= width

    def write(self, x: float, y: float, text: str, size: float, colour: str, **style: Any) -> None:
        """Writes a line of text, its middle at a height y."""
        # Names in a sentence may hold the signs that mark formulae.
        self._axes.text(
            x, y, text, fontsize=size, color=colour, va="center_baseline", parse_math=False, **style
        )  # fmt: skip

    def box(
        self, x: float, y: float, width: float, height: float, colour: str, fill: str, **style: Any
    ) -> None:
        """Draws a box with round corners."""
        from matplotlib.patches import FancyBboxPatch

        self._axes.add_patch(
            FancyBboxPatch(
                (x, y), width, height, boxstyle="round,pad=0,rounding_size=0.07",
                edgecolor=colour, facecolor=fill, linewidth=1.3, **style,
            )
        )  # fmt: skip

    def tie(
        self, start: tuple[float, float], end: tuple[float, float], colour: str, **style: Any
    ) -> None:
        """Draws a curve from one point to another, level at both ends."""
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path as Curve

        bend = 0.5 * (start[0] + end[0])
        points = [start, (bend, start[1]), (bend, end[1]), end]
        curve = Curve(points, [Curve.MOVETO, Curve.CURVE4, Curve.CURVE4, Curve.CURVE4])
        style = {"linewidth": 1.4, "zorder": 0} | style
        self._axes.add_patch(PathPatch(curve, facecolor="none", edgecolor=colour, **style))

    def save(self, path: Path, height: float) -> None:
        """Writes the sheet to a file, as high as it has become [in]."""
        self._figure.set_size_inches(self._width, height)
        self._axes.set_ylim(height, 0.0)
        self._figure.savefig(path)
