"""Beliefs about an object that stands on a table, whatever its shape.

Every parameter has a standard deviation; a fit may add correlations. Keys of model files carry
units; they are the aliases of the fields here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    model_validator,
)

from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import Coordinate, Deviation, Length, Mass, Name, length_of
from objectmodels.files.yaml_documents import Friction as Coefficient
from objectmodels.geometry.base_shapes import Array, Support
from objectmodels.geometry.pushed_body import UNCERTAIN, Friction
from objectmodels.geometry.rotations import as_tuple, as_tuples
from objectmodels.lazy import cached_property
from objectmodels.mechanics.push_thresholds import GRAVITY
from objectmodels.models.object_parts import Cavity, Container, Graspable, Lid, Part

RADIUS_SHARE_SD = 0.45
"""Standard deviation of an unfitted friction radius as a share of it: real objects spread so."""

_DERIVED = float("nan")  # a default that depends on the shape; never seen from outside


Vector3 = Annotated[tuple[Coordinate, Coordinate, Coordinate], BeforeValidator(as_tuple)]
Size = Annotated[tuple[Length, Length, Length], BeforeValidator(as_tuple)]
Deviation3 = Annotated[tuple[Deviation, Deviation, Deviation], BeforeValidator(as_tuple)]
Corners = Annotated[
    tuple[tuple[Coordinate, Coordinate], ...], BeforeValidator(as_tuples), length_of("corners")
]
Names = Annotated[tuple[Name, ...], BeforeValidator(as_tuple)]
Correlation = Annotated[
    tuple[str, str, Annotated[float, Field(ge=-1.0, le=1.0)]], BeforeValidator(as_tuple)
]
Correlations = Annotated[tuple[Correlation, ...], BeforeValidator(as_tuple)]


class Provenance(Part):
    """Origin of a model's figures.

    Attributes:
        source: publication, person or program.
        method: how the figures were found, and what was estimated.
        trials: number of measurements behind each figure, if measured.
        date: ISO date of the measurement or entry.
    """

    source: str = "not stated"
    method: str = "not stated"
    trials: Annotated[int, Field(ge=1)] | None = None
    date: Annotated[str, Field(pattern=r"^\d{4}(-\d{2}(-\d{2})?)?$")] | None = None


class Parameters(Part):
    """Beliefs about an object; the *_sd are standard deviations of them.

    Attributes:
        name: what the object is called.
        mass: m [kg].
        friction: static friction coefficient μ between object and table.
        friction_kinetic: the same while it slides, if known.
        finger_friction: static friction coefficient between object and fingertip.
        finger_friction_kinetic: the same while it slips, if known.
        com: centre of mass in B [m]; that of the solid shape if not given.
        support: how the base carries it; see `objectmodels.geometry.base_shapes`.
        friction_radius: c̄ = m_max / f_max [m]; from `support` if not given.
        friction_radius_sd: 45 % of c̄ if not given, which is the spread over real objects.
        correlations: of the beliefs, as (name, name, coefficient); names of `UNCERTAIN`.
        container: what it holds, if it is hollow.
        inside: where other objects may stand, if it is an open box.
        lid: what covers it, if it has a lid.
        grasp: where a hand may hold it, if it may be held.
        synonyms: other names.
        provenance: where the figures come from.
    """

    model_config = ConfigDict(validate_by_alias=False, serialize_by_alias=False)

    version: ClassVar[int] = 1
    """Version of the model file's format."""

    name: Name
    synonyms: Names = ()
    mass: Annotated[Mass, Field(alias="mass_kg")]
    mass_sd: Annotated[Deviation, Field(alias="mass_kg_sd")] = 0.0
    friction: Annotated[Coefficient, Field(alias="friction_table")]
    friction_sd: Annotated[Deviation, Field(alias="friction_table_sd")] = 0.0
    friction_kinetic: Annotated[Coefficient | None, Field(alias="friction_table_kinetic")] = None
    finger_friction: Annotated[Coefficient, Field(alias="friction_finger")] = 0.6
    finger_friction_sd: Annotated[Deviation, Field(alias="friction_finger_sd")] = 0.0
    finger_friction_kinetic: Annotated[
        Coefficient | None, Field(alias="friction_finger_kinetic")
    ] = None
    com: Annotated[Vector3, Field(alias="centre_of_mass_m")] = (_DERIVED,) * 3
    com_sd: Annotated[Deviation3, Field(alias="centre_of_mass_m_sd")] = (0.0, 0.0, 0.0)
    support: Support = "uniform"
    friction_radius: Annotated[Length, Field(alias="friction_radius_m")] = _DERIVED
    friction_radius_sd: Annotated[Deviation, Field(alias="friction_radius_m_sd")] = _DERIVED
    correlations: Correlations = ()
    container: Container | None = None
    inside: Cavity | None = None
    lid: Lid | None = None
    grasp: Graspable | None = None
    provenance: Provenance = Provenance()

    @model_validator(mode="after")
    def _sensible_correlations(self) -> Self:
        unknown = [name for pair in self.correlations for name in pair[:2] if name not in UNCERTAIN]
        pairs = [frozenset(pair[:2]) for pair in self.correlations]
        wrong, hint = None, "leave it out"
        if unknown:
            wrong = f"found {unknown[0]!r}, expected one of: {', '.join(UNCERTAIN)}"
            hint = "leave out pairs of other parameters"
        elif any(len(pair) == 1 for pair in pairs):
            wrong = "found a correlation of a parameter with itself"
        elif len(set(pairs)) < len(pairs):
            wrong = "found a correlation given twice"
        elif pairs and np.linalg.eigvalsh(self.correlation).min() < -1e-9:
            wrong = "found correlations that contradict each other: no distribution has them"
            hint = "leave out the correlations: parameters then are independent"
        if wrong:
            raise ModelError("bad_value", wrong, path="correlations", suggestions=(hint,))
        return self

    def __eq__(self, other: object) -> bool:
        """Equal beliefs of one kind; what was computed from them does not count."""
        return isinstance(other, type(self)) and self._field_values == other._field_values

    def __hash__(self) -> int:
        return hash((type(self), self._field_values))

    @cached_property
    def _field_values(self) -> tuple[object, ...]:
        return tuple(getattr(self, name) for name in type(self).model_fields)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with changed fields, unchecked; nothing computed before is kept."""
        copied = super().model_copy(update=update, deep=deep)
        for name in set(copied.__dict__) - set(type(self).model_fields):
            del copied.__dict__[name]
        return copied

    @property
    def weight(self) -> float:
        """G = m g [N]."""
        return self.mass * GRAVITY

    def friction_coefficient(self, friction: Friction) -> float:
        """The friction coefficient at the table, of one kind or the other.

        Raises:
            ModelError: `unknown_parameter` if it is not known.
        """
        if friction == "static":
            return self.friction
        if self.friction_kinetic is None:
            raise ModelError(
                "unknown_parameter",
                f"the kinetic friction of the {self.name} is not known",
                suggestions=("use the static one",),
            )
        return self.friction_kinetic

    @property
    def means(self) -> Array:
        """The uncertain parameters in the order of `UNCERTAIN`, shape (7,)."""
        return np.array(
            [self.mass, self.friction, self.finger_friction, self.friction_radius, *self.com]
        )

    @property
    def deviations(self) -> Array:
        """Their standard deviations, shape (7,)."""
        coefficients = self.friction_sd, self.finger_friction_sd
        return np.array([self.mass_sd, *coefficients, self.friction_radius_sd, *self.com_sd])

    @property
    def covariance(self) -> Array:
        """Their covariance, shape (7, 7)."""
        sd = self.deviations
        return np.asarray(sd[:, None] * self.correlation * sd)

    @property
    def correlation(self) -> Array:
        """Their correlations, shape (7, 7)."""
        matrix = np.eye(len(UNCERTAIN))
        for a, b, value in self.correlations:
            i, j = UNCERTAIN.index(a), UNCERTAIN.index(b)
            matrix[i, j] = matrix[j, i] = value
        return matrix
