"""Who touches whom: what the shapes tell is what the plant's own contacts tell."""

from __future__ import annotations

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import ContactResults
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from sim import load_scene
from sim.worlds.drake.drake_bodies import APART, ContactWatch
from sim.worlds.drake.drake_plant import add_plant


class _Kitchen:
    """Its plant with the arm at home, where objects may be put into others."""

    def __init__(self) -> None:
        builder = DiagramBuilder()
        scene = load_scene("kitchen")
        self.model = add_plant(builder, scene)
        self._simulator = Simulator(builder.Build())
        self.plant = self.model.plant
        root = self._simulator.get_mutable_context()
        self.context = self.plant.GetMyMutableContextFromRoot(root)
        home = np.radians(scene.robot.home_deg)
        self.plant.SetPositions(self.context, self.model.arm, home)
        for instance in (self.model.arm, self.model.hand):
            port = self.plant.get_desired_state_input_port(instance)
            port.FixValue(self.context, np.zeros(port.size()))
        self.watch = ContactWatch(self.plant, self.model.bodies)

    def put(self, name: str, p_WB: np.ndarray) -> None:
        body = self.model.bodies[name]
        self.plant.SetFloatingBaseBodyPoseInWorldFrame(self.context, body, RigidTransform(p_WB))

    def contacts(self) -> set[frozenset[str]]:
        """Pairs that the plant itself has in contact, but for what stands on the table."""
        results: ContactResults = self.plant.get_contact_results_output_port().Eval(self.context)
        infos = map(results.point_pair_contact_info, range(results.num_point_pair_contacts()))
        pairs = ((info.bodyA_index(), info.bodyB_index()) for info in infos)
        return {
            frozenset(self.plant.get_body(index).name() for index in pair)
            for pair in pairs
            if self.plant.world_body().index() not in pair
        }


def test_what_overlaps_is_in_contact() -> None:
    kitchen = _Kitchen()
    first, second = list(kitchen.model.bodies)[:2]
    kitchen.put(first, np.array([0.5, 0.0, 0.0]))
    for time, aside in ((0.0, 0.3), (1.0, 0.01)):
        kitchen.put(second, np.array([0.5, aside, 0.0]))
        kitchen.watch.note(time, kitchen.context)
        told = {frozenset((e.body_a, e.body_b)) for e in kitchen.watch.begun}
        assert told == kitchen.contacts()
    assert told == {frozenset((first, second))}
    assert [event.time for event in kitchen.watch.begun] == [1.0]


def test_what_the_robot_touches_anew() -> None:
    kitchen = _Kitchen()
    name = next(iter(kitchen.model.bodies))
    finger = kitchen.plant.GetBodyByName("index_tip")
    p_WF = kitchen.plant.EvalBodyPoseInWorld(kitchen.context, finger).translation()
    touching = np.array([*p_WF[:2], p_WF[2] - 0.05])
    kitchen.put(name, touching)
    assert kitchen.watch.note(0.0, kitchen.context) == [name]
    assert kitchen.watch.note(0.1, kitchen.context) == []
    assert kitchen.watch.note(0.2 + APART, kitchen.context) == [name]
