"""Lids that open, come off and are put on again, in a world that moves on.

Model: a flip lid's catch pulls it shut by a torque that fades linearly over its snap angle. A
lift-off lid is off once it has been pulled over its travel, a screw cap once it has turned by all
of its turns; then it is a free body. It is on again once it lies on its rim upright, within
`SEATED` of its middle, and no finger touches it any more.

All of this happens between control steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.models.object_parts import FlipLid, Lid, LiftOffLid
from sim.rotations import Array
from sim.truth.object_truth import Truth
from sim.worlds.drake.lid_bodies import LidBody, shared_inertia

if TYPE_CHECKING:
    from pydrake.math import RigidTransform
    from pydrake.systems.framework import Context

    from sim.worlds.drake.drake_plant import Standing

SEATED = 0.004
"""How far from its middle a lid may be put on [m]."""

_ON_TOP = 0.002  # height up to which it lies on its rim [m]
_FREE = np.radians(30.0)  # opening from which a flip lid lets the contents out
_UPRIGHT = np.cos(np.radians(6.0))


class Lids:
    """Keeps the lids of a world as they are, in the root context of its diagram."""

    def __init__(self, model: Standing, root: Context) -> None:
        self._plant, self._scene_graph = model.plant, model.scene_graph
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._scene_context = model.scene_graph.GetMyMutableContextFromRoot(root)
        self._lids = model.lids
        self._off: set[str] = set()
        self._objects = {body.index() for body in model.bodies.values()}
        self._snapping = {
            name: each
            for name, each in model.lids.items()
            if isinstance(each.lid, FlipLid) and each.lid.snap_torque > 0.0
        }
        for each in model.lids.values():
            port = self._plant.get_desired_state_input_port(each.model)
            port.FixValue(self._context, np.zeros(2))
            if each.seat is not None:
                self._seat(each)

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: catches pull, lids come off and are on again."""
        del touched, poses
        if self._snapping:
            self._snap()
        for name, each in self._lids.items():
            if each.seat is None:
                continue
            if name not in self._off:
                if self._joint_position(each) > _comes_off(each.lid):
                    self._take_off(name, each)
            elif self._is_seated(each) and not self._is_touched(each):
                self._put_on(name, each)

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object does not change with its lid."""
        del name
        return truth

    def lid_openings(self) -> dict[str, float]:
        """Opening of each lid, as in `sim.traces.trace.Trace.lids`."""
        return {
            name: float(np.linalg.norm(self._from_seat(each).translation()))
            if name in self._off and isinstance(each.lid, LiftOffLid)
            else self._joint_position(each)
            for name, each in self._lids.items()
        }

    def is_open(self, name: str) -> bool:
        """True if the opening of an object with a lid is free."""
        each = self._lids[name]
        if isinstance(each.lid, FlipLid):
            return bool(self._joint_position(each) > _FREE)
        return name in self._off

    def loose(self) -> dict[str, tuple[Array, Array]]:
        """R_WL and p_WL of the lids that are off, by the names of their objects."""
        off = {name: each for name, each in self._lids.items() if name in self._off}
        poses = {n: self._plant.EvalBodyPoseInWorld(self._context, e.body) for n, e in off.items()}
        return {n: (X_WL.rotation().matrix(), X_WL.translation()) for n, X_WL in poses.items()}

    def poses(self) -> dict[str, Array]:
        """Poses X_WL of the lids that come off, quaternion (w, x, y, z) and p_WL, shape (7,)."""
        poses = {}
        for name, each in self._lids.items():
            if each.seat is not None:
                X_WL = self._plant.EvalBodyPoseInWorld(self._context, each.body)
                poses[name] = np.concatenate(
                    [X_WL.rotation().ToQuaternion().wxyz(), X_WL.translation()]
                )
        return poses

    def _snap(self) -> None:
        tau = np.zeros(self._plant.num_velocities())
        for each in self._snapping.values():
            assert isinstance(each.lid, FlipLid)
            left = max(0.0, 1.0 - max(0.0, self._joint_position(each)) / each.lid.snap_angle)
            tau[each.joint.velocity_start()] = -each.lid.snap_torque * left
        self._plant.get_applied_generalized_force_input_port().FixValue(self._context, tau)

    def _joint_position(self, each: LidBody) -> float:
        """Position of hinge, slide or thread [rad], [m]."""
        return float(each.joint.GetOnePosition(self._context))

    def _from_seat(self, each: LidBody) -> RigidTransform:
        """Pose of a lid in its seat."""
        assert each.seat is not None
        X_WS, X_WL = (
            self._plant.EvalBodyPoseInWorld(self._context, body) for body in (each.seat, each.body)
        )
        return X_WS.InvertAndCompose(X_WL)

    def _is_seated(self, each: LidBody) -> bool:
        X_SL = self._from_seat(each)
        x, y, z = X_SL.translation()
        upright = X_SL.rotation().matrix()[2, 2] > _UPRIGHT
        return bool(np.hypot(x, y) < SEATED and z < _ON_TOP and upright)

    def _is_touched(self, each: LidBody) -> bool:
        """True if anything but objects touches a lid."""
        results = self._plant.get_contact_results_output_port().Eval(self._context)
        contacts = map(results.point_pair_contact_info, range(results.num_point_pair_contacts()))
        pairs = ({contact.bodyA_index(), contact.bodyB_index()} for contact in contacts)
        return any(each.body.index() in pair and not pair & self._objects for pair in pairs)

    def _take_off(self, name: str, each: LidBody) -> None:
        """The lid becomes free where it is; its seat waits for it."""
        self._plant.SetConstraintActiveStatus(self._context, each.weld, False)
        self._share(each, on=False)
        if isinstance(each.lid, LiftOffLid):
            each.joint.set_translation(self._context, 0.0)
            each.joint.set_translation_rate(self._context, 0.0)
        self._touch_own(each, touches=True)
        self._off.add(name)

    def _put_on(self, name: str, each: LidBody) -> None:
        self._seat(each)
        self._share(each, on=True)
        self._plant.SetConstraintActiveStatus(self._context, each.weld, True)
        self._touch_own(each, touches=False)
        self._off.remove(name)

    def _seat(self, each: LidBody) -> None:
        """Moves a lid to where its seat is."""
        X_WS = self._plant.EvalBodyPoseInWorld(self._context, each.seat)
        self._plant.SetFreeBodyPose(self._context, each.body, X_WS)

    def _share(self, each: LidBody, *, on: bool) -> None:
        assert each.seat is not None
        assert not isinstance(each.lid, FlipLid)
        for body, inertia in zip(
            (each.seat, each.body), shared_inertia(each.lid, on=on), strict=True
        ):
            body.SetSpatialInertiaInBodyFrame(self._context, inertia)

    def _touch_own(self, each: LidBody, *, touches: bool) -> None:
        """Lets a lid touch its own object or not; one that is on is held to it by its joint."""
        from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

        pair = GeometrySet([*each.solids, *each.feet]), GeometrySet([each.own])
        filters = CollisionFilterDeclaration()
        changed = filters.AllowBetween(*pair) if touches else filters.ExcludeBetween(*pair)
        self._scene_graph.collision_filter_manager(self._scene_context).Apply(changed)


def _comes_off(lid: Lid) -> float:
    """Position of its joint at which a lid is off."""
    if isinstance(lid, LiftOffLid):
        return lid.travel
    assert not isinstance(lid, FlipLid)
    return 2.0 * np.pi * lid.turns
