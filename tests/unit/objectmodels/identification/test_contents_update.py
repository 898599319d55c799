"""What a container holds once it is known to weigh otherwise."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from objectmodels import BoxModel
from objectmodels.identification.measurement_model import (
    container_with_mass,
    container_with_volume,
)
from objectmodels.models.object_parts import Container, Opening

LITRE = 1e-3


def carton(contents_sd: float = 0.03, mass_sd: float = 0.05, shell: float = 0.04) -> BoxModel:
    """200 g of water in a light shell, of both of which some grams are unknown."""
    return BoxModel(
        name="carton", size=(0.06, 0.06, 0.16), mass=0.2 + shell, mass_sd=mass_sd, friction=0.4,
        container=Container(
            wall=0.001, opening=Opening(radius=0.014), contents_l=0.2, contents_l_sd=contents_sd
        ),
    )  # fmt: skip


def test_what_is_hollow_is_reweighed_by_its_share() -> None:
    """The share of two independent parts of a variance: (30 / 50)²."""
    after = container_with_mass(carton(), 0.26, 0.0)
    assert after is not None
    assert after.contents_l == pytest.approx(0.2 + 0.36 * 0.02)
    assert after.contents_l_sd == pytest.approx(0.8 * 0.03)  # √(1 − 0.36)
    same = container_with_mass(carton(), carton().mass, carton().mass_sd)
    assert same is not None
    assert (same.contents_l, same.contents_l_sd) == pytest.approx((0.2, 0.03))


def test_where_all_that_is_unknown_is_the_contents_the_shell_stays() -> None:
    after = container_with_mass(carton(contents_sd=0.05), 0.14, 0.0)
    assert after is not None
    assert after.contents_l == pytest.approx(0.1)
    assert after.contents_l_sd == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("contents_sd", "mass_sd"), [(0.0, 0.05), (0.03, 0.0)])
def test_what_is_known_changes_for_nothing_but_too_little_mass(
    contents_sd: float, mass_sd: float
) -> None:
    model = carton(contents_sd, mass_sd)
    heavy = container_with_mass(model, 0.3, 0.01)
    assert heavy is not None
    assert (heavy.contents_l, heavy.contents_l_sd) == pytest.approx((0.2, contents_sd))
    light = container_with_mass(model, 0.12, 0.01)
    assert light is not None
    assert light.contents_l == pytest.approx(0.1)  # half of all of it, half of each


def test_what_is_not_hollow_holds_nothing() -> None:
    brick = BoxModel(name="brick", size=(0.1, 0.1, 0.1), mass=1.0, friction=0.4)
    assert container_with_mass(brick, 2.0, 0.1) is None


def test_no_more_than_it_holds_and_no_less_than_nothing() -> None:
    model = carton()
    assert model.vessel is not None
    assert container_with_volume(model, 1.0, 0.0).contents == pytest.approx(model.vessel.capacity)
    assert container_with_volume(model, -1.0, 0.0).contents == 0.0


DEVIATION = st.just(0.0) | st.floats(1e-6, 0.1)


@given(
    contents_sd=DEVIATION, mass_sd=DEVIATION, shell=st.floats(0.005, 0.2),
    mass=st.floats(0.001, 2.0), now=DEVIATION,
)  # fmt: skip
def test_whatever_it_weighs_is_a_model(
    contents_sd: float, mass_sd: float, shell: float, mass: float, now: float
) -> None:
    model = carton(contents_sd, mass_sd, shell)
    after = container_with_mass(model, mass, now)
    made = BoxModel(
        name="carton", size=model.size, mass=mass, mass_sd=now, friction=0.4, container=after
    )
    assert made.container is not None
    assert made.container.mass < made.mass
