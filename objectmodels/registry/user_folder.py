"""The folder of the user's own models, and the files in it."""

from __future__ import annotations

import os
import re
from itertools import count
from pathlib import Path

FOLDER_VARIABLE = "NLCONTROL_OBJECTS"
"""Environment variable that names the user's folder of models."""

_LONGEST = 50  # characters of a file's name; each of them may take four bytes of 255


def user_folder() -> Path:
    """The folder of the user's own models, where `objects add` and `import` put them."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    data = os.environ.get("APPDATA" if os.name == "nt" else "XDG_DATA_HOME")
    home = Path(data) if data else Path.home() / ".local" / "share"
    return home / "nlcontrol" / "objects"


def free_file(name: str) -> Path:
    """A file in the user's folder that is not there yet, for a model of that name."""
    plain = re.sub(r"[^\w.+-]+", "_", name).lstrip(".")[:_LONGEST] or "_"
    names = (plain if number == 1 else f"{plain}_{number}" for number in count(1))
    files = (user_folder() / f"{name}.yaml" for name in names)
    return next(file for file in files if not os.path.lexists(file))
