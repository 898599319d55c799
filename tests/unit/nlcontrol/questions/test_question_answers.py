"""Questions: frames made by hand, answers checked against formulae that the code does not use.

The ice tea box of the kitchen is believed to be 0.09 × 0.09 × 0.23 m, 0.9952 ± 0.0375 kg, with
μ = 0.378 ± 0.0689 and its centre of mass known to 3 mm: pushed straight in the middle of a face it
slides at μ m g and topples at m g b / h.
"""

from __future__ import annotations

import math
from pathlib import Path
from statistics import NormalDist
from typing import Any, get_args

import numpy as np
import pytest
from PIL import Image

from grammar.frames import command as g
from nlcontrol.cli import run
from nlcontrol.errors import ControlError
from nlcontrol.questions.answer import Answer
from nlcontrol.questions.push_prediction import deviations, predict_push
from nlcontrol.references.object_names import face_of
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import BoxModel
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from sim.simulated_executor import simulation
from sim.truth.scene_file import parse_scene

MASS, MASS_SD, MU, MU_SD, HALF, COM_SD = 0.9952, 0.0375, 0.378, 0.0689, 0.045, 0.003
WEIGHT = MASS * 9.81
SLIDE = MU * WEIGHT
SLIDE_SD = SLIDE * math.hypot(MU_SD / MU, MASS_SD / MASS)
TOP, MIDDLE, BOTTOM = 0.23 * 5 / 6, 0.115, 0.23 / 6  # the middles of the thirds

AT_THE_TOP = g.ContactRegion(region="top")
AT_THE_BOTTOM = g.ContactRegion(region="bottom")
PUSH: dict[str, Any] = {"action": "push", "goal": g.Displace()}
TOPPLE: dict[str, Any] = {"action": "topple", "goal": g.Topple()}


def _topple(height: float) -> float:
    return WEIGHT * HALF / height


def _topple_sd(height: float) -> float:
    return _topple(height) * math.hypot(MASS_SD / MASS, COM_SD / HALF)


def _slides_first(height: float) -> float:
    """Probability that μ < b / h, both normal; turning is left out."""
    spread = math.hypot(MU_SD, COM_SD / height)
    return NormalDist().cdf((HALF / height - MU) / spread)


@pytest.fixture(scope="module")
def kitchen() -> Controller:
    return Controller("kitchen")


@pytest.fixture(scope="module")
def counter() -> Controller:
    return Controller("counter")


def _ask(query: str, name: str = "ice tea box", *clauses: g.Constraint, **parts: Any) -> g.Frame:
    ref = g.ObjectRef(text=name, id=name)
    return g.Frame.model_validate({"query": query, "object": ref, "constraints": clauses, **parts})


# -- what happens -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("clauses", "height"), [((AT_THE_TOP,), TOP), ((AT_THE_BOTTOM,), BOTTOM), ((), MIDDLE)]
)
def test_what_a_push_does_by_the_formulae(
    kitchen: Controller, clauses: tuple[g.Constraint, ...], height: float
) -> None:
    found = kitchen.answer(_ask("predict", "ice tea box", *clauses, **PUSH))
    numbers = found.numbers
    assert numbers["height"] == pytest.approx(height, abs=1e-9)
    # Closed forms and their first derivatives: only rounding is left.
    assert numbers["slide"] == pytest.approx(SLIDE, rel=1e-6)
    assert numbers["slide_sd"] == pytest.approx(SLIDE_SD, rel=1e-6)
    assert numbers["topple"] == pytest.approx(_topple(height), rel=1e-6)
    assert numbers["topple_sd"] == pytest.approx(_topple_sd(height), rel=1e-6)
    likely = 1.0 - _slides_first(height) if height > HALF / MU else _slides_first(height)
    # The sequence's own 0.04. A push off the centre of mass turns it, and then it slides earlier:
    # half-way up that is worth 0.14, as it is for drawn bodies.
    turns = 0.14 if height == MIDDLE else 0.0
    assert found.probability == pytest.approx(likely + turns, abs=0.04)
    assert found.yes is None


def test_the_words_of_a_prediction(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("predict", "ice tea box", AT_THE_TOP, **PUSH))
    assert found.text == (
        "Pushed on its front face, 192 mm above the table, the ice tea box would topple: it topples"
        " from 2.3 N ± 0.2 N on and slides only from 3.7 N ± 0.7 N on (probability that it topples"
        " 0.939)."
    )
    assert "falls by itself beyond 21.4°" in found.lines[0]


