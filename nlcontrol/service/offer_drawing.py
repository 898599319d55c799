"""Drawing of an offer: what its plan predicts, or what stands in its way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nlcontrol.references.object_names import face_names
from nlcontrol.reports.plan_drawing import end_poses, plan_contacts
from nlcontrol.reports.replay_story import prediction_lines
from nlcontrol.service.documents import Drawing

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from planner.types.actions import Vector3
    from planner.types.world_state import SeenObject

_TO_ROBOT = (-1.0, 0.0, 0.0)  # where a front face looks, in W


def offer_drawing(result: Result) -> Drawing | None:
    """The drawing of a plan or of a refusal; None if no object on the table is meant."""
    step = result.steps[-1] if result.steps else None
    if step is None or step.basis is None:
        return None
    target, plan = step.basis.target, step.plan
    normal_W = plan.push.normal_W if plan is not None and plan.pushes else _TO_ROBOT
    return Drawing(
        object=target.name,
        faces=_faces_towards(target, normal_W),
        lines=tuple(prediction_lines(step)),
        ghosts=tuple(end_poses([step])),
        contacts=tuple(
            plan_contacts(plan, target.body_pose[0], target.rest) if plan is not None else ()
        ),
        marks=step.marks,
    )


def _faces_towards(target: SeenObject, normal_W: Vector3) -> tuple[str, ...]:
    """Names of its side faces; those first whose normals are next to a direction."""
    faces, n = face_names(target.model, target.pose.yaw), target.pose.R_WB.T @ normal_W
    return tuple(sorted(faces, key=lambda name: -float(np.dot(faces[name].normal, n))))
