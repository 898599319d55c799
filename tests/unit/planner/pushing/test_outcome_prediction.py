"""Chosen pushes are looked at once more by the exact tier."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from objectmodels import BoxModel, CylinderModel, HullModel, ObjectModel, Registry
from objectmodels.exact.exact_probability import least_probability
from objectmodels.mechanics.friction_cone import worst_probability
from planner.planning import plan
from planner.problem.planning_problem import PushStep, Side
from planner.pushing import contact_planner
from planner.pushing.contact_planner import SURE, confirm_with_exact_tier
from planner.pushing.contact_sampling import rate_contacts
from planner.types.defaults import DEFAULTS
from planner.types.plan import Plan
from planner.types.refusal import Refusal
from planner.types.world_state import PlanarPose, SeenObject, WorldState
from tests.unit.planner.conftest import RuledReach, frame_of, problem_of

# Its mass lies to one side, so that one finger in the middle turns it: the ellipsoid believes that
# it tips first, but the corners under the load's far side let it turn before.
LOPSIDED = BoxModel(
    name="ice tea box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.378, com=(0.0, 0.02, 0.115),
    finger_friction=0.05, support="corners", friction_radius_sd=0.0,
)  # fmt: skip


def state_of(model: ObjectModel) -> WorldState:
    return WorldState({model.name: SeenObject(model.name, PlanarPose(0.45, 0.0), model)})


def verdicts(model: ObjectModel, sentence: str) -> list[tuple[float, bool]]:
    """Heights of the contacts that the closed form chooses, and what the exact tier says."""
    state = state_of(model)
    frame = frame_of(sentence)
    # In the middle of the face, as a push that turns it is placed where it is said.
    problem = problem_of(frame, state, DEFAULTS, RuledReach())
    problem = replace(problem, contact=replace(problem.contact, fingers=(1,)))
    step = replace(PushStep.from_goal(problem.goal), swing=0.1, lateral=0.0)
    face = model.faces(np.array([0.0]))[2 if isinstance(model, BoxModel) else 0]
    found = [
        (float(contact.point[2]), confirm_with_exact_tier(problem, step, contact))
        for case in rate_contacts(problem, step, [Side(face, 0.0)], 1)
        for contacts in case
        for contact in contacts
    ]
    assert found
    return found


def test_contacts_that_turn_it_before_it_tips_are_not_confirmed() -> None:
    found = verdicts(LOPSIDED, "topple the ice tea box")
    assert not all(ok for _, ok in found)
    centred = LOPSIDED.model_copy(update={"com": (0.0, 0.0, 0.115)})
    assert all(ok for _, ok in verdicts(centred, "topple the ice tea box"))


def test_a_plan_takes_no_contact_that_is_not_confirmed() -> None:
    refused = {height for height, ok in verdicts(LOPSIDED, "topple the ice tea box") if not ok}
    frame = frame_of("topple the ice tea box with one finger")
    made = plan(frame, state_of(LOPSIDED), RuledReach())
    if isinstance(made, Plan):
        assert made.push.fingers == 1
        assert made.push.p_BC[2] not in refused
        assert made.push.prediction.tier == "exact"
    else:
        assert isinstance(made, Refusal)
        assert made.reason in ("impossible", "too_uncertain")


def test_a_round_object_may_spin_on_its_rim_before_it_tips() -> None:
    bottle = CylinderModel(
        name="ice tea box", radius=0.03, height=0.21, mass=0.5, friction=0.45,
        finger_friction=0.5, support="corners", friction_radius_sd=0.0,
    )  # fmt: skip
    assert any(ok for _, ok in verdicts(bottle, "topple the ice tea box"))


@pytest.mark.parametrize("sentence", ["push the ice tea box away with one finger"])
def test_what_slides_is_confirmed_to_slide(sentence: str) -> None:
    assert all(ok for _, ok in verdicts(LOPSIDED, sentence))


def test_what_has_no_side_for_a_finger_is_refused() -> None:
    needle = HullModel(
        name="ice tea box", mass=0.1, friction=0.3,
        vertices=tuple((x, y, z) for x in (-1e-2, 1e-2) for y in (-5e-3, 5e-3) for z in (0.0, 0.3)),
    )  # fmt: skip
    thin = needle.model_copy(
        update={"vertices": tuple((x / 3, y, z) for x, y, z in needle.vertices)}
    )
    made = plan(frame_of("push the ice tea box away"), state_of(thin), RuledReach())
    assert isinstance(made, Refusal)
    assert made.reason == "impossible"
    assert "wide enough" in made.message


def test_one_finger_topples_what_turns_only_as_it_slides() -> None:
    model = BoxModel(
        name="ice tea box", size=(0.09, 0.09, 0.23), mass=1.0, friction=0.378, friction_sd=0.044,
        com=(0.0, 0.0, 0.115), com_sd=(0.0017, 0.0017, 0.0017), finger_friction=0.693,
        friction_radius=0.0344, friction_radius_sd=0.0155,
    )  # fmt: skip
    made = plan(frame_of("topple the ice tea box with one finger"), state_of(model), RuledReach())
    assert isinstance(made, Plan)
    assert made.push.fingers == 1
    # If it might turn while it tips, the doubt about its friction radius would leave 0.93. What is
    # left of that comes from its centre of mass, which may lie beside the finger.
    assert made.probability > 0.97


def test_of_sure_slides_the_exact_tier_says_the_same() -> None:
    sure = []
    for name in ("ice tea box", "coffee box", "cereal box"):
        model = Registry.built_in().get(name)
        for face in model.faces()[:2]:
            points, normals = face.points_at(np.array([0.0, 0.01]), np.array([0.03, 0.045]))
            closed = worst_probability(model, points, normals, True, "slide")
            sure += [
                (float(p), least_probability(model, point, normal, "slide"))
                for p, point, normal in zip(closed, points, normals, strict=True)
                if p >= SURE
            ]
    assert len(sure) > 4
    # Of 689 contacts that were drawn it is 0.0001 less at most, and 0.001 more.
    assert all(closed - 0.0002 < exact < closed + 0.001 for closed, exact in sure)


@pytest.mark.parametrize(("name", "is_asked"), [("ice tea box", False), ("cereal box", True)])
def test_sure_slides_do_without_the_exact_tier(
    monkeypatch: pytest.MonkeyPatch, name: str, is_asked: bool
) -> None:
    asked = []

    def counted(*args: object) -> float:
        asked.append(args)
        return 1.0

    monkeypatch.setattr(contact_planner, "_exact_probability", counted)
    frame = frame_of(f"push the {name} away with one finger")
    made = plan(frame, state_of(Registry.built_in().get(name)), RuledReach())
    assert isinstance(made, Plan)
    assert bool(asked) == is_asked


@pytest.mark.parametrize(("room", "looks"), [(0.5, True), (0.7, False)])
def test_contacts_far_from_toppling_are_not_looked_at_again(
    room: float, looks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    cone = SimpleNamespace(slide_margin=np.array([room * 4.0]), slide_max=np.array([4.0]))
    side = SimpleNamespace(face=SimpleNamespace(normal=(-1.0, 0.0, 0.0)))
    among = SimpleNamespace(fingers=1, cone=cone, guarded=False, side=side)
    contact: Any = SimpleNamespace(index=0, among=among, point=np.zeros(3))
    step = PushStep("slide", 0.0, 0.1)
    monkeypatch.setattr(contact_planner, "_exact_outcomes", lambda *_: np.array(["topple"]))
    problem: Any = SimpleNamespace(target=SimpleNamespace(model=LOPSIDED))
    assert confirm_with_exact_tier(problem, step, contact) == (not looks)