def test_one_code_behind_predict_and_the_question(kitchen: Controller) -> None:
    model = kitchen.models["ice tea box"]
    told = predict_push(model, "front", face_of(model, "front"), lateral=0.0, height=TOP, force=3.0)
    found = kitchen.answer(_ask("predict", "ice tea box", AT_THE_TOP, g.Force(value=3.0), **PUSH))
    assert found.probability is not None
    assert found.numbers["topple"] == told.topple
    assert found.probability == told.probability[told.outcome]


@pytest.mark.parametrize(
    ("event", "clauses", "yes", "lead"),
    [
        ("tips", (AT_THE_TOP, g.Force(value=3.0)), True, "Probably, pushed with 3.0 N on"),
        ("tips", (AT_THE_TOP, g.Force(value=1.5)), False, "No, "),
        ("moves", (AT_THE_TOP, g.MaxForce(value=1.5)), False, "No, "),
        ("slides", (AT_THE_BOTTOM,), True, "Yes, "),
        ("tilts", (AT_THE_BOTTOM,), False, "No, "),
        ("turns", (AT_THE_BOTTOM,), False, "No, "),
        ("stays_upright", (AT_THE_BOTTOM,), True, "Yes, "),
        ("stays_upright", (AT_THE_TOP, g.Force(value=1.5)), True, "Yes, "),
        ("stays_upright", (), True, "Probably, "),
    ],
)
def test_whether_an_event_comes(
    kitchen: Controller, event: str, clauses: tuple[g.Constraint, ...], yes: bool, lead: str
) -> None:
    found = kitchen.answer(_ask("predict", "ice tea box", *clauses, event=event, **PUSH))
    assert found.yes is yes
    assert found.text.startswith(lead)
    assert found.probability is not None
    assert (found.probability >= 0.5) is yes


def test_a_push_to_the_side_touches_the_other_one(kitchen: Controller) -> None:
    goal = g.Displace(direction="left")
    found = kitchen.answer(_ask("predict", "cereal box", action="push", goal=goal))
    assert "on its right face" in found.text
    # Seen at 4° to the push at most: 1 − cos 4° and the little turning that it makes.
    assert found.numbers["slide"] == pytest.approx(0.3428 * 0.2413 * 9.81, rel=0.01)


def test_a_place_that_is_said_to_be_on_a_face(kitchen: Controller) -> None:
    left = g.ContactRegion(face="left")
    assert "on its left face" in kitchen.answer(_ask("predict", "cereal box", left, **PUSH)).text


def test_directions_in_words_are_the_robots(counter: Controller) -> None:
    # The tin stands at 30° and looks at the robot with a face all the same.
    goal = g.Displace(direction="away")
    found = counter.answer(_ask("predict", "tea tin", action="push", goal=goal))
    assert "on its front face" in found.text
    assert "'away'" in found.lines[0] or "moves away" in found.lines[0]
    degrees = [int(word[:-1]) for word in found.lines[0].split() if word.rstrip("°").isdigit()]
    assert all(d <= 3 for d in degrees)  # the camera's 1° and the tin's own turning


def test_a_toppling_is_asked_about_where_it_takes_least(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("predict", **TOPPLE))
    assert found.numbers["height"] == pytest.approx(0.225)  # 5 mm below the edge


@pytest.mark.parametrize(
    ("clause", "parts", "code"),
    [
        (g.ContactRegion(face="top"), PUSH, "unsupported"),
        (
            g.ContactRegion(height=g.ContactHeight(value=0.3, origin="table")),
            PUSH,
            "impossible",
        ),
        (
            g.ContactRegion(face="left"),
            {"action": "push", "goal": g.Displace(direction="left")},
            "impossible",
        ),
    ],
)
def test_what_is_no_push_of_this_robot(
    kitchen: Controller, clause: g.Constraint, parts: dict[str, Any], code: str
) -> None:
    with pytest.raises(ControlError) as raised:
        kitchen.answer(_ask("predict", "ice tea box", clause, **parts))
    assert raised.value.code == code
    assert raised.value.info.status.exit == 4
    assert raised.value.info.suggestions


def test_a_pull_is_a_push_from_behind(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("predict", "ice tea box", AT_THE_TOP, action="pull"))
    assert found.push is not None
    assert found.push.face == "back"
    assert abs(found.push.heading) == pytest.approx(math.pi, abs=0.06)  # square to the face
    assert "topple" in found.text


