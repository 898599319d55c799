"""Tests of plug-ins: good models pass all of them, and each fault is found by its own."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import ArrayLike

from objectmodels import BoxModel, ObjectModel, Polygon, Registry, sides
from objectmodels.geometry.side_faces import Face
from objectmodels.registry.model_checks import CHECKS, model_faults

GIVEN: dict[str, Any] = {"name": "crate", "size": (0.1, 0.08, 0.2), "mass": 1.0, "friction": 0.4}


@pytest.mark.parametrize("model", Registry.built_in(), ids=lambda model: model.name)
def test_the_models_that_are_built_in_pass(model: ObjectModel) -> None:
    assert model_faults(model) == dict.fromkeys(CHECKS)


class Displaced(BoxModel):
    """A box whose faces were measured from a corner."""

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        return sides(Polygon(self.footprint.vertices + 0.1), self.top)


class Inverted(BoxModel):
    """A box whose normals look inwards."""

    def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
        x, y, z = self.size
        return (Face.upright([1.0, 0.0], [-x / 2.0, 0.0], y, z),)


class Unknown(BoxModel):
    """A box of which one prediction is no number."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        found = super().thresholds(points, directions, **options)
        found.slide[-1] = np.nan
        return found


class Weightless(BoxModel):
    """A box that slides at twice the force of its friction, or is believed to."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        found = super().thresholds(points, directions, **options)
        found.slide[:] *= 2.0
        return found


class Untilted(BoxModel):
    """A box that topples as if its base were twice as wide."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        found = super().thresholds(points, directions, **options)
        found.topple[:] *= 2.0
        return found


class Unbalanced(BoxModel):
    """A box whose exact tier is none."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        found = super().thresholds(points, directions, **options)
        if options.get("exact"):
            found.residual[:] = 1e-3
        return found


class Slow(BoxModel):
    """A box that computes each answer a hundred times, however busy the machine is."""

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        for _ in range(100):
            found = super().thresholds(points, directions, **options)
        return found


class Forgetful(BoxModel):
    """A box with a coefficient that no field has."""

    @cached_property
    def wear(self) -> float:
        return 1.0

    def thresholds(self, points: Any, directions: Any, **options: Any) -> Any:
        found = super().thresholds(points, directions, **options)
        found.slide[:] *= self.wear
        return found

    def __reduce__(self) -> Any:
        return (Forgetful, (), None)


class Unsaved(BoxModel):
    """A box with a field that its file leaves out."""

    kind: Literal["box"] = "box"

    def model_dump(self, **options: Any) -> Any:
        document = super().model_dump(**options)
        document.pop("friction_table", None)
        return document | {"friction_table": 0.2}


@pytest.mark.parametrize(
    ("cls", "check", "code"),
    [
        (Displaced, "frames", "wrong_frame"),
        (Inverted, "frames", "wrong_frame"),
        (Unknown, "finite", "not_finite"),
        (Weightless, "bounds", "out_of_bounds"),
        (Untilted, "bounds", "out_of_bounds"),
        (Unbalanced, "residual", "not_balanced"),
        (Weightless, "calibrated", "not_calibrated"),
        (Slow, "speed", "too_slow"),
        (Forgetful, "pickles", "not_picklable"),
        (Unsaved, "file", "not_saved"),
    ],
)
def test_a_fault_is_found_by_the_check_for_it(cls: type[BoxModel], check: str, code: str) -> None:
    fault = model_faults(cls(**GIVEN))[check]
    assert fault is not None
    assert (fault.code, bool(fault.suggestions)) == (code, True)


def test_a_class_that_raises_is_told_and_not_raised() -> None:
    class Raising(BoxModel):
        @property
        def outline(self) -> Any:
            raise ZeroDivisionError

    faults = model_faults(Raising(**GIVEN))
    assert {fault.code for fault in faults.values() if fault} == {"broken_kind", "not_picklable"}


def test_an_object_without_sides_is_told() -> None:
    class Needle(BoxModel):
        def faces(self, headings: ArrayLike | None = None) -> tuple[Face, ...]:
            return ()

    fault = model_faults(Needle(**GIVEN))["frames"]
    assert fault is not None
    assert fault.code == "unknown_face"
