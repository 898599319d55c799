"""What is learned of an object as it lies holds for it as it stands."""

from __future__ import annotations

import numpy as np
import pytest

from objectmodels import BoxModel, HullModel, ObjectModel
from objectmodels.errors import ModelError
from objectmodels.identification.belief_update import standing_belief
from objectmodels.identification.measurement_model import with_belief

BOX = BoxModel(
    name="b", size=(0.09, 0.07, 0.23), mass=1.0, mass_sd=0.04, friction=0.4, friction_sd=0.04,
    com=(0.004, -0.003, 0.1), com_sd=(0.002, 0.003, 0.01),
)  # fmt: skip
WEDGE = HullModel(
    name="w",
    vertices=tuple((x, y, z) for x, z in ((-0.05, 0.0), (0.05, 0.0), (-0.05, 0.06))
              for y in (-0.04, 0.04)),
    mass=0.5, mass_sd=0.02, friction=0.3, friction_sd=0.03, com=(-0.015, 0.001, 0.02),
    com_sd=(0.002, 0.002, 0.002),
)  # fmt: skip
EXACT = 1e-9  # rounding of two rotations; of standard deviations also that of correlations


@pytest.mark.parametrize("model", [BOX, WEDGE], ids=["box", "hull"])
def test_nothing_learned_changes_nothing(model: ObjectModel) -> None:
    for rest in model.rests[1:]:
        back = standing_belief(rest, rest.model)
        assert back.means == pytest.approx(model.means, abs=EXACT)
        # A box's deviations along its axes stay; those of a hull turn, and are told along N's.
        if isinstance(model, BoxModel):
            assert back.covariance == pytest.approx(model.covariance, abs=EXACT)


def test_the_centre_of_mass_moves_in_the_axes_of_the_bottom() -> None:
    rest = next(each for each in BOX.rests if each.face == "right")
    step = np.array([0.005, 0.002, -0.003])
    learned = rest.model.model_copy(
        update={"com": tuple(np.add(rest.model.com, step)), "mass": 1.1}
    )
    back = standing_belief(rest, learned)
    assert np.subtract(back.com, BOX.com) == pytest.approx(rest.R_BN @ step, abs=EXACT)
    assert (back.mass, back.friction_radius) == (1.1, BOX.friction_radius)


def test_what_hangs_together_still_does() -> None:
    rest = next(each for each in BOX.rests if each.face == "right")
    P = rest.model.covariance.copy()
    P[0, 1] = P[1, 0] = -0.5 * np.sqrt(P[0, 0] * P[1, 1])
    back = standing_belief(rest, with_belief(rest.model, P))
    assert back.covariance[0, 1] == pytest.approx(P[0, 1], rel=1e-6)  # correlations' hair


def test_what_would_not_stand_is_not_believed() -> None:
    rest = next(each for each in BOX.rests if each.face == "right")
    outside = rest.R_BN.T @ (np.array([0.06, 0.0, 0.1]) - rest.p_BN)
    lying = rest.model.model_copy(update={"com": tuple(outside.tolist())})
    with pytest.raises(ModelError, match="would not stand"):
        standing_belief(rest, lying)
