"""A plan as a picture: the table from above, and the touched face as it looks from outside.

Drawn are the contacts, the way of the object, its predicted end as a ghost, and the distance that
is kept from everything else. All of it is belief. Colours are Okabe and Ito's, and each also has a
line or a mark of its own, so that they are told apart without red and green.

Frames: the picture is W's table plane as the robot sees it, x upwards and y to the left.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from textwrap import fill, wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from nlcontrol.plan_text import plan_lines
from nlcontrol.references.object_names import face_names
from nlcontrol.reports.predicted_places import end_poses, plan_contacts
from objectmodels.geometry.base_shapes import hull_polygon
from objectmodels.geometry.rotations import Array, from_quaternion
from planner.problem.footprints import footprint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nlcontrol.results.result import Result, Step
    from planner.types.actions import PushAction
    from planner.types.plan import Plan
    from planner.types.world_state import SeenObject, WorldState

BLUE, ORANGE, PURPLE, GREY, DARK = "#0072b2", "#d55e00", "#a0307a", "#8a8a8a", "#222222"
_MARGIN = 0.06  # of the picture around what is drawn [m]
_ROUND = np.linspace(0.0, 2.0 * np.pi, 33)
_WRAP = 150  # characters of a line below the picture


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
    told = "\n".join(fill(line.strip(), _WRAP) for line in list(plan_lines(step.plan))[:2])
    figure.legend(
        entries.values(), entries.keys(), fontsize=8, loc="outside lower left", ncols=6,
        frameon=False, title=told, title_fontsize=8, alignment="left",
    )  # fmt: skip
    figure.suptitle("\n".join(wrap(f"“{result.text}”", 90)), fontsize=12, fontweight="bold")
    return figure


# -- the table from above -------------------------------------------------------------------------


def _draw_table(axes: Axes, step: Step, plan: Plan, state: WorldState) -> None:
    target = state.objects[plan.object]
    drawn = [footprint(target)]
    for seen in state.objects.values():
        _draw_object(axes, seen, moved=seen is target)
        if seen is not target:
            kept = _grown(footprint(seen), _clearance(seen, step, plan))
            style = {"color": GREY, "linestyle": ":", "linewidth": 1.2}
            drawn.append(_outline(axes, kept, "distance kept", **style))
    for ghost in end_poses([step]):
        corners = _corners(target, np.array(ghost.pose))
        style = {"color": ORANGE, "linestyle": "--", "linewidth": 1.8}
        drawn.append(_outline(axes, corners, "predicted end", **style))
    drawn.append(_draw_way(axes, plan, target, state))
    R_WB, p_WB = target.body_pose
    marks = [p_WB + R_WB @ np.array(mark.place) for mark in plan_contacts(plan, R_WB, target.rest)]
    if marks:
        x, y, _ = np.transpose(marks)
        axes.plot(
            y, x, "o", color=PURPLE, markeredgecolor="white", markersize=7, zorder=5,
            label="contact", linestyle="none",
        )  # fmt: skip
    _frame(axes, np.concatenate(drawn), state)


def _clearance(seen: SeenObject, step: Step, plan: Plan) -> float:
    """Distance that is kept from another object [m]."""
    assert step.basis is not None, "what is planned has an object"
    defaults = step.basis.defaults
    usual = defaults.clearance_fragile if seen.fragile else defaults.clearance
    return max(dict(plan.limits.clear_of).get(seen.name, 0.0), usual)


def _draw_object(axes: Axes, seen: SeenObject, *, moved: bool) -> None:
    colour, width = (BLUE, 1.8) if moved else (DARK, 0.9)
    corners = footprint(seen)
    notes = [word for word in ("fragile", "fixed") if getattr(seen, word)]
    axes.fill(
        corners[:, 1], corners[:, 0], facecolor=f"{colour}22", edgecolor=colour, linewidth=width,
        hatch="//" if seen.fragile else None, zorder=2,
    )  # fmt: skip
    x, y = corners.mean(axis=0)
    axes.text(
        y, x, "\n".join((fill(seen.name, 9), *notes)), color=colour, fontsize=7, ha="center",
        va="center", zorder=6, fontweight="bold" if moved else "normal",
    )  # fmt: skip


def _draw_way(axes: Axes, plan: Plan, target: SeenObject, state: WorldState) -> Array:
    """The way of the object's middle and the push; returns its points in W, shape (k, 2) [m]."""
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
    return points


def _arrow(axes: Axes, start: Array, end: Array, label: str, **style: Any) -> None:
    axes.annotate(
        "", (end[1], end[0]), (start[1], start[0]), zorder=4,
        arrowprops={"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, **style},
    )  # fmt: skip
    axes.plot([], [], label=label, **style)


def _outline(axes: Axes, corners: Array, label: str, **style: Any) -> Array:
    closed = np.vstack([corners, corners[:1]])
    axes.plot(closed[:, 1], closed[:, 0], label=label, zorder=3, **style)
    return corners


def _frame(axes: Axes, points: Array, state: WorldState) -> None:
    """Axes, the table's edges and a legend around all that is drawn, shape (k, 2) [m]."""
    table = state.table
    edges = np.array(
        [[table.x_min, table.y_min], [table.x_max, table.y_min], [table.x_max, table.y_max],
         [table.x_min, table.y_max]]
    )  # fmt: skip
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


# -- the face from outside ------------------------------------------------------------------------


def _draw_face(axes: Axes, push: PushAction, seen: SeenObject) -> None:
    """The touched face with the contacts, and the heights above which it would topple."""
    normal = seen.pose.R_WB.T @ push.normal_W
    face = max(face_names(seen.model).values(), key=lambda each: np.dot(each.normal, normal))
    half = face.width / 2
    axes.fill(
        [-half, half, half, -half], [face.bottom, face.bottom, face.top, face.top],
        facecolor=f"{BLUE}22", edgecolor=BLUE, linewidth=1.4,
    )  # fmt: skip
    aside = float((np.array(push.p_BC) - face.centre) @ face.tangent)
    for side in (-0.5, 0.5) if push.fingers == 2 else (0.0,):
        axes.plot(
            aside + side * push.spread, push.p_BC[2], "o", color=PURPLE, markersize=8,
            markeredgecolor="white",
        )  # fmt: skip
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
