"""Push, look, plan anew: until it is there, or nothing more can be done."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from planner.problem.directions import angle_between
from planner.types.defaults import DEFAULTS
from planner.types.end_reasons import EndReason
from planner.types.plan import Plan
from sim.traces.trace import Trace
from tests.fakes.played_executor import played
from tests.unit.nlcontrol.pushes import BOX, Happens, TraceMaker
from tests.unit.planner.conftest import RuledReach

SENTENCE = "push the ice tea box away without toppling it"
EXACT = 1e-6  # a camera without noise; what is left are sums of floats [m], [rad]


@pytest.fixture
def controller() -> Controller:
    return Controller(seed=1)


def tilted(happens: Happens) -> Happens:
    """Stopped because it tilted: the force rises before anything moves, and falls from then on."""

    def stopped(plan: Plan) -> Trace:
        trace = happens(plan)
        push = np.flatnonzero(trace.phase == "push")
        before, after = np.array_split(push, [len(push) // 3])
        rise = np.ones(len(trace.time))
        rise[before] = np.linspace(0.0, 1.0, len(before))
        rise[after] = np.linspace(1.0, 0.8, len(after))
        start = {name: p[push[0]] for name, p in trace.tips.items()}
        late = np.zeros(len(trace.time))
        late[after] = np.linspace(0.0, 1.0, len(after))
        late[push[-1] + 1 :] = 1.0
        tips = {
            name: start[name] + np.outer(late, p[-1] - start[name])
            for name, p in trace.tips.items()
        }
        felt = {name: rise[:, None] * f for name, f in trace.felt.items()}
        return replace(trace, end="tilted", tips=tips, felt=felt)

    return stopped


# -- until it is there --------------------------------------------------------------------------


def test_one_push_that_gets_there_is_enough(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes())
    result = Conversation(controller).say(SENTENCE)
    assert (result.ok, result.status, len(stage.executed)) == (True, "done", 1)
    (step,) = result.steps
    assert step.plans == (result.plan,) == tuple(stage.executed)
    assert step.stuck is None


def test_pushes_that_fall_short_are_followed_by_others(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes(share=0.4))
    result = Conversation(controller).say(SENTENCE)
    assert (result.ok, result.status) == (True, "done")
    left = [
        math.hypot(*plan.push.displacement[:2]) for plan in stage.executed if plan.push.displacement
    ]
    # Every push leaves 0.6 of the way, until that is below 2 mm.
    assert left == pytest.approx([0.1 * 0.6**k for k in range(len(left))], abs=EXACT)
    assert left[-1] > DEFAULTS.aim_position > 0.6 * left[-1]
    assert {plan.aim for plan in stage.executed} == {stage.executed[0].aim}
    assert (result.planned, result.plan) == (1, stage.executed[0])
    assert result.steps[0].plans == tuple(stage.executed)
    assert result.trace is not None
    assert len(result.trace.time) == sum(len(trace.time) for trace in stage.traces)


def test_what_went_too_far_is_pushed_back(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes(share=1.2), goes())
    result = Conversation(controller).say(SENTENCE)
    first, second = stage.executed
    assert (first.push.face, second.push.face) == ("front", "back")
    assert second.push.displacement == pytest.approx((-0.02, 0.0, 0.0), abs=EXACT)
    assert stage.moved == pytest.approx((0.1, 0.0), abs=EXACT)
    assert result.status == "done"


def test_over_two_faces(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes())
    result = Conversation(controller).say("push the ice tea box 14 cm away and to the left")
    assert (result.status, len(stage.executed)) == ("done", 2)
    assert {plan.push.face for plan in stage.executed} == {"front", "right"}
    assert stage.moved == pytest.approx((0.14 / math.sqrt(2), 0.14 / math.sqrt(2)), abs=EXACT)
    assert "What happened, in 2 pushes:" in str(result)


def test_nothing_is_pushed_that_is_there_already(controller: Controller) -> None:
    # In Drake: what is judged is what the camera sees while nothing is done.
    result = Conversation(controller).say("put the ice tea box at x 45 cm, y 0 cm")
    assert (result.ok, result.status, result.plan) == (True, "done", None)
    assert result.execution is not None
    assert result.execution.end == "reached"
    assert result.trace is not None
    assert set(result.trace.phase) == {"look"}
    assert result.checks
    assert "It is there already: nothing is to be done." in str(result)
    planned = Conversation(controller).say("put the ice tea box at x 45 cm, y 0 cm", plan_only=True)
    assert (planned.ok, planned.status, planned.plan) == (True, "planned", None)


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
@pytest.mark.slow
def test_half_a_turn_goes_on_where_headings_begin_anew(
    controller: Controller,
    goes: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
    side: str,
    sign: float,
) -> None:
    stage = played(controller, goes())
    result = Conversation(controller).say(f"turn the ice tea box 180 degrees to the {side}")
    assert (result.ok, result.status) == (True, "done")
    turns = [plan.push.turn for plan in stage.executed if plan.push.ends_on == "turned"]
    assert all(sign * turn > 0.0 for turn in turns)
    assert sum(plan.push.turn for plan in stage.executed) == pytest.approx(
        sign * math.pi, abs=DEFAULTS.aim_angle
    )
    assert {plan.aim for plan in stage.executed} == {stage.executed[0].aim}
    # The aim lies beyond the half circle in which headings are seen.
    aim = stage.executed[0].aim
    assert aim is not None
    assert aim.yaw == pytest.approx(stage.start.yaw + sign * math.pi)


@pytest.mark.slow
def test_a_turn_too_far_is_turned_back_not_around(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes(share=1.3), goes())
    result = Conversation(controller).say("turn the ice tea box 170 degrees to the left")
    assert result.status == "done"
    assert sum(abs(plan.push.turn) for plan in stage.executed) < math.tau
    here = stage.poses[BOX].yaw - stage.start.yaw
    assert angle_between(here, math.radians(170.0)) == pytest.approx(0.0, abs=DEFAULTS.aim_angle)


# -- ends that end a frame ----------------------------------------------------------------------


def test_the_event_is_the_end(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, goes(share=0.04, end="event", force=3.7))
    result = Conversation(controller).say("push the ice tea box until it moves")
    # 4 of 100 mm, and yet nothing is left to be done.
    assert (result.status, len(stage.executed)) == ("done", 1)
    assert stage.executed[0].push.until == "moves"


@pytest.mark.parametrize(
    ("sentence", "end"),
    [("topple the ice tea box", "toppled"), ("tilt the ice tea box by 5 degrees", "returned")],
)
def test_what_fell_or_stands_again_is_left_alone(
    controller: Controller,
    make_trace: TraceMaker,
    monkeypatch: pytest.MonkeyPatch,
    sentence: str,
    end: EndReason,
) -> None:
    tilt = math.radians(90.0 if end == "toppled" else 5.0)
    trace = make_trace(
        travel=(1e-4, 0.0),
        speed=1e-4,
        tilt=tilt,
        tilt_at_end=None if end == "toppled" else 0.0,
        height=0.2,
        end=end,
    )
    stage = played(controller, lambda _: trace)
    result = Conversation(controller).say(sentence)
    assert (result.status, len(stage.executed)) == ("done", 1)


# -- otherwise than predicted -------------------------------------------------------------------


def test_planned_anew_after_a_contradiction(
    controller: Controller,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    believed = controller.models[BOX].friction
    stage = played(controller, stands(force=7.0), goes(force=6.0))
    told: list[tuple[str, float, str]] = []
    result = Conversation(controller).say(SENTENCE, progress=lambda *report: told.append(report))
    assert (result.ok, result.status) == (True, "done")
    first, second = stage.executed
    assert result.plan == first
    assert result.planned == 1  # one frame, however many plans it took
    # It was pushed as hard as the first plan allows; the second one allows more.
    assert second.push.prediction.onset > first.push.prediction.onset
    assert second.push.force_limit > first.push.force_limit
    assert controller.models[BOX].friction > believed
    (step,) = result.steps
    stood, went = step.lessons
    assert (stood.moved, stood.contradicts) == ("none", True)
    assert (went.moved, went.contradicts) == ("slide", False)
    assert [kind for kind, *_ in told] == ["push", "learn", "push"]
    assert told[1][2] == stood.text
    assert "What the pushes taught:" in str(result)
    assert stood.text in str(result)
    again = json.loads(result.to_json())["steps"][0]["lessons"]
    assert [lesson["moved"] for lesson in again] == ["none", "slide"]
    assert again[0]["changes"][0].keys() == {
        "parameter", "before", "before_sd", "after", "after_sd"
    }  # fmt: skip


def test_the_rest_of_the_way_is_planned(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, tilted(goes(share=0.4, force=15.0)), goes())
    result = Conversation(controller).say(SENTENCE)
    first, second = stage.executed
    assert first.push.displacement == pytest.approx((0.1, 0.0, 0.0))
    assert second.push.displacement == pytest.approx((0.06, 0.0, 0.0), abs=EXACT)
    assert second.aim == first.aim
    assert second.push.stroke == pytest.approx(first.push.stroke - 0.04, abs=0.002)
    # Judged is the whole way, over both pushes.
    assert (result.ok, result.status) == (True, "done")
    assert "displace" in {check.clause for check in result.checks}
    assert result.trace is not None
    assert result.trace.displacement(BOX)[0] == pytest.approx(0.1)
    assert [lesson.moved for lesson in result.steps[0].lessons] == ["topple", "slide"]


def test_a_clause_broken_by_the_first_push_stays_broken(
    controller: Controller, goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    leant = goes(share=0.4, force=15.0, tilt=0.8, tilt_at_end=0.0)
    stage = played(controller, tilted(leant), goes())
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, len(stage.executed)) == ("failed", 2)
    assert {check.clause for check in result.checks if not check.ok} == {"no_topple"}


def test_given_up_after_so_many_pushes(
    stands: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    controller = Controller(seed=1, defaults=replace(DEFAULTS, most_pushes=3))
    stage = played(controller, stands(force=4.0))
    result = Conversation(controller).say(SENTENCE)
    assert (result.ok, result.status, result.exit_status) == (False, "failed", 5)
    assert len(stage.executed) == 3
    (step,) = result.steps
    assert len(step.lessons) == 3
    assert step.stuck == "this may take 3 pushes at most"
    assert result.error is not None
    assert result.error.code == "clause_not_held"
    assert step.stuck in result.error.message
    assert result.trace is not None
    assert len(result.trace.time) == 3 * len(stage.traces[0].time)
    limits = [plan.push.force_limit for plan in stage.executed]
    # It learns that 4 N are too little, and no more than that from the second time on.
    assert limits[1] > 1.05 * limits[0]
    assert min(limits[1:]) > 0.99 * limits[1]


def test_the_last_push_may_be_the_one_that_gets_there(
    goes: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    controller = Controller(seed=1, defaults=replace(DEFAULTS, most_pushes=2))
    played(controller, goes(share=0.5), goes())
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, result.steps[0].stuck) == ("done", None)


def test_what_got_stuck_is_not_done_whatever_was_measured(goes: Callable[..., Happens]) -> None:
    controller = Controller(seed=1, defaults=replace(DEFAULTS, most_pushes=1))
    played(controller, goes(share=0.95))
    result = Conversation(controller).say(SENTENCE)
    # 95 mm of 100 mm, within the tolerance of 10 mm; but the robot wanted to go on.
    assert all(check.ok for check in result.checks)
    assert (result.status, result.exit_status) == ("failed", 5)
    assert result.error is not None
    assert result.error.code == "not_finished"
    assert "this may take 1 push at most" in result.error.message


# Of "tilted" from the start nobody can tell the onset: it teaches nothing.
@pytest.mark.parametrize("end", ["no_touch", "guard", "too_close", "turned_off", "speed", "tilted"])
def test_after_a_push_that_failed_another_contact_is_tried(
    controller: Controller,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
    end: EndReason,
) -> None:
    stage = played(controller, stands(end), goes())
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, result.steps[0].lessons[1:]) == ("done", ())
    failed, other = (plan.push for plan in stage.executed[:2])
    apart = math.dist(failed.p_BC, other.p_BC)
    assert apart > 0.02 or failed.fingers != other.fingers
    assert failed.direction_W == pytest.approx(other.direction_W, abs=EXACT)


@pytest.mark.slow
def test_it_is_told_that_planning_takes_longer(
    controller: Controller, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[tuple[str, str]] = []

    def progress(phase: str, _: float, text: str) -> None:
        told.append((phase, text))

    # Nothing is asked of the hand.
    Conversation(controller).say("push the ice tea box 3 m away", plan_only=True, progress=progress)
    assert told == []
    monkeypatch.setattr(controller.executor, "_robot", RuledReach(lambda _: False))
    Conversation(controller).say("push the ice tea box away", plan_only=True, progress=progress)
    assert told
    assert set(told) == {("plan", "no plan as usual; looking thoroughly for what the hand can do")}


def test_what_ends_halfway_tells_where_things_are(
    controller: Controller, goes: Callable[..., Happens], stands: Callable[..., Happens]
) -> None:
    stage = played(controller, goes(share=0.5), stands("no_touch"))
    stood = controller.look().objects[BOX].pose
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, result.steps[0].stuck is None) == ("failed", False)
    assert len(stage.executed) > 1
    x, y = (1e3 * at for at in (stood.x + 0.05, stood.y))
    # Half of the 10 cm that are asked, by a camera without noise.
    told = f"{BOX} is at x {x:.0f} mm, y {y:.0f} mm now, 50 mm from where it was"
    assert [told in note for note in result.notes] == [True]


def test_stuck_where_every_contact_has_failed(
    controller: Controller, stands: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = played(controller, stands("no_touch"))
    result = Conversation(controller).say(SENTENCE)
    assert (result.status, result.exit_status) == ("failed", 5)
    assert 1 < len(stage.executed) < DEFAULTS.most_pushes
    (step,) = result.steps
    assert step.stuck is not None
    assert result.error is not None
    assert step.stuck in result.error.message
    tried = [plan.push for plan in stage.executed]
    for i, one in enumerate(tried):
        for other in tried[:i]:
            assert math.dist(one.p_BC, other.p_BC) > 0.02 or one.fingers != other.fingers


def test_the_next_frame_may_use_contacts_that_failed_before(
    controller: Controller,
    goes: Callable[..., Happens],
    stands: Callable[..., Happens],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stage = played(controller, stands("no_touch"), goes())
    assert Conversation(controller).say(SENTENCE).ok
    assert Conversation(controller).say("push the ice tea box 5 cm away").ok
    first, _, third = (plan.push for plan in stage.executed)
    assert (first.face, first.fingers) == (third.face, third.fingers)
    assert math.dist(first.p_BC, third.p_BC) < 0.02


def test_a_refusal_after_a_push_keeps_what_happened(
    controller: Controller, stands: Callable[..., Happens], monkeypatch: pytest.MonkeyPatch
) -> None:
    # What withstood 60 N is believed to stick so fast that it topples wherever it is pushed.
    stage = played(controller, stands(force=60.0))
    result = Conversation(controller).say(SENTENCE)
    assert (result.ok, result.status, result.exit_status) == (False, "failed", 5)
    assert len(stage.executed) == 1
    assert result.trace is stage.traces[0]
    assert result.execution is not None
    assert result.execution.end == "force"
    (step,) = result.steps
    assert step.execution == result.execution
    assert [lesson.moved for lesson in step.lessons] == ["none"]
    assert step.lessons[0].text in str(result)
    assert step.stuck is not None
    assert "topples before it slides" in step.stuck
    assert result.error is not None
    assert (result.error.code, step.stuck in result.error.message) == ("clause_not_held", True)


def test_a_refusal_before_any_push_stays_a_refusal(controller: Controller) -> None:
    result = Conversation(controller).say("push the ice tea box 3 m away")
    assert (result.status, result.exit_status) == ("refused", 4)
    assert result.trace is None
    assert result.steps[0].stuck is None
