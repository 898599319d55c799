"""Liquid in containers that are moved by hand, in a plant that only keeps their masses."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.engines.hand_work import Prescribed
from objectmodels.containers.pour_dynamics import Catch, caught_volume, pour
from sim.errors import SceneError
from sim.truth.scene_file import parse_scene
from sim.worlds.drake.contents import Liquid
from sim.worlds.drake.drake_world import DrakeWorld

Array = NDArray[np.float64]

SCENE = """
version: 1
name: kitchen corner
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: carton
    model: coffee box
    pose: {x_m: 0.5, y_m: 0.0}
    truth:
      {size_m: [0.06, 0.08, 0.16], mass_kg: 0.34, friction_table: 0.4, friction_finger: 0.7,
       container: {wall_m: 0.002, opening: {centre_m: [0.0, 0.02], radius_m: 0.014},
                   contents_l: 0.3}}
  - name: mug
    model: mug
    pose: {x_m: 0.5, y_m: 0.15}
    truth:
      {radius_m: 0.04, height_m: 0.082, mass_kg: 0.12, friction_table: 0.4, friction_finger: 0.7,
       container: {wall_m: 0.003, opening: {radius_m: 0.037}}}
"""
LID = "lid: {kind: flip, mass_kg: 0.01, tab_m: 0.02, friction_torque_nm: 0.01}, container:"
PLAIN = """
version: 1
name: plain
robot: {home_deg: [41.0, -95.0, 75.0, -87.0, 110.0, -90.0, 42.0]}
objects:
  - name: box
    model: coffee box
    pose: {x_m: 0.5, y_m: 0.0}
    truth: {size_m: [0.06, 0.08, 0.16], mass_kg: 0.34, friction_table: 0.4, friction_finger: 0.7}
