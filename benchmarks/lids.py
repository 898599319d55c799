"""Predicted and simulated openings of random lids.

    python -m benchmarks.lids --cases 120 --seed 0

Cups with flip lids are opened by a fingertip that follows the lid's arc, jars with lift-off lids by
a pull that grows, bottles with screw caps by a torque that grows. What is predicted from the true
figures (`objectmodels.containers.lids`) is compared with what happens in Drake. Cases in
which the object bears within 10 % of what the lid needs may go either way and are counted apart.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.lidbench import LidBench
from nlcontrol.batches.drawn_scenes import scene_of
from nlcontrol.parallel_tasks import run_all
from objectmodels import CylinderModel
from objectmodels.containers import lids
from objectmodels.models.object_parts import FlipLid, Lid, LiftOffLid, ScrewCap
from sim.robots.cell_description import Vision
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Pose, SceneObject

Kind = Literal["flip", "lift_off", "screw"]

BAND = 0.10
"""Margins nearer to one may go either way."""

_END = np.radians(100.0)
_OPEN = 0.9  # share of the way at which a lid counts as open
_MORE = 1.5  # largest pull or torque as a share of what lid or object needs
_SHARES: dict[Kind, float] = {"flip": 0.6, "lift_off": 0.2, "screw": 0.2}


class Case(NamedTuple):
    """A drawn object.

    Attributes:
        kind: of its lid.
        truth: how it is.
        yaw: how it is turned [degrees].
    """

    kind: Kind
    truth: Truth
    yaw: float


class Outcome(NamedTuple):
    """What was predicted and what happened.

    Attributes:
        kind: of the lid.
        predicted: `opens`, or `gives way` if the object slides, tips or comes along.
        margin: least, of what the object bears over what the lid needs.
        happened: as `predicted`.
    """

    kind: Kind
    predicted: str
    margin: float
    happened: str

    @property
    def close(self) -> bool:
        """Whether it may go either way."""
        return abs(self.margin - 1.0) < BAND


def drawn(kind: Kind, rng: np.random.Generator) -> Case:
    """A round object of any size that a hand could open, with its lid."""
    radius, height = rng.uniform(0.025, 0.045), rng.uniform(0.07, 0.16)
    mass = rng.uniform(0.08, 0.60)
    truth = Truth(
        radius_m=radius,
        base_radius_m=radius * rng.uniform(0.85, 1.0),
        height_m=height,
        mass_kg=mass,
        friction_table=rng.uniform(0.15, 0.6),
        friction_finger=rng.uniform(0.3, 0.9),
        centre_of_mass_m=(0.0, 0.0, height * rng.uniform(0.3, 0.5)),
        lid=_lid(kind, radius, mass, rng),
    )
    return Case(kind, truth, rng.uniform(-180.0, 180.0))


def _lid(kind: Kind, radius: float, mass: float, rng: np.random.Generator) -> Lid:
    if kind == "flip":
        return FlipLid(
            mass=rng.uniform(0.008, 0.03),
            tab=rng.uniform(0.018, 0.025),
            tab_heading_deg=rng.uniform(-180.0, 180.0),
            friction_torque=rng.uniform(0.005, 0.05),
            snap_torque=rng.uniform(0.0, 0.08),
            snap_angle_deg=rng.uniform(2.0, 6.0),
        )
    if kind == "lift_off":
        return LiftOffLid(
            mass=rng.uniform(0.1, 0.3) * mass,
            retention=rng.uniform(0.2, 1.6) * 0.8 * mass * 9.81,
            radius=radius,
            knob_radius=0.01,
            knob_height=0.02,
        )
    return ScrewCap(
        mass=rng.uniform(0.002, 0.006),
        friction_torque=rng.uniform(0.01, 0.08),
        pitch=rng.uniform(0.002, 0.004),
        radius=0.6 * radius,
        height=0.018,
    )


def believed(truth: Truth) -> CylinderModel:
    """A belief that is exactly right."""
    assert truth.radius_m is not None
    return CylinderModel(
        name="object",
        radius=truth.radius_m,
        base_radius=truth.base_radius_m,
        height=truth.height,
        mass=truth.mass_kg,
        friction=truth.friction_table,
        finger_friction=truth.friction_finger,
        com=truth.centre_of_mass,
        support="corners",
        lid=truth.lid,
    )


def run(case: Case) -> Outcome:
    """Predicts a case, and opens its lid in Drake."""
    item = SceneObject(
        name="object",
        model="object",
        pose=Pose(x_m=0.5, y_m=0.0, yaw_deg=case.yaw),
        truth=case.truth,
    )
    bench = LidBench(scene_of("lids", [item], Vision()))
    model, lid = believed(case.truth), case.truth.lid
    if isinstance(lid, FlipLid):
        return _flipped(bench, model, lid)
    if isinstance(lid, LiftOffLid):
        expected = lids.lift_off(model, lid)
        done = bench.pull(_MORE * min(expected.needed, expected.held))
    else:
        assert isinstance(lid, ScrewCap)
        expected = lids.unscrew(model, lid)
        done = bench.turn(_MORE * min(expected.needed, expected.held))
    opens = expected.margin > 1.0
    return Outcome(case.kind, _told(opens), expected.margin, _told(not done.came_along))


def _flipped(bench: LidBench, model: CylinderModel, lid: FlipLid) -> Outcome:
    arc = lids.flip(model, lid, end=_END)
    done = bench.flip(_END)
    opened = done.lid > _OPEN * _END and not done.came_along
    return Outcome("flip", _told(arc.least_margin > 1.0), arc.least_margin, _told(opened))


def _told(opens: bool) -> str:
    return "opens" if opens else "gives way"


def table(outcomes: Iterable[Outcome]) -> str:
    """Counts as a table in Markdown."""
    lines = [
        "| lid | cases | opened | within 10 % | the others | right of these |",
        "|---|---|---|---|---|---|",
    ]
    every = list(outcomes)
    for kind in _SHARES:
        these = [each for each in every if each.kind == kind]
        clear = [each for each in these if not each.close]
        wrong = [each for each in clear if each.predicted != each.happened]
        opened = sum(each.happened == "opens" for each in these)
        right = 1.0 - len(wrong) / max(len(clear), 1)
        lines.append(
            f"| {kind.replace('_', '-')} | {len(these)} | {opened} | {len(these) - len(clear)} "
            f"| {len(clear)} | {right:.1%} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Runs the cases and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    cases = [
        drawn(kind, rng)
        for kind, share in _SHARES.items()
        for _ in range(round(share * asked.cases))
    ]
    outcomes = list(run_all(run, cases, workers=asked.workers))
    print(table(outcomes))
    for each in outcomes:
        if each.predicted != each.happened:
            print(f"{each.kind}: {each.happened} at a margin of {each.margin:.2f}")


if __name__ == "__main__":
    main()
