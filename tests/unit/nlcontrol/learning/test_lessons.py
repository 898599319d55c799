"""What is believed after a push, and how it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nlcontrol.batches.drawn_scenes import scene_of
from nlcontrol.learning.learning_reports import Change, Lesson
from nlcontrol.learning.lessons import (
    RADIUS_SD,
    apply_lesson,
    lesson_from_push,
    parameter_changes,
)
from nlcontrol.session.controller import Controller
from objectmodels import BoxModel, Registry
from objectmodels.geometry.pushed_body import UNCERTAIN
from objectmodels.identification import Trial
from objectmodels.identification.belief_update import SURPRISING
from objectmodels.mechanics.push_motion import turning_motion
from planner.types.end_reasons import END_REASONS, EndReason
from planner.types.plan import Plan
from planner.types.world_state import SeenObject
from sim.robots.cell_description import Vision
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, SceneObject
from tests.unit.nlcontrol.pushes import TraceMaker, stuck

BELIEF = BoxModel(
    name="b", size=(0.09, 0.09, 0.23), mass=1.0, mass_sd=0.04, friction=0.4, friction_sd=0.04,
    com=(0.0, 0.0, 0.1), com_sd=(0.002, 0.002, 0.01),
)  # fmt: skip
SLIDES = 1.0 * 0.4 * 9.81


def slid(force: float) -> Trial:
    return Trial("slide", (-0.045, 0.0, 0.03), (force, 0.0, 0.0), 0.02 * force)


def test_a_slide_as_believed_makes_surer() -> None:
    update = apply_lesson(BELIEF, slid(SLIDES))
    assert update.surprise == pytest.approx(0.0, abs=1e-6)
    assert update.model.friction == pytest.approx(0.4, rel=1e-3)
    assert update.model.friction_sd < BELIEF.friction_sd


def test_a_slide_that_contradicts_is_believed_more_than_one_that_does_not() -> None:
    near, far = apply_lesson(BELIEF, slid(1.1 * SLIDES)), apply_lesson(BELIEF, slid(3.0 * SLIDES))
    assert not near.is_contradiction
    assert far.surprise > SURPRISING
    # The belief was too sure: widened, it gets there but for a tenth.
    assert far.model.mass * far.model.friction * 9.81 == pytest.approx(3.0 * SLIDES, rel=0.1)
    # Told from how far it was before it was widened.
    assert far.surprise == pytest.approx(np.log(3.0) / np.sqrt(0.1**2 + 0.04**2 + 0.02**2), rel=0.2)


def test_one_slide_tells_no_more_than_pushes_differ() -> None:
    unsure = BELIEF.model_copy(update={"mass_sd": 1e-4, "friction_sd": 0.2})
    found = apply_lesson(unsure, replace(slid(SLIDES), force_sd=1e-4)).model
    # Friction differs by 5 % from push to push, and this one from the mean by as much.
    assert 0.05 <= found.friction_sd / found.friction < 0.10


def test_what_moved_nothing_raises_the_belief() -> None:
    update = apply_lesson(
        BELIEF, Trial("none", (-0.045, 0.0, 0.03), (2.0 * SLIDES, 0.0, 0.0), 0.05)
    )
    assert update.is_contradiction
    onset = update.model.thresholds([(-0.045, 0.0, 0.03)], [(1.0, 0.0, 0.0)]).onset[0]
    assert onset > 1.9 * SLIDES


def test_only_what_changed_is_a_change() -> None:
    after = BELIEF.model_copy(update={"friction": 0.45, "mass_sd": 0.03})
    found = {change.parameter: change for change in parameter_changes(BELIEF, after)}
    assert set(found) == {"mass", "friction"}
    assert (found["mass"].before_sd, found["mass"].after_sd) == (0.04, 0.03)
    assert parameter_changes(BELIEF, BELIEF) == ()


@pytest.mark.parametrize(
    ("after", "after_sd", "matters"),
    [
        (0.40, 0.04, False),
        (0.41, 0.04, False),  # a quarter of a standard deviation
        (0.42, 0.04, True),  # half of one
        (0.38, 0.04, True),
        (0.40, 0.033, False),  # known better by less than a fifth
        (0.40, 0.030, True),
        (0.40, 0.08, False),
    ],
)
def test_what_is_worth_telling(after: float, after_sd: float, matters: bool) -> None:
    change = Change(
        parameter="friction", before=0.4, before_sd=0.04, after=after, after_sd=after_sd
    )
    assert change.matters is matters


def test_changes_in_words() -> None:
    def text(parameter: str, *figures: float) -> str:
        keys = ("before", "before_sd", "after", "after_sd")
        return Change(parameter=parameter, **dict(zip(keys, figures, strict=True))).text

    assert text("friction", 0.378, 0.069, 0.351, 0.024) == "friction 0.378 ± 0.069 → 0.351 ± 0.024"
    assert text("mass", 1.0, 0.04, 1.06, 0.01) == "mass 1.000 ± 0.040 → 1.060 ± 0.010 kg"
    assert text("com_x", 0.0, 0.003, -0.0012, 0.001) == (
        "centre of mass, x 0.0 ± 3.0 → -1.2 ± 1.0 mm"
    )


@pytest.mark.parametrize(
    ("moved", "why", "text"),
    [
        ("slide", None, "The b slid at 3.90 N: friction 0.400 ± 0.040 → 0.500 ± 0.020"),
        ("none", "it did not move", "it did not move: the b stood still at 3.90 N: friction"),
        ("topple", "it tilted", "it tilted: the b tilted at 3.90 N: friction"),
        ("slip", None, "The b let the finger slip at 3.90 N: friction"),
    ],
)
def test_a_lesson_in_a_sentence(moved: str, why: str | None, text: str) -> None:
    told = Change(parameter="friction", before=0.4, before_sd=0.04, after=0.5, after_sd=0.02)
    hair = Change(parameter="mass", before=1.0, before_sd=0.04, after=1.001, after_sd=0.04)
    lesson = Lesson(
        object="b", moved=moved, force=3.9, surprise=1.0, contradicts=why is not None, why=why,
        changes=(told, hair),
    )  # fmt: skip
    assert lesson.text.startswith(text)
    assert "mass" not in lesson.text
    assert lesson.model_copy(update={"changes": (hair,)}).text.endswith("N: as believed")


@pytest.fixture(scope="module")
def planned() -> tuple[Plan, SeenObject]:
    controller = Controller(seed=1)
    command = controller.resolve(controller.parse("push the ice tea box away"))
    state = controller.look()
    plan = controller.plan(command.frames[0], state)
    assert isinstance(plan, Plan)
    return plan, state.objects["ice tea box"]


@pytest.mark.parametrize("end", ["force", "slid", "tilted"])
def test_ends_that_contradict(
    planned: tuple[Plan, SeenObject], make_trace: TraceMaker, end: EndReason
) -> None:
    plan, target = planned
    trace = stuck(make_trace(force=5.0)) if end == "force" else make_trace(force=5.0, end=end)
    found = lesson_from_push(plan, target, trace)
    if end == "tilted":  # even from the start: an onset that nobody can tell
        assert found is None
        return
    assert found is not None
    model, lesson = found
    assert lesson.contradicts
    assert lesson.why == END_REASONS[end].contradicts
    assert lesson.object == "ice tea box"
    assert lesson.force == pytest.approx(5.0)
    assert {change.parameter for change in lesson.changes} <= set(UNCERTAIN)
    assert model.friction > target.model.friction
    assert Lesson.model_validate_json(lesson.model_dump_json()) == lesson


def test_a_push_that_went_as_predicted_teaches_too(
    planned: tuple[Plan, SeenObject], make_trace: TraceMaker
) -> None:
    plan, target = planned
    found = lesson_from_push(plan, target, make_trace(force=3.2))
    assert found is not None
    model, lesson = found
    assert (lesson.moved, lesson.contradicts, lesson.why) == ("slide", False, None)
    assert model.friction < target.model.friction


def test_a_drag_that_slips_teaches_both_frictions(make_trace: TraceMaker) -> None:
    truth = truth_as_believed(Registry.built_in().get("book"))
    book = SceneObject(name="book", model="book", pose=Pose(x_m=0.5, y_m=0.0), truth=truth)
    controller = Controller(scene_of("a book", [book], Vision()), seed=1)
    command = controller.resolve(controller.parse("push the book 10 cm to the left"))
    state = controller.look()
    plan = controller.plan(command.frames[0], state)
    assert isinstance(plan, Plan)
    model, press = state.objects["book"].model, plan.push.press
    ratio = 0.8 * model.finger_friction
    trace = make_trace(force=ratio * press, end="slipped")
    felt = {name: force.copy() for name, force in trace.felt.items()}
    tips = {name: place.copy() for name, place in trace.tips.items()}
    pushing = np.flatnonzero(trace.phase == "push")
    for name, force in felt.items():
        force[pushing, 2] = -press / len(felt)
        force[pushing[: len(pushing) // 2], :2] *= 0.5  # before it slips
        # In the end it has sprung back, and presses no more.
        force[pushing[-10:]], tips[name][pushing[-10:]] = 0.0, tips[name][0]
    trace = replace(trace, felt=felt, tips=tips)
    found = lesson_from_push(plan, state.objects["book"], trace)
    assert found is not None
    after, lesson = found
    assert (lesson.moved, lesson.contradicts) == ("slip", True)
    assert lesson.force == pytest.approx(ratio * press)
    # Between what was believed and felt, nearer to the felt ratio, which is the surer one.
    assert ratio < after.finger_friction < 0.9 * model.finger_friction
    assert after.finger_friction_sd < model.finger_friction_sd
    # The table held the book against that force, under its weight and the fingertip's.
    assert after.friction * after.mass > model.friction * model.mass


def test_what_lies_on_another_face_teaches_of_the_whole_object(
    planned: tuple[Plan, SeenObject], make_trace: TraceMaker
) -> None:
    plan, target = planned
    rest = next(each for each in target.model.rests if each.face == "right")
    lying = replace(target, model=rest.model, rest=rest)
    found = lesson_from_push(plan, lying, make_trace(force=3.2))
    assert found is not None
    model, lesson = found
    assert model.friction < target.model.friction
    assert model.friction_radius == target.model.friction_radius
    assert lesson.changes == parameter_changes(target.model, model)
    # As it lies it is pushed with the force that was felt, but for what one push does not tell.
    after = next(each.model for each in model.rests if each.face == "right")
    slides = [m.friction * m.weight for m in (rest.model, after)]
    assert abs(slides[1] - 3.2) < 0.5 * abs(slides[0] - 3.2)
    assert lesson_from_push(plan, lying, make_trace(force=3.2, end="turned")) is None
    leaning = replace(target, attitude=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    assert lesson_from_push(plan, leaning, make_trace(force=3.2)) is None


def test_a_turn_shows_the_friction_radius(make_trace: TraceMaker) -> None:
    controller = Controller(seed=1)
    command = controller.resolve(controller.parse("turn the ice tea box by 60 degrees to the left"))
    state = controller.look()
    plan = controller.plan(command.frames[0], state)
    assert isinstance(plan, Plan)
    target, push = state.objects["ice tea box"], plan.push
    true_radius = 1.7 * target.model.friction_radius
    truly = target.model.model_copy(update={"friction_radius": true_radius})
    normal = target.pose.R_WB.T @ np.array(push.normal_W)
    direction = target.pose.R_WB.T @ np.array(push.direction_W)
    slant = np.arctan2(direction[1], direction[0]) - np.arctan2(-normal[1], -normal[0])
    after = turning_motion(truly, [push.p_BC], [normal], slant, push.turn).pose[0]
    there = target.pose.R_WB @ np.array([after[0], after[1], 0.0]) + target.pose.p_WB

    trace = make_trace(force=2.0, end="turned")
    n = len(trace.time)
    seen = np.tile([1.0, 0.0, 0.0, 0.0, *target.pose.p_WB], (n, 1))
    half = 0.5 * after[2]
    seen[trace.phase != "look"] = [np.cos(half), 0.0, 0.0, np.sin(half), *there]
    trace = replace(trace, seen={**trace.seen, push.object: seen})
    assert trace.seen_turn(push.object) == pytest.approx(after[2])

    found = lesson_from_push(plan, target, trace)
    assert found is not None
    model, lesson = found
    before, sd = target.model.friction_radius, target.model.friction_radius_sd
    shown_sd = RADIUS_SD * true_radius
    weight = sd**2 / (sd**2 + shown_sd**2)
    # Geometry alone, but for the wrapping of angles.
    assert model.friction_radius == pytest.approx(
        before + weight * (true_radius - before), rel=0.03
    )
    assert model.friction_radius_sd < shown_sd
    assert not lesson.contradicts

    barely = np.tile(seen[0], (n, 1))
    assert lesson_from_push(plan, target, replace(trace, seen={push.object: barely})) is None
    # The pivot of a smaller turn drowns in the noise of two looks.
    for degrees, shows in ((6.0, False), (10.0, True)):
        half = 0.5 * np.radians(degrees)
        seen[trace.phase != "look", :4] = [np.cos(half), 0.0, 0.0, np.sin(half)]
        turned = replace(trace, seen={push.object: seen})
        assert (lesson_from_push(plan, target, turned) is not None) == shows
