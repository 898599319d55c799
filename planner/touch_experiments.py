"""Experiments with which a robot finds the parameters of an object by touching it.

- *Tilt*: press a side 1 cm below the top, square to it, until the object has tilted a few degrees.
  The force at the start gives weight times the lever of the centre of mass; opposite sides tell the
  two apart; how the force falls with the tilt gives the height of the centre of mass.
- *Slide*: press as low as the finger gets, in the middle of a side, until the object has slid by a
  centimetre: friction.
- *Off-centre slide*: the same near the end of a side; how far the object turns gives the friction
  radius. At one end it is made as low, at the other as high as the object surely slides: pushed
  high, the load moves to the far edge, and how the object then turns tells whether it stands on its
  corners or all over its base.
- *Rub*: press a side gently and draw the fingertip down along it until it slips: finger friction.
- *Press*: press any place of a side straight in until something has moved, whatever that is.

Each is a push of one fingertip, so reach and clearance are asked for as for any push. What is
proposed depends on what is believed: a tilt needs a height at which the object may tilt at all.

Frames: W is the world, B the object's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.side_faces import Face
from objectmodels.identification.trial import Trial
from objectmodels.mechanics import push_thresholds
from objectmodels.models.object_model import ObjectModel
from objectmodels.safety_figure import SafetyFigure
from planner.problem.directions import face_name
from planner.types.actions import Push
from planner.types.robot import RobotLimits
from planner.types.world_state import SeenObject

Kind = Literal["tilt", "slide", "off-centre slide", "rub", "press"]

MOST_FORCE: SafetyFigure = 10.0
"""Largest force with which an object is touched, if the finger has as much [N]."""

BELOW_TOP: SafetyFigure = 0.010
"""Distance of a tilt's contact from the top [m]."""

SLIDE = 0.012
"""Way of a slide [m]."""

TILT = np.radians(8.0)
"""Largest tilt of an experiment [rad]."""

TILT_SHARE: SafetyFigure = 0.4
"""A tilt stays below this share of the angle of no return, in the worst case believed."""

SPEED: Mapping[Kind, float] = {
    "tilt": 0.008,
    "slide": 0.005,
    "off-centre slide": 0.005,
    "rub": 0.005,
    "press": 0.0025,
}
"""Of the fingertip while it presses [m/s]."""

RUB = 0.010
"""Way of a rub [m]."""

PRESS, RAISED = 0.003, 0.0015
"""Way of a press, and how far it raises an edge of the base at least if the object tilts [m]."""

_SIGMAS: SafetyFigure = 2.0
_SURE, _HEIGHTS = 0.99, 9  # believed probability of a slide that is sure, and heights tried


@dataclass(frozen=True, eq=False)
class Experiment:
    """One touch that shows something about an object.

    Attributes:
        kind: see the module.
        push: where the fingertip touches, which way and how far it goes then.
        onset: force at which the object is believed to move [N].
        angle: of a tilt, at which it ends [rad].
        length: from the touched side to the far edge of the base, about which it would tilt [m].
        R_WB: orientation in which the object was seen, shape (3, 3).
        lateral: place of the contact along its face from the middle [m].
        raised: of a rub, how far above `push.p_BC` it begins [m].
    """

    kind: Kind
    push: Push
    onset: float
    length: float
    R_WB: Array = field(repr=False)
    angle: float = 0.0
    lateral: float = 0.0
    raised: float = 0.0

    @property
    def name(self) -> str:
        """Name in words, such as `tilt at the front`."""
        return f"{self.kind} at the {self.push.face}"


def experiments(seen: SeenObject, limits: RobotLimits) -> tuple[Experiment, ...]:
    """All experiments that the object's shape and the beliefs about it allow.

    Whether the hand gets there is another question.
    """
    # A round side is touched where the robot's own directions meet it.
    headings = np.array([np.pi, -np.pi / 2, 0.0, np.pi / 2]) - seen.pose.yaw
    found: list[Experiment] = []
    for face in seen.model.faces(headings):
        room = face.width / 2.0 - limits.fingertip_radius
        low = max(limits.lowest_height, face.bottom)
        if room < 0.0 or face.normal[2] != 0.0 or low > face.top - BELOW_TOP:
            continue
        tilt = _tilt_experiment(seen, face, face.top - BELOW_TOP, limits)
        found += [tilt] if tilt is not None else []
        found.append(_slide_experiment(seen, face, 0.0, low, limits))
        # Distance from the middle of a side from which on a slide is off-centre [m].
        if not face.curvature and room > 0.002:
            high = _still_slides(seen.model, face, -room, low)
            found += [
                _slide_experiment(seen, face, y, z, limits) for y, z in ((room, low), (-room, high))
            ]
        point, normal = face.points_at(0.0, max(0.4 * face.top, low))
        found.append(
            replace(_touch_experiment("rub", seen, point, normal, 0.0, limits), raised=RUB)
        )
    return tuple(found)


