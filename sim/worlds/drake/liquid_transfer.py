"""Liquid in the containers of a scene: it moves their masses, runs out, is caught or is spilled.

Model: at rest at every instant (`objectmodels.models.object_parts`), with the flow and the stream
of `objectmodels.containers.pour_dynamics`; between control steps both stay as they are. A stream is
caught by the highest open container whose opening it passes through, and arrives at once; what is
too much for that one runs over. All else is spilled and gone. A lid that is not open keeps
everything in, and out. Each container's liquid has the density of its own.

A body's mass and centre of mass follow its contents; what it is made of besides stays. Its radii of
gyration about the centre of mass stay too.

Frames: W is the world, B a container.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from objectmodels.containers.pour_dynamics import landing_distance, outflow_rate
from objectmodels.models.object_parts import section_area
from sim.rotations import Array
from sim.truth.object_truth import Truth
from sim.truth.scene_file import Scene
from sim.worlds.drake.drake_plant import Standing

if TYPE_CHECKING:
    from pydrake.systems.framework import Context

    from objectmodels.models.object_parts import Container, Vessel

_TURNED = 1e-3  # what turned less has its contents where they were [1]
_LEVEL = 0.02  # what leans less runs over all round, down its own sides [rad]
_UPRIGHT = math.cos(math.radians(5.0))  # what stands so shows its level
_OPEN_ABOVE = 0.5  # cosine of the largest tilt at which an opening catches anything


@dataclass
class _Filled:
    """A container and what is in it now.

    Attributes:
        truth: as the scene has it.
        vessel: its cavity.
        container: its liquid.
        volume: in it now [m³].
        middle: centre of that volume in B [m].
        up: the vertical in B for which this holds.
        restless: whether it may run over its lip though it does not move: it did in the last step,
            or something was poured in.
    """

    truth: Truth
    vessel: Vessel
    container: Container
    volume: float
    middle: Array
    up: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    restless: bool = False


class Liquid:
    """Keeps the contents of all containers.

    Attributes:
        contents: per container, volume in it [m³].
        spilled: volume that ran out and into none of them [m³].
    """

    def __init__(
        self,
        model: Standing,
        root: Context,
        scene: Scene,
        is_open: Callable[[str], bool] = lambda _: False,
    ) -> None:
        self._model = model
        self._context = model.plant.GetMyMutableContextFromRoot(root)
        self._period = 1.0 / scene.control_rate_hz
        self._is_open = is_open
        self._filled = {
            item.name: _filled_container(item.truth)
            for item in scene.objects
            if item.truth.container
        }
        self._bare = {
            name: model.bodies[name].CalcSpatialInertiaInBodyFrame(self._context)
            for name in self._filled
        }
        self.contents = {name: filled.volume for name, filled in self._filled.items()}
        self.spilled = 0.0

    def prepare(self, touched: Sequence[str], poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Before a step: lets run out what stands above a lip, moves what moved inside."""
        del touched
        for name in self._filled:
            if name in poses:
                self._run(name, poses)
        for name, filled in self._filled.items():
            if name in poses:
                self._settle(name, filled, poses[name][0][2])

    def levels(self, poses: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
        """Heights of the liquids over the bottoms of open containers that stand upright [m]."""
        return {
            name: filled.volume / section_area(filled.vessel.section)
            for name, filled in self._filled.items()
            if name in poses and poses[name][0][2, 2] > _UPRIGHT and not self._is_closed(name)
        }

    def present(self, name: str, truth: Truth) -> Truth:
        """The truth of an object with the contents that it has now."""
        filled = self._filled.get(name)
        if filled is None:
            return truth
        mass, middle = _with_contents(truth.mass_kg, np.array(truth.centre_of_mass), filled)
        contents = filled.container.model_copy(update={"contents_l": 1e3 * filled.volume})
        changes = {"mass_kg": mass, "centre_of_mass_m": tuple(middle.tolist())}
        return truth.model_copy(update={**changes, "container": contents})

    def _is_closed(self, name: str) -> bool:
        return self._filled[name].truth.lid is not None and not self._is_open(name)

    def _run(self, name: str, poses: Mapping[str, tuple[Array, Array]]) -> None:
        """Lets run out of a container what does so in a step, into what catches it."""
        filled = self._filled[name]
        R_WB, p_WB = poses[name]
        still = not filled.restless and _near(filled.up, R_WB[2])
        if filled.volume <= 0.0 or still or self._is_closed(name):
            return
        vessel, (tilt, heading) = filled.vessel, lean_of(R_WB[2])
        above = filled.volume - float(vessel.brim(tilt, heading))
        filled.restless = above > 0.0
        if not filled.restless:
            return
        head = float(vessel.liquid_head(filled.volume, tilt, heading))
        flow = float(outflow_rate(head, tilt, vessel.opening.radius))
        volume = min(flow * self._period, above)
        filled.volume -= volume
        into = None
        if tilt > _LEVEL:
            p_WL = p_WB + R_WB @ vessel.lip_point(heading)
            into = self._catching(name, p_WL, _level(R_WB[:, 2]), head, tilt, poses)
        if into is None:
            self.spilled += volume
        else:
            self._filled[into].volume += volume
            self._filled[into].restless = True

    def _catching(
        self,
        source: str,
        p_WL: Array,
        ahead: Array,
        head: float,
        tilt: float,
        poses: Mapping[str, tuple[Array, Array]],
    ) -> str | None:
        """The container through whose opening a stream falls that leaves a lip."""
        found: list[tuple[float, str]] = []
        for name, filled in self._filled.items():
            if name == source or name not in poses or self._is_closed(name):
                continue
            R_WB, p_WB = poses[name]
            opening = filled.vessel.opening
            p_WO = p_WB + R_WB @ np.array([*opening.centre, filled.vessel.top])
            fall = p_WL[2] - p_WO[2]
            if fall <= 0.0 or R_WB[2, 2] < _OPEN_ABOVE:
                continue
            lands = p_WL[:2] + ahead * float(landing_distance(head, tilt, fall))
            if math.dist(lands, p_WO[:2]) < opening.radius:
                found.append((p_WO[2], name))
        return max(found)[1] if found else None

    def _settle(self, name: str, filled: _Filled, up: Array) -> None:
        """Lets a body's inertia follow its contents, if anything changed."""
        if filled.volume == self.contents[name] and _near(filled.up, up):
            return
        self.contents[name] = filled.volume
        filled.up = up.copy()
        if filled.volume > 0.0:
            filled.middle = filled.vessel.centroid(filled.volume, *lean_of(up))
        self._weigh(name, filled)

    def _weigh(self, name: str, filled: _Filled) -> None:
        from pydrake.multibody.tree import SpatialInertia

        bare = self._bare[name]
        com = bare.get_com()
        mass, middle = _with_contents(bare.get_mass(), com, filled)
        G_BBcm = bare.get_unit_inertia().ShiftToCenterOfMass(com)
        changed = SpatialInertia(mass, middle, G_BBcm.ShiftFromCenterOfMass(middle))
        self._model.bodies[name].SetSpatialInertiaInBodyFrame(self._context, changed)


def lean_of(up: Array) -> tuple[float, float]:
    """Lean of a body in which the vertical is `up`, and its direction in x, y there [rad]."""
    x, y, z = up.tolist()
    return math.atan2(math.hypot(x, y), z), math.atan2(-y, -x)


def _filled_container(truth: Truth) -> _Filled:
    container, vessel = truth.container, truth.vessel
    assert container is not None
    assert vessel is not None
    middle = vessel.centroid(container.contents, 0.0, 0.0)
    return _Filled(truth, vessel, container, container.contents, middle)


def _with_contents(mass: float, middle: Array, filled: _Filled) -> tuple[float, Array]:
    """Mass and centre of mass of a body with the contents of now instead of those at the start."""
    density, before = filled.container.density, filled.container.contents
    at_first = filled.vessel.centroid(before, 0.0, 0.0)
    now = mass + density * (filled.volume - before)
    moment = mass * middle + density * (filled.volume * filled.middle - before * at_first)
    return now, moment / now


def _level(v: Array) -> Array:
    """The horizontal direction of a vector, shape (2,)."""
    return np.asarray(v[:2] / max(math.hypot(v[0], v[1]), 1e-12))


def _near(before: Array, now: Array) -> bool:
    return bool(np.abs(now - before).max() < _TURNED)
