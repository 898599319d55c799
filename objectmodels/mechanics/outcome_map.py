"""Outcome maps: class and force of a push at every place of a face.

This is the paper's Fig. 7 for any model: for a grid of contacts on a face, pushed one way, the
force at which the object moves and whether it then slides or topples. Where that is too close to
call it is undecided: the two thresholds lie within a stated band or, if a probability is asked for,
neither class reaches it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any, Literal, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array, support_points
from objectmodels.geometry.pushed_body import PushedBody
from objectmodels.geometry.side_faces import Face

if TYPE_CHECKING:
    from objectmodels.mechanics.outcome_probability import Likelihood
    from objectmodels.mechanics.push_outcomes import Thresholds


BAND = 0.05
"""Relative distance of the two thresholds up to which an outcome counts as undecided."""

MARGIN = 0.005
"""Distance that contacts keep from the border of the face [m]."""

MOST_CONTACTS = 100_000


MOST_DRAWN = 16_000
"""Contacts times support points whose probabilities the exact tier computes for a map: a second or
two. Those of more contacts are interpolated between so many."""

_PLACES = 9  # decimals to which contacts stand in one row [m]
_SUREST = 1e-9  # from which on probabilities are not told apart


class MappedObject(PushedBody, Protocol):
    """An object of which a map can be made: it answers with exact thresholds and probabilities."""

    def thresholds(
        self, points: ArrayLike, directions: ArrayLike, *, exact: bool | Literal["border"]
    ) -> Thresholds:
        """See `ObjectModel.thresholds`."""

    def likelihood(self, points: ArrayLike, directions: ArrayLike, *, exact: bool) -> Likelihood:
        """See `ObjectModel.likelihood`."""

    def model_copy(self, *, update: dict[str, Any]) -> Self:
        """A copy with changed parameters."""


@dataclass(frozen=True)
class OutcomeMap:
    """Outcomes over a face; arrays over n contacts.

    Attributes:
        face: the face.
        lateral: places along its tangent from the middle, shape (n,) [m].
        height: above the table, shape (n,) [m].
        points: the contacts in B, shape (n, 3) [m].
        directions: of the pushes in B, shape (n, 3).
        slide, topple: thresholds, shape (n,) [N].
        band: relative distance of the thresholds up to which an outcome is undecided.
        level: probability that a decided outcome has; None if that was not asked for.
        friction: which coefficient at the table decided.
        model: the model.
    """

    face: Face
    lateral: Array
    height: Array
    points: Array
    directions: Array
    slide: Array
    topple: Array
    band: float
    level: float | None
    friction: str
    model: MappedObject

    @property
    def force(self) -> Array:
        """Force at which the object moves, inf if it never does, shape (n,) [N]."""
        return np.minimum(self.slide, self.topple)

    @cached_property
    def likelihood(self) -> Likelihood:
        """Probabilities of the outcomes at the onset, computed when first asked for.

        They are the exact tier's. Where there are more contacts than are quick, on even pressure,
        they are so in some rows and columns, and interpolated between them; `method` says so. Of
        what does not turn the closed form is exact.
        """
        if not np.isfinite(self.model.friction_radius):
            return self.model.likelihood(self.points, self.directions, exact=False)
        points, _ = support_points(self.model.support, self.model.footprint)
        i = _some_contacts(self.lateral, self.height, MOST_DRAWN / len(points))
        known = self.model.likelihood(self.points[i], self.directions[i], exact=True)
        if len(i) == len(self.points):
            return known
        none, slide, topple = (
            _between_contacts(self.lateral, self.height, i, each)
            for each in (known.none, known.slide, known.topple)
        )
        total = none + slide + topple
        method = f"{known.method}, interpolated between {len(i)} contacts"
        return replace(
            known, none=none / total, slide=slide / total, topple=topple / total, method=method
        )

    @cached_property
    def outcome(self) -> NDArray[np.str_]:
        """`slide`, `topple`, `undecided` or `none` (nothing moves it), shape (n,)."""
        with np.errstate(invalid="ignore"):
            close = np.abs(self.slide - self.topple) <= self.band * self.force
        if self.level is not None:
            sure = np.maximum(self.likelihood.slide, self.likelihood.topple)
            close = sure < self.level
        names = np.where(self.slide < self.topple, "slide", "topple")
        return np.select([np.isinf(self.force), close], ["none", "undecided"], names)

    def _repr_html_(self) -> str:
        return map_svg(self)

    def is_safe(self, outcome: str, probability: float) -> NDArray[np.bool_]:
        """Contacts whose outcome is as asked with a probability or more, in [0, 1], shape (n,).

        Raises:
            ModelError: `bad_value` if the outcome is neither `slide` nor `topple`.
        """
        if outcome not in ("slide", "topple"):
            raise ModelError(
                "bad_value",
                f"outcome must be slide or topple, not {outcome!r}",
                suggestions=("slide", "topple"),
            )
        return np.asarray(getattr(self.likelihood, outcome) >= probability)


def outcome_map(
    model: MappedObject,
    face: Face,
    *,
    direction: ArrayLike | None = None,
    spacing: float = 0.01,
    band: float = BAND,
    level: float | None = None,
    turning: bool = True,
) -> OutcomeMap:
    """The outcomes of pushes all over a face.

    Args:
        model: what is believed about the object.
        face: one of its faces.
        direction: of the pushes in B, shape (3,); along each contact's inward normal if not given.
        spacing: about the distance between contacts [m].
        band: relative distance of the thresholds up to which an outcome is undecided.
        level: if given, undecided is where no class has this probability, instead of the band.
        turning: whether the object may turn as it slides. False is the paper's own model, and what
            two fingers do that hold it straight.

    Raises:
        ModelError: `bad_value` if a number makes no sense or the grid would be too fine;
            `bad_array` if the direction does not go into the face.
    """
    _require_sense(face, spacing, band, level)
    margin = min(MARGIN, face.width / 4.0, face.height / 4.0)
    lateral, height = face.grid(spacing, margin)
    points, normals = face.points_at(lateral, height)
    u = -normals if direction is None else _all_along(direction, normals)
    if not turning:
        # No moment about the vertical turns an object of infinite friction radius.
        model = model.model_copy(update={"friction_radius": np.inf, "friction_radius_sd": 0.0})
    # Maps of more contacts take the exact tier only where the closed form may have the wrong class.
    exact: bool | Literal["border"] = turning and (len(u) <= 5_000 or "border")
    t = model.thresholds(points, u, exact=exact)
    return OutcomeMap(
        face=face,
        lateral=lateral,
        height=height,
        points=points,
        directions=u,
        slide=t.slide,
        topple=t.topple,
        band=band,
        level=level,
        friction=t.friction,
        model=model,
    )


def _some_contacts(lateral: Array, height: Array, most: float) -> NDArray[np.intp]:
    """Indices of about so many contacts, in rows and columns, middle and borders among them."""
    share = math.sqrt(min(1.0, most / max(len(lateral), 1)))
    chosen = np.ones(len(lateral), dtype=bool)
    for along in (lateral.round(_PLACES), height.round(_PLACES)):
        lines = np.unique(along)
        odd = 2 * round(0.5 * (share * len(lines) - 1.0)) + 1
        at = np.linspace(0.0, len(lines) - 1.0, min(max(odd, 3), len(lines))).round()
        chosen &= np.isin(along, lines[at.astype(np.intp)])
    return np.flatnonzero(chosen)


def _between_contacts(
    lateral: Array, height: Array, known: NDArray[np.intp], probability: Array
) -> Array:
    """Probabilities at all contacts, shape (n,), by those of some that stand in rows.

    Their log odds are linear along a row, and between two rows.
    """
    sure = np.clip(probability, _SUREST, 1.0 - _SUREST)
    odds = np.log(sure / (1.0 - sure))
    levels = height[known].round(_PLACES)
    rows = np.unique(levels)
    in_rows = np.array(
        [np.interp(lateral, lateral[known[levels == row]], odds[levels == row]) for row in rows]
    )
    if len(rows) == 1:
        return np.asarray(1.0 / (1.0 + np.exp(-in_rows[0])))
    above = np.clip(np.searchsorted(rows, height), 1, len(rows) - 1)
    share = np.clip((height - rows[above - 1]) / (rows[above] - rows[above - 1]), 0.0, 1.0)
    at = np.arange(len(height))
    found = (1.0 - share) * in_rows[above - 1, at] + share * in_rows[above, at]
    return np.asarray(1.0 / (1.0 + np.exp(-found)))


def _require_sense(face: Face, spacing: float, band: float, level: float | None) -> None:
    if not (spacing > 0.0 and 0.0 <= band < 1.0 and (level is None or 0.5 <= level <= 1.0)):
        raise ModelError(
            "bad_value",
            "expected spacing > 0 m, 0 ≤ band < 1 and a level between 0.5 and 1",
            suggestions=("take a spacing of some millimetres and a band of a few percent",),
        )
    if face.width / spacing * face.height / spacing > MOST_CONTACTS:
        raise ModelError(
            "bad_value",
            f"a spacing of {spacing} m makes more than {MOST_CONTACTS} contacts",
            suggestions=("take a larger spacing",),
        )


def _all_along(direction: ArrayLike, normals: Array) -> Array:
    """One direction for all contacts, as a unit vector that must go into the face there."""
    given = np.asarray(direction, dtype=np.float64)
    if given.shape != (3,) or not np.isfinite(given).all() or not given.any():
        raise ModelError(
            "bad_array",
            f"expected a direction of three numbers, found {given}",
            suggestions=("leave it out: pushes then go straight in",),
        )
    u = np.tile(given / np.linalg.norm(given), (len(normals), 1))
    if (np.sum(u * normals, axis=1) >= 0.0).any():
        raise ModelError(
            "bad_array",
            "the direction does not go into the face",
            suggestions=("leave it out: pushes then go straight in",),
        )
    return u


# An outcome map as a picture for notebooks: the face seen from outside, a square for each
# contact.
#
# Blue slides, orange topples, grey is undecided; the darker, the less force the object needs.

COLOURS = {"slide": "#0072b2", "topple": "#d55e00", "undecided": "#7f7f7f", "none": "#9a9a9a"}
"""Colours of the outcomes, which people with colour blindness tell apart."""

_WIDE = 5.0  # of a square that is alone in its row and column [mm]


def map_svg(chart: OutcomeMap) -> str:
    """The map as a drawing in millimetres; pointing at a square tells its figures."""
    y, z = 1e3 * chart.lateral, 1e3 * chart.height
    side = min(np.diff(np.unique(v.round(3))).min(initial=np.inf) for v in (y, z))
    side = side if np.isfinite(side) else _WIDE
    left, top = y.min() - side, z.max() + side
    most = np.max(chart.force, where=np.isfinite(chart.force), initial=0.0)
    # Where the most force is needed it is the palest.
    opacity = 1.0 - 0.65 * np.minimum(chart.force / max(most, 1e-9), 1.0)
    squares = (
        f'<rect x="{a - left - 0.45 * side:.1f}" y="{top - b - 0.45 * side:.1f}" '
        f'width="{0.9 * side:.1f}" height="{0.9 * side:.1f}" fill="{COLOURS[name]}" '
        f'fill-opacity="{shade:.2f}"><title>{a:z.0f}, {b:.0f} mm: {name}, {f:.2f} N</title></rect>'
        for a, b, name, f, shade in zip(y, z, chart.outcome, chart.force, opacity, strict=True)
    )
    names, counts = np.unique(chart.outcome, return_counts=True)
    key = ", ".join(f"{n} {name}" for name, n in zip(names, counts, strict=True))
    by = "" if chart.level is None else f"; probabilities: {chart.likelihood.method}"
    width, height = np.ptp(y) + 2.0 * side, top
    return "\n".join(
        [
            f"<p>{escape(chart.model.name)}: {key}; with up to {most:.2f} N{by}</p>",
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.1f} {height:.1f}" '
            f'width="{2.0 * width:.0f}" height="{2.0 * height:.0f}" role="img">',
            *squares,
            f'<line x2="{width:.1f}" y1="{height:.1f}" y2="{height:.1f}" stroke="#808080"/>',
            "</svg>",
        ]
    )