def press(seen: SeenObject, point: Array, normal: Array, limits: RobotLimits) -> Experiment:
    """A press at any place of an upright face, straight in, until something has moved.

    Args:
        seen: the object.
        point: p_BC, shape (3,) [m].
        normal: outward unit normal there in B, horizontal, shape (3,).
        limits: figures of the robot.
    """
    # Tilted, the far edge stays; the near one rises as far behind it as the contact moves above it.
    stroke = RAISED * float(point[2]) / push_thresholds.length_along(seen.model, -normal)
    return _touch_experiment("press", seen, point, normal, max(PRESS, stroke), limits)


def expected_trials(experiment: Experiment, model: ObjectModel) -> tuple[Trial, ...]:
    """Trials that an experiment would show if the model were right, with their precision."""
    point = experiment.push.p_BC
    R_WB = experiment.R_WB
    u = R_WB.T @ np.array(experiment.push.direction_W)
    x, y, z = (experiment.onset * u).tolist()
    # A force is felt to a hundredth.
    trial = Trial("slide", point, (x, y, z), 0.01 * experiment.onset, source=experiment.name)
    if experiment.kind == "tilt":
        # Shares of the largest tilt at which the balance is read.
        tilts = np.linspace(0.2, 0.85, 2) * experiment.angle
        return tuple(replace(trial, moved="topple", tilt=float(tilt)) for tilt in tilts)
    if experiment.kind == "rub":
        n_x, n_y, _ = (-u).tolist()
        force = (x, y, z - model.finger_friction * experiment.onset)
        return (replace(trial, moved="slip", force=force, normal=(n_x, n_y, 0.0)),)
    turn = float(np.nan_to_num(model.thresholds([point], [u]).twist[0, 2]))
    return (replace(trial, turn_rate=turn, turn_rate_sd=0.4),)  # [rad/m]


def _tilt_experiment(
    seen: SeenObject, face: Face, height: float, limits: RobotLimits
) -> Experiment | None:
    model = seen.model
    point, normal = face.points_at(0.0, height)
    # Least believed probability of a tilt worth a trial.
    if float(model.likelihood([point], [-normal], exact=False).topple[0]) < 0.02:
        return None
    fall = model.angle_of_no_return(-normal, sigmas=_SIGMAS)
    angle = float(min(TILT, TILT_SHARE * fall))
    stroke = model.topple_stroke(-normal, height, angle)
    return replace(_touch_experiment("tilt", seen, point, normal, stroke, limits), angle=angle)


def _slide_experiment(
    seen: SeenObject, face: Face, lateral: float, height: float, limits: RobotLimits
) -> Experiment:
    point, normal = face.points_at(lateral, height)
    kind: Kind = "slide" if lateral == 0.0 else "off-centre slide"
    return replace(_touch_experiment(kind, seen, point, normal, SLIDE, limits), lateral=lateral)


def _still_slides(model: ObjectModel, face: Face, lateral: float, low: float) -> float:
    """The greatest height, up to the middle of a face, at which the object surely slides [m]."""
    heights = np.linspace(low, max(low, 0.5 * face.top), _HEIGHTS)
    points, normals = face.points_at(np.full(_HEIGHTS, lateral), heights)
    sure = model.likelihood(points, -normals, exact=False).slide > _SURE
    sure[0] = True
    return float(heights[np.flatnonzero(np.logical_and.accumulate(sure))[-1]])


def _touch_experiment(
    kind: Kind, seen: SeenObject, point: Array, normal: Array, stroke: float, limits: RobotLimits
) -> Experiment:
    x, y, z = point.tolist()
    normal_W = seen.pose.R_WB @ normal
    n_x, n_y, _ = normal_W.tolist()
    push = Push(
        object=seen.name,
        face=face_name(normal_W)[0],
        p_BC=(x, y, z),
        normal_W=(n_x, n_y, 0.0),
        direction_W=(-n_x, -n_y, 0.0),
        force_limit=min(MOST_FORCE, limits.max_force),
        speed=SPEED[kind],
        stroke=stroke,
        fingers=1,
        spread=0.0,
        ends_on="stroke",
    )
    return Experiment(
        kind,
        push,
        onset=float(seen.model.thresholds([point], [-normal]).onset[0]),
        length=push_thresholds.length_along(seen.model, -normal),
        R_WB=seen.pose.R_WB,
    )
