"""Files that describe a model to another simulator."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from objectmodels.descriptions.hull_mesh import obj_text
from objectmodels.descriptions.mjcf_description import mjcf_text
from objectmodels.descriptions.rigid_body import rigid_body
from objectmodels.descriptions.sdf_description import sdf_text
from objectmodels.descriptions.urdf_description import urdf_text
from objectmodels.files.file_writing import replace_file

if TYPE_CHECKING:
    from objectmodels.models.object_model import ObjectModel

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
    for solid in body.solids:
        if solid.shape == "hull":
            texts[mesh] = obj_text(solid.vertices)
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
