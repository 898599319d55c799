"""Imports of the five packages: no other people's folders.

Four of the packages have everyday names. A folder `planner/` of the user's own, found first on the
path, would be imported in place of ours, and the error would surface far from its cause. So each is
looked at before it is imported.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import PathFinder

TYPE_CHECKING = False  # `typing` is not imported before signals are held
if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

SIBLINGS = ("grammar", "objectmodels", "planner", "sim")


def home() -> str:
    """The folder that holds the five packages."""
    return os.path.dirname(os.path.dirname(os.path.realpath(__file__)))


def package_path(name: str) -> str | None:
    """The folder or file that `import name` takes, without importing it; None if there is none."""
    loaded = sys.modules.get(name)
    spec = PathFinder.find_spec(name) if loaded is None else loaded.__spec__
    if spec is None:
        return None
    if spec.submodule_search_locations:  # a package, with an __init__ or without
        return os.path.realpath(next(iter(spec.submodule_search_locations)))
    return os.path.realpath(spec.origin) if spec.origin else None


def misplaced_packages() -> Iterator[tuple[str, str | None]]:
    """Each sibling package that is not the one beside nlcontrol, with what is found instead."""
    for name in SIBLINGS:
        path = package_path(name)
        if path != os.path.join(home(), name):
            yield name, path


def _require_own(name: str) -> None:
    """Refuses a sibling package that is missing or somebody else's.

    Raises:
        ImportError: names the package, what was found in its place, and where ours lies.
    """
    path, ours = package_path(name), os.path.join(home(), name)
    if path is None:
        raise ImportError(
            f"nlcontrol's package '{name}' is missing: it should be at {ours}. "
            "Install nlcontrol again.",
            name=name,
        )
    if path != ours:
        raise ImportError(
            f"nlcontrol's package '{name}' is shadowed by {path}: Python finds that one before "
            f"nlcontrol's own at {ours}. Rename it, or start Python from another folder.",
            name=name,
            path=path,
        )


class _OwnPackages:
    """Finder that lets nobody else's package through in the place of one of ours."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """None, so that others find the package, unless it would not be ours."""
        if fullname in SIBLINGS:
            _require_own(fullname)
        return None


def guard_packages() -> None:
    """Refuses a shadowed sibling package, now if it is loaded, else when it is imported.

    So the command line starts, and its error is one as all others are.

    Raises:
        ImportError: as from the import of a shadowed package.
    """
    for name in SIBLINGS:
        if name in sys.modules:
            _require_own(name)
    sys.meta_path.insert(0, _OwnPackages())
