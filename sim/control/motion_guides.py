"""Guides: the executor's way with a plan, as numbers for the controller of another arm.

Places, speeds and conditions are those that the executor itself goes by: the fingertips' path, the
guarded touch, the guards, the legs of what is held. Nothing is searched for but the stance of the
standard hand in a push, which its planner found before.

Frames: W is the world, B the object's, G the middle of a grasp, E the hinge of a lid.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from objectmodels.geometry.rotations import Array
from planner.types.actions import FlipOver, Grasp, PourOut, PushAction, TurnCap, Vector3
from planner.types.plan import (
    FlipGuide,
    GraspGuide,
    HandLeg,
    MotionGuide,
    Plan,
    PushGuide,
    StopCondition,
)
from planner.types.robot import ReachAnswer, Robot
from planner.types.world_state import SeenObject, WorldState, plain_vector
from sim.control.grasp_control import CLOSING_SPEED, FlipControl, flip_guards, force_limits_at
from sim.control.guarded_touch import NO_TOUCH, TOUCH_SPEED, touch_force
from sim.control.guards import RAMP, planned_ends, push_guards, sentence_guards, stop_conditions
from sim.control.held_object_sensing import (
    CONTACT,
    LidEstimator,
    cap_guard,
    contact_guard,
    others_guard,
    slip_guard,
)
from sim.control.push_control import FASTEST_START
from sim.motion.fingertip_path import BACK, FingertipPath
from sim.motion.held_object_path import (
    REACH_SPEED,
    HeldObject,
    HeldSegment,
    step_segments,
    withdrawal_vectors,
)
from sim.motion.robot_reach import ArmHandReach
from sim.robots.cell_description import Vision
from sim.robots.lid_path import LidPath, hinge_pose, lid_shape


def motion_guide(plan: Plan, state: WorldState, robot: Robot) -> MotionGuide:
    """The committed part of a plan, for a guarded Cartesian controller.

    Args:
        plan: what to do.
        state: what is believed.
        robot: that the plan was made for.
    """
    if plan.pushes:
        return _push_guide(plan.push, state, robot)
    if plan.grasp is not None:
        return _grasp_guide(plan, state, robot)
    (step,) = plan.steps
    assert isinstance(step, FlipOver), "an empty hand only flips lids"
    return _flip_guide(step, state.objects[plan.object], robot.limits.fingertip_radius)


def _push_guide(push: PushAction, state: WorldState, robot: Robot) -> PushGuide:
    seen, radius = state.objects[push.object], robot.limits.fingertip_radius
    way = FingertipPath.from_push(push, seen, radius)
    left = np.cross([0.0, 0.0, 1.0], way.R_WD[:, 0])
    asides = np.linspace(0.5, -0.5, push.fingers) * push.spread
    return PushGuide(
        object=push.object,
        contact_W=plain_vector(way.touch - radius * np.array(push.normal_W)),
        fingertips_W=tuple(plain_vector(way.touch + aside * left) for aside in asides),
        tip_radius=radius,
        start_W=plain_vector(way.start),
        inward_W=plain_vector(way.inward),
        fingers_W=_fingers(push, state, robot),
        touch_speed=TOUCH_SPEED,
        touch_force=touch_force(push.prediction.onset),
        touch_travel=NO_TOUCH.limit,
        direction_W=push.direction_W,
        stroke=push.stroke,
        end_W=plain_vector(way.end),
        hand_turn=way.turn,
        tilt=push.tilt,
        press=push.press,
        force_limit=push.force_limit,
        force_rise=RAMP,
        first_speed=min(FASTEST_START, push.speed),
        speed=push.speed,
        retreat=BACK,
        stop=stop_conditions(
            (
                NO_TOUCH,
                *planned_ends(push),
                *sentence_guards(push, state, Vision()),
                *push_guards(push),
            )
        ),
    )


def _fingers(push: PushAction, state: WorldState, robot: Robot) -> Vector3 | None:
    """Direction from the palm to the fingertips of the hand that was found for a push."""
    if not isinstance(robot, ArmHandReach):
        return None
    for reach in (robot, robot.thorough_reach):
        answer = reach.push_configuration(push, state)
        if not isinstance(answer, ReachAnswer):
            points = answer[0].R_WP @ answer[0].posture.tip_midpoint
            return plain_vector(points / np.linalg.norm(points))
    return None


def _grasp_guide(plan: Plan, state: WorldState, robot: Robot) -> GraspGuide:
    handled = HeldObject.from_plan(plan, state)
    grasp = handled.grasp
    R_WB, p_WB = handled.start_pose
    middle = p_WB + R_WB @ np.array(grasp.p_BG)
    off = withdrawal_vectors(grasp, handled.held)[0]
    thumb, *fingers = _contacts(handled, middle, robot)
    steps = step_segments(handled)
    return GraspGuide(
        object=handled.name,
        held=grasp.held,
        thumb_W=thumb,
        fingers_W=tuple(fingers),
        middle_W=plain_vector(middle),
        closing_W=grasp.closing_W,
        approach_W=grasp.approach_W,
        start_W=plain_vector(middle if grasp.held else middle + off),
        reach_speed=REACH_SPEED,
        close_speed=CLOSING_SPEED,
        contact_force=CONTACT,
        squeeze=grasp.squeeze,
        legs=tuple(_leg(segment) for legs in steps for segment in legs),
        stop=tuple(_grasp_ends(plan, grasp)),
    )


def _contacts(handled: HeldObject, middle: Array, robot: Robot) -> tuple[Vector3, ...]:
    """Contacts of the thumb and of the fingers that touch, in W [m]."""
    grasp = handled.grasp
    grip = robot.grasp(grasp.width, pinch=grasp.part != "body")
    assert grip is not None, "it was planned with a grip"
    closing, approach = np.array(grasp.closing_W), np.array(grasp.approach_W)
    aside = np.cross(approach, closing)
    sides = np.where(np.arange(len(grip.contacts)) == 0, 0.5, -0.5) * grasp.width
    press = handled.outer_press(grip.contacts, robot.limits.fingertip_radius)
    sides += np.where(grip.contacts[:, 1] == 0.0, 0.0, press.behind)
    points = (
        middle
        + sides[:, None] * closing
        + grip.contacts[:, :1] * approach
        + grip.contacts[:, 1:] * aside
    )
    return tuple(plain_vector(point) for point in points)


def _leg(segment: HeldSegment) -> HandLeg:
    return HandLeg(
        phase=segment.phase,
        open=segment.free,
        p_BC=plain_vector(segment.p_BC),
        start_W=plain_vector(segment.start),
        end_W=plain_vector(segment.end),
        axis_W=plain_vector(segment.axis),
        turn=float(segment.turn),
        speed=float(segment.speed),
        rate=float(segment.rate),
    )


def _grasp_ends(plan: Plan, grasp: Grasp) -> Iterator[StopCondition]:
    held = contact_guard(grasp.width), slip_guard(plan.object), others_guard()
    yield from stop_conditions(held)
    for step in plan.steps:
        if isinstance(step, TurnCap):
            yield from stop_conditions([cap_guard(step)])
        if isinstance(step, PourOut):
            told = f"it is tilted by {np.degrees(step.angle):.0f}°, or enough has run out"
            yield StopCondition(when="tilted", limit=step.angle, unit="rad", text=told)


def _flip_guide(step: FlipOver, seen: SeenObject, radius: float) -> FlipGuide:
    path = LidPath.from_lid(lid_shape(step, seen, radius))
    R_WE, p_WE = hinge_pose(seen)
    arc = path.points[path.touching] @ R_WE.T + p_WE
    forces = force_limits_at(step, path.shares[path.touching])
    view = LidEstimator(seen, step.start, Vision())
    return FlipGuide(
        object=seen.name,
        tip_radius=radius,
        hinge_W=plain_vector(p_WE),
        path_W=tuple(map(plain_vector, arc)),
        speed=step.speed,
        force_limit=step.force_limit,
        force_limits=tuple(forces.tolist()),
        stop=stop_conditions(flip_guards(step, view, FlipControl.tuning)),
    )
