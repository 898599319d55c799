"""Strokes of a free fingertip: the same in both engines, and judged as the robot is."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.goals.postures import _orientations, _postures, reachable
from benchmarks.goals.search import Asked, Found, missed, repeated, search
from benchmarks.rollouts import GOALS, OBJECT, world
from benchmarks.worlds.drake import DrakeBench
from benchmarks.worlds.strokes import BEFORE, Stroke, at, heading_of, upright
from nlcontrol import Registry
from nlcontrol.session.controller import Controller
from objectmodels.geometry.side_faces import Face
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from sim.robots.robots import HAND
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import SceneObject

MODEL = Registry.built_in().get(OBJECT)


def stroke(*, height: float, length: float, face: int = 0) -> Stroke:
    """Straight into the middle of a face of the box as it stands in `world`."""
    bench = DrakeBench(world(), OBJECT)
    side: Face = MODEL.faces()[face]
    return at(OBJECT, side.points_at(0.0, height), bench.poses()[OBJECT], slant=0.0, length=length)


def asked(text: str) -> Asked:
    controller = Controller(world(), registry=Registry.built_in())
    (frame,) = controller.resolve(controller.parse(text)).frames
    return Asked(frame, OBJECT, controller.models, controller.look().table)


def test_a_stroke_begins_before_the_face_and_ends_in_it() -> None:
    made = stroke(height=0.03, length=0.1)
    assert np.linalg.norm(made.end - made.start) == pytest.approx(BEFORE + 0.1)
    path, there = made.path(0.1)
    assert path[0] == pytest.approx(made.start)
    assert path[there][-1] == pytest.approx(made.end)
    assert path[-1] == pytest.approx(made.start, abs=0.002)  # one step of the way back


def test_both_engines_push_the_box_as_far() -> None:
    pytest.importorskip("mujoco")
    from benchmarks.worlds.mujoco import MujocoBench

    made = stroke(height=0.03, length=0.1)
    for bench in (DrakeBench(world(), OBJECT), MujocoBench(world())):
        before = bench.poses()[OBJECT]
        after = bench.roll(made, 0.1).poses[OBJECT][-1]
        moved = float(np.linalg.norm(after[4:6] - before[4:6]))
        # The springs that hold the fingertip give way by force over stiffness, 4 N / 2 kN/m.
        assert moved == pytest.approx(0.1, abs=0.003)
        # A push through the middle turns it by what the fingertip's side leaves open.
        assert abs(heading_of(after) - heading_of(before)) < np.radians(3.0)
        assert upright(after)


def test_what_is_put_back_rolls_the_same() -> None:
    bench = DrakeBench(world(), OBJECT)
    state, made = bench.keep(), stroke(height=0.03, length=0.03)
    ends = []
    for _ in range(2):
        bench.back(state)
        ends.append(bench.roll(made, 0.1).poses[OBJECT][-1])
    assert ends[0].tolist() == ends[1].tolist()


@pytest.mark.slow
def test_a_sentence_that_can_be_done_is_found_and_can_be_repeated() -> None:
    scene, can = world(), asked(f"push the {OBJECT} a little away")
    found, rolled = search(scene, can, 12, np.random.default_rng(0))
    assert found
    assert rolled <= 2 * 3 * 12  # numbers of fingertips, rounds, tries
    assert repeated(scene, can, found[0])


@pytest.mark.slow
def test_a_sentence_that_cannot_be_done_is_not_found() -> None:
    cannot = asked(f"push the {OBJECT} away with at most 0.5 N")
    found, rolled = search(world(), cannot, 1, np.random.default_rng(0))
    assert not found
    assert 2 <= rolled <= 2 * 3  # numbers of fingertips, rounds: fewer where every try falls over


def test_there_is_no_time_for_a_second_stroke() -> None:
    assert asked(f"push the {OBJECT} away within 8 s").rounds == 1
    assert asked(f"push the {OBJECT} away").rounds == 3


def test_each_stroke_keeps_the_constraints() -> None:
    top = asked(f"push the {OBJECT} a little away at the top")
    low = stroke(height=0.03, length=0.05, face=2)
    assert not repeated(world(), top, Found((low,), ({},), 1))


def test_nothing_missed_means_that_all_checks_hold() -> None:
    assert missed(()) == 0.0


@pytest.mark.parametrize(("height", "expected"), [(0.10, True), (-0.05, False)])
def test_postures_for_a_stroke(height: float, expected: bool) -> None:
    made = stroke(height=0.05, length=0.05)
    lifted = Stroke(
        np.array([*made.start[:2], height]), np.array([*made.end[:2], height]), made.heading, OBJECT
    )
    start = world().objects[0].pose
    box = SeenObject(OBJECT, PlanarPose(start.x_m, start.y_m, 0.0), MODEL)
    state = WorldState({OBJECT: box})
    rng = np.random.default_rng(0)
    assert reachable(lifted, 1, world().robot, state, rng) is expected


def test_goals_know_when_they_are_reached() -> None:
    push, turn = GOALS
    here = np.array([1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0])
    there = np.array([1.0, 0.0, 0.0, 0.0, 0.5, 0.15, 0.0])
    assert push.off(here, there) == pytest.approx((0.0, 0.0))
    assert turn.off(here, there) == pytest.approx((0.15, np.radians(45.0)))


def test_what_is_believed_has_the_shape_of_the_model() -> None:
    for model in Registry.built_in():
        truth = truth_as_believed(model)
        assert truth.shape.top == model.top
        assert truth.mass_kg == model.mass
        assert truth.shape.top > HAND.tip_radius


@pytest.mark.parametrize(("gap", "free"), [(0.067, True), (0.055, False), (0.04, False)])
def test_a_stroke_keeps_the_object_away_from_the_others(gap: float, free: bool) -> None:
    alone, mug = world(), Registry.built_in().get("mug")
    (box,) = alone.objects
    ahead = box.pose.x_m + MODEL.outline[:, 0].max() + gap - mug.outline[:, 0].min()
    pose = box.pose.model_copy(update={"x_m": ahead})
    other = SceneObject(name="mug", model="mug", pose=pose, truth=truth_as_believed(mug))
    both = alone.model_copy(update={"objects": (box, other)})
    controller = Controller(both, registry=Registry.built_in())
    (frame,) = controller.resolve(controller.parse(f"push the {OBJECT} 5 cm away")).frames
    can = Asked(frame, OBJECT, controller.models, controller.look().table)
    faces = [face.normal[0] for face in MODEL.faces()]
    made = stroke(height=0.03, length=0.05, face=int(np.argmin(faces)))
    # 10 mm are kept, and the fingertip's springs take a little of the stroke.
    assert repeated(both, can, Found((made,), ({},), 1)) == free


def test_two_fingertips_are_level_in_every_posture_that_is_looked_at() -> None:
    rng = np.random.default_rng(0)
    for posture in _postures(2, rng):
        tips = posture.tips @ np.swapaxes(_orientations(2, rng), -1, -2)
        # In the push's frame: across the push, which is along x.
        assert np.abs(tips[:, 1, [0, 2]] - tips[:, 0, [0, 2]]).max() < 1e-9
