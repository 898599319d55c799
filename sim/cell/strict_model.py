"""Parts of a scene file: strict, frozen models and ranges of numbers."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import core_schema

from objectmodels.files.yaml_documents import Angle, Coordinate

Fraction = Annotated[float, Field(ge=0, le=1)]
Spread = Annotated[float, Field(ge=0, le=0.45)]
"""A relative standard deviation; at two of the largest, a tenth of the value is left."""

Point2 = tuple[Coordinate, Coordinate]
Point3 = tuple[Coordinate, Coordinate, Coordinate]
Angles3 = tuple[Angle, Angle, Angle]


class AsItIs:
    """Mark of a field that takes instances of its class, and looks no further into them.

    pydantic's `InstanceOf` builds a schema of all that such a class holds, which takes a while.
    """

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.is_instance_schema(source)


class Part(BaseModel):
    """A part of a scene file: nothing unknown, nothing converted, nothing changed later."""

    model_config = ConfigDict(
        defer_build=True, frozen=True, extra="forbid", strict=True, allow_inf_nan=False
    )