@pytest.mark.parametrize(
    ("parts", "pushes"),
    [
        ({"action": "turn", "goal": g.Rotate(angle=math.radians(90.0))}, 3),
        ({"action": "push", "goal": g.Displace(direction=("away", "left"))}, 2),
        ({"action": "tilt", "goal": g.Tilt(angle=math.radians(5.0))}, 1),
    ],
)
def test_what_is_possible_tells_all_its_pushes(
    kitchen: Controller, parts: dict[str, Any], pushes: int
) -> None:
    found = kitchen.answer(_ask("possible", "ice tea box", **parts))
    assert found.yes
    assert found.numbers["pushes"] == pushes
    assert (f"in {pushes} pushes, the first with" in found.text) == (pushes > 1)


def test_it_is_possible_to_leave_it_where_it_is(kitchen: Controller) -> None:
    seen = kitchen.look().objects["ice tea box"].pose
    there = g.Place(relation="at", reference=g.Point(x=seen.x, y=seen.y))
    found = kitchen.answer(_ask("possible", "ice tea box", action="place", goal=there))
    assert (found.yes, found.text) == (True, "Yes: it is there already.")


def test_the_deviation_of_a_force_against_drawn_parameters() -> None:
    box = BoxModel(
        name="crate", size=(0.1, 0.1, 0.2), mass=1.0, mass_sd=0.1, friction=0.4, friction_sd=0.04,
        com_sd=(0.004, 0.0, 0.0), friction_radius_sd=0.0, correlations=(("mass", "friction", 0.8),),
    )  # fmt: skip
    slide, topple = deviations(box, np.array([-0.05, 0.0, 0.1]), np.array([1.0, 0.0, 0.0]))
    rng = np.random.default_rng(0)
    both = np.array([[0.1**2, 0.8 * 0.004], [0.8 * 0.004, 0.04**2]])
    mass, friction = rng.multivariate_normal([1.0, 0.4], both, 200_000).T
    com = rng.normal(0.0, 0.004, 200_000)
    # Linear over one standard deviation; products of deviations of 10 % add about 0.5 %.
    assert slide == pytest.approx(np.std(friction * mass * 9.81), rel=0.02)
    assert topple == pytest.approx(np.std(mass * 9.81 * (0.05 - com) / 0.1), rel=0.02)


def test_what_never_comes_has_no_deviation(kitchen: Controller) -> None:
    low, down = np.array([-0.045, 0.0, 0.01]), np.array([0.28, 0.0, -0.96])
    slide, topple = deviations(kitchen.models["ice tea box"], low, down)
    # It presses on the table at more than the friction angle, and over the base.
    assert (slide, topple) == (None, None)


def test_kinetic_friction_has_no_known_deviation(kitchen: Controller) -> None:
    model = kitchen.models["coffee box"]
    push = {"lateral": 0.0, "height": 0.05, "friction": "kinetic"}
    found = predict_push(model, "front", face_of(model, "front"), **push)  # type: ignore[arg-type]
    assert found.slide_sd is None
    assert found.topple_sd is not None


# -- what can be done -------------------------------------------------------------------------


def test_what_is_possible_is_what_the_planner_plans(kitchen: Controller) -> None:
    frame = _ask("possible", "ice tea box", g.NoTopple(), **PUSH)
    made = kitchen.plan(frame.model_copy(update={"query": None}))
    assert isinstance(made, Plan)
    found = kitchen.answer(frame)
    assert (found.yes, found.probability) == (True, made.push.prediction.probability)
    assert found.numbers["force"] == made.push.force_limit
    height = f"{1e3 * made.push.p_BC[2]:.0f} mm above the table"
    assert found.text.startswith(f"Yes: two fingers on its front face, {height}")


@pytest.mark.slow
def test_what_is_impossible_says_why_and_what_would_do(kitchen: Controller) -> None:
    frame = _ask("possible", "ice tea box", AT_THE_TOP, g.NoTopple(), **PUSH)
    made = kitchen.plan(frame.model_copy(update={"query": None}))
    assert isinstance(made, Refusal)
    found = kitchen.answer(frame)
    assert (found.yes, found.reason) == (False, made.reason)
    assert found.text == f"No: {made.message}."
    assert (found.suggestions, found.numbers) == (made.suggestions, made.numbers)


def test_what_no_check_could_see_is_not_possible(kitchen: Controller) -> None:
    frame = _ask("possible", action="hand_over", goal=g.HandOver())
    found = kitchen.answer(frame)
    assert (found.yes, found.reason) == (False, "unsupported")


