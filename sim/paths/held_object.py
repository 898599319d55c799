"""The object that a hand takes hold of, or the lid of one.

Model: a lid that comes off is held by its knob or its rim, from above. The hand treats it as an
upright cylinder of its own, on the object's top or where it lies aside; its frame stands at the
middle of its lower side and has the headings of the object's B. The camera tells how far a lid is
open, and not where one is in the hand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from objectmodels.containers import lid_geometry as lids
from objectmodels.models.object_parts import ScrewCap
from planner.types.actions import Grasp, GraspAction
from planner.types.plan import Plan
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.collision.collision_scene import Obstacle

THREAD = 2.0 * np.pi
"""Turn of a cap in which it rises by its pitch [rad]."""


@dataclass(frozen=True, eq=False)
class HeldObject:
    """A plan and a state in which what is held is an object of its own.

    Attributes:
        asked: the grasp as it was planned.
        plan: whose object and grasp are those of what is held.
        grasp: of this plan.
        state: what is believed.
        held: what is held.
        height: of its base above the table, where it is taken [m].
        seat: height of its base once it is on its rim again [m]; 0 for an object.
        owner: name of the object whose lid it is; None for an object.
        pitch: by which it rises per turn [m].
        opened: how far the lid is seen to be open; 0 for an object.
    """

    asked: Grasp
    plan: Plan
    grasp: GraspAction
    state: WorldState
    held: SeenObject
    height: float
    seat: float = 0.0
    owner: str | None = None
    pitch: float = 0.0
    opened: float = 0.0

    @classmethod
    def from_plan(cls, plan: Plan, state: WorldState) -> HeldObject:
        """The object or lid that a plan with a grasp is about."""
        assert plan.grasp is not None, "something is held"
        already = state.held if plan.grasp.held else None
        target = state.objects[plan.object]
        if plan.grasp.part == "body":
            height = 0.0 if already is None else already.height
            return cls(plan.grasp, plan, plan.grasp, state, target, height)
        lid, seat = target.model.lid, target.model.top
        pitch = lid.pitch if isinstance(lid, ScrewCap) else 0.0
        held, height = _lid_as_object(target, pitch)
        x, y, z = plan.grasp.p_BG
        grasp = plan.grasp.model_copy(update={"p_BG": (x, y, z - seat)})
        changed = plan.model_copy(update={"object": held.name, "actions": (grasp, *plan.steps)})
        # Without its lid the object is no higher than its rim.
        bare = {target.name: replace(target, lid=None), held.name: held}
        known = replace(state, objects={**state.objects, **bare})
        height = height if already is None else already.height
        opened = target.lid or 0.0
        return cls(
            plan.grasp, changed, grasp, known, held, height, seat, target.name, pitch, opened
        )

    @property
    def name(self) -> str:
        """Of the object in the scene that it is or belongs to."""
        return self.owner or self.held.name

    @property
    def grasped_obstacle(self) -> Obstacle:
        """Obstacle about which the hand closes, where it is taken."""
        whole = Obstacle.from_seen(self.held, 0.0)
        there = replace(whole, p_WB=whole.p_WB + np.array([0.0, 0.0, self.height]))
        if self.owner is None:
            return there
        return replace(there, radius=0.5 * self.grasp.width, around=0.5 * self.grasp.width)


def _lid_as_object(target: SeenObject, pitch: float) -> tuple[SeenObject, float]:
    """A lid as an object of its own, and the height of its base [m]."""
    model = lids.detached_lid(target.model, target.name)
    assert model is not None, "a lid that is held comes off"
    pose, height = target.pose, target.model.top + pitch * (target.lid or 0.0) / THREAD
    if target.lid_at is not None:
        x, y, height = target.lid_at
        pose = PlanarPose(x, y, target.pose.yaw)
    return SeenObject(model.name, pose, model), height