"""
FULL = 0.3e-3
FORWARDS = np.pi / 2.0  # to the side where the carton's opening is
RATE = np.radians(30.0)


class Moved(Prescribed):
    """A carton that is tilted over a mug."""

    def pour_out(self, lip_W: Array, angle: float, wait: float) -> None:
        """Tilts the carton at a steady rate."""
        steps = round(angle / RATE * self.scene.control_rate_hz)
        for i in range(steps + round(wait * self.scene.control_rate_hz)):
            self.lean("carton", min(i / steps, 1.0) * angle, FORWARDS, lip_W)

    def inertia(self, name: str) -> tuple[float, Array]:
        """Mass and centre of mass in the plant."""
        M = self.model.bodies[name].CalcSpatialInertiaInBodyFrame(self.context)
        return M.get_mass(), M.get_com()

    @property
    def total(self) -> float:
        """All there is [m³]."""
        return sum(self.liquid.contents.values()) + self.liquid.spilled


def _over_the_mug(ahead: float) -> Array:
    return np.array([0.5, 0.15 - ahead, 0.082 + 0.04])


def test_it_pours_as_predicted() -> None:
    moved = Moved(parse_scene(SCENE))
    vessel = moved.scene.object("carton").truth.vessel
    assert vessel is not None
    angle = np.radians(115.0)
    for aim in (0.03, 0.07):
        moved = Moved(parse_scene(SCENE))
        moved.pour_out(_over_the_mug(aim), angle, 2.0)
        running = pour(vessel, FULL, heading=FORWARDS, angle=angle, rate=RATE, wait=2.0)
        expected = caught_volume(running, FULL, Catch(aim, 0.0, 0.04, 0.037, 1.0))
        # Steps of 10 ms against some of 20 ms and more.
        assert moved.liquid.contents["mug"] == pytest.approx(expected.received[0], abs=0.01 * FULL)
        assert moved.liquid.spilled == pytest.approx(expected.spilled[0], abs=0.01 * FULL)
        assert moved.total == pytest.approx(FULL)


def test_masses_follow_the_contents() -> None:
    moved = Moved(parse_scene(SCENE))
    moved.pour_out(_over_the_mug(0.03), np.radians(90.0), 1.0)
    left, received = moved.liquid.contents["carton"], moved.liquid.contents["mug"]
    assert 0.0 < left < 0.2e-3
    mass, com = moved.inertia("carton")
    assert mass == pytest.approx(0.04 + 1000.0 * left)
    assert moved.inertia("mug")[0] == pytest.approx(0.12 + 1000.0 * received)
    for name in ("carton", "mug"):
        truth = moved.liquid.present(name, moved.scene.object(name).truth)
        assert truth.mass_kg == pytest.approx(moved.inertia(name)[0])
        assert truth.centre_of_mass == pytest.approx(moved.inertia(name)[1])
    # What is left lies on the side that is below.
    vessel = moved.scene.object("carton").truth.vessel
    assert vessel is not None
    liquid = vessel.centroid(left, np.radians(90.0), FORWARDS)
    shell = (0.34 * np.array([0.0, 0.0, 0.08]) - 0.3 * vessel.centroid(FULL, 0.0, 0.0)) / 0.04
    expected = (0.04 * shell + 1000.0 * left * liquid) / mass
    assert com == pytest.approx(expected, abs=1e-4)
    assert com[1] > 0.01


def test_what_leans_back_is_as_before() -> None:
    moved = Moved(parse_scene(SCENE))
    before = moved.inertia("carton")
    moved.pour_out(_over_the_mug(0.03), np.radians(40.0), 0.0)
    assert abs(moved.inertia("carton")[1][1]) > 1e-3
    moved.lean("carton", 0.0, FORWARDS, _over_the_mug(0.03))
    assert moved.liquid.contents == {"carton": FULL, "mug": 0.0}
    assert moved.inertia("carton")[0] == before[0]
    assert moved.inertia("carton")[1] == pytest.approx(before[1], abs=1e-12)


@pytest.mark.parametrize("fallen", [1.0, -1.0])
def test_a_fallen_carton_spills_by_where_its_opening_lies(fallen: float) -> None:
    """Lying on the side of its opening it runs nearly dry; on the other one it keeps a lot."""
    moved = Moved(parse_scene(SCENE))
    for i in range(1000):
        tilt = min(i / 50.0, 1.0) * np.pi / 2.0
        moved.lean("carton", tilt, fallen * FORWARDS, np.array([0.0, 0.0, 0.05]))
    vessel = moved.scene.object("carton").truth.vessel
    assert vessel is not None
    held = float(vessel.brim(np.pi / 2.0, fallen * FORWARDS))
    # The rest still drips, slower and slower.
    assert moved.liquid.contents["carton"] == pytest.approx(min(held, FULL), abs=0.1 * FULL)
    assert moved.liquid.spilled == pytest.approx(FULL - moved.liquid.contents["carton"])


@pytest.mark.slow
def test_a_full_mug_runs_over() -> None:
    text = SCENE.replace("radius_m: 0.037}}", "radius_m: 0.037}, contents_l: 0.3}")
    moved = Moved(parse_scene(text.replace("mass_kg: 0.12", "mass_kg: 0.42")))
    mug = moved.scene.object("mug").truth.vessel
    assert mug is not None
    moved.pour_out(_over_the_mug(0.03), np.radians(115.0), 5.0)
    # A film of less than a millimetre still stands above the rim.
    assert moved.liquid.contents["mug"] == pytest.approx(mug.capacity, abs=4e-6)
    assert moved.liquid.spilled == pytest.approx(0.3e-3 + FULL - mug.capacity, abs=0.02 * FULL)
    assert moved.total == pytest.approx(0.6e-3)


@pytest.mark.parametrize("covered", ["carton", "mug"])
def test_a_closed_lid_keeps_everything_in_and_out(covered: str) -> None:
    head, tail = SCENE.split("  - name: mug")
    if covered == "carton":
        head = head.replace("container:", LID)
    else:
        tail = tail.replace("container:", LID)
    moved = Moved(parse_scene(f"{head}  - name: mug{tail}"))
    moved.pour_out(_over_the_mug(0.03), np.radians(115.0), 1.0)
    assert moved.liquid.contents["mug"] == 0.0
    assert (moved.liquid.spilled > 0.0) == (covered == "mug")
    if covered == "carton":
        moved = Moved(moved.scene)
        moved.liquid = Liquid(moved.model, moved.root, moved.scene, lambda name: True)
        moved.pour_out(_over_the_mug(0.03), np.radians(115.0), 1.0)
        assert moved.liquid.contents["mug"] > 0.9 * FULL


def test_a_world_tells_its_observer() -> None:
    world = DrakeWorld(parse_scene(SCENE))
    for _ in range(3):
        world.robot.step(*world.robot.commanded)
    assert world.sample.contents == {"carton": FULL, "mug": 0.0}
    assert world.sample.spilled == 0.0
    truth = world.truth_now("carton")
    assert truth.container is not None
    assert truth.container.contents == FULL


def test_a_carton_that_falls_over_spills() -> None:
    """Let go beyond its angle of no return, towards its opening; the mug stands aside."""
    from pydrake.math import RigidTransform, RotationMatrix

    world = DrakeWorld(parse_scene(SCENE.replace("y_m: 0.15", "y_m: -0.2")))
    tilt = np.radians(35.0)
    X_WB = RigidTransform(RotationMatrix.MakeXRotation(-tilt), [0.5, 0.0, 0.04 * np.sin(tilt)])
    plant, body = world._plant, world._model.bodies["carton"]
    plant.SetFreeBodyPose(world._context, body, X_WB)
    for _ in range(150):
        world.robot.step(*world.robot.commanded)
    last = world.sample
    # It lies on its side; in a second and a half half of it is out.
    assert last.poses["carton"][1] == pytest.approx(-np.sqrt(0.5), abs=0.05)
    assert last.spilled > 0.3 * FULL
    assert last.spilled + sum(last.contents.values()) == pytest.approx(FULL)
    assert world.truth_now("carton").mass_kg == pytest.approx(0.34 - 1000.0 * last.spilled)


def test_a_world_without_containers_has_no_liquid() -> None:
    world = DrakeWorld(parse_scene(PLAIN))
    world.robot.step(*world.robot.commanded)
    assert world.sample.contents == {}
    assert world.sample.spilled == 0.0
    assert world.truth_now("box") == world.scene.object("box").truth


@pytest.mark.parametrize(
    ("found", "wrong"),
    [
        ("contents_l: 0.3}", "contents_l: 0.34}"),
        ("contents_l: 0.3}}", "contents_l: 0.3}, contents_shift_m: 0.003}"),
        ("wall_m: 0.002", "wall_m: 0.04"),
    ],
)
def test_a_truth_that_cannot_be_is_refused(found: str, wrong: str) -> None:
    parse_scene(SCENE)
    with pytest.raises(SceneError, match=r"contents|walls"):
        parse_scene(SCENE.replace(found, wrong, 1))