def test_affordances_are_those_of_the_command(
    counter: Controller, capsys: pytest.CaptureFixture[str]
) -> None:
    found = counter.answer(_ask("affordances", "soup can"))
    assert run(["affordances", "soup can", "--scene", "counter"]) == 0
    assert capsys.readouterr().out.splitlines() == list(found.lines)
    can = sum(line.startswith("✓") for line in found.lines)
    assert found.numbers["can"] == can > 0
    assert found.text.startswith("With the soup can I can slide it away")
    assert "I cannot topple" in found.text


# -- how hard ---------------------------------------------------------------------------------


def test_the_force_that_topples(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("how_hard", **TOPPLE))
    height, force = found.numbers["height"], found.numbers["force"]
    assert force == pytest.approx(_topple(height), rel=1e-6)
    assert found.numbers["force_sd"] == pytest.approx(_topple_sd(height), rel=1e-6)
    # 95 % of a normal distribution.
    assert found.numbers["force_high"] - force == pytest.approx(1.96 * _topple_sd(height), rel=1e-4)
    assert found.text.startswith(f"It takes {force:.1f} N ± 0.1 N to topple the ice tea box")
    assert found.yes is True


def test_the_force_that_slides(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("how_hard", "ice tea box", AT_THE_BOTTOM, event="slides", **PUSH))
    assert found.numbers["force"] == pytest.approx(SLIDE, rel=1e-6)
    assert "to make the ice tea box slide" in found.text


@pytest.mark.parametrize(
    ("event", "clause", "words"),
    [
        ("tips", AT_THE_BOTTOM, ("would not topple", "slides from 3.7 N", "the 11.5 N ± 0.9 N")),
        ("slides", AT_THE_TOP, ("would not slide", "topples from 2.3 N", "the 3.7 N ± 0.7 N")),
    ],
)
def test_what_never_comes_first_is_told_with_both_forces(
    kitchen: Controller, event: str, clause: g.Constraint, words: tuple[str, ...]
) -> None:
    found = kitchen.answer(_ask("how_hard", "ice tea box", clause, event=event, **PUSH))
    assert all(word in found.text for word in words)
    assert "force" not in found.numbers
    assert found.yes is False


def test_what_topples_nowhere_on_a_face(kitchen: Controller) -> None:
    # Along its wide side b / μ is 0.28 m, and the cereal box is 0.26 m high.
    goal = g.Topple(direction="left")
    found = kitchen.answer(_ask("how_hard", "cereal box", action="topple", goal=goal))
    assert found.text.startswith("Even pushed on its right face")
    assert found.yes is False


def test_the_largest_force_before_it_topples(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("how_hard", "ice tea box", AT_THE_TOP, g.NoTopple(), **PUSH))
    least = _topple(TOP) - 1.644854 * _topple_sd(TOP)
    assert found.numbers["force"] == pytest.approx(least, rel=1e-6)
    # 4000 samples: three standard deviations of 0.0035.
    assert found.probability == pytest.approx(0.95, abs=0.011)
    low = kitchen.answer(_ask("how_hard", "ice tea box", AT_THE_BOTTOM, g.NoTopple(), **PUSH))
    assert "however hard" in low.text
    assert "force" not in low.numbers


def test_the_largest_force_before_it_moves(kitchen: Controller) -> None:
    clauses = (AT_THE_BOTTOM, g.NoSlide(), g.NoTilt(), g.NoTurn())
    found = kitchen.answer(_ask("how_hard", "ice tea box", *clauses, **PUSH))
    assert found.numbers["force"] == pytest.approx(SLIDE - 1.644854 * SLIDE_SD, rel=1e-6)
    # As above, and the centre of mass off the push lets it go a little earlier.
    assert found.probability == pytest.approx(0.95, abs=0.03)


def test_turning_takes_less_than_sliding_and_a_place_off_the_middle(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("how_hard", action="turn", goal=g.Rotate(sense="ccw")))
    # Counter-clockwise seen from above: on the right of who looks at the face.
    assert found.numbers["lateral"] > 0.01
    assert found.numbers["force"] < SLIDE
    assert found.probability is not None
    assert found.probability >= kitchen.defaults.probability


