"""What planner and checks count on in a model, as tests of one that somebody else brings.

The object is pushed level all over its sides. A check raises a `ModelError`, whose code says what
is wrong. Bounds are computed here from figures of the model, and not by what it predicts itself.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import numpy as np

from objectmodels.errors import ModelError
from objectmodels.exact.slide_search import CERTAIN
from objectmodels.files.yaml_documents import short_text
from objectmodels.geometry.base_shapes import Array, Polygon
from objectmodels.geometry.side_faces import Face
from objectmodels.models.kinds import BoxModel
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.predictor import own_predictions, require_calibration
from objectmodels.registry.model_registry import kind_of, model_document, model_from_document

SLOWEST = 20.0
"""Time that predictions may take, in that of a box: a plan asks for some thousands of them."""

NEAR = 0.001
"""Distance by which a place on a side may lie outside of the outline [m]."""

_LATERAL, _HEIGHTS = (-0.4, 0.0, 0.4), (0.1, 0.3, 0.5, 0.7, 0.9)  # shares of a face
_BOUNDED = 8  # pushes for which the best sharing of the load is looked for
_ROUNDING = 1e-6  # relative; what is compared was computed in two ways


def model_faults(model: ObjectModel) -> dict[str, ModelError | None]:
    """Faults of a model by the names of the checks; None where it passes."""
    return {name: _fault_of(check, model) for name, check in CHECKS.items()}


def _fault_of(check: Callable[[ObjectModel], None], model: ObjectModel) -> ModelError | None:
    try:
        check(model)
    except ModelError as fault:
        return fault
    except Exception as error:  # kinds of plug-ins may fail in any way
        told = short_text(f"{type(error).__name__}: {error}")
        return ModelError(
            "broken_kind", f"{type(model).__name__} fails: {told}", suggestions=("mend the class",)
        )
    return None


def _require_frames(model: ObjectModel) -> None:
    """Faces are on the object, look outwards, and B's origin is in the base."""
    if not model.footprint.contains(np.zeros((1, 2))):
        raise _wrong_frame("the origin of B is not in its base", "move the shape over [0, 0]")
    faces = model.faces()
    if not faces:
        raise ModelError(
            "unknown_face",
            f"the {model.name} has no side to be pushed",
            suggestions=("`faces` returns one `Face` for each side, `sides` makes upright ones",),
        )
    outline = Polygon.convex(model.outline)
    for k, face in enumerate(faces):
        points, normals = _places(face)
        n, t = normals[0], np.array(face.tangent)
        if not (np.allclose(np.linalg.norm(normals, axis=1), 1.0) and abs(n[2]) < 1.0 - NEAR):
            raise _wrong_frame(f"the normal of face {k} is no unit vector sideways", "scale it")
        if not np.allclose([np.linalg.norm(t), t[2], t @ face.normal], [1.0, 0.0, 0.0]):
            raise _wrong_frame(
                f"the tangent of face {k} is no level unit vector in it", "take ẑ × normal"
            )
        if not outline.contains(points[:, :2], NEAR) or points[:, 2].max() > model.top + NEAR:
            raise _wrong_frame(f"face {k} is not on the object", "give its middle in B [m]")
        if ((points - np.array(model.com)) * normals)[:, :2].sum(axis=1).max() <= 0.0:
            raise _wrong_frame(f"the normal of face {k} looks inwards", "turn it round")


def _require_finite(model: ObjectModel) -> None:
    """Predictions are numbers, one for each push."""
    p, u = _level_pushes(model)
    thresholds, chances = model.thresholds(p, u), model.likelihood(p, u, exact=False)
    predicted = {
        "the sliding force": thresholds.slide,
        "the toppling force": thresholds.topple,
        "the probability of sliding": chances.slide,
        "the probability of toppling": chances.topple,
        "the critical height": model.cone_thresholds(p, -u).critical_height,
    }
    for name, values in predicted.items():
        if np.shape(values) != (len(p),) or np.isnan(values).any() or np.min(values) < 0.0:
            raise _fault(
                "not_finite",
                f"{name} of {len(p)} pushes has shape {np.shape(values)}, or is no number",
                "return one number for each push, inf for what never happens",
            )


