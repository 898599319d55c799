"""What lies on another face is pushed as it lies there, tipped on, and stood up."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from objectmodels import BoxModel, Registry
from planner import plan
from planner.affordances import hand_affordances
from planner.problem.predicted_states import state_after
from planner.types.actions import LiftUp, SetDown, TurnOver
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan, Reached
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import TABLE, RuledReach, frame_of, planned
from tests.unit.planner.grasping.conftest import CONTACTS, HAND, RuledHand

ROUNDING = 1e-9
CUBE = BoxModel(name="cube", size=(0.08, 0.08, 0.08), mass=0.3, friction=1.0, finger_friction=0.4)


def lying(name: str, axis: str, degrees: float, yaw: float = 0.4) -> WorldState:
    """A thing on an empty table, turned about an axis of its own, then about the vertical."""
    model = CUBE if name == "cube" else Registry.built_in().get(name)
    attitude = tuple(Rotation.from_euler(axis, degrees, degrees=True).as_matrix().ravel().tolist())
    seen = SeenObject.lying(name, PlanarPose(0.5, 0.0, yaw, attitude), model)
    return WorldState({name: seen}, TABLE)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_what_lies_is_pushed_by_the_model_of_the_face_below(axis: str) -> None:
    state = lying("coffee box", axis, 90.0)
    seen = state.objects["coffee box"]
    push = planned("push the coffee box 10 cm away", state).push
    # 62 mm or 93 mm high as it lies; it stands 180 mm high.
    assert seen.model.top == pytest.approx(0.093 if axis == "x" else 0.062)
    assert push.p_BC[2] < seen.model.top
    normal = seen.pose.R_WB.T @ push.normal_W
    there = seen.model.thresholds([push.p_BC], [-normal])
    assert push.prediction.slide_force == pytest.approx(float(there.slide[0]), rel=0.1)
    found = state_after(planned("push the coffee box 10 cm away", state), state)
    assert found is not None
    after = found.objects["coffee box"]
    assert after.lies_on == seen.lies_on
    assert after.pose.x - seen.pose.x == pytest.approx(0.1)


def test_what_is_toppled_on_and_on_comes_around() -> None:
    state = WorldState({"cube": SeenObject("cube", PlanarPose(0.4, 0.0), CUBE)}, TABLE)
    faces = []
    for _ in range(4):
        after = state_after(planned("topple the cube away", state), state)
        assert after is not None
        # An edge of 80 mm on; rounding alone.
        moved = after.objects["cube"].pose.x - state.objects["cube"].pose.x
        assert moved == pytest.approx(0.08, abs=ROUNDING)
        state = after
        faces.append(state.objects["cube"].lies_on)
    assert faces == ["back", "top", "front", "bottom"]


def test_what_lies_on_its_round_side_would_roll() -> None:
    for said in ("push the soup can away", "stand the soup can up", "lift the soup can"):
        made = plan(frame_of(said), lying("soup can", "x", 90.0), RuledHand())
        assert isinstance(made, Refusal)
        assert made.code == "rolls"
    leaning = plan(frame_of("push the book away"), lying("book", "x", 40.0), RuledReach())
    assert isinstance(leaning, Refusal)
    assert leaning.code == "leans"


@pytest.mark.parametrize(("axis", "degrees"), [("x", 90.0), ("y", 180.0)])
def test_what_lies_is_turned_over_in_the_hand(axis: str, degrees: float) -> None:
    state, hand = lying("ice tea", axis, degrees), RuledHand()
    made = plan(frame_of("stand the ice tea up"), state, hand)
    assert isinstance(made, Plan), made
    lift, turn, down = made.steps
    assert isinstance(lift, LiftUp)
    assert isinstance(turn, TurnOver)
    assert isinstance(down, SetDown)
    seen = state.objects["ice tea"]
    R_WB, _ = seen.body_pose
    R = Rotation.from_rotvec(turn.angle * np.array(turn.axis_W)).as_matrix()
    np.testing.assert_allclose((R @ R_WB)[:, 2], [0.0, 0.0, 1.0], atol=ROUNDING)
    # The fingers do not come from below, and the object never touches the table as it turns.
    assert made.grasp is not None
    assert (R @ made.grasp.approach_W)[2] <= 0.2
    shares = np.linspace(0.0, 1.0, 50)[:, None]
    way = Rotation.from_rotvec(shares * turn.angle * np.array(turn.axis_W)).as_matrix()
    middle = np.array(made.grasp.p_BG)
    corners = [(x, y, z) for x, y in seen.model.outline for z in (0.0, seen.model.top)]
    off = (np.array(corners) - middle) @ seen.pose.R_WB.T
    lowest = (off @ np.swapaxes(way, 1, 2))[..., 2].min()
    # A millimetre for what lies between the orientations that are looked at.
    assert lowest + middle[2] + lift.height > DEFAULTS.carry_clearance - 0.001
    after = state_after(made, state)
    assert after is not None
    there = after.objects["ice tea"]
    assert (there.lies_on, there.model) == ("bottom", seen.standing_model)
    assert made.aim is not None
    assert made.aim.yaw == pytest.approx(Rotation.from_matrix(R @ R_WB).as_euler("zyx")[0])


def test_a_hand_from_above_may_end_pointing_to_a_side() -> None:
    """Where it cannot end pointing one way, another is tried."""

    def heading(made: Plan) -> float:
        turn = made.steps[1]
        assert isinstance(turn, TurnOver)
        assert made.grasp is not None
        R = Rotation.from_rotvec(turn.angle * np.array(turn.axis_W)).as_matrix()
        x, y, _ = R @ made.grasp.approach_W
        return float(np.degrees(np.arctan2(y, x)))

    hand = RuledHand(holds=lambda made: heading(made) > 60.0)
    made = plan(frame_of("stand the ice tea up"), lying("ice tea", "x", 90.0), hand)
    assert isinstance(made, Plan), made
    assert heading(made) > 60.0
    assert min(heading(each) for each in hand.plans) < 0.0


def test_something_low_is_held_up_to_its_rim_where_lower_fingers_would_hit_the_table() -> None:
    def highest_contact(made: Plan) -> float:
        assert made.grasp is not None
        up = np.cross(made.grasp.approach_W, made.grasp.closing_W)[2]
        return float(made.grasp.p_BG[2] + np.abs(CONTACTS[:, 1] * up).max())

    state, tip = lying("coffee box", "y", 90.0), HAND.fingertip_radius
    top = state.objects["coffee box"].model.top
    hand = RuledHand(holds=lambda made: highest_contact(made) > top - tip + ROUNDING)
    made = plan(frame_of("stand the coffee box up"), state, hand)
    assert isinstance(made, Plan), made
    # 4 mm are left to the border of a side.
    assert highest_contact(made) == pytest.approx(top - 0.004, abs=ROUNDING)


def test_what_no_hand_turns_is_tipped_onto_its_bottom() -> None:
    """A book on its edge falls flat; on its back there is no edge for that."""
    made = planned("stand the book up", lying("book", "x", 90.0))
    assert made.push.ends_on == "toppled"
    after = state_after(made, lying("book", "x", 90.0))
    assert after is not None
    assert after.objects["book"].lies_on == "bottom"
    on_its_top = plan(frame_of("stand the book up"), lying("book", "x", 180.0), RuledReach())
    assert isinstance(on_its_top, Refusal)
    assert on_its_top.code == "no_edge"


def test_what_stands_is_left_alone() -> None:
    state = WorldState({"cube": SeenObject("cube", PlanarPose(0.4, 0.0), CUBE)}, TABLE)
    for robot in (RuledHand(), RuledReach()):
        assert isinstance(plan(frame_of("stand the cube up"), state, robot), Reached)
    held = state_after(planned("lift the cube", state, RuledHand()), state)
    assert held is not None
    down = plan(frame_of("stand the cube up"), held, RuledHand())
    assert isinstance(down, Plan)
    assert down.steps == (SetDown(),)


def test_standing_up_is_an_affordance_of_what_lies() -> None:
    state = lying("sugar box", "x", 90.0)
    seen = state.objects["sugar box"]
    found = {a.outcome: a for a in hand_affordances(seen, state, RuledHand(), DEFAULTS)}
    assert found["stand"].can
    upright = SeenObject("sugar box", PlanarPose(0.5, 0.0), seen.standing_model)
    there = WorldState({"sugar box": upright}, TABLE)
    assert {a.outcome for a in hand_affordances(upright, there, RuledHand(), DEFAULTS)} == {"lift"}