# -- where ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("parts", "slides"), [(PUSH, True), (TOPPLE, False)])
def test_where_it_is_sure_and_where_it_flips(
    kitchen: Controller, parts: dict[str, Any], slides: bool
) -> None:
    clauses = (g.NoTopple(),) if slides else ()
    found = kitchen.answer(_ask("where", "ice tea box", *clauses, **parts))
    assert found.numbers["critical_height"] == pytest.approx(HALF / MU, rel=1e-6)
    limit = found.numbers["highest" if slides else "lowest"]
    beyond = limit + (0.01 if slides else -0.01)  # the next row of the map
    likely = [_slides_first(z) if slides else 1.0 - _slides_first(z) for z in (limit, beyond)]
    assert likely[0] >= 0.95 > likely[1]
    assert f"{1e3 * limit:.0f} mm" in found.text
    assert found.chart is not None
    assert (found.chart.object, found.chart.face) == ("ice tea box", "front")


def test_where_it_turns(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("where", event="turns", **PUSH))
    # An arm of a quarter of the friction radius, 0.3826 of the side: 8.6 mm, on a grid of 10 mm.
    assert "at least 10 mm to either side of its middle" in found.text
    one = kitchen.answer(_ask("where", action="turn", goal=g.Rotate(sense="cw")))
    assert "to the left of its middle" in one.text


def test_where_nothing_is_sure(kitchen: Controller) -> None:
    goal = g.Topple(direction="left")
    found = kitchen.answer(_ask("where", "cereal box", action="topple", goal=goal))
    assert found.text.startswith("Nowhere on its right face")
    assert found.yes is False
    assert "lowest" not in found.numbers


# -- what is known ----------------------------------------------------------------------------


def test_how_heavy(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("value", goal=g.Parameters(which=("mass",))))
    assert found.numbers == {"mass": MASS, "mass_sd": MASS_SD}
    assert found.text.startswith("The ice tea box weighs 0.995 kg ± 0.038 kg (source: Ruiz-Ugalde")
    assert found.text.endswith(", 10 trials).")


@pytest.mark.parametrize(
    ("which", "words", "numbers"),
    [
        ("friction", "coefficient of 0.343 ± 0.051", {"friction": 0.3428, "friction_sd": 0.051}),
        ("height", "is 260 mm high", {"height": 0.26}),
        ("width", "is 192 mm wide", {"width": 0.192}),
        ("length", "is 52 mm deep", {"length": 0.052}),
        ("size", "260 mm high, 192 mm wide and 52 mm deep", {"length": 0.052}),
        ("centre_of_mass", "130 mm ± 20 mm above the table", {"com_z": 0.13, "com_z_sd": 0.02}),
    ],
)
def test_what_is_believed(
    kitchen: Controller, which: str, words: str, numbers: dict[str, float]
) -> None:
    found = kitchen.answer(_ask("value", "cereal box", goal=g.Parameters(which=(which,))))
    assert words in found.text
    assert numbers.items() <= found.numbers.items()
    assert "trials" not in found.text


def test_where_it_stands_is_what_the_camera_sees(kitchen: Controller) -> None:
    found = kitchen.answer(_ask("value", "cereal box", goal=g.Parameters(which=("position",))))
    pose = kitchen.look().objects["cereal box"].pose
    assert (found.numbers["x"], found.numbers["y"]) == (pose.x, pose.y)
    # Noise of 2 mm over a second of 30 frames.
    assert found.numbers["position_sd"] == pytest.approx(0.002 / math.sqrt(30))


def test_several_and_no_properties(kitchen: Controller) -> None:
    both = kitchen.answer(_ask("value", goal=g.Parameters(which=("height", "mass"))))
    assert {"height", "mass"} <= set(both.numbers)
    every = kitchen.answer(_ask("value", goal=g.Parameters()))
    assert {"height", "mass", "friction"} <= set(every.numbers)


def test_how_full_is_not_known(kitchen: Controller) -> None:
    with pytest.raises(ControlError) as raised:
        kitchen.answer(_ask("value", "cereal box", goal=g.Parameters(which=("fill",))))
    assert raised.value.code == "unsupported"
    assert raised.value.info.capability == "knowing what is in the cereal box"


# -- in `say` and on the command line -----------------------------------------------------------


def _read_as(monkeypatch: pytest.MonkeyPatch, *frames: g.Frame) -> None:
    """Whatever is said is read as these frames."""
    monkeypatch.setattr(
        Controller,
        "command",
        lambda _, text, before=(): g.Command(text=text, frames=frames, paraphrase="asked"),
    )


