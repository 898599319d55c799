"""Estimates of where everything stands, from camera frames.

Frames: W is the world, B an object.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from objectmodels.containers.lids import detached_lid
from objectmodels.models.object_model import LEVEL, ObjectModel, Resting
from planner.problem.stacks import with_supports
from planner.types.world_state import Held, PlanarPose, SeenObject
from sim.cell.cell_description import CellDescription
from sim.rotations import rot_z, yaw_of
from sim.worlds.ports import Frame, SeenPose


def mean_pose(poses: Iterable[SeenPose]) -> PlanarPose:
    """Mean of several views of an object that stands still."""
    seen = list(poses)
    x, y, _ = np.mean([pose.p_WB for pose in seen], axis=0)
    R_WB = np.mean([pose.R_WB for pose in seen], axis=0)
    yaw = float(yaw_of(R_WB))
    if R_WB[2, 2] > np.cos(LEVEL):
        return PlanarPose(float(x), float(y), yaw)
    # The nearest rotation to a mean of rotations.
    left, _, right = np.linalg.svd(R_WB)
    attitude = rot_z(-yaw) @ left @ right
    return PlanarPose(float(x), float(y), yaw, tuple(attitude.ravel().tolist()))


def estimate_objects(
    cell: CellDescription,
    frames: Iterable[Frame],
    models: Mapping[str, ObjectModel],
    held: Held | None = None,
) -> dict[str, SeenObject]:
    """The objects of a cell as the robot knows them from frames in which everything stands still.

    There must be a frame, and a believed model of every object; a lid that is off is one more. What
    is held stands on nothing.
    """
    seen = list(frames)
    poses, lids, colours = mean_poses(seen), mean_lids(seen), seen[-1].colours
    found = {
        item.name: SeenObject.lying(
            item.name,
            poses[item.name],
            models[item.name],
            colours.get(item.name),
            fragile=item.fragile,
            fixed=item.fixed,
            lid=lids.get(item.name),
        )
        for item in cell.objects
    }
    for name, seen_object in list(found.items()):
        lid = detached_lid(models[name], name)
        if lid is not None and lid.name in poses:
            found[name] = replace(seen_object, lid_at=_lid_at(seen, lid.name, poses[lid.name]))
            found[lid.name] = SeenObject.lying(lid.name, poses[lid.name], lid)
    upright = {item.name for item in cell.objects if poses[item.name].attitude is None}
    if held is not None:
        upright.discard(held.name)
    return with_supports(found, {name: _mean_height(seen, name) for name in upright})


def _mean_height(frames: Iterable[Frame], name: str) -> float:
    """Mean height at which an object's origin is seen over the table [m]."""
    return float(np.mean([f.poses[name].p_WB[2] for f in frames if name in f.poses]))


def frame_as_things_lie(frame: Frame, rests: Mapping[str, Resting]) -> Frame:
    """A camera frame in which some objects have the frames of the faces that they lay on."""
    shown = {
        name: SeenPose(*rests[name].lying_pose(pose.R_WB, pose.p_WB)) if name in rests else pose
        for name, pose in frame.poses.items()
    }
    return replace(frame, poses=shown)


def _lid_at(frames: list[Frame], name: str, pose: PlanarPose) -> tuple[float, float, float] | None:
    """Place of a lid that is off; None if it does not lie level."""
    if pose.attitude is not None:
        return None
    return pose.x, pose.y, max(0.0, _mean_height(frames, name))


def mean_poses(frames: Iterable[Frame]) -> dict[str, PlanarPose]:
    """Mean pose of each object over frames in which everything stands still."""
    seen = list(frames)
    return {
        name: mean_pose(f.poses[name] for f in seen if name in f.poses) for name in seen[-1].poses
    }


def mean_lids(frames: Iterable[Frame]) -> dict[str, float]:
    """Mean of how far each lid is open over frames in which everything stands still."""
    seen = list(frames)
    return {name: float(np.mean([f.lids[name] for f in seen])) for name in seen[0].lids}
