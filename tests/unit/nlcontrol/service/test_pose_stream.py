"""Poses for viewers: the simulation keeps to the clock as long as somebody looks."""

from __future__ import annotations

from nlcontrol import Session
from nlcontrol.service.workers.session_host import PoseStream
from sim.simulated_executor import simulation
from tests.patience import wait_until


def test_a_world_keeps_real_time_while_it_is_looked_at() -> None:
    with Session("kitchen") as session:
        session.look()
        clock = simulation(session.controller.executor).world.clock
        told: list[bytes] = []
        poses = PoseStream(session, told.append)
        assert not clock.runs
        poses.tell_frames(wanted=True)
        wait_until(lambda: told and clock.runs)
        poses.tell_frames(wanted=False)
        wait_until(lambda: not clock.runs)