@pytest.mark.parametrize(
    "query",
    [
        pytest.param(query, marks=pytest.mark.slow) if query == "affordances" else query
        for query in sorted(set(get_args(g.Query)) - {"why", "did"})
    ],
)
def test_no_question_pushes(
    kitchen: Controller, monkeypatch: pytest.MonkeyPatch, query: str
) -> None:
    _read_as(monkeypatch, _ask(query, "ice tea box", g.NoTopple(), **PUSH))
    monkeypatch.setattr(Controller, "execute", None)
    result = Conversation(kitchen).say("a question")
    assert not simulation(kitchen.executor).is_built
    assert (result.plan, result.trace, result.checks) == (None, None, ())
    assert (result.ok, result.status, result.exit_status) == (True, "answered", 0)
    assert result.answer is not None
    assert result.answer.text in str(result)
    again = Result.model_validate_json(result.to_json())
    assert again.answer == result.answer.model_copy(update={"map": None})


def test_the_planner_plans_no_question(kitchen: Controller) -> None:
    made = kitchen.plan(_ask("predict", **PUSH))
    assert isinstance(made, Refusal)
    assert made.reason == "unsupported"


def test_a_question_before_a_command(kitchen: Controller, monkeypatch: pytest.MonkeyPatch) -> None:
    command = _ask("value", **PUSH).model_copy(update={"query": None})
    heavy = _ask("value", goal=g.Parameters(which=("mass",)))
    _read_as(monkeypatch, heavy, command)
    result = Conversation(kitchen).say("how heavy is it? push it", plan_only=True)
    assert (result.status, result.planned) == ("planned", 1)
    assert result.answer is not None
    assert any(row.field.startswith("action") for row in result.explanation_rows())


@pytest.mark.parametrize("command", ["say", "plan"])
def test_a_question_of_places_prints_the_map(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    _read_as(monkeypatch, _ask("where", "ice tea box", g.NoTopple(), **PUSH))
    assert run([command, "where can I push it"]) == 0
    out = capsys.readouterr().out
    assert "5 mm to 85 mm above the table" in out
    assert "   85 mm  s s s" in out
    assert "  225 mm  T T T" in out


def test_a_question_of_places_draws_the_map(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    _read_as(monkeypatch, _ask("where", "ice tea box", g.NoTopple(), **PUSH))
    picture = tmp_path / "map.png"
    assert run(["say", "where can I push it", "--picture", str(picture)]) == 0
    assert f"Picture: {picture}" in capsys.readouterr().out
    # Circles in red, green and blue, with softened rims.
    assert (
        len(np.unique(np.asarray(Image.open(picture).convert("RGB")).reshape(-1, 3), axis=0)) > 50
    )


def test_an_answer_is_a_frozen_value() -> None:
    assert Answer.model_config["frozen"]
    with pytest.raises(ValueError, match="extra"):
        Answer.model_validate({"query": "value", "text": "", "colour": "red"})


def test_what_stands_on_what_is_told_by_the_camera() -> None:
    high = Controller(
        parse_scene(
            """
            version: 1
            name: high
            objects:
              - {name: book, model: book, pose: {x_m: 0.45, y_m: 0.1}}
              - {name: mug, model: mug, pose: {x_m: 0.46, y_m: 0.12, z_m: 0.03}}
            """
        )
    )
    told = {
        said: Conversation(high).say(said).answer
        for said in ("what is on the book", "what is under the mug")
    }
    answers = {said: answer.text for said, answer in told.items() if answer}
    assert answers == {
        "what is on the book": "The book carries the mug.",
        "what is under the mug": "The mug stands on the book.",
    }
    refused = Conversation(high).say("push the book to the left", plan_only=True).error
    assert refused is not None
    assert refused.code == "blocked"


def test_what_stands_in_an_open_box_is_told() -> None:
    bins = Controller(
        parse_scene(
            """
            version: 1
            name: bins
            objects:
              - {name: bin, model: storage bin, pose: {x_m: 0.45, y_m: 0.1}}
              - {name: mug, model: mug, pose: {x_m: 0.46, y_m: 0.12, z_m: 0.004}}
            """
        )
    )
    said = ("what is in the bin?", "what is under the mug?", "what is in the mug?")
    answers = [
        answer.text for answer in (Conversation(bins).say(each).answer for each in said) if answer
    ]
    assert answers[:2] == ["The bin contains the mug.", "The mug stands in the bin."]
    assert answers[2].startswith("The mug holds 0 ml")
    seen = Conversation(bins).say("what do you see?").answer
    assert seen is not None
    assert any(line.endswith(", in the bin") for line in seen.lines)
