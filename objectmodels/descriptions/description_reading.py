"""Files of URDF, SDF and MJCF that describe one object, told by their contents."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn
from xml.etree import ElementTree

import numpy as np

from objectmodels.descriptions.description_writing import mesh_texts, mjcf_text, sdf_text, urdf_text
from objectmodels.descriptions.rigid_body import (
    Element,
    LinkDescription,
    LinkShape,
    attribute_numbers,
    description_error,
    mesh_path,
    only_link,
    rigid_body,
    rotation,
    text_numbers,
    unsupported_shape,
)
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import read_text, replace_file
from objectmodels.geometry.base_shapes import Array

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel


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
        shapes=tuple(_mjcf_shape(geom, root, folder) for geom in touching or geoms),
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


def _mjcf_shape(geom: Element, root: Element, folder: Path) -> LinkShape:
    for way in _TURNED:
        if way in geom.attrib:
            raise description_error(f"a geom has {way!r}", "give it `pos` and `quat` or `euler`")
    mu = geom.get("friction")
    soft = _first_number(geom.get("solref", "-1"), "solref")  # negative if it is a stiffness
    return replace(
        _mjcf_solid(geom, root, folder),
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


def _mjcf_solid(geom: Element, root: Element, folder: Path) -> LinkShape:
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
            _sdf_shape(part, folder, (R, p))
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


def _sdf_shape(part: Element, folder: Path, link: Pose) -> LinkShape:
    R, p = _pose(part)
    mu = part.findtext("surface/friction/ode/mu")
    soft = part.findtext(".//{*}point_contact_stiffness")
    return replace(
        _sdf_solid(part.find("geometry/*"), folder),
        R=link[0] @ R,
        p=link[1] + link[0] @ p,
        friction=None if mu is None else float(text_numbers(mu, "<mu>", 1)[0]),
        stiffness=float(text_numbers(soft, "point_contact_stiffness", 1, [1.0])[0]),
    )


def _sdf_solid(geometry: Element | None, folder: Path) -> LinkShape:
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
            _urdf_shape(part, folder, usual)
            for part in link.findall("collision") or link.findall("visual")
        ),
    )


def _origin(element: Element) -> tuple[Array, Array]:
    origin = element.find("origin")
    turned = attribute_numbers(origin, "rpy", 3, np.zeros(3))
    return rotation(turned), attribute_numbers(origin, "xyz", 3, np.zeros(3))


def _urdf_shape(part: Element, folder: Path, usual: float | None) -> LinkShape:
    R, p = _origin(part)
    contact = part.find("{*}proximity_properties")
    mu = None if contact is None else contact.find("{*}mu_static")
    soft = None if contact is None else contact.find("{*}point_contact_stiffness")
    return replace(
        _urdf_solid(part.find("geometry/*"), folder),
        R=R,
        p=p,
        friction=usual if mu is None else float(attribute_numbers(mu, "value", 1)[0]),
        stiffness=float(attribute_numbers(soft, "value", 1, [1.0])[0]),
    )


def _urdf_solid(geometry: Element | None, folder: Path) -> LinkShape:
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


READERS = {"robot": urdf_link, "sdf": sdf_link, "mujoco": mjcf_link}
"""Readers by the name of the outermost element."""

FILE_ENDINGS = (".urdf", ".sdf", ".xml", ".mjcf")
"""Endings of names by which a description is told from a model file."""


class _Builder(ElementTree.TreeBuilder):
    """Builds elements; entities, which may stand for any amount of text, are refused."""

    def doctype(self, name: str, pubid: str | None, system: str | None) -> NoReturn:
        raise description_error("declares a document type", "remove <!DOCTYPE …>")


def read_link(path: Path) -> LinkDescription:
    """The link that a file describes.

    Raises:
        ModelError: `unreadable_file`; `bad_description` if it is none of these, or something is
            missing; `not_one_body`; `unsupported_shape`.
    """
    text = read_text(path, "description_file")
    try:
        root = ElementTree.fromstring(text, ElementTree.XMLParser(target=_Builder()))
        if root.tag not in READERS:
            raise description_error(
                f"begins with <{root.tag}>, expected one of: {', '.join(READERS)}",
                "give a file of URDF, SDF or MJCF",
            )
        link = READERS[root.tag](root, path.parent)
        if not link.shapes:
            raise description_error("nothing in it touches", "give its body a collision geometry")
    except ElementTree.ParseError as error:
        raise ModelError(
            "bad_description",
            f"is no XML: {error}",
            path=str(path),
            suggestions=("export it once more", "a prefix like drake: needs its xmlns:drake"),
        ) from error
    except ValueError as error:
        if not isinstance(error, ModelError):  # of a rotation that is none
            error = description_error(f"holds no rotation: {error}", "correct its quat or euler")
        raise ModelError(
            error.code, error.message, path=str(path), suggestions=error.suggestions
        ) from error
    return link


Format = Literal["mjcf", "sdf", "urdf"]

ENDINGS: dict[Format, str] = {"mjcf": ".xml", "sdf": ".sdf", "urdf": ".urdf"}
"""Endings of the files' names."""


def description_texts(model: ObjectModel, form: Format) -> dict[str, str]:
    """Texts that describe a model, by the names of their files; the first one is to be opened.

    A second one is the mesh of a solid that is neither box nor cylinder.

    Args:
        model: to be described.
        form: `mjcf`, `sdf` or `urdf`.
    """
    body = rigid_body(model)
    name, mesh = body.name + ENDINGS[form], body.name + ".obj"
    if form == "mjcf":
        return {name: mjcf_text(body)}
    texts = {name: {"sdf": sdf_text, "urdf": urdf_text}[form](body, mesh)}
    for text in mesh_texts(body):
        texts[mesh] = text
    return texts


def write_description(model: ObjectModel, form: Format, folder: Path) -> list[Path]:
    """Writes the files of `description_texts` into a folder, and returns their paths.

    Raises:
        ModelError: `cannot_write`.
    """
    paths = []
    for name, text in description_texts(model, form).items():
        with replace_file(folder / name) as temporary:
            temporary.write_text(text, "utf-8")
        paths.append(folder / name)
    return paths
