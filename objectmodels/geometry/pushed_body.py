"""The object as the mechanics knows it: figures, base and beliefs, in frame B.

The closed forms and the exact tier take anything that fits `PushedBody`; the models of
`objectmodels.models` do.
"""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.geometry.base_shapes import Array, Base, Support
from objectmodels.geometry.side_faces import Face

Friction = Literal["static", "kinetic"]

UNCERTAIN = ("mass", "friction", "finger_friction", "friction_radius", "com_x", "com_y", "com_z")
"""Names of the uncertain parameters, in the order of `PushedBody.means`."""

BESIDE = 0.5
"""A contact may lie so far beside the shape, as a share of its size: shapes leave out handles."""


class PushedBody(Protocol):
    """A rigid object that stands on a table, with what is not known of it.

    Its values never change, and it can be hashed.
    """

    @property
    def name(self) -> str:
        """Its name, for messages."""

    @property
    def base(self) -> Base:
        """Base that it would topple over."""

    @property
    def footprint(self) -> Base:
        """Base of its shape."""

    @property
    def outline(self) -> Array:
        """Convex polygon that it covers seen from above, shape (k, 2) [m]."""

    @property
    def top(self) -> float:
        """Height of its highest point [m]."""

    @property
    def contact_room(self) -> tuple[Array, Array]:
        """Corners of the box in which contacts may lie; see the function of that name [m]."""

    @property
    def support(self) -> Support:
        """Points on which it stands; see `objectmodels.geometry.base_shapes`."""

    @property
    def mass(self) -> float:
        """M [kg]."""

    @property
    def weight(self) -> float:
        """G = m g [N]."""

    @property
    def gyration(self) -> tuple[float, float, float]:
        """Squared radii of gyration about x, y, z through the centre of mass [m²]."""

    @property
    def com(self) -> tuple[float, float, float]:
        """Centre of mass c [m]."""

    @property
    def friction(self) -> float:
        """μ, static, at the table."""

    @property
    def finger_friction(self) -> float:
        """μ_f, static, at the fingertip."""

    @property
    def friction_radius(self) -> float:
        """c̄ [m]."""

    @property
    def means(self) -> Array:
        """Uncertain parameters in the order of `UNCERTAIN`, shape (7,)."""

    @property
    def deviations(self) -> Array:
        """Standard deviations of these, shape (7,)."""

    @property
    def correlation(self) -> Array:
        """Correlations of these, shape (7, 7)."""

    @property
    def mass_sd(self) -> float:
        """Standard deviation of m [kg]."""

    @property
    def com_sd(self) -> tuple[float, float, float]:
        """Standard deviations of c [m]."""

    @property
    def friction_sd(self) -> float:
        """Standard deviation of μ."""

    @property
    def finger_friction_sd(self) -> float:
        """Standard deviation of μ_f."""

    @property
    def friction_radius_sd(self) -> float:
        """Standard deviation of c̄ [m]."""

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        """Side faces; those of a round side look against each heading (k,) [rad]."""

    def friction_coefficient(self, friction: Friction) -> float:
        """μ at the table, static or kinetic."""


def contact_room(body: PushedBody) -> tuple[Array, Array]:
    """Corners of the box in which contacts may lie, with the least and the largest x, y, z [m]."""
    outline = body.outline
    low, high = np.append(outline.min(axis=0), 0.0), np.append(outline.max(axis=0), body.top)
    near = BESIDE * float((high - low).max())
    return low - near, high + near
