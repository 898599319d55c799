"""The truth of an object that really is as its model says."""

from __future__ import annotations

from objectmodels import BoxModel, CylinderModel, HullModel, ObjectModel, PrismModel
from sim.truth.object_truth import Truth

Colour = tuple[float, float, float]

GREY: Colour = (0.6, 0.6, 0.6)


def truth_as_believed(model: ObjectModel, colour: Colour = GREY) -> Truth:
    """The truth of an object that is exactly as its model says, without contents and lid.

    Of a kind that a plug-in brings it has the hull of its base and, at its top, of its outline.
    """
    return Truth.model_validate(_shape(model) | _figures(model, colour))


def whole_truth(model: ObjectModel) -> Truth:
    """The same with its contents and its lid; a hull has neither."""
    shape = _shape(model)
    parts = {} if "vertices_m" in shape else {"container": model.container, "lid": model.lid}
    return Truth.model_validate(shape | _figures(model, GREY) | parts)


def _shape(model: ObjectModel) -> dict[str, object]:
    match model:
        case BoxModel():
            return {"size_m": model.size, "inside": model.inside}
        case CylinderModel():
            return {
                "radius_m": model.radius,
                "height_m": model.height,
                "base_radius_m": model.base_radius,
            }
        case PrismModel():
            return {"corners_m": model.corners, "height_m": model.height}
        case HullModel():
            return {"vertices_m": model.vertices}
        case _:
            ends = ((model.footprint.corners, 0.0), (model.outline, model.top))
            vertices = [(x, y, z) for corners, z in ends for x, y in corners.tolist()]
            return {"vertices_m": tuple(vertices)}


def _figures(model: ObjectModel, colour: Colour) -> dict[str, object]:
    feet = None if isinstance(model.support, str) else tuple(p[:2] for p in model.support)
    return {
        "support_m": feet,
        "mass_kg": model.mass,
        "friction_table": model.friction,
        "friction_finger": model.finger_friction,
        "centre_of_mass_m": tuple(model.com),
        "colour": colour,
    }
