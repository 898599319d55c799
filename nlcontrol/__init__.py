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
    from grammar import Command as Command
    from grammar import Frame as Frame
    from grammar import ParseError as ParseError
    from grammar import parse as parse
    from nlcontrol.batches.batch import batch as batch
    from nlcontrol.batches.rows import BatchRow as BatchRow
    from nlcontrol.batches.rows import DrawnScene as DrawnScene
    from nlcontrol.checks.verdicts import Check as Check
    from nlcontrol.errors import ControlError as ControlError
    from nlcontrol.errors import ErrorInfo as ErrorInfo
    from nlcontrol.questions.answer import Answer as Answer
    from nlcontrol.results.result import Result as Result
    from nlcontrol.service.remote_session import Client as Client
    from nlcontrol.service.session import Session as Session
    from nlcontrol.session.controller import Controller as Controller
    from nlcontrol.session.conversation import Conversation as Conversation
    from nlcontrol.session.events import Event as Event
    from nlcontrol.session.executor import Executor as Executor
    from nlcontrol.session.executor import Perception as Perception
    from nlcontrol.session.executor import Planner as Planner
    from objectmodels import BoxModel as BoxModel
    from objectmodels import CylinderModel as CylinderModel
    from objectmodels import HullModel as HullModel
    from objectmodels import ModelError as ModelError
    from objectmodels import ObjectModel as ObjectModel
    from objectmodels import PrismModel as PrismModel
    from objectmodels import Registry as Registry
    from objectmodels.identification import fit as fit
    from objectmodels.mechanics.push_outcomes import Prediction as Prediction
    from objectmodels.mechanics.push_outcomes import Thresholds as Thresholds
    from planner.affordances import Affordance as Affordance
    from planner.types.defaults import DEFAULTS as DEFAULTS
    from planner.types.defaults import Defaults as Defaults
    from planner.types.defaults import with_settings as with_settings
    from planner.types.plan import Plan as Plan
    from planner.types.plan import Reached as Reached
    from planner.types.refusal import Refusal as Refusal
    from planner.types.robot import Robot as Robot
    from sim.simulated_executor import SimulatedExecutor as SimulatedExecutor
    from sim.supervision import Monitor as Monitor
    from sim.supervision import StopToken as StopToken
    from sim.traces.trace import Trace as Trace
    from sim.truth.scene_file import Scene as Scene
    from sim.truth.scene_file import load_scene as load_scene
    from sim.views.trace_picture import save_picture as save_picture
    from sim.views.viewer_recording import save_replay as save_replay

__version__ = "0.1.0"

_HOMES = {
    "grammar": ["Command", "Frame", "ParseError", "parse"],
    "nlcontrol.batches.batch": ["batch"],
    "nlcontrol.batches.rows": ["BatchRow", "DrawnScene"],
    "nlcontrol.checks.verdicts": ["Check"],
    "nlcontrol.errors": ["ControlError", "ErrorInfo"],
    "nlcontrol.questions.answer": ["Answer"],
    "nlcontrol.results.result": ["Result"],
    "nlcontrol.service.remote_session": ["Client"],
    "nlcontrol.service.session": ["Session"],
    "nlcontrol.session.controller": ["Controller"],
    "nlcontrol.session.conversation": ["Conversation"],
    "nlcontrol.session.events": ["Event"],
    "nlcontrol.session.executor": ["Executor", "Perception", "Planner"],
    "objectmodels": [
        "BoxModel",
        "CylinderModel",
        "HullModel",
        "ModelError",
        "ObjectModel",
        "PrismModel",
        "Registry",
    ],
    "objectmodels.identification": ["fit"],
    "objectmodels.mechanics.push_outcomes": ["Prediction", "Thresholds"],
    "planner.affordances": ["Affordance"],
    "planner.types.defaults": ["DEFAULTS", "Defaults", "with_settings"],
    "planner.types.plan": ["Plan", "Reached"],
    "planner.types.refusal": ["Refusal"],
    "planner.types.robot": ["Robot"],
    "sim.simulated_executor": ["SimulatedExecutor"],
    "sim.supervision": ["Monitor", "StopToken"],
    "sim.traces.trace": ["Trace"],
    "sim.truth.scene_file": ["Scene", "load_scene"],
    "sim.views.trace_picture": ["save_picture"],
    "sim.views.viewer_recording": ["save_replay"],
}

__all__ = [name for names in _HOMES.values() for name in names]
__all__ += ["__version__"]


def __getattr__(name: str) -> object:
    home = next((module for module, names in _HOMES.items() if name in names), None)
    if home is None:
        raise AttributeError(f"module 'nlcontrol' has no attribute '{name}'")
    value: object = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
