"""What a robot of one's own needs, and the simulated one."""

from __future__ import annotations

from nlcontrol.session.executor import Executor as Executor
from nlcontrol.session.executor import Perception as Perception
from nlcontrol.session.executor import Planner as Planner
from planner.touch_experiments import Experiment as Experiment
from planner.types.robot import Grip as Grip
from planner.types.robot import ReachAnswer as ReachAnswer
from planner.types.robot import Robot as Robot
from planner.types.robot import RobotLimits as RobotLimits
from sim.exploration.trial_extraction import Recording as Recording
from sim.robots.cell_description import CellDescription as CellDescription
from sim.robots.cell_description import CellObject as CellObject
from sim.robots.cell_description import JointSensor as JointSensor
from sim.robots.cell_description import RobotMount as RobotMount
from sim.robots.cell_description import Table as Table
from sim.robots.cell_description import TorqueSensor as TorqueSensor
from sim.robots.cell_description import Vision as Vision
from sim.simulated_executor import SimulatedExecutor as SimulatedExecutor
from sim.supervision import Monitor as Monitor
from sim.supervision import StopToken as StopToken
from sim.traces.trace import ContactEvent as ContactEvent
from sim.traces.trace import Trace as Trace
from sim.truth.object_truth import Truth as Truth
from sim.truth.scene_file import FrictionVariation as FrictionVariation
from sim.truth.scene_file import Hidden as Hidden
from sim.truth.scene_file import Pose as Pose
from sim.truth.scene_file import ScaledTorqueSensor as ScaledTorqueSensor
from sim.truth.scene_file import Scene as Scene
from sim.truth.scene_file import SceneObject as SceneObject
from sim.truth.scene_file import VaryingTable as VaryingTable
from sim.views.run_story import ContactMark as ContactMark
from sim.views.run_story import Ghost as Ghost
from sim.views.run_story import StoryLine as StoryLine
