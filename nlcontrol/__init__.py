"""The front of nlcontrol: say a sentence, get a predicted, executed and checked action.

    from nlcontrol import Controller

    result = Controller(scene="kitchen").say("push the ice tea box away without toppling it")
    print(result.text)

What users need is re-exported here and loaded on first use, so importing nlcontrol costs next to
nothing and never loads the simulator.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from nlcontrol.package_imports import guard_packages, serve_former_names

guard_packages()
serve_former_names()

if TYPE_CHECKING:
    from grammar import Command, Frame, ParseError, parse
    from nlcontrol.checks.verdicts import Check
    from nlcontrol.errors import ControlError, ErrorInfo
    from nlcontrol.results.result import Result
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation
    from nlcontrol.session.events import Event
    from nlcontrol.session.executor import Executor, Perception, Planner
    from objectmodels import (
        BoxModel,
        CylinderModel,
        HullModel,
        ModelError,
        ObjectModel,
        PrismModel,
        Registry,
    )
    from planner.types.plan import Plan
    from planner.types.refusal import Refusal
    from planner.types.robot import Robot
    from sim.simulated_executor import SimulatedExecutor
    from sim.supervision import Monitor, StopToken
    from sim.traces.trace import Trace

__version__ = "0.1.0"

_HOMES = {
    "BoxModel": "objectmodels",
    "Check": "nlcontrol.checks.verdicts",
    "Command": "grammar",
    "ControlError": "nlcontrol.errors",
    "Controller": "nlcontrol.session.controller",
    "Conversation": "nlcontrol.session.conversation",
    "CylinderModel": "objectmodels",
    "HullModel": "objectmodels",
    "ObjectModel": "objectmodels",
    "PrismModel": "objectmodels",
    "ErrorInfo": "nlcontrol.errors",
    "Event": "nlcontrol.session.events",
    "Executor": "nlcontrol.session.executor",
    "Monitor": "sim.supervision",
    "StopToken": "sim.supervision",
    "Perception": "nlcontrol.session.executor",
    "Planner": "nlcontrol.session.executor",
    "Robot": "planner.types.robot",
    "SimulatedExecutor": "sim.simulated_executor",
    "Trace": "sim.traces.trace",
    "Frame": "grammar",
    "ModelError": "objectmodels",
    "ParseError": "grammar",
    "Plan": "planner.types.plan",
    "Refusal": "planner.types.plan",
    "Registry": "objectmodels",
    "Result": "nlcontrol.results.result",
    "parse": "grammar",
}

__all__ = [
    "BoxModel",
    "Check",
    "Command",
    "ControlError",
    "Controller",
    "Conversation",
    "CylinderModel",
    "ErrorInfo",
    "Event",
    "Executor",
    "Frame",
    "HullModel",
    "ModelError",
    "Monitor",
    "ObjectModel",
    "ParseError",
    "Perception",
    "Plan",
    "Planner",
    "PrismModel",
    "Refusal",
    "Registry",
    "Result",
    "Robot",
    "SimulatedExecutor",
    "StopToken",
    "Trace",
    "__version__",
    "parse",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'nlcontrol' has no attribute '{name}'")
    value: object = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
