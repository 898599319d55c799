"""What will be believed once a plan is carried out, if all comes as predicted.

Frames: W is the world, B the object.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from objectmodels.geometry.base_shapes import Array
from planner.problem.stacks import put_on
from planner.types.actions import Aim, Grasp, LiftUp, PushAction, SetOn
from planner.types.plan import Plan, Reached
from planner.types.world_state import Held, PlanarPose, SeenObject, WorldState


def state_after(made: Plan | Reached, state: WorldState) -> WorldState | None:
    """The belief after a plan; None if another one than of poses and of the hand would follow."""
    if isinstance(made, Reached):
        return state
    seen = state.objects[made.object]
    if made.task == "lift":
        return replace(state, held=_held(made, state))
    if made.task == "stand" and made.aim is not None:
        there = standing_object(seen, made.aim)
    elif made.task in ("push", "place") and made.aim is not None:
        yaw = seen.pose.yaw if made.aim.yaw is None else made.aim.yaw
        last = made.actions[-1]
        lower = state.objects[last.onto] if isinstance(last, SetOn) else None
        moved = replace(seen, pose=replace(seen.pose, x=made.aim.x, y=made.aim.y, yaw=yaw))
        there = put_on(moved, lower)
    elif made.task in ("topple", "tilt") and all(push.displacement for push in made.pushes[:-1]):
        there = _prepared(seen, made.pushes[:-1])
        if made.task == "topple":
            there = fallen_object(made.pushes[-1], there)
    else:
        return None
    return replace(state, objects={**state.objects, there.name: there}, held=None)


def standing_object(seen: SeenObject, aim: Aim) -> SeenObject:
    """The object as it stands on its bottom at an aim, which has a heading."""
    assert aim.yaw is not None, "it stands with some heading"
    pose = PlanarPose(aim.x, aim.y, aim.yaw)
    return replace(seen, pose=pose, model=seen.standing_model, rest=None, attitude=None)


def fallen_object(push: PushAction, before: SeenObject) -> SeenObject:
    """The object once a push has tipped it over."""
    R_WB, p_WB = fallen_pose(push, before.pose)
    if before.rest is not None:
        R_WB, p_WB = before.rest.body_pose(R_WB, p_WB)
    x, y, _ = p_WB.tolist()
    return SeenObject.lying(
        before.name,
        PlanarPose(x, y, attitude=tuple(R_WB.ravel().tolist())),
        before.standing_model,
        before.colour,
        fragile=before.fragile,
        lid=before.lid,
    )


def fallen_pose(push: PushAction, before: PlanarPose) -> tuple[Array, Array]:
    """R_WB, (3, 3), and p_WB, (3,) [m], tipped by a right angle over the edge beyond a contact."""
    R_WB, n = before.R_WB, np.array(push.normal_W)
    depth = float((R_WB @ np.array(push.p_BC)) @ n)
    edge = before.p_WB - depth * n
    x, y, _ = np.cross([0.0, 0.0, 1.0], -n).tolist()
    quarter = np.array([[x * x, x * y, y], [x * y, y * y, -x], [-y, x, 0.0]])
    return quarter @ R_WB, edge + quarter @ (before.p_WB - edge)


def _held(made: Plan, state: WorldState) -> Held:
    """What the hand holds after a lift."""
    assert made.grasp is not None, "what is lifted is held"
    grasp = Grasp(**{name: getattr(made.grasp, name) for name in Grasp.model_fields})
    risen = sum(step.height for step in made.steps if isinstance(step, LiftUp))
    begun = state.held.height if state.held else state.objects[made.object].pose.z
    return Held(made.object, grasp, begun + risen)


def _prepared(seen: SeenObject, pushes: tuple[PushAction, ...]) -> SeenObject:
    """The object after pushes that bring it to where it is toppled."""
    still = (0.0, 0.0, 0.0)
    x, y, _ = np.sum([still, *(push.displacement or still for push in pushes)], axis=0).tolist()
    turned = math.fsum(push.turn for push in pushes)
    pose = seen.pose
    return replace(seen, pose=replace(pose, x=pose.x + x, y=pose.y + y, yaw=pose.yaw + turned))
