"""Model files: a YAML file with units in its keys, read into a `BoxModel`.

The file's schema is strict and versioned (`format: box/1`); what is not stated takes the default of
`BoxModel`. See `objectmodels/models/` for examples.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from objectmodels.box import BoxModel, Deviation3, Provenance, Size, Vector3, Word, Words
from objectmodels.errors import ModelError
from objectmodels.suggest import suggest
from objectmodels.support import Support
from objectmodels.yamlfile import read_yaml

FORMAT = "box/1"

Positive = Annotated[float, Field(gt=0.0)]
Deviation = Annotated[float, Field(ge=0.0)]


class BoxFile(BaseModel):
    """Schema of a box's model file; keys carry their units, attributes are those of `BoxModel`."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    format: Literal["box/1"]
    name: Word
    size: Size = Field(alias="size_m")
    mass: Positive = Field(alias="mass_kg")
    mass_sd: Deviation | None = Field(None, alias="mass_kg_sd")
    friction: Positive = Field(alias="friction_table")
    friction_sd: Deviation | None = Field(None, alias="friction_table_sd")
    friction_kinetic: Positive | None = Field(None, alias="friction_table_kinetic")
    finger_friction: Positive | None = Field(None, alias="friction_finger")
    finger_friction_sd: Deviation | None = Field(None, alias="friction_finger_sd")
    finger_friction_kinetic: Positive | None = Field(None, alias="friction_finger_kinetic")
    com: Vector3 | None = Field(None, alias="centre_of_mass_m")
    com_sd: Deviation3 | None = Field(None, alias="centre_of_mass_m_sd")
    support: Support | None = None
    friction_radius: Positive | None = Field(None, alias="friction_radius_m")
    friction_radius_sd: Deviation | None = Field(None, alias="friction_radius_m_sd")
    synonyms: Words | None = None
    provenance: Provenance

    def model(self) -> BoxModel:
        """The box that the file describes."""
        stated = {key: value for key, value in self if value is not None and key != "format"}
        return BoxModel(**stated)


def load_model(path: Path) -> BoxModel:
    """Reads a model file.

    Args:
        path: the YAML file.

    Raises:
        ModelError: `unreadable_file`, `bad_yaml`, `unknown_format`, `missing_key`, `unknown_key` or
            `bad_value`; names the file, the key, the value found and what was expected.
    """
    content = read_yaml(path)
    if content.get("format") != FORMAT:
        found = f"format {content['format']!r}" if "format" in content else "no `format`"
        raise ModelError(
            "unknown_format",
            f"{found}, expected {FORMAT!r}",
            path=str(path),
            suggestions=(f"begin the file with `format: {FORMAT}`",),
        )
    try:
        return BoxFile.model_validate(content).model()
    except ValidationError as error:
        raise _explained(error, path) from error


def _explained(error: ValidationError, path: Path) -> ModelError:
    """The first complaint of pydantic in the words of a model file's author."""
    first = error.errors(include_url=False)[0]
    key = ".".join(str(part) for part in first["loc"]) or "file"
    where = f"{path}: {key}"
    found: Any = first["input"]
    if first["type"] == "missing":
        return ModelError("missing_key", "is required, but not given", path=where)
    if first["type"] == "extra_forbidden":
        known = Provenance.model_fields if "." in key else _keys()
        hints = tuple(f"did you mean '{name}'?" for name in suggest(key.split(".")[-1], known))
        return ModelError(
            "unknown_key", "is not a key of this format", path=where, suggestions=hints
        )
    if not first["loc"] or isinstance(found, dict):
        return ModelError("bad_value", first["msg"], path=where)
    expected = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    return ModelError("bad_value", f"found {found!r}, expected {expected}", path=where)


def _keys() -> list[str]:
    return [field.alias or name for name, field in BoxFile.model_fields.items()]
