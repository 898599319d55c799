"""Contents in the simulated world: lids on their hinges and threads, liquids.

Frames: W is the world, B a container.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers.pour_dynamics import landing_distance, outflow_rate
from objectmodels.geometry.rotations import Array
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_bodies import LidBody
from sim.worlds.drake.drake_plant import Standing, pose_row

if TYPE_CHECKING:
    from pydrake.math import RigidTransform
    from pydrake.systems.framework import Context

    from objectmodels.models.object_parts import Container, Vessel


class Lids:
    """Keeps the lids of a world as they are, in the root context of its diagram.

    Model: a flip lid's catch pulls it shut by a torque that fades linearly over its snap angle. A
    lift-off lid is off once it has been pulled over its travel, a screw cap once it has turned by
    all of its turns; then it is a free body. It is on again once it lies on its rim upright, near
    its middle, and no finger touches it any more. All of this happens between control steps.
    """

    def __init__(self, model: Standing, root: Context) -> None:
        self._plant, self._scene_graph = model.plant, model.scene_graph
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._scene_context = model.scene_graph.GetMyMutableContextFromRoot(root)
        self._lids = model.lids
        self._off: set[str] = set()
        self._objects = {body.index() for body in model.bodies.values()}
        self._snapping = {
            name: each for name, each in model.lids.items() if each.catch_torque > 0.0
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
                if self._joint_position(each) > each.off_from:
                    self._take_off(name, each)
            elif self._is_seated(each) and not self._is_touched(each):
                self._seat(each)
                self._share(each, on=True)
                self._plant.SetConstraintActiveStatus(self._context, each.weld, True)
                self._touch_own(each, touches=False)
                self._off.remove(name)

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object does not change with its lid."""
        del name
        return truth

    def lid_openings(self) -> dict[str, float]:
        """Opening of each lid, as in `sim.traces.trace.Trace.lids`."""
        return {
            name: float(np.linalg.norm(self._from_seat(each).translation()))
            if name in self._off and each.slides
            else self._joint_position(each)
            for name, each in self._lids.items()
        }

    def is_open(self, name: str) -> bool:
        """True if the opening of an object with a lid is free."""
        each = self._lids[name]
        if each.seat is None:
            return bool(self._joint_position(each) > np.radians(30.0))  # lets the contents out
        return name in self._off

    def loose(self) -> dict[str, tuple[Array, Array]]:
        """R_WL and p_WL of the lids that are off, by the names of their objects."""
        poses = {name: self._pose(each) for name, each in self._lids.items() if name in self._off}
        return {n: (X_WL.rotation().matrix(), X_WL.translation()) for n, X_WL in poses.items()}

    def poses(self) -> dict[str, Array]:
        """Poses X_WL of the lids that come off, quaternion (w, x, y, z) and p_WL, shape (7,)."""
        return {
            name: pose_row(self._pose(each))
            for name, each in self._lids.items()
            if each.seat is not None
        }

    def _pose(self, each: LidBody) -> RigidTransform:
        return self._plant.EvalBodyPoseInWorld(self._context, each.body)

    def _snap(self) -> None:
        tau = np.zeros(self._plant.num_velocities())
        for each in self._snapping.values():
            left = max(0.0, 1.0 - max(0.0, self._joint_position(each)) / each.catch_angle)
            tau[each.joint.velocity_start()] = -each.catch_torque * left
        self._plant.get_applied_generalized_force_input_port().FixValue(self._context, tau)

    def _joint_position(self, each: LidBody) -> float:
        """Position of hinge, slide or thread [rad], [m]."""
        return float(each.joint.GetOnePosition(self._context))

    def _from_seat(self, each: LidBody) -> RigidTransform:
        """Pose of a lid in its seat."""
        assert each.seat is not None
        X_WS = self._plant.EvalBodyPoseInWorld(self._context, each.seat)
        return X_WS.InvertAndCompose(self._pose(each))

    def _is_seated(self, each: LidBody) -> bool:
        X_SL = self._from_seat(each)
        x, y, z = X_SL.translation()
        upright = X_SL.rotation().matrix()[2, 2] > np.cos(np.radians(6.0))
        return bool(np.hypot(x, y) < 0.004 and z < 0.002 and upright)  # [m]

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
        if each.slides:
            each.joint.set_translation(self._context, 0.0)
            each.joint.set_translation_rate(self._context, 0.0)
        self._touch_own(each, touches=True)
        self._off.add(name)

    def _seat(self, each: LidBody) -> None:
        """Moves a lid to where its seat is."""
        X_WS = self._plant.EvalBodyPoseInWorld(self._context, each.seat)
        self._plant.SetFreeBodyPose(self._context, each.body, X_WS)

    def _share(self, each: LidBody, *, on: bool) -> None:
        inertias = each.on if on else each.off
        for body, inertia in zip((each.seat, each.body), inertias, strict=True):
            body.SetSpatialInertiaInBodyFrame(self._context, inertia)

    def _touch_own(self, each: LidBody, *, touches: bool) -> None:
        """Lets a lid touch its own object or not; one that is on is held to it by its joint."""
        from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

        pair = GeometrySet([*each.solids, *each.feet]), GeometrySet([each.own])
        filters = CollisionFilterDeclaration()
        changed = filters.AllowBetween(*pair) if touches else filters.ExcludeBetween(*pair)
        self._scene_graph.collision_filter_manager(self._scene_context).Apply(changed)


