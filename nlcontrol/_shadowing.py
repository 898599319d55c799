"""A guard against other people's folders that bear the names of this project's packages.

nlcontrol is five import packages that lie side by side, four of them with everyday names. A
folder `planner/` of the user's own, found first on the path, would be imported in place of ours,
and the error would surface far from its cause. So the front looks before it imports.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Iterator

SIBLINGS = ("grammar", "objectmodels", "planner", "sim")


def home() -> str:
    """The folder that holds the five packages."""
    return os.path.dirname(os.path.dirname(os.path.realpath(__file__)))


def found(name: str) -> str | None:
    """The folder or file that `import name` takes, without importing it; None if there is none."""
    spec = importlib.util.find_spec(name)
    if spec is None:
        return None
    if spec.submodule_search_locations:  # a package, with an __init__ or without
        return os.path.realpath(next(iter(spec.submodule_search_locations)))
    return os.path.realpath(spec.origin) if spec.origin else None


def misplaced() -> Iterator[tuple[str, str | None]]:
    """Each sibling package that is not the one beside nlcontrol, with what is found instead."""
    for name in SIBLINGS:
        path = found(name)
        if path != os.path.join(home(), name):
            yield name, path


def refuse_shadowed() -> None:
    """Stops the import of nlcontrol if a sibling package is missing or shadowed.

    Raises:
        ImportError: names the package, what was found in its place, and where ours lies.
    """
    for name, path in misplaced():
        ours = os.path.join(home(), name)
        if path is None:
            raise ImportError(
                f"nlcontrol's package '{name}' is missing: it should be at {ours}. "
                "Install nlcontrol again.",
                name=name,
            )
        raise ImportError(
            f"nlcontrol's package '{name}' is shadowed by {path}: Python finds that one before "
            f"nlcontrol's own at {ours}. Rename it, or start Python from another folder.",
            name=name,
            path=path,
        )
