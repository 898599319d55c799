"""The one link of a URDF file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from objectmodels.descriptions.link_description import (
    Element,
    LinkDescription,
    LinkShape,
    attribute_numbers,
    mesh_path,
    only_link,
    rotation,
    text_numbers,
    unsupported_shape,
)
from objectmodels.geometry.base_shapes import Array


def urdf_link(root: Element, folder: Path) -> LinkDescription:
    """The link of a `<robot>`; its shapes are those of `<collision>`, else of `<visual>`.

    Raises:
        ModelError: `not_one_body`, `bad_description`, `unsupported_shape`.
    """
    link = only_link(root.findall("link"), root.findall("joint"))
    inertial = link.find("inertial")
    mass = None if inertial is None else link.find("inertial/mass")
    told = root.findtext("gazebo/mu1")
    usual = None if told is None else float(text_numbers(told, "<mu1>", 1)[0])
    return LinkDescription(
        name=root.get("name") or link.get("name") or "",
        mass=None if mass is None else float(attribute_numbers(mass, "value", 1)[0]),
        com=None if inertial is None else _origin(inertial)[1],
        shapes=tuple(
            _shape(part, folder, usual)
            for part in link.findall("collision") or link.findall("visual")
        ),
    )


def _origin(element: Element) -> tuple[Array, Array]:
    origin = element.find("origin")
    turned = attribute_numbers(origin, "rpy", 3, np.zeros(3))
    return rotation(turned), attribute_numbers(origin, "xyz", 3, np.zeros(3))


def _shape(part: Element, folder: Path, usual: float | None) -> LinkShape:
    R, p = _origin(part)
    contact = part.find("{*}proximity_properties")
    mu = None if contact is None else contact.find("{*}mu_static")
    soft = None if contact is None else contact.find("{*}point_contact_stiffness")
    return replace(
        _solid(part.find("geometry/*"), folder),
        R=R,
        p=p,
        friction=usual if mu is None else float(attribute_numbers(mu, "value", 1)[0]),
        stiffness=float(attribute_numbers(soft, "value", 1, [1.0])[0]),
    )


def _solid(geometry: Element | None, folder: Path) -> LinkShape:
    match None if geometry is None else geometry.tag:
        case "box":
            return LinkShape("box", attribute_numbers(geometry, "size", 3))
        case "cylinder":
            size = [attribute_numbers(geometry, name, 1)[0] for name in ("radius", "length")]
            return LinkShape("cylinder", np.array(size))
        case "sphere":
            return LinkShape("sphere", attribute_numbers(geometry, "radius", 1))
        case "mesh" if geometry is not None:
            scale = attribute_numbers(geometry, "scale", 3, np.ones(3))
            return LinkShape("mesh", scale, mesh=mesh_path(folder, geometry.get("filename")))
        case other:
            raise unsupported_shape(str(other))
