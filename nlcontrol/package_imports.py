"""Imports of the five packages: no other people's folders, and documented modules' former names.

Four of the packages have everyday names. A folder `planner/` of the user's own, found first on the
path, would be imported in place of ours, and the error would surface far from its cause. So each is
looked at before it is imported.

The front also serves former names for one version: `import nlcontrol` comes first, as it does
wherever a plug-in is loaded. A former name is looked up only when Python finds no module of that
name, and importing it warns with `DeprecationWarning`. To rename something that the guides show,
add a row to `FORMER`.
"""

from __future__ import annotations

import importlib
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
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


class _OwnPackages(MetaPathFinder):
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


FORMER: dict[str, tuple[str, dict[str, str]]] = {
    "grammar.lexicon": ("grammar.words.lexicon", {}),
    "nlcontrol.exploring": ("nlcontrol.learning.exploration_session", {}),
    "objectmodels.identification.datafile": ("objectmodels.identification.logs.touch_log", {}),
    "objectmodels.identification.recordings": ("objectmodels.identification.onset_detection", {}),
    "objectmodels.opening": ("objectmodels.containers.lid_forces", {}),
    "objectmodels.parameters": ("objectmodels.models.parameters", {}),
    "objectmodels.parts": ("objectmodels.models.object_parts", {}),
    "objectmodels.pouring": ("objectmodels.containers.pour_dynamics", {}),
    "objectmodels.tilting": ("objectmodels.mechanics.tilt_limits", {}),
    "planner.defaults": ("planner.types.defaults", {"changed": "with_settings"}),
    "planner.settings": ("planner.types.defaults", {"changed": "with_settings"}),
    "sim.hidden": ("sim.truth.scene_file", {"drawn": "sample_world"}),
}
"""New name of each former module, and the new names of what was renamed in it.

A new name may say another module: `module:name`."""


class _FormerNames(MetaPathFinder, Loader):
    """Finder and loader of modules by their former names."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Spec of a module that has a former name."""
        return ModuleSpec(fullname, self) if fullname in FORMER else None

    def exec_module(self, module: ModuleType) -> None:
        """Let a module answer with what stands in the one that took its place."""
        old = module.__name__
        home, renamed = FORMER[old]
        warnings.warn(
            f"{old} is now {home}; the former name goes with the next version",
            DeprecationWarning,
            stacklevel=2,
        )

        def current(name: str) -> object:
            where, _, new = renamed.get(name, name).rpartition(":")
            return getattr(importlib.import_module(where or home), new)

        vars(module)["__getattr__"] = current


def serve_former_names() -> None:
    """Let Python find documented modules by their former names."""
    sys.meta_path.append(_FormerNames())
