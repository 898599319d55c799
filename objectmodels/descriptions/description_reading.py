"""Files of URDF, SDF and MJCF that describe one object, told by their contents."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn
from xml.etree import ElementTree

from objectmodels.descriptions.link_description import LinkDescription, description_error
from objectmodels.descriptions.mjcf_link import mjcf_link
from objectmodels.descriptions.sdf_link import sdf_link
from objectmodels.descriptions.urdf_link import urdf_link
from objectmodels.errors import ModelError
from objectmodels.files.file_reading import read_text

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
