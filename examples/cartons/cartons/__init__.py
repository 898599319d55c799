"""Cartons of liquid, whose centre of mass follows from how full they are."""

from pathlib import Path
from typing import Annotated, Literal

from numpy.typing import ArrayLike
from pydantic import Field

from objectmodels import Face, ObjectModel, Polygon, sides
from objectmodels.models.parameters import Size


class CartonModel(ObjectModel):
    """A carton of a shell and a liquid."""

    size: Annotated[Size, Field(alias="size_m")]
    shell: Annotated[float, Field(gt=0.0, alias="shell_kg")]
    fill: Annotated[float, Field(ge=0.0, le=1.0)]
    kind: Literal["carton"] = "carton"

    @property
    def footprint(self) -> Polygon:
        return Polygon.rectangle(*self.size[:2])

    @property
    def top(self) -> float:
        return self.size[2]

    @property
    def centre(self) -> tuple[float, float, float]:
        liquid = (self.mass - self.shell) * self.fill
        return (0.0, 0.0, (self.shell + liquid) * self.top / 2.0 / self.mass)

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        return sides(self.footprint, self.top)


MODELS = Path(__file__).parent / "models"