def _require_bounds(model: ObjectModel) -> None:
    """Predictions keep the laws that hold for every rigid object on a table."""
    p, u = _level_pushes(model)
    thresholds, chances = model.thresholds(p, u), model.likelihood(p, u, exact=False)
    most = model.friction * model.weight * (1.0 + _ROUNDING)
    if (thresholds.slide > most).any():
        raise _out_of_bounds("a level push slides it only beyond μ m g", "check mass and friction")
    phi = np.radians(np.arange(360.0))
    around = np.column_stack((np.cos(phi), np.sin(phi)))
    edges = model.base.extent(around) - around @ np.array(model.com[:2])
    lever = thresholds.topple * p[:, 2] / model.weight
    # Between degrees an edge is nearer by 4e-5 of its distance at most.
    if (lever < edges.min() * (1.0 - 1e-3)).any() or (lever > edges.max() * (1.0 + 1e-3)).any():
        raise _out_of_bounds("it topples at a force that lifts no edge of its base", "check `base`")
    shares = np.array([chances.none, chances.slide, chances.topple])
    if (shares < -_ROUNDING).any() or (np.abs(shares.sum(axis=0) - 1.0) > _ROUNDING).any():
        raise _out_of_bounds("its probabilities do not add up to one", "return shares of one")
    some = slice(None, None, max(1, len(p) // _BOUNDED))
    exact = model.thresholds(p[some], u[some], exact=True)
    if exact.fitted:
        return
    low, high = exact.pessimistic * (1.0 - _ROUNDING), exact.optimistic * (1.0 + _ROUNDING)
    if ((exact.onset < low) | (exact.onset > high)).any():
        raise _out_of_bounds("no sharing of the load moves it at that force", "check `support`")


def _require_balance(model: ObjectModel) -> None:
    """Answers of the exact tier balance the push."""
    try:
        residual = model.thresholds(*_level_pushes(model), exact=True).residual
    except ModelError as error:
        raise _fault("not_balanced", error.message, *error.suggestions) from error
    if not (residual <= CERTAIN).all():
        raise _fault(
            "not_balanced",
            f"the exact tier is off balance by {np.max(residual):.1e}, {CERTAIN:.0e} is certain",
            "check `support`, `footprint` and `friction_radius`",
        )


def _require_calibration(model: ObjectModel) -> None:
    """Predictions of its own hold for pushes that were seen."""
    if own_predictions(type(model), ObjectModel):
        require_calibration(model, model.seen_pushes, model.name)


def _require_speed(model: ObjectModel) -> None:
    """Predictions take about the time of a box's."""
    size = model.extents
    box = BoxModel(name="box", size=size, mass=model.mass, friction=model.friction)
    ratio = _prediction_time(model) / _prediction_time(box)
    if ratio > SLOWEST:
        raise _fault(
            "too_slow",
            f"predictions take {ratio:.0f} times the time of a box's, expected {SLOWEST:.0f}",
            "take arrays in place of loops, and keep what does not change (`cached_property`)",
        )


def _require_pickling(model: ObjectModel) -> None:
    """Workers in other processes get the same model."""
    try:
        copy = pickle.loads(pickle.dumps(model))
    except Exception as error:  # a class may fail in any way
        raise _fault(
            "not_picklable",
            f"{type(model).__name__} cannot be pickled: {short_text(str(error))}",
            "define the class in a module, and keep no open files or functions in it",
        ) from error
    _require_same(model, copy, "not_picklable")


def _require_file(model: ObjectModel) -> None:
    """Its file gives the same model again."""
    document = model_document(model)
    copy = model_from_document(document, "its file", {kind_of(model): type(model)})
    _require_same(model, copy, "not_saved")


CHECKS: Mapping[str, Callable[[ObjectModel], None]] = {
    "frames": _require_frames,
    "finite": _require_finite,
    "bounds": _require_bounds,
    "residual": _require_balance,
    "calibrated": _require_calibration,
    "speed": _require_speed,
    "pickles": _require_pickling,
    "file": _require_file,
}
"""Checks by their names, in the order in which they are told."""


def _places(face: Face) -> tuple[Array, Array]:
    """Points of a face p_BC (k, 3) [m] and its outward normals there (k, 3)."""
    y, z = (grid.ravel() for grid in np.meshgrid(_LATERAL, _HEIGHTS))
    y, z = y * face.width, face.bottom + z * face.height
    inside = face.contains(y, z)
    return face.points_at(y[inside], z[inside])


def _level_pushes(model: ObjectModel) -> tuple[Array, Array]:
    """Contact points (n, 3) [m] all over its sides, and level unit directions into it (n, 3)."""
    places = [_places(face) for face in model.faces()]
    points, normals = (np.concatenate(parts) for parts in zip(*places, strict=True))
    level = -normals * [1.0, 1.0, 0.0]
    return points, level / np.linalg.norm(level, axis=1, keepdims=True)


def _prediction_time(model: ObjectModel) -> float:
    """Time of predictions at so many places, the best of five [s]."""

    def once() -> float:
        begun = perf_counter()  # a processor's own clock may be too coarse for it
        p, u = (np.resize(v, (600, 3)) for v in _level_pushes(model))
        model.thresholds(p, u)
        return perf_counter() - begun

    return min(once() for _ in range(5))


def _require_same(model: ObjectModel, copy: Any, code: str) -> None:
    p, u = _level_pushes(model)
    if copy == model and np.array_equal(copy.thresholds(p, u).onset, model.thresholds(p, u).onset):
        return
    raise _fault(code, "a copy predicts otherwise", "keep in fields all that predictions depend on")


def _wrong_frame(message: str, hint: str) -> ModelError:
    return _fault("wrong_frame", message, hint)


def _out_of_bounds(message: str, hint: str) -> ModelError:
    return _fault("out_of_bounds", message, hint)


def _fault(code: str, message: str, *hints: str) -> ModelError:
    return ModelError(code, message, suggestions=hints)
