"""A plan as a picture: the table from above, and the touched face as it looks from outside.

Drawn are the contacts, the way of the object, its predicted end as a ghost, and the distance that
is kept from everything else. All of it is belief. Colours are Okabe and Ito's, and each also has a
line or a mark of its own, so that they are told apart without red and green.

Frames: the picture is W's table plane as the robot sees it, x upwards and y to the left.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from textwrap import fill, wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from nlcontrol.plan_text import plan_lines
from nlcontrol.references.object_names import face_names
from objectmodels.geometry.base_shapes import hull_polygon
from objectmodels.geometry.rotations import Array, from_quaternion, quaternion, rot_z
from planner.problem.footprints import footprint
from planner.problem.predicted_states import fallen_pose, standing_object
from planner.touch_experiments import Kind
from sim.exploration.trial_extraction import force_curve
from sim.views.run_story import ContactMark, Ghost

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nlcontrol.results.result import Result, Step
    from objectmodels.models.object_model import Resting
    from planner.types.actions import GraspAction, PushAction
    from planner.types.plan import Plan
    from planner.types.world_state import SeenObject, WorldState
    from sim.exploration.exploration_run import Touched


# Places that a plan predicts: where objects are touched, and the poses in which they end.
#
# All of it is belief. A pose is a row of a trace: quaternion (w, x, y, z) and position in W [m].


_Mark = tuple[Array, Array]  # a place and the outward normal there, in the frame of a plan


def end_poses(steps: Sequence[Step]) -> Iterator[Ghost]:
    """Poses in which moved objects end, as predicted."""
    ends = {}
    for step in steps:
        if step.plan is not None and step.basis is not None:
            ends[step.plan.object] = _end_pose(step.plan, step.basis.target)
    for name, pose in ends.items():
        if pose is not None:
            yield Ghost(name, tuple(pose.round(6).tolist()))


def _end_pose(plan: Plan, target: SeenObject) -> Array | None:
    """The predicted pose at the end, as a row of a trace; None if none was predicted."""
    before, rest = target.pose, target.rest
    if plan.task == "topple" and plan.pushes:
        return _row(rest, *fallen_pose(plan.push, before))
    if plan.task == "stand" and plan.aim is not None:
        return _row(None, *standing_object(target, plan.aim).body_pose)
    if plan.aim is not None:
        last = plan.actions[-1]
        height = last.height if last.kind == "set_on" else 0.0
        yaw = before.yaw if plan.aim.yaw is None else plan.aim.yaw
        return _row(rest, rot_z(yaw), np.array([plan.aim.x, plan.aim.y, height]))
    if plan.pushes and plan.push.displacement is not None:
        return _row(rest, before.R_WB, before.p_WB + plan.push.displacement)
    if plan.task == "lift":
        height = sum(step.height for step in plan.steps if step.kind == "lift_up")
        return _row(rest, before.R_WB, before.p_WB + np.array([0.0, 0.0, height]))
    return None


def _row(rest: Resting | None, R_WN: Array, p_WN: Array) -> Array:
    """The pose of the object's own B, from that of the face on which it lies."""
    R_WB, p_WB = (R_WN, p_WN) if rest is None else rest.body_pose(R_WN, p_WN)
    return np.concatenate([quaternion(R_WB), p_WB])


def plan_contacts(
    plan: Plan, R_WB: Array, rest: Resting | None, since: float = 0.0
) -> Iterator[ContactMark]:
    """Places where the fingertips touch in the first action of a plan.

    Args:
        plan: of pushes or of a hand.
        R_WB: attitude of its object, shape (3, 3).
        rest: how that lies, if not on its bottom.
        since: when they count [s].
    """
    R_BN, p_BN = (np.eye(3), np.zeros(3)) if rest is None else (rest.R_BN, rest.p_BN)
    R_WN = R_WB @ R_BN
    marks = _push_marks(plan.push, R_WN) if plan.pushes else _grasp_marks(plan.grasp, R_WN)
    for there, out in marks:
        place, outward = p_BN + R_BN @ there, R_BN @ out
        x, y, z = place.round(5).tolist()
        yield ContactMark(since, plan.object, (x, y, z), tuple(outward.round(5).tolist()))


def _push_marks(push: PushAction, R_WN: Array) -> Iterator[_Mark]:
    """Places where the fingertips push."""
    n = np.array(push.normal_W) @ R_WN
    along = np.cross([0.0, 0.0, 1.0] @ R_WN, n)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        yield push.p_BC + side * push.spread * along, n


