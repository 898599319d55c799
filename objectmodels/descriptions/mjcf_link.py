"""The one body of an MJCF file. Frame L is the body's, wherever it stands in the world."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from objectmodels.descriptions.link_description import (
    Element,
    LinkDescription,
    LinkShape,
    attribute_numbers,
    description_error,
    mesh_path,
    only_link,
    rotation,
    text_numbers,
    unsupported_shape,
)
from objectmodels.geometry.base_shapes import Array

_TURNED = ("axisangle", "xyaxes", "zaxis", "fromto")  # ways to orient a geom that are not read


def mjcf_link(root: Element, folder: Path) -> LinkDescription:
    """The body of a `<mujoco>`; its shapes are the geoms that touch.

    Raises:
        ModelError: `not_one_body`, `bad_description`, `unsupported_shape`.
    """
    joints = [j for j in root.findall(".//body/joint") if j.get("type") != "free"]
    body = only_link(root.findall("worldbody//body"), joints)
    inertial = body.find("inertial")
    geoms = [_with_defaults(geom, root, body) for geom in body.findall("geom")]
    touching = [g for g in geoms if (g.get("contype"), g.get("conaffinity")) != ("0", "0")]
    masses = [geom.get("mass") for geom in geoms]
    mass = None if inertial is None else inertial.get("mass", "")
    if inertial is None and masses and None not in masses:
        mass = str(sum(text_numbers(m, "<geom> mass", 1)[0] for m in masses))
    return LinkDescription(
        name=root.get("model") or body.get("name") or "",
        mass=None if mass is None else float(text_numbers(mass, "mass", 1)[0]),
        com=None if inertial is None else attribute_numbers(inertial, "pos", 3, np.zeros(3)),
        shapes=tuple(_shape(geom, root, folder) for geom in touching or geoms),
    )


def _with_defaults(geom: Element, root: Element, body: Element) -> Element:
    """The geom with the attributes of its class that it does not state itself."""
    classes: dict[str, dict[str, str]] = {}

    def collect(default: Element, inherited: dict[str, str]) -> None:
        own = default.find("geom")
        known = inherited | ({} if own is None else own.attrib)
        classes[default.get("class", "main")] = known
        for child in default.findall("default"):
            collect(child, known)

    for default in root.findall("default"):
        collect(default, {})
    name = geom.get("class") or body.get("childclass") or "main"
    return Element("geom", {**classes.get(name, {}), **geom.attrib})


def _shape(geom: Element, root: Element, folder: Path) -> LinkShape:
    for way in _TURNED:
        if way in geom.attrib:
            raise description_error(f"a geom has {way!r}", "give it `pos` and `quat` or `euler`")
    mu = geom.get("friction")
    soft = _first_number(geom.get("solref", "-1"), "solref")  # negative if it is a stiffness
    return replace(
        _solid(geom, root, folder),
        R=_orientation(geom, root),
        p=attribute_numbers(geom, "pos", 3, np.zeros(3)),
        friction=None if mu is None else _first_number(mu, "friction"),
        stiffness=max(-soft, 0.0) or 1.0,
    )


def _first_number(text: str, what: str) -> float:
    return float(text_numbers(" ".join(text.split()[:1]), what, 1)[0])


def _orientation(geom: Element, root: Element) -> Array:
    from scipy.spatial.transform import Rotation  # takes a while to import

    if "quat" in geom.attrib:
        w, *xyz = attribute_numbers(geom, "quat", 4)
        return np.asarray(Rotation.from_quat([*xyz, w]).as_matrix())
    angles = attribute_numbers(geom, "euler", 3, np.zeros(3))
    compiler = root.find("compiler")
    settings = {} if compiler is None else compiler.attrib
    if settings.get("angle", "degree") == "degree":
        angles = np.radians(angles)
    # Small letters are moving axes here, and fixed ones in scipy.
    return rotation(angles, axes=settings.get("eulerseq", "xyz").swapcase())


def _solid(geom: Element, root: Element, folder: Path) -> LinkShape:
    match geom.get("type", "mesh" if "mesh" in geom.attrib else "sphere"):
        case "box":
            return LinkShape("box", 2.0 * attribute_numbers(geom, "size", 3))
        case "cylinder":
            return LinkShape("cylinder", attribute_numbers(geom, "size", 2) * [1.0, 2.0])
        case "sphere":
            return LinkShape("sphere", np.array([_first_number(geom.get("size", ""), "size")]))
        case "mesh":
            return _mesh(geom.get("mesh"), root, folder)
        case other:
            raise unsupported_shape(other)


def _mesh(name: str | None, root: Element, folder: Path) -> LinkShape:
    for asset in root.findall("asset/mesh"):
        file, vertices = asset.get("file"), asset.get("vertex")
        if name != asset.get("name", Path(file or "").stem):
            continue
        scale = attribute_numbers(asset, "scale", 3, np.ones(3))
        if vertices is not None:
            points = text_numbers(vertices, "vertex", 3 * (len(vertices.split()) // 3))
            return LinkShape("mesh", scale, vertices=points.reshape(-1, 3))
        compiler = root.find("compiler")
        inside = "" if compiler is None else compiler.get("meshdir", "")
        return LinkShape("mesh", scale, mesh=mesh_path(folder, str(Path(inside) / (file or ""))))
    raise description_error(f"there is no mesh {name!r} among its assets", "add it to <asset>")
