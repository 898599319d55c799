"""Places that a plan predicts: where objects are touched, and the poses in which they end.

All of it is belief. A pose is a row of a trace: quaternion (w, x, y, z) and position in W [m].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.geometry.rotations import Array, quaternion, rot_z
from planner.problem.predicted_states import fallen_pose, standing_object
from sim.views.run_story import ContactMark, Ghost

if TYPE_CHECKING:
    from nlcontrol.results.result import Step
    from objectmodels.models.object_model import Resting
    from planner.types.actions import GraspAction, PushAction
    from planner.types.plan import Plan
    from planner.types.world_state import SeenObject

_Mark = tuple[Array, Array]  # a place and the outward normal there, in the frame of a plan


def end_poses(steps: Sequence[Step]) -> Iterator[Ghost]:
    """Poses in which moved objects end, as predicted."""
    ends = {}
    for step in steps:
        if step.plan is not None and step.basis is not None:
            ends[step.plan.object] = _end_pose(step.plan, step.basis.target)
    for name, pose in ends.items():
        if pose is not None:
            yield Ghost(name, tuple(pose.round(6).tolist()))


def _end_pose(plan: Plan, target: SeenObject) -> Array | None:
    """The predicted pose at the end, as a row of a trace; None if none was predicted."""
    before, rest = target.pose, target.rest
    if plan.task == "topple" and plan.pushes:
        return _row(rest, *fallen_pose(plan.push, before))
    if plan.task == "stand" and plan.aim is not None:
        return _row(None, *standing_object(target, plan.aim).body_pose)
    if plan.aim is not None:
        last = plan.actions[-1]
        height = last.height if last.kind == "set_on" else 0.0
        yaw = before.yaw if plan.aim.yaw is None else plan.aim.yaw
        return _row(rest, rot_z(yaw), np.array([plan.aim.x, plan.aim.y, height]))
    if plan.pushes and plan.push.displacement is not None:
        return _row(rest, before.R_WB, before.p_WB + plan.push.displacement)
    if plan.task == "lift":
        height = sum(step.height for step in plan.steps if step.kind == "lift_up")
        return _row(rest, before.R_WB, before.p_WB + np.array([0.0, 0.0, height]))
    return None


def _row(rest: Resting | None, R_WN: Array, p_WN: Array) -> Array:
    """The pose of the object's own B, from that of the face on which it lies."""
    R_WB, p_WB = (R_WN, p_WN) if rest is None else rest.body_pose(R_WN, p_WN)
    return np.concatenate([quaternion(R_WB), p_WB])


def plan_contacts(
    plan: Plan, R_WB: Array, rest: Resting | None, since: float = 0.0
) -> Iterator[ContactMark]:
    """Places where the fingertips touch in the first action of a plan.

    Args:
        plan: of pushes or of a hand.
        R_WB: attitude of its object, shape (3, 3).
        rest: how that lies, if not on its bottom.
        since: when they count [s].
    """
    R_BN, p_BN = (np.eye(3), np.zeros(3)) if rest is None else (rest.R_BN, rest.p_BN)
    R_WN = R_WB @ R_BN
    marks = _push_marks(plan.push, R_WN) if plan.pushes else _grasp_marks(plan.grasp, R_WN)
    for there, out in marks:
        place, outward = p_BN + R_BN @ there, R_BN @ out
        x, y, z = place.round(5).tolist()
        yield ContactMark(since, plan.object, (x, y, z), tuple(outward.round(5).tolist()))


def _push_marks(push: PushAction, R_WN: Array) -> Iterator[_Mark]:
    """Places where the fingertips push."""
    n = np.array(push.normal_W) @ R_WN
    along = np.cross([0.0, 0.0, 1.0] @ R_WN, n)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        yield push.p_BC + side * push.spread * along, n


def _grasp_marks(grasp: GraspAction | None, R_WN: Array) -> Iterator[_Mark]:
    """Places where thumb and fingers hold an object; a lid's own contacts are on no object."""
    if grasp is None or grasp.part == "lid":
        return
    closing = np.array(grasp.closing_W) @ R_WN
    for side in (-1.0, 1.0):
        yield grasp.p_BG + 0.5 * side * grasp.width * closing, side * closing
