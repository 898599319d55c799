"""One link as a simulator's file describes it, before it is known what model that is.

Frame L is the link's, z up. Files of URDF, SDF and MJCF differ in their words for the same: a mass,
a centre of mass, and shapes that touch.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from objectmodels.errors import ModelError
from objectmodels.geometry.base_shapes import Array

Element = ElementTree.Element


@dataclass(frozen=True, eq=False)
class LinkShape:
    """A shape that touches.

    Attributes:
        kind: of it.
        size: extents (x, y, z) of a box, radius and length of a cylinder, radius of a sphere [m];
            factors along the axes of a mesh.
        R: orientation of its own frame in L, shape (3, 3).
        p: origin of that frame in L, shape (3,) [m].
        friction: coefficient; None if the file has none.
        stiffness: relative to that of the other shapes.
        mesh: file of a mesh.
        vertices: of a mesh that stands in the file itself, shape (k, 3).
    """

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    size: Array
    R: Array = field(default_factory=lambda: np.eye(3))
    p: Array = field(default_factory=lambda: np.zeros(3))
    friction: float | None = None
    stiffness: float = 1.0
    mesh: Path | None = None
    vertices: Array | None = None


@dataclass(frozen=True)
class LinkDescription:
    """A link.

    Attributes:
        name: of the object.
        mass: [kg]; None if the file has none.
        com: centre of mass in L, shape (3,) [m]; None if the file has none.
        shapes: that touch.
    """

    name: str
    mass: float | None
    com: Array | None
    shapes: tuple[LinkShape, ...]


def description_error(message: str, hint: str) -> ModelError:
    """The error of a file that is read, and makes no sense."""
    return ModelError("bad_description", message, suggestions=(hint,))


def unsupported_shape(kind: str) -> ModelError:
    """The error of a shape that stands on no face, or that is not known."""
    return ModelError(
        "unsupported_shape",
        f"a shape is {kind!r}, expected a box, a cylinder or a mesh",
        suggestions=("describe what touches by boxes, cylinders and meshes",),
    )


def only_link(links: list[Element], joints: list[Element]) -> Element:
    """The one link of a file.

    Raises:
        ModelError: `not_one_body`.
    """
    if len(links) == 1 and not joints:
        return links[0]
    raise ModelError(
        "not_one_body",
        f"has {len(links)} bodies and {len(joints)} joints, expected one rigid body",
        suggestions=("keep one body in a file, and describe the object as one rigid piece",),
    )


def attribute_numbers(
    element: Element | None, name: str, count: int, default: ArrayLike | None = None
) -> Array:
    """Numbers in an attribute of an element, shape (count,).

    Args:
        element: that has the attribute.
        name: of the attribute.
        count: of numbers.
        default: if there is no such element or attribute; required if None.

    Raises:
        ModelError: `bad_description`.
    """
    text = None if element is None else element.get(name)
    tag = "" if element is None else f"<{element.tag}> "
    return text_numbers(text, f"{tag}{name}", count, default)


def text_numbers(
    text: str | None, what: str, count: int, default: ArrayLike | None = None
) -> Array:
    """Numbers in a text; see `attribute_numbers`."""
    if text is None and default is not None:
        return np.asarray(default, dtype=np.float64)
    try:
        found = np.array([float(part) for part in (text or "").split()])
    except ValueError:
        found = np.empty(0)
    if len(found) != count or not np.isfinite(found).all():
        shown = "nothing" if text is None else repr(text[:40])
        raise description_error(f"{what}: found {shown}, expected {count} numbers", "complete it")
    return found


def mesh_path(folder: Path, name: str | None) -> Path:
    """The file of a mesh that a description names, beside it or in a folder of its package.

    Raises:
        ModelError: `bad_description` if there is none.
    """
    scheme, _, rest = (name or "").rpartition("://")
    parts = Path(rest).parts[1:] if scheme in ("package", "model") else Path(rest).parts
    for place in (folder, folder.parent):
        path = place.joinpath(*parts)
        if parts and not Path(*parts).is_absolute() and path.is_file():
            return path
    raise description_error(f"the mesh {name!r} is not beside it", "put it into the same folder")


def rotation(angles: Array, *, axes: str = "xyz") -> Array:
    """Orientation by three angles [rad] about fixed axes, or, in capitals, moving ones, (3, 3)."""
    from scipy.spatial.transform import Rotation  # takes a while to import

    return np.asarray(Rotation.from_euler(axes, angles).as_matrix())