def _grasp_marks(grasp: GraspAction | None, R_WN: Array) -> Iterator[_Mark]:
    """Places where thumb and fingers hold an object; a lid's own contacts are on no object."""
    if grasp is None or grasp.part == "lid":
        return
    closing = np.array(grasp.closing_W) @ R_WN
    for side in (-1.0, 1.0):
        yield grasp.p_BG + 0.5 * side * grasp.width * closing, side * closing


BLUE, ORANGE, PURPLE, GREY, DARK = "#0072b2", "#d55e00", "#a0307a", "#8a8a8a", "#222222"
_MARGIN = 0.06  # of the picture around what is drawn [m]
_ROUND = np.linspace(0.0, 2.0 * np.pi, 33)


def save_plan(result: Result, state: WorldState, path: Path) -> None:
    """Draws the plan of a result: PNG, SVG or PDF by the path's ending; see `plan_figure`."""
    figure = plan_figure(result, state)
    figure.draw_without_rendering()  # the layout converges in two steps
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def plan_figure(result: Result, state: WorldState) -> Figure:
    """The drawing of the plan of a result's last step.

    Args:
        result: of a sentence that was planned.
        state: what was believed when it was planned.
    """
    from matplotlib.figure import Figure

    step = result.steps[-1]
    assert step.plan is not None, "without a plan there is nothing to draw"
    figure = Figure(figsize=(9.0, 5.6), dpi=160, layout="constrained")
    # What is drawn from above shows its contact there.
    if step.plan.pushes and not step.plan.push.press:
        above, face = figure.subplots(1, 2, width_ratios=(3.2, 1.0))
        _draw_face(face, step.plan.push, state.objects[step.plan.object])
    else:
        above = figure.add_subplot()
    _draw_table(above, step, step.plan, state)
    handles, labels = above.get_legend_handles_labels()
    entries = dict(zip(labels, handles, strict=True))
    # 150 characters of a line fit below the picture.
    told = "\n".join(fill(line.strip(), 150) for line in list(plan_lines(step.plan))[:2])
    figure.legend(
        entries.values(),
        entries.keys(),
        fontsize=8,
        loc="outside lower left",
        ncols=6,
        frameon=False,
        title=told,
        title_fontsize=8,
        alignment="left",
    )
    figure.suptitle("\n".join(wrap(f"“{result.text}”", 90)), fontsize=12, fontweight="bold")
    return figure


def _draw_table(axes: Axes, step: Step, plan: Plan, state: WorldState) -> None:
    target = state.objects[plan.object]
    drawn = [footprint(target)]
    for seen in state.objects.values():
        _draw_object(axes, seen, moved=seen is target)
        if seen is not target:
            # Distance that is kept from another object [m].
            assert step.basis is not None, "what is planned has an object"
            defaults = step.basis.defaults
            usual = defaults.clearance_fragile if seen.fragile else defaults.clearance
            kept = _grown(
                footprint(seen), max(dict(plan.limits.clear_of).get(seen.name, 0.0), usual)
            )
            style = {"color": GREY, "linestyle": ":", "linewidth": 1.2}
            drawn.append(_outline(axes, kept, "distance kept", **style))
    for ghost in end_poses([step]):
        corners = _corners(target, np.array(ghost.pose))
        style = {"color": ORANGE, "linestyle": "--", "linewidth": 1.8}
        drawn.append(_outline(axes, corners, "predicted end", **style))
    # The way of the object's middle and the push; returns its points in W, shape (k, 2) [m].
    here = target.pose.p_WB[:2]
    stops = [
        (step.to.x, step.to.y) if step.kind == "carry" else state.objects[step.into].pose.p_WB[:2]
        for step in plan.actions
        if step.kind in ("carry", "pour_out")
    ]
    if plan.aim is not None and not stops:
        stops = [(plan.aim.x, plan.aim.y)]
    points = np.array([here, *stops])
    for start, end in pairwise(points):
        if np.linalg.norm(end - start) > 0.005:
            _arrow(axes, start, end, "way", color=ORANGE, linewidth=1.4)
    if plan.pushes:
        push = plan.push
        contact = here + (target.pose.R_WB @ np.array(push.p_BC))[:2]
        ahead = 0.05 * np.array(push.direction_W[:2])
        _arrow(axes, contact - ahead, contact, "push", color=PURPLE, linewidth=2.4)
        points = np.vstack([points, contact - ahead])
    drawn.append(points)
    R_WB, p_WB = target.body_pose
    marks = [p_WB + R_WB @ np.array(mark.place) for mark in plan_contacts(plan, R_WB, target.rest)]
    if marks:
        x, y, _ = np.transpose(marks)
        axes.plot(
            y,
            x,
            "o",
            color=PURPLE,
            markeredgecolor="white",
            markersize=7,
            zorder=5,
            label="contact",
            linestyle="none",
        )
    _frame(axes, np.concatenate(drawn), state)


