"""The front of nlcontrol: say a sentence, get a predicted, executed and checked action.

    from nlcontrol import Controller

    result = Controller(scene="kitchen").say("push the ice tea box away without toppling it")
    print(result.text)

What users need is re-exported here and loaded on first use, so importing nlcontrol costs next to
nothing and never loads the simulator.
"""

from __future__ import annotations

import importlib

from nlcontrol.package_imports import guard_packages

guard_packages()

TYPE_CHECKING = False  # `typing` is not imported before signals are held
if TYPE_CHECKING:
    from grammar import Command, Frame, ParseError, parse
    from nlcontrol.batches.batch import batch
    from nlcontrol.batches.rows import BatchRow, DrawnScene
    from nlcontrol.checks.verdicts import Check
    from nlcontrol.errors import ControlError, ErrorInfo
    from nlcontrol.questions.answer import Answer
    from nlcontrol.results.result import Result
    from nlcontrol.service.remote_session import Client
    from nlcontrol.service.session import Session
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
    from objectmodels.identification import fit
    from objectmodels.mechanics.push_outcomes import Prediction, Thresholds
    from planner.affordances import Affordance
    from planner.types.defaults import DEFAULTS, Defaults, with_settings
    from planner.types.plan import Plan, Reached
    from planner.types.refusal import Refusal
    from planner.types.robot import Robot
    from sim.simulated_executor import SimulatedExecutor
    from sim.supervision import Monitor, StopToken
    from sim.traces.trace import Trace
    from sim.truth.scene_file import Scene, load_scene
    from sim.views.trace_picture import save_picture
    from sim.views.viewer_recording import save_replay

__version__ = "0.1.0"

_HOMES = {
    "Affordance": "planner.affordances",
    "Answer": "nlcontrol.questions.answer",
    "BatchRow": "nlcontrol.batches.rows",
    "BoxModel": "objectmodels",
    "Check": "nlcontrol.checks.verdicts",
    "Client": "nlcontrol.service.remote_session",
    "Command": "grammar",
    "ControlError": "nlcontrol.errors",
    "Controller": "nlcontrol.session.controller",
    "Conversation": "nlcontrol.session.conversation",
    "CylinderModel": "objectmodels",
    "DEFAULTS": "planner.types.defaults",
    "Defaults": "planner.types.defaults",
    "DrawnScene": "nlcontrol.batches.rows",
    "ErrorInfo": "nlcontrol.errors",
    "Event": "nlcontrol.session.events",
    "Executor": "nlcontrol.session.executor",
    "Frame": "grammar",
    "HullModel": "objectmodels",
    "ModelError": "objectmodels",
    "Monitor": "sim.supervision",
    "ObjectModel": "objectmodels",
    "ParseError": "grammar",
    "Perception": "nlcontrol.session.executor",
    "Plan": "planner.types.plan",
    "Planner": "nlcontrol.session.executor",
    "Prediction": "objectmodels.mechanics.push_outcomes",
    "PrismModel": "objectmodels",
    "Reached": "planner.types.plan",
    "Refusal": "planner.types.refusal",
    "Registry": "objectmodels",
    "Result": "nlcontrol.results.result",
    "Robot": "planner.types.robot",
    "Scene": "sim.truth.scene_file",
    "Session": "nlcontrol.service.session",
    "SimulatedExecutor": "sim.simulated_executor",
    "StopToken": "sim.supervision",
    "Thresholds": "objectmodels.mechanics.push_outcomes",
    "Trace": "sim.traces.trace",
    "batch": "nlcontrol.batches.batch",
    "fit": "objectmodels.identification",
    "load_scene": "sim.truth.scene_file",
    "parse": "grammar",
    "save_picture": "sim.views.trace_picture",
    "save_replay": "sim.views.viewer_recording",
    "with_settings": "planner.types.defaults",
}

__all__ = [
    "DEFAULTS",
    "Affordance",
    "Answer",
    "BatchRow",
    "BoxModel",
    "Check",
    "Client",
    "Command",
    "ControlError",
    "Controller",
    "Conversation",
    "CylinderModel",
    "Defaults",
    "DrawnScene",
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
    "Prediction",
    "PrismModel",
    "Reached",
    "Refusal",
    "Registry",
    "Result",
    "Robot",
    "Scene",
    "Session",
    "SimulatedExecutor",
    "StopToken",
    "Thresholds",
    "Trace",
    "__version__",
    "batch",
    "fit",
    "load_scene",
    "parse",
    "save_picture",
    "save_replay",
    "with_settings",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'nlcontrol' has no attribute '{name}'")
    value: object = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
