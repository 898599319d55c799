"""Places that a plan predicts: where objects are touched, and the poses in which they end.

All of it is belief. A pose is a row of a trace: quaternion (w, x, y, z) and position in W [m].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from planner.predicted_states import fallen_pose
from sim.rotations import Array, quaternion, rot_z
from sim.views.run_story import ContactMark, Ghost

if TYPE_CHECKING:
    from nlcontrol.results.result import Step
    from planner.types.actions import Aim, GraspAction, PushAction
    from planner.types.plan import Plan
    from planner.types.world_state import PlanarPose

_Mark = tuple[Array, Array]  # a place and the outward normal there, in B


def end_poses(steps: Sequence[Step]) -> Iterator[Ghost]:
    """Poses in which moved objects end, as predicted."""
    ends = {}
    for step in steps:
        if step.plan is not None and step.before is not None:
            ends[step.plan.object] = _end_pose(step.plan, step.before)
    for name, pose in ends.items():
        if pose is not None:
            yield Ghost(name, tuple(pose.round(6).tolist()))


def _end_pose(plan: Plan, before: PlanarPose) -> Array | None:
    """The predicted pose at the end, as a row of a trace; None if none was predicted."""
    if plan.task == "topple" and plan.pushes:
        return _row(*fallen_pose(plan.push, before))
    if plan.aim is not None:
        return _row(_attitude(before, plan.aim), (plan.aim.x, plan.aim.y, 0.0))
    if plan.pushes and plan.push.displacement is not None:
        return _row(_attitude(before), np.add((before.x, before.y, 0.0), plan.push.displacement))
    if plan.task == "lift":
        height = sum(step.height for step in plan.steps if step.kind == "lift_up")
        return _row(_attitude(before), (before.x, before.y, height))
    return None


def _attitude(before: PlanarPose, aim: Aim | None = None) -> Array:
    yaw = before.yaw if aim is None or aim.yaw is None else aim.yaw
    tipped = np.eye(3) if before.attitude is None else np.reshape(before.attitude, (3, 3))
    return np.asarray(rot_z(yaw) @ tipped)


def _row(R: Array, p: Sequence[float] | Array) -> Array:
    return np.concatenate([quaternion(R), p])


def plan_contacts(plan: Plan, R_WB: Array, since: float = 0.0) -> Iterator[ContactMark]:
    """Places where the fingertips touch in the first action of a plan.

    Args:
        plan: of pushes or of a hand.
        R_WB: attitude of its object, shape (3, 3).
        since: when they count [s].
    """
    marks = _push_marks(plan.push, R_WB) if plan.pushes else _grasp_marks(plan.grasp, R_WB)
    for place, outward in marks:
        x, y, z = place.round(5).tolist()
        yield ContactMark(since, plan.object, (x, y, z), tuple(outward.round(5).tolist()))


def _push_marks(push: PushAction, R_WB: Array) -> Iterator[_Mark]:
    """Places where the fingertips push."""
    n = np.array(push.normal_W) @ R_WB
    along = np.cross([0.0, 0.0, 1.0] @ R_WB, n)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        yield push.p_BC + side * push.spread * along, n


def _grasp_marks(grasp: GraspAction | None, R_WB: Array) -> Iterator[_Mark]:
    """Places where thumb and fingers hold an object; a lid's own contacts are on no object."""
    if grasp is None or grasp.part == "lid":
        return
    closing = np.array(grasp.closing_W) @ R_WB
    for side in (-1.0, 1.0):
        yield grasp.p_BG + 0.5 * side * grasp.width * closing, side * closing