@dataclass
class _Filled:
    """A container and what is in it now.

    Attributes:
        truth: as the scene has it.
        vessel: its cavity.
        container: its liquid.
        volume: in it now [m³].
        middle: centre of that volume in B [m].
        up: the vertical in B for which this holds.
        restless: whether it may run over its lip though it does not move: it did in the last step,
            or something was poured in.
    """

    truth: Truth
    vessel: Vessel
    container: Container
    volume: float
    middle: Array
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    restless: bool = False


class Liquid:
    """Keeps the contents of all containers: liquid that runs out, is caught or is spilled.

    Model: at rest at every instant (`objectmodels.models.object_parts`), with the flow and the
    stream of `objectmodels.containers.pour_dynamics`; between control steps both stay as they are.
    A stream is caught by the highest open container whose opening it passes through, and arrives at
    once; what is too much for that one runs over. All else is spilled and gone. A lid that is not
    open keeps everything in, and out. Each container's liquid has the density of its own.

    A body's mass and centre of mass follow its contents; what it is made of besides stays. Its
    radii of gyration about the centre of mass stay too.

    Attributes:
        contents: per container, volume in it [m³].
        spilled: volume that ran out and into none of them [m³].
    """

    def __init__(
        self,
        model: Standing,
        root: Context,
        scene: Scene,
        is_open: Callable[[str], bool] = lambda _: False,
    ) -> None:
        self._model = model
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._period = 1.0 / scene.control_rate_hz
        self._is_open = is_open
        self._filled = {
            item.name: _filled_container(item.truth)
            for item in scene.objects
            if item.truth.container
        }
        self._bare = {
            name: model.bodies[name].CalcSpatialInertiaInBodyFrame(self._context)
            for name in self._filled
        }
        self.contents = {name: filled.volume for name, filled in self._filled.items()}
        self.spilled = 0.0

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: lets run out what stands above a lip, moves what moved inside."""
        del touched
        for name in self._filled:
            if name in poses:
                self._run(name, poses)
        for name, filled in self._filled.items():
            if name in poses:
                self._settle(name, filled, poses[name][0][2])

    def levels(self, poses: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
        """Heights of the liquids over the bottoms of open containers that stand upright [m]."""
        return {
            name: filled.volume / filled.vessel.section.area
            for name, filled in self._filled.items()
            if name in poses
            and poses[name][0][2, 2] > math.cos(math.radians(5.0))
            and not self._is_closed(name)
        }

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object with the contents that it has now."""
        filled = self._filled.get(name)
        if filled is None:
            return truth
        mass, middle = _with_contents(truth.mass_kg, np.array(truth.centre_of_mass), filled)
        contents = filled.container.model_copy(update={"contents_l": 1e3 * filled.volume})
        changes = {"mass_kg": mass, "centre_of_mass_m": tuple(middle.tolist())}
        return truth.model_copy(update={**changes, "container": contents})

    def _is_closed(self, name: str) -> bool:
        return self._filled[name].truth.lid is not None and not self._is_open(name)

    def _run(self, name: str, poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Lets run out of a container what does so in a step, into what catches it."""
        filled = self._filled[name]
        R_WB, p_WB = poses[name]
        still = not filled.restless and _near(filled.up, R_WB[2])
        if filled.volume <= 0.0 or still or self._is_closed(name):
            return
        vessel, (tilt, heading) = filled.vessel, lean_of(R_WB[2])
        above = filled.volume - float(vessel.brim(tilt, heading))
        filled.restless = above > 0.0
        if not filled.restless:
            return
        head = float(vessel.liquid_head(filled.volume, tilt, heading))
        flow = float(outflow_rate(head, tilt, vessel.opening.radius))
        volume = min(flow * self._period, above)
        filled.volume -= volume
        into = None
        # What leans less runs over all round, down its own sides.
        if tilt > 0.02:
            p_WL = p_WB + R_WB @ vessel.lip_point(heading)
            ahead = R_WB[:2, 2] / max(math.hypot(*R_WB[:2, 2]), 1e-12)
            into = self._catching(name, p_WL, ahead, head, tilt, poses)
        if into is None:
            self.spilled += volume
        else:
            self._filled[into].volume += volume
            self._filled[into].restless = True

    def _catching(
        self,
        source: str,
        p_WL: Array,
        ahead: Array,
        head: float,
        tilt: float,
        poses: Mapping[str, tuple[Array, Array]],
    ) -> str | None:
        """The container through whose opening a stream falls that leaves a lip."""
        found: list[tuple[float, str]] = []
        for name, filled in self._filled.items():
            if name == source or name not in poses or self._is_closed(name):
                continue
            R_WB, p_WB = poses[name]
            opening = filled.vessel.opening
            p_WO = p_WB + R_WB @ np.array([*opening.centre, filled.vessel.top])
            fall = p_WL[2] - p_WO[2]
            if fall <= 0.0 or R_WB[2, 2] < 0.5:  # it leans by more than 60°
                continue
            lands = p_WL[:2] + ahead * float(landing_distance(head, tilt, fall))
            if math.dist(lands, p_WO[:2]) < opening.radius:
                found.append((p_WO[2], name))
        return max(found)[1] if found else None

    def _settle(self, name: str, filled: _Filled, up: Array) -> None:
        """Lets a body's inertia follow its contents, if anything changed."""
        from pydrake.multibody.tree import SpatialInertia

        if filled.volume == self.contents[name] and _near(filled.up, up):
            return
        self.contents[name] = filled.volume
        filled.up = up.copy()
        if filled.volume > 0.0:
            filled.middle = filled.vessel.centroid(filled.volume, *lean_of(up))
        bare = self._bare[name]
        com = bare.get_com()
        mass, middle = _with_contents(bare.get_mass(), com, filled)
        G_BBcm = bare.get_unit_inertia().ShiftToCenterOfMass(com)
        changed = SpatialInertia(mass, middle, G_BBcm.ShiftFromCenterOfMass(middle))
        self._model.bodies[name].SetSpatialInertiaInBodyFrame(self._context, changed)


def lean_of(up: Array) -> tuple[float, float]:
    """Lean of a body in which the vertical is `up`, and its direction in x, y there [rad]."""
    x, y, z = up.tolist()
    return math.atan2(math.hypot(x, y), z), math.atan2(-y, -x)


def _filled_container(truth: Truth) -> _Filled:
    container, vessel = truth.container, truth.vessel
    assert container is not None
    assert vessel is not None
    middle = vessel.centroid(container.contents, 0.0, 0.0)
    return _Filled(truth, vessel, container, container.contents, middle)


def _with_contents(mass: float, middle: Array, filled: _Filled) -> tuple[float, Array]:
    """Mass and centre of mass of a body with the contents of now instead of those at the start."""
    density, before = filled.container.density, filled.container.contents
    at_first = filled.vessel.centroid(before, 0.0, 0.0)
    now = mass + density * (filled.volume - before)
    moment = mass * middle + density * (filled.volume * filled.middle - before * at_first)
    return now, moment / now


def _near(before: Array, now: Array) -> bool:
    """True if the vertical in B is so much the same that the contents are where they were."""
    return bool(np.abs(now - before).max() < 1e-3)
