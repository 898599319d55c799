"""The one link of an SDF file. Frame L is that of the model, in which its link has a pose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from objectmodels.descriptions.link_description import (
    Element,
    LinkDescription,
    LinkShape,
    description_error,
    mesh_path,
    only_link,
    rotation,
    text_numbers,
    unsupported_shape,
)
from objectmodels.geometry.base_shapes import Array

Pose = tuple[Array, Array]


def sdf_link(root: Element, folder: Path) -> LinkDescription:
    """The link of the one `<model>`; its shapes are those of `<collision>`, else of `<visual>`.

    Raises:
        ModelError: `not_one_body`, `bad_description`, `unsupported_shape`.
    """
    models = root.findall(".//model")
    link = only_link(
        [link for model in models for link in model.findall("link")], root.findall(".//joint")
    )
    R, p = _pose(link)
    inertial = link.find("inertial")
    mass = link.findtext("inertial/mass")
    return LinkDescription(
        name=models[0].get("name") or link.get("name") or "",
        mass=None if mass is None else float(text_numbers(mass, "<mass>", 1)[0]),
        com=None if inertial is None else p + R @ _pose(inertial)[1],
        shapes=tuple(
            _shape(part, folder, (R, p))
            for part in link.findall("collision") or link.findall("visual")
        ),
    )


def _pose(element: Element) -> Pose:
    """Orientation and place that an element states, in those of what it stands in."""
    pose = element.find("pose")
    if pose is not None and any(value not in ("false", "") for value in pose.attrib.values()):
        raise description_error("a <pose> is relative to something", "state it in its own frame")
    numbers = text_numbers(None if pose is None else pose.text, "<pose>", 6, np.zeros(6))
    return rotation(numbers[3:]), numbers[:3]


def _shape(part: Element, folder: Path, link: Pose) -> LinkShape:
    R, p = _pose(part)
    mu = part.findtext("surface/friction/ode/mu")
    soft = part.findtext(".//{*}point_contact_stiffness")
    return replace(
        _solid(part.find("geometry/*"), folder),
        R=link[0] @ R,
        p=link[1] + link[0] @ p,
        friction=None if mu is None else float(text_numbers(mu, "<mu>", 1)[0]),
        stiffness=float(text_numbers(soft, "point_contact_stiffness", 1, [1.0])[0]),
    )


def _solid(geometry: Element | None, folder: Path) -> LinkShape:
    match None if geometry is None else geometry.tag:
        case "box" if geometry is not None:
            return LinkShape("box", text_numbers(geometry.findtext("size"), "<size>", 3))
        case "cylinder" if geometry is not None:
            radius = text_numbers(geometry.findtext("radius"), "<radius>", 1)
            length = text_numbers(geometry.findtext("length"), "<length>", 1)
            return LinkShape("cylinder", np.concatenate((radius, length)))
        case "sphere" if geometry is not None:
            return LinkShape("sphere", text_numbers(geometry.findtext("radius"), "<radius>", 1))
        case "mesh" if geometry is not None:
            scale = text_numbers(geometry.findtext("scale"), "<scale>", 3, np.ones(3))
            return LinkShape("mesh", scale, mesh=mesh_path(folder, geometry.findtext("uri")))
        case other:
            raise unsupported_shape(str(other))
