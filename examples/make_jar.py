"""Writes `jar.stl`, the mesh of a jar in millimetres: a foot, a straight side, a narrower lid.

    python examples/make_jar.py

Needs the extra `mesh`.
"""

from pathlib import Path

import trimesh

PROFILE = [(0, 0), (33, 0), (36, 3), (36, 88), (32, 92), (32, 100), (0, 100)]
"""Radius and height along its outline [mm]."""

if __name__ == "__main__":
    jar = trimesh.creation.revolve(PROFILE, sections=48)
    jar.export(Path(__file__).with_name("jar.stl"))
