"""The front of nlcontrol: say a sentence, get a predicted, executed and checked action.

    from nlcontrol import Session

    with Session("kitchen") as session:
        print(session.say("push the ice tea box away without toppling it"))
        print(session.say("a bit more"))

These names are loaded on first use, so importing nlcontrol costs next to nothing and never loads
the simulator. More stand in `nlcontrol.types`, `nlcontrol.objects`, `nlcontrol.robots`,
`nlcontrol.views` and `nlcontrol.batches`.
"""

from __future__ import annotations

import importlib

from nlcontrol.package_imports import guard_packages

guard_packages()

TYPE_CHECKING = False  # `typing` is not imported before signals are held
if TYPE_CHECKING:
    from grammar.parser import parse as parse
    from nlcontrol.batches.batch import batch as batch
    from nlcontrol.results.result import Result as Result
    from nlcontrol.service.async_session import AsyncClient as AsyncClient
    from nlcontrol.service.documents import Offer as Offer
    from nlcontrol.service.methods import Run as Run
    from nlcontrol.service.remote_session import Client as Client
    from nlcontrol.service.session import Session as Session
    from objectmodels.errors import NlcontrolError as NlcontrolError
    from objectmodels.identification.joint_fit import fit as fit
    from objectmodels.models.kinds import BoxModel as BoxModel
    from objectmodels.models.object_model import ObjectModel as ObjectModel
    from objectmodels.registry.model_registry import Registry as Registry
    from planner.types.plan import Plan as Plan
    from sim.truth.scene_file import load_scene as load_scene

__version__ = "0.1.0"

_HOMES = {
    "parse": "grammar.parser",
    "batch": "nlcontrol.batches.batch",
    "Result": "nlcontrol.results.result",
    "AsyncClient": "nlcontrol.service.async_session",
    "Offer": "nlcontrol.service.documents",
    "Run": "nlcontrol.service.methods",
    "Client": "nlcontrol.service.remote_session",
    "Session": "nlcontrol.service.session",
    "NlcontrolError": "objectmodels.errors",
    "fit": "objectmodels.identification.joint_fit",
    "ObjectModel": "objectmodels.models.object_model",
    "BoxModel": "objectmodels.models.kinds",
    "Registry": "objectmodels.registry.model_registry",
    "Plan": "planner.types.plan",
    "load_scene": "sim.truth.scene_file",
}

__all__ = list(_HOMES)
__all__ += ["__version__"]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'nlcontrol' has no attribute '{name}'")
    value: object = getattr(importlib.import_module(_HOMES[name]), name)
    if not isinstance(value, type):  # a call, which refuses arguments of a wrong type here
        from nlcontrol.argument_types import checked_arguments

        value = checked_arguments(value)  # type: ignore[arg-type]
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
