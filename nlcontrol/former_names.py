"""Former names of documented modules, which plug-ins may still import for one version.

The front serves them: `import nlcontrol` comes first, as it does wherever a plug-in is loaded. A
former name is looked up only when Python finds no module of that name, and importing it warns with
`DeprecationWarning`. To rename something that the guides show, add a row here.
"""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

FORMER: dict[str, tuple[str, dict[str, str]]] = {
    "grammar.lexicon": ("grammar.words.lexicon", {}),
    "nlcontrol.exploring": ("nlcontrol.learning.exploration_session", {}),
    "objectmodels.identification.datafile": ("objectmodels.identification.logs.touch_log", {}),
    "objectmodels.identification.recordings": (
        "objectmodels.identification.logs.force_recordings",
        {},
    ),
    "objectmodels.opening": ("objectmodels.containers.lid_forces", {}),
    "objectmodels.parameters": ("objectmodels.models.parameters", {}),
    "objectmodels.parts": ("objectmodels.models.object_parts", {}),
    "objectmodels.pouring": ("objectmodels.containers.pour_dynamics", {}),
    "objectmodels.tilting": ("objectmodels.mechanics.tilt_limits", {}),
    "planner.defaults": ("planner.types.defaults", {}),
    "planner.settings": ("planner.types.default_settings", {}),
    "sim.hidden": ("sim.truth.world_sampling", {}),
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
