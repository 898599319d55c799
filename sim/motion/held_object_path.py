"""The object that a hand holds, and its way, leg after leg.

A lid that comes off is held by its knob or its rim, from above. The hand treats it as an upright
cylinder of its own, on the object's top or where it lies aside; its frame stands at the middle of
its lower side and has the headings of the object's B. The camera tells how far a lid is open, and
not where one is in the hand.

On a leg a point goes straight and the rest turns evenly about it. An object that the hand has yet
to reach, or has left, is thought to hang in the hand as well, so that one kind of leg serves
everything. While something is poured the lip is the point: it stays where it is put. It comes down
to the other object's rim only when the held one leans so far that its body is no more in the way.

Frames: W is the world, B the held object, C a point of it, G the middle of the grasp.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from objectmodels.containers import lids
from objectmodels.geometry.rotations import Array, axis_rotation, spatial_cross, wrap
from objectmodels.geometry.side_faces import SidePress
from objectmodels.models.object_parts import ScrewCap
from planner.types.actions import (
    Action,
    Carry,
    Grasp,
    GraspAction,
    LiftUp,
    PourOut,
    PutOn,
    SetDown,
    SetOn,
    TurnCap,
    TurnOver,
)
from planner.types.plan import LIFT_SPEED, Plan
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.motion.collision_scene import Obstacle

THREAD = 2.0 * np.pi
"""Turn of a cap in which it rises by its pitch [rad]."""

CARRY_SPEED, REACH_SPEED = 0.12, 0.10
"""Of the hand that carries, and reaches for something [m/s]."""

_TURN_SPEED, _RIGHTING_SPEED = 0.6, 0.9  # about the vertical; upright after pouring [rad/s]
_BEYOND = 0.03  # how far the open hand is drawn off from what it is to hold, beyond its end [m]


@dataclass(frozen=True, eq=False)
class HeldSegment:
    """A point C of the held object goes straight while it turns evenly about an axis.

    Attributes:
        phase: of the trace.
        R_WB: orientation at the start, shape (3, 3).
        p_BC: the point, shape (3,) [m].
        start, end: where it is in W, shape (3,) [m].
        axis: of the turn in W, shape (3,).
        turn: angle altogether [rad].
        speed, rate: largest ones of the point [m/s] and of the turn [rad/s].
        free: whether the hand is open, and the object stands where the leg begins or ends.
    """

    phase: str
    R_WB: Array
    p_BC: Array
    start: Array
    end: Array
    axis: Array
    turn: float
    speed: float
    rate: float
    free: bool = False

    def poses_at(self, shares: Array) -> tuple[Array, Array]:
        """R_WB, shape (n, 3, 3), and p_WB, shape (n, 3), after shares of the leg, shape (n,)."""
        R_WB = axis_rotation(self.axis, self.turn * shares) @ self.R_WB
        p_WC = self.start + shares[:, None] * (self.end - self.start)
        return R_WB, p_WC - R_WB @ self.p_BC

    def sample_shares(self) -> Array:
        """Shares between which nothing is missed."""
        far = np.linalg.norm(self.end - self.start)
        # Every 25 mm and every 8°.
        n = int(np.ceil(max(far / 0.025, abs(self.turn) / np.radians(8.0), 1.0)))
        return np.linspace(0.0, 1.0, n + 1)

    @property
    def share_rate(self) -> float:
        """Largest share of the leg per time [1/s]."""
        far = float(np.linalg.norm(self.end - self.start))
        return min(self.speed / max(far, 1e-9), self.rate / max(abs(self.turn), 1e-9))

    @property
    def end_pose(self) -> tuple[Array, Array]:
        """R_WB and p_WB at the end."""
        R_WB, p_WB = self.poses_at(np.ones(1))
        return R_WB[0], p_WB[0]

    def way_back(self, **changes: object) -> HeldSegment:
        """The same leg the other way."""
        R_WB, _ = self.end_pose
        there = replace(self, R_WB=R_WB, start=self.end, end=self.start, turn=-self.turn)
        return replace(there, **changes)  # type: ignore[arg-type]


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
    def start_pose(self) -> tuple[Array, Array]:
        """R_WB and p_WB of what is held, where it is taken."""
        pose = self.held.pose
        return pose.R_WB, pose.p_WB + np.array([0.0, 0.0, self.height])

    def palm_at(self, middle: Array) -> tuple[Array, Array]:
        """R_BP, shape (3, 3), and p_BP, shape (3,) [m], of the palm as it holds the object.

        The middle of the grasp in P is (3,) [m].
        """
        R_BP, p_BG = grasp_frame(self.grasp, self.held.pose.R_WB)
        return R_BP, p_BG - R_BP @ middle

    def outer_press(self, contacts: Array, tip_radius: float) -> SidePress:
        """How the outer fingertips press on what is held.

        Args:
            contacts: as of `planner.types.robot.Grip`, shape (k, 2) [m].
            tip_radius: of the fingertips [m].
        """
        R_BG, _ = grasp_frame(self.grasp, self.held.pose.R_WB)
        closing, _, approach = R_BG.T
        faces = self.held.model.faces(np.array([math.atan2(closing[1], closing[0])]))
        side = min(faces, key=lambda face: float(closing @ face.normal))
        return SidePress.on_face(side, closing, approach, contacts, tip_radius)

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


def grasp_frame(grasp: Grasp, R_WB: Array) -> tuple[Array, Array]:
    """R_BG, shape (3, 3), whose axes are those of the palm, and p_BG, shape (3,) [m].

    The object stands at R_WB, shape (3, 3).
    """
    closing, approach = np.array(grasp.closing_W), np.array(grasp.approach_W)
    R_WG = np.column_stack([closing, spatial_cross(approach, closing), approach])
    return R_WB.T @ R_WG, np.array(grasp.p_BG)


def withdrawal_vectors(grasp: Grasp, held: SeenObject) -> tuple[Array, ...]:
    """Ways of the open hand off what it holds, in W: back along its fingers, or straight up."""
    approach = np.array(grasp.approach_W)
    corners = np.vstack(
        [
            np.c_[held.model.outline, np.full(len(held.model.outline), z)]
            for z in (0.0, held.model.top)
        ]
    )
    off = (corners - np.array(grasp.p_BG)) @ held.pose.R_WB.T
    back = -(_BEYOND + float(np.max(off @ -approach))) * approach
    half_hand = 0.04  # of index and ring about the middle finger, with their thickness [m]
    up = np.array([0.0, 0.0, _BEYOND + held.model.top - grasp.p_BG[2] + half_hand])
    return (back,) if approach[2] < -0.7 else (back, up)


def step_segments(handled: HeldObject) -> tuple[tuple[HeldSegment, ...], ...]:
    """The legs of each step of a plan."""
    R_WB, p_WB = handled.start_pose
    made: list[tuple[HeldSegment, ...]] = []
    fastest = math.inf if handled.plan.speed is None else handled.plan.speed
    for step in handled.plan.steps:
        legs = _step_segments(step, handled, R_WB, p_WB)
        made.append(tuple(replace(leg, speed=min(leg.speed, fastest)) for leg in legs))
        if made[-1]:
            R_WB, p_WB = made[-1][-1].end_pose
    return tuple(made)


def free_segments(
    handled: HeldObject, off: Array, steps: tuple[tuple[HeldSegment, ...], ...]
) -> tuple[tuple[HeldSegment, ...], tuple[HeldSegment, ...]]:
    """The legs of the open hand before and after the steps.

    Args:
        handled: what is held, and the plan.
        off: the way of the open hand off it, in W, shape (3,) [m].
        steps: the legs of each step.

    Returns:
        Of either there is one, or none where the hand holds it already, or still does.
    """
    R_WB, p_WB = handled.start_pose
    there = _straight_segment("approach", R_WB, p_WB + off, p_WB, REACH_SPEED, free=True)
    before = () if handled.grasp.held else (there,)
    if not isinstance(handled.plan.steps[-1], SetDown | SetOn | PutOn | TurnCap):
        return before, ()
    ends = [legs[-1].end_pose for legs in steps if legs]
    R_WE, p_WE = ends[-1] if ends else (R_WB, p_WB)
    # The hand may have turned about the vertical meanwhile.
    away = R_WE @ handled.held.pose.R_WB.T @ off
    back = _straight_segment("retreat", R_WE, p_WE, p_WE + away, REACH_SPEED, free=True)
    return before, (back,)


def _step_segments(
    step: Action, handled: HeldObject, R_WB: Array, p_WB: Array
) -> Iterator[HeldSegment]:
    """The legs of a step that begins somewhere."""
    if isinstance(step, LiftUp):
        up = np.array([0.0, 0.0, step.height])
        yield _straight_segment("lift", R_WB, p_WB, p_WB + up, LIFT_SPEED)
    elif isinstance(step, Carry):
        turn = 0.0
        if step.to.yaw is not None:
            turn = float(wrap(step.to.yaw - np.arctan2(R_WB[1, 0], R_WB[0, 0])))
        end = np.array([step.to.x, step.to.y, p_WB[2]])
        yield replace(_straight_segment("carry", R_WB, p_WB, end, CARRY_SPEED), turn=turn)
    elif isinstance(step, TurnOver):
        yield _turning_segment(step, handled, R_WB, p_WB)
    elif isinstance(step, PourOut):
        yield from _pour_segments(step, handled.held, R_WB, p_WB)
    elif isinstance(step, SetDown):
        # As high as B's origin is when it stands on the table in that orientation.
        held = handled.held
        corners = [[x, y, z] for z in (0.0, held.model.top) for x, y in held.model.outline]
        height = float(np.round(-(np.array(corners) @ R_WB[2]).min(), 9)) + 0.0
        stands = np.array([*p_WB[:2], height])
        yield _straight_segment("set_down", R_WB, p_WB, stands, LIFT_SPEED)
    elif isinstance(step, SetOn):
        on = np.array([*p_WB[:2], step.height])
        yield _straight_segment("set_down", R_WB, p_WB, on, LIFT_SPEED)
    elif isinstance(step, PutOn):
        on = np.array([*p_WB[:2], handled.seat])
        yield _straight_segment("lid", R_WB, p_WB, on, LIFT_SPEED)
    elif isinstance(step, TurnCap):
        yield from _turn_segments(step, handled.pitch, R_WB, p_WB)


def _straight_segment(
    phase: str, R_WB: Array, start: Array, end: Array, speed: float, *, free: bool = False
) -> HeldSegment:
    up = np.array([0.0, 0.0, 1.0])
    return HeldSegment(phase, R_WB, np.zeros(3), start, end, up, 0.0, speed, _TURN_SPEED, free)


def _turn_segments(step: TurnCap, pitch: float, R_WB: Array, p_WB: Array) -> Iterator[HeldSegment]:
    """Turns of the held cap, and of the open hand back between them."""
    # A wrist turns a cap by no more before it grips anew.
    strokes = max(1, int(np.ceil(abs(step.angle) / np.radians(125.0))))
    turn = step.angle / strokes
    rise = np.array([0.0, 0.0, pitch * turn / THREAD])
    for k in range(strokes):
        leg = replace(_straight_segment("lid", R_WB, p_WB, p_WB + rise, LIFT_SPEED), turn=turn)
        yield leg
        _, p_WB = leg.end_pose
        if k < strokes - 1:
            yield leg.way_back(start=p_WB, end=p_WB, free=True)


def _turning_segment(step: TurnOver, handled: HeldObject, R_WB: Array, p_WB: Array) -> HeldSegment:
    p_BG, axis = np.array(handled.grasp.p_BG), np.array(step.axis_W)
    middle = p_WB + R_WB @ p_BG
    fastest = math.inf if handled.plan.speed is None else handled.plan.speed
    rate = min(_TURN_SPEED, fastest / float(np.linalg.norm(p_BG)))
    return HeldSegment("carry", R_WB, p_BG, middle, middle, axis, step.angle, CARRY_SPEED, rate)


def _pour_segments(
    step: PourOut, held: SeenObject, R_WB: Array, p_WB: Array
) -> Iterator[HeldSegment]:
    """Over the other object, tilted there, and upright again where it came from."""
    lean = np.array([np.cos(step.heading), np.sin(step.heading), 0.0])
    axis = np.cross([0.0, 0.0, 1.0], lean)
    p_BC = lip_point(held, R_WB.T @ lean)
    here, there = p_WB + R_WB @ p_BC, np.array(step.lip_W)
    over = np.array([*there[:2], max(here[2], there[2])])
    # Tilts between which the lip comes down; shares of the largest one if that is little.
    lowers = np.minimum(np.radians([52.0, 74.0]), np.multiply([0.55, 0.85], step.angle))
    tilts = np.array([0.0, *lowers, step.angle])
    places = [over, over, there, there]
    first = HeldSegment("carry", R_WB, p_BC, here, over, axis, 0.0, CARRY_SPEED, step.rate)
    tilting = [
        replace(
            first,
            phase="pour",
            R_WB=axis_rotation(axis, tilts[k]) @ R_WB,
            start=places[k],
            end=places[k + 1],
            turn=float(tilts[k + 1] - tilts[k]),
        )
        for k in range(3)
    ]
    yield first
    yield from tilting
    for leg in reversed(tilting):
        yield leg.way_back(rate=_RIGHTING_SPEED)
    yield first.way_back()


def lip_point(held: SeenObject, lean_B: Array) -> Array:
    """The point of the opening's rim that comes lowest when the object leans, in B, shape (3,).

    It leans in a horizontal unit direction in B, shape (3,).
    """
    container = held.model.container
    assert container is not None, "only a container is poured from"
    x, y = np.array(container.opening.centre) + container.opening.radius * lean_B[:2]
    return np.array([x, y, held.model.top])


def upright_again(
    done: Sequence[HeldSegment], leg: HeldSegment, share: float
) -> tuple[HeldSegment, ...]:
    """The way back upright after legs that were made, and a share of the last one."""
    R_WB, _ = leg.poses_at(np.array([share]))
    here = leg.start + share * (leg.end - leg.start)
    rest = replace(leg, R_WB=R_WB[0], start=here, end=leg.start, turn=-share * leg.turn)
    way = [rest, *(each.way_back() for each in reversed(done))]
    return tuple(replace(each, rate=max(each.rate, _RIGHTING_SPEED)) for each in way)


def attractor_points(
    start: Array, target: Array, *, speed: float, acceleration: float, period: float
) -> Iterator[Array]:
    """Points on the way from `start` to `target`, one per period; the last one is the target.

    A point attractor: the velocity points at the target, is no faster than allowed and changes no
    faster than an acceleration allows; near the target it is what still lets it stop there. The
    point may be that of the fingertips in W or the joint angles of the arm: a point that starts at
    rest then moves on the straight line to its target, which is what was checked for collisions.

    Args:
        start: where the point is, at rest, shape (n,).
        target: where it is pulled, shape (n,).
        speed: largest speed [units/s].
        acceleration: largest change of the velocity [units/s²].
        period: time between two points [s].
    """
    point, velocity = np.array(start, dtype=float), np.zeros(len(start))
    arrived = 1e-6
    while True:
        way = target - point
        distance = float(np.linalg.norm(way))
        if distance < arrived:
            if distance > 0.0:
                yield target.copy()
            return
        # Speed from which it can stop at the target, in whole periods.
        stopping = np.sqrt(2.0 * acceleration * distance + (acceleration * period / 2) ** 2)
        allowed = min(speed, max(stopping - acceleration * period / 2, arrived / period))
        change = allowed * way / distance - velocity
        most = acceleration * period
        velocity = velocity + change * min(1.0, most / max(float(np.linalg.norm(change)), 1e-12))
        step = velocity * period
        point = target.copy() if np.linalg.norm(step) >= distance else point + step
        yield point
