"""The seam at the robot: any executor will do, and its robot's port knows no truth."""

from __future__ import annotations

import subprocess
import sys
import types
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from nlcontrol.robots import SimulatedExecutor
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.types.plan import Plan, Reached
from planner.types.world_state import WorldState
from sim import load_scene
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene, SceneObject
from sim.worlds.drake.drake_world import DrakeWorld
from sim.worlds.ports import Sample
from tests.fakes.played_executor import played

SENTENCE = "push the ice tea box away without toppling it"

WITHOUT_DRAKE = """
import sys
sys.modules["pydrake"] = None  # any import of it fails from now on
import numpy as np
from dataclasses import replace
from nlcontrol.robots import Trace
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from tests.fakes.played_executor import PlayedExecutor
from tests.unit.nlcontrol.pushes import BOX

def gone(plan):
    n, phase = 301, np.repeat(["look", "push", "settle"], [100, 101, 100])
    share = np.clip(np.linspace(-1.0, 2.0, n), 0.0, 1.0)
    far = plan.aim.x - executor.poses[BOX].x, plan.aim.y - executor.poses[BOX].y
    still = {name: np.tile((1.0, 0.0, 0.0, 0.0, at.x, at.y, 0.0), (n, 1))
             for name, at in executor.poses.items()}
    still[BOX][:, 4:6] = np.outer(share, far)
    tips = np.column_stack([share * far[0], share * far[1], np.full(n, 0.03)])
    return Trace(
        time=0.01 * np.arange(n), phase=phase, poses=still, seen=still,
        joints=np.zeros((n, 1)), joint_names=("joint",), tips={"index": tips},
        felt={"index": np.tile((4.0, 0.0, 0.0), (n, 1))}, force_limit=np.full(n, 6.0),
        contacts=(), pushed=BOX, direction=np.array([1.0, 0.0, 0.0]), end="stroke",
        detail="played", seed=0,
    )

simulated = Controller("kitchen", seed=1)
poses = {name: seen.pose for name, seen in simulated.look().objects.items()}
executor = PlayedExecutor(simulated.cell, poses, simulated.robot, gone)
conversation = Conversation(Controller(executor=executor))
result = conversation.say("push the ice tea box away without toppling it")
print(result.status, len(executor.executed), len(result.checks))
assert not any(name.startswith("pydrake.") for name in sys.modules)
"""


def test_a_sentence_needs_no_simulator_where_another_executor_carries_it_out() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_DRAKE], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["done", "1", "5"]


def test_a_controller_takes_cell_and_seed_from_its_executor() -> None:
    executor = SimulatedExecutor(load_scene("counter"), seed=5)
    controller = Controller("kitchen", executor=executor, seed=1)
    assert (controller.cell.name, controller.seed) == ("counter", 5)
    assert set(controller.models) == set(controller.cell.names)


def test_a_controller_asks_the_planner_that_it_is_given() -> None:
    asked: list[WorldState] = []

    def planner(frame: Any, state: WorldState, robot: Any, **_: Any) -> Plan | Reached:
        asked.append(state)
        return Reached()

    controller = Controller("kitchen", planner=planner)
    result = Conversation(controller).say(SENTENCE, plan_only=True)
    assert len(asked) == 1
    assert result.plan is None


def _parts(value: Any, depth: int = 0) -> Iterator[Any]:
    """A value and everything that its public attributes lead to."""
    yield value
    if depth > 6 or isinstance(value, str | bytes | float | int | np.ndarray | type(None)):
        return
    if isinstance(value, Mapping):
        inner = [*value.keys(), *value.values()]
    elif isinstance(value, list | tuple | set | frozenset):
        inner = list(value)
    elif isinstance(value, types.ModuleType | type):
        return
    else:
        names = [name for name in dir(value) if not name.startswith(("_", "model_"))]
        inner = [part for part in (getattr(value, name) for name in names) if not callable(part)]
    for part in inner:
        yield from _parts(part, depth + 1)


def test_the_port_of_a_robot_leads_to_no_truth() -> None:
    scene = load_scene("kitchen")
    world = DrakeWorld(scene, seed=1)
    for _ in range(10):
        world.robot.step(*world.robot.commanded)
    hidden = (Truth, Scene, SceneObject, DrakeWorld, Sample)
    reached = [part for part in _parts(world.robot) if isinstance(part, hidden)]
    reached += [part for part in _parts(world.robot.frames()) if isinstance(part, hidden)]
    assert reached == []
    # The same walk does find what an observer sees.
    assert any(isinstance(part, Sample) for part in _parts(world))


def test_a_played_executor_takes_the_place_of_the_simulation() -> None:
    controller = Controller("kitchen", seed=1)
    executor = played(controller)
    assert controller.look().objects["ice tea box"].pose == executor.poses["ice tea box"]
