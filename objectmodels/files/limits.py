"""Limits of what comes from outside: sizes of files, counts and ranges of numbers.

The one table of them; docs/limits.md shows it, and a test holds the two together. Ranges of numbers
are wide: they keep out what is no object on a table, and what formulae would overflow with.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Limit(NamedTuple):
    """A range, its ends included.

    Attributes:
        what: is limited.
        least, most: its ends.
        unit: of both.
    """

    what: str
    least: float
    most: float
    unit: str


LIMITS: Mapping[str, Limit] = MappingProxyType(
    {
        "model_file": Limit("model file", 0, 1_000_000, "bytes"),
        "scene_file": Limit("scene file", 0, 1_000_000, "bytes"),
        "data_file": Limit("data file (CSV)", 0, 50_000_000, "bytes"),
        "mesh_file": Limit("mesh file, also unpacked", 0, 60_000_000, "bytes"),
        "description_file": Limit("description (URDF, SDF, MJCF)", 0, 10_000_000, "bytes"),
        "record_file": Limit("record of experiments", 0, 200_000_000, "bytes"),
        "trace_file": Limit("file of a trace, also unpacked", 0, 500_000_000, "bytes"),
        "bundle_file": Limit("bundle of a run", 0, 200_000_000, "bytes"),
        "bundle_part": Limit("member of a bundle, unpacked", 0, 200_000_000, "bytes"),
        "history_file": Limit("history of the shell", 0, 10_000_000, "bytes"),
        "token_file": Limit("file of a token", 0, 10_000, "bytes"),
        "frames_file": Limit("file of frames", 0, 1_000_000, "bytes"),
        "batch_row": Limit("row of a batch", 0, 1_000_000, "bytes"),
        "lexicon_file": Limit("file of words of a plug-in", 0, 1_000_000, "bytes"),
        "yaml_nodes": Limit("values in a YAML file, aliases written out", 0, 20_000, ""),
        "yaml_depth": Limit("lists and mappings inside each other", 0, 20, ""),
        "yaml_text": Limit("one text in a YAML file", 0, 10_000, "characters"),
        "data_rows": Limit("lines of a data file", 0, 200_000, ""),
        "data_columns": Limit("columns of a data file", 1, 100, ""),
        "mesh_triangles": Limit("triangles of a mesh", 1, 1_200_000, ""),
        "name": Limit("name of an object, a model or a scene", 1, 100, "characters"),
        "objects": Limit("objects in a scene", 0, 60, ""),
        "corners": Limit("corners of a base", 3, 2000, ""),
        "support": Limit("points of a support", 3, 500, ""),
        "vertices": Limit("vertices of a hull", 4, 2000, ""),
        "mass": Limit("mass", 1e-6, 1e4, "kg"),
        "length": Limit("length, radius, height", 1e-6, 100.0, "m"),
        "table": Limit("size of a table", 0.001, 10.0, "m"),
        "variation": Limit("length over which friction varies", 0.02, 100.0, "m"),
        "height": Limit("height on an object", 0.0, 100.0, "m"),
        "coordinate": Limit("coordinate", -100.0, 100.0, "m"),
        "friction": Limit("friction coefficient", 1e-12, 100.0, ""),
        "deviation": Limit("standard deviation", 0.0, 1e4, "unit of the value"),
        "weight": Limit("weight of a support point", 1e-4, 1e4, ""),
        "volume": Limit("contents", 0.0, 1e4, "l"),
        "density": Limit("density", 1e-3, 1e5, "kg/m³"),
        "force": Limit("force", 0.0, 1e6, "N"),
        "squeeze": Limit("squeeze that crushes", 1e-3, 1e6, "N"),
        "torque": Limit("torque", 0.0, 1e6, "N·m"),
        "turns": Limit("turns of a cap", 1e-3, 100.0, ""),
        "angle": Limit("angle", -3600.0, 3600.0, "degrees"),
        "opening": Limit("opening of a lid", 1e-3, 360.0, "degrees"),
        "frames": Limit("frames of a camera", 0.1, 1000.0, "Hz"),
        "samples": Limit("samples of a torque sensor", 1.0, 1e5, "Hz"),
        "time_step": Limit("time step of the simulation", 1e-4, 0.005, "s"),
        "control_rate": Limit("control rate", 20.0, 1000.0, "Hz"),
        "delay": Limit("delay of a camera", 0.0, 10.0, "s"),
    }
)
"""Every limit by its key."""