def _draw_object(axes: Axes, seen: SeenObject, *, moved: bool) -> None:
    colour, width = (BLUE, 1.8) if moved else (DARK, 0.9)
    corners = footprint(seen)
    notes = [word for word in ("fragile", "fixed") if getattr(seen, word)]
    axes.fill(
        corners[:, 1],
        corners[:, 0],
        facecolor=f"{colour}22",
        edgecolor=colour,
        linewidth=width,
        hatch="//" if seen.fragile else None,
        zorder=2,
    )
    x, y = corners.mean(axis=0)
    axes.text(
        y,
        x,
        "\n".join((fill(seen.name, 9), *notes)),
        color=colour,
        fontsize=7,
        ha="center",
        va="center",
        zorder=6,
        fontweight="bold" if moved else "normal",
    )


def _arrow(axes: Axes, start: Array, end: Array, label: str, **style: Any) -> None:
    axes.annotate(
        "",
        (end[1], end[0]),
        (start[1], start[0]),
        zorder=4,
        arrowprops={"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, **style},
    )
    axes.plot([], [], label=label, **style)


def _outline(axes: Axes, corners: Array, label: str, **style: Any) -> Array:
    closed = np.vstack([corners, corners[:1]])
    axes.plot(closed[:, 1], closed[:, 0], label=label, zorder=3, **style)
    return corners


def _frame(axes: Axes, points: Array, state: WorldState) -> None:
    """Axes, the table's edges and a legend around all that is drawn, shape (k, 2) [m]."""
    table = state.table
    edges = np.array(
        [
            [table.x_min, table.y_min],
            [table.x_max, table.y_min],
            [table.x_max, table.y_max],
            [table.x_min, table.y_max],
        ]
    )
    (x_min, y_min), (x_max, y_max) = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    if x_min < table.x_min or x_max > table.x_max or y_min < table.y_min or y_max > table.y_max:
        _outline(axes, edges, "edge of the table", color=DARK, linewidth=1.6)
    axes.set_xlim(y_max, y_min)  # y to the left
    axes.set_ylim(x_min, x_max)
    axes.set_aspect("equal")
    axes.xaxis.set_major_formatter(_millimetres)
    axes.yaxis.set_major_formatter(_millimetres)
    axes.tick_params(labelsize=7)
    axes.set_xlabel("y, to the robot's left [mm]", fontsize=8)
    axes.set_ylabel("x, away from the robot [mm]", fontsize=8)
    axes.set_title("the table from above, as the robot sees it", fontsize=9)


def _millimetres(value: float, _position: float) -> str:
    return f"{1e3 * value:z.0f}"


def _corners(seen: SeenObject, pose: Array) -> Array:
    """Corners of what an object covers in a pose X_WB, a row of a trace; shape (k, 2) [m]."""
    outline, top = seen.standing_model.outline, seen.standing_model.top
    solid = np.array([[x, y, z] for z in (0.0, top) for x, y in outline])
    return np.asarray(
        hull_polygon((solid @ from_quaternion(pose[:4]).T + pose[4:])[:, :2]).vertices
    )


def _grown(corners: Array, distance: float) -> Array:
    """Corners of a convex polygon with so much around it, shape (k, 2) [m]."""
    disc = distance * np.column_stack((np.cos(_ROUND), np.sin(_ROUND)))
    return np.asarray(hull_polygon((corners[:, None] + disc).reshape(-1, 2)).vertices)


def _draw_face(axes: Axes, push: PushAction, seen: SeenObject) -> None:
    """The touched face with the contacts, and the heights above which it would topple."""
    normal = seen.pose.R_WB.T @ push.normal_W
    face = max(face_names(seen.model).values(), key=lambda each: np.dot(each.normal, normal))
    half = face.width / 2
    axes.fill(
        [-half, half, half, -half],
        [face.bottom, face.bottom, face.top, face.top],
        facecolor=f"{BLUE}22",
        edgecolor=BLUE,
        linewidth=1.4,
    )
    aside = float((np.array(push.p_BC) - face.centre) @ face.tangent)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        axes.plot(
            aside + side * push.spread,
            push.p_BC[2],
            "o",
            color=PURPLE,
            markersize=8,
            markeredgecolor="white",
        )
    found = push.prediction
    other = "slides below" if push.ends_on == "toppled" else "topples above"
    for height, style, words in (
        (found.critical_height, "--", "as believed"),
        (found.critical_height_worst, ":", "worst case"),
    ):
        if height is not None and height < face.top:
            axes.axhline(height, color=ORANGE, linestyle=style, linewidth=1.4)
            told = f"{other} {1e3 * height:.0f} mm\n{words}"
            axes.text(half, height, told, fontsize=6.5, color=ORANGE, ha="right", va="bottom")
    axes.axhline(0.0, color=DARK, linewidth=1.6)
    axes.set_xlim(-1.3 * half, 1.3 * half)
    axes.set_ylim(-0.05 * face.top, 1.08 * face.top)
    axes.set_aspect("equal")
    axes.xaxis.set_major_formatter(_millimetres)
    axes.yaxis.set_major_formatter(_millimetres)
    axes.tick_params(labelsize=7)
    axes.set_title(f"{push.face} face, from outside\n{1e3 * push.p_BC[2]:.0f} mm up", fontsize=9)


# A sheet to draw boxes, texts and ties on, measured in inches from its upper left corner.
#
# Texts are measured before they are placed, so a layout can give each as much room as it needs.


LINE = 1.35
"""Distance of lines as a share of the size of the letters."""

_DPI = 150


def line_height(size: float) -> float:
    """Height of a line of text [in], by the size of its letters in points."""
    # 72 points are an inch.
    return LINE * size * (1.0 / 72.0)


class Sheet:
    """A sheet of a given width [in]; its height is known when it is saved."""

    def __init__(self, width: float) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._figure = Figure(figsize=(width, width), dpi=_DPI, facecolor="white")
        canvas: Any = FigureCanvasAgg(self._figure)
        self._renderer = canvas.get_renderer()
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        self._axes.set_xlim(0.0, width)
        self._width = width

    def length(self, text: str, size: float, *, bold: bool = False) -> float:
        """Length of a text in one line [in]."""
        from matplotlib.font_manager import FontProperties

        font = FontProperties(size=size, weight="bold" if bold else "normal")
        return float(self._renderer.get_text_width_height_descent(text, font, False)[0]) / _DPI

    def lines_of(self, text: str, width: float, size: float, *, bold: bool = False) -> list[str]:
        """The lines of a text that is not to be longer than `width` [in].

        A word that is too long by itself is divided.
        """
        lines = [""]
        for word in text.split():
            rest = word
            if not self._fits(f"{lines[-1]} {rest}".strip(), width, size, bold):
                lines.append("")
            while not self._fits(rest, width, size, bold):
                most = next(
                    n
                    for n in range(len(rest) - 1, 0, -1)
                    if n == 1 or self._fits(rest[:n], width, size, bold)
                )
                lines[-1:] = [rest[:most], ""]
                rest = rest[most:]
            lines[-1] = f"{lines[-1]} {rest}".strip()
        return [line for line in lines if line] or [""]

    def _fits(self, text: str, width: float, size: float, bold: bool) -> bool:
        return len(text) < 2 or self.length(text, size, bold=bold) <= width

    def write(self, x: float, y: float, text: str, size: float, colour: str, **style: Any) -> None:
        """Writes a line of text, its middle at a height y."""
        # Names in a sentence may hold the signs that mark formulae.
        self._axes.text(
            x, y, text, fontsize=size, color=colour, va="center_baseline", parse_math=False, **style
        )

    def box(
        self, x: float, y: float, width: float, height: float, colour: str, fill: str, **style: Any
    ) -> None:
        """Draws a box with round corners."""
        from matplotlib.patches import FancyBboxPatch

        self._axes.add_patch(
            FancyBboxPatch(
                (x, y),
                width,
                height,
                boxstyle="round,pad=0,rounding_size=0.07",
                edgecolor=colour,
                facecolor=fill,
                linewidth=1.3,
                **style,
            )
        )

    def tie(
        self, start: tuple[float, float], end: tuple[float, float], colour: str, **style: Any
    ) -> None:
        """Draws a curve from one point to another, level at both ends."""
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path as Curve

        bend = 0.5 * (start[0] + end[0])
        points = [start, (bend, start[1]), (bend, end[1]), end]
        curve = Curve(points, [Curve.MOVETO, Curve.CURVE4, Curve.CURVE4, Curve.CURVE4])
        style = {"linewidth": 1.4, "zorder": 0} | style
        self._axes.add_patch(PathPatch(curve, facecolor="none", edgecolor=colour, **style))

    def save(self, path: Path, height: float) -> None:
        """Writes the sheet to a file, as high as it has become [in]."""
        self._figure.set_size_inches(self._width, height)
        self._axes.set_ylim(height, 0.0)
        self._figure.savefig(path)


# Force curves of an exploration: one panel for each kind of experiment, the onsets marked.
#
# Thin and pale stand the samples, drawn through them their running mean. What a panel tells
# stands above it. A rub has a second curve: the force with which the fingertip drags along the
# face.


TELLS: Mapping[Kind, str] = {
    "tilt": "the onset tells weight × lever, the fall the height of the mass",
    "slide": "the level tells friction × weight",
    "off-centre slide": "with the turn, the level tells the friction radius",
    "rub": "dashed over solid, once even, is the friction at the finger",
}
"""What the curves of each experiment say about the object."""

MEAN_OVER = 0.1
"""Time over which the running mean is taken [s]."""

_COLOURS = {"front": "#0072b2", "back": "#d55e00", "left": "#009e73", "right": "#cc79a7"}
_SAMPLES, _MEAN = 0.12, 0.9  # opacity


def save_curves(touches: Sequence[Touched], name: str, path: Path) -> None:
    """Draws the force over the time since the touch: PNG, SVG or PDF by the path's ending."""
    from matplotlib.figure import Figure

    drawn = [touched for touched in touches if len(touched.recording.time)]
    kinds = list(dict.fromkeys(touched.experiment.kind for touched in drawn))
    rows = (len(kinds) + 1) // 2
    figure = Figure(figsize=(8.4, 1.0 + 3.0 * max(rows, 1)), dpi=160, layout="constrained")
    for place, kind in enumerate(kinds, start=1):
        axes = figure.add_subplot(rows, 2 if len(kinds) > 1 else 1, place)
        here = [touched for touched in drawn if touched.experiment.kind == kind]
        _draw(axes, here)
        times = f"{len(here)} touches" if len(here) > 1 else "1 touch"
        axes.set_title(f"{kind}, {times}", fontsize=10, fontweight="bold", loc="left", pad=18)
        axes.annotate(
            TELLS[kind],
            (0.0, 1.0),
            (0.0, 4.0),
            xycoords="axes fraction",
            fontsize=8,
            textcoords="offset points",
            va="bottom",
            color="#444444",
        )
    sides = dict.fromkeys(touched.experiment.push.face for touched in drawn)
    handles = [axes.plot([], [], color=_COLOURS[side], label=f"at the {side}")[0] for side in sides]
    if "rub" in kinds:
        handles.append(axes.plot([], [], "--", color="#444444", label="along the face")[0])
    if set(kinds) - {"rub"}:
        handles.append(axes.plot([], [], "o", color="black", label="onset of motion", ms=4)[0])
    figure.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=8, frameon=False)
    figure.suptitle(f"{name}: force felt along each push", fontsize=12, fontweight="bold")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _draw(axes: Axes, touches: Sequence[Touched]) -> None:
    for touched in touches:
        recording, found = touched.recording, force_curve(touched.recording)
        colour = _COLOURS[touched.experiment.push.face]
        rubs = touched.experiment.kind == "rub"
        forces = {"-": found.force} | ({"--": -recording.forces[:, 2]} if rubs else {})
        for style, force in forces.items():
            axes.plot(found.time, force, style, color=colour, alpha=_SAMPLES, linewidth=0.6)
            axes.plot(*_running(found.time, force), style, color=colour, alpha=_MEAN, linewidth=1.0)
        if found.onset is not None and found.onset.moved and not rubs:
            axes.plot(
                found.onset.time,
                found.onset.force,
                "o",
                color="black",
                ms=4.5,
                mec="white",
                mew=0.6,
                zorder=3,
            )
    axes.set_xlabel("time since the touch [s]", fontsize=8)
    axes.set_ylabel("force [N]", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.set_xlim(0.0, None)
    axes.set_ylim(0.0, None)
    axes.grid(visible=True, linewidth=0.3, alpha=0.5)


def _running(time: Array, force: Array) -> tuple[Array, Array]:
    """Means over `MEAN_OVER`; all samples if there are too few."""
    if len(time) < 2:
        return time, force
    width = max(1, min(len(time), round(MEAN_OVER / float(np.median(np.diff(time))))))
    window = np.full(width, 1.0 / width)
    return np.convolve(time, window, "valid"), np.convolve(force, window, "valid")
