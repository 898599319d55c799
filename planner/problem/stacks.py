"""Who stands on whom, and how surely.

Model: what is seen as high above the table as another object's top, its middle over that, stands on
it; what is seen within the walls of an open box, below its rim, stands on its floor. Stability is
that of `objectmodels.mechanics.standing_balance`. Frames: W is the world, B an object.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from objectmodels.geometry.base_shapes import Polygon
from objectmodels.mechanics.standing_balance import StackedBody
from objectmodels.models.object_parts import inner_floor
from planner.types.world_state import SeenObject

_SAME_HEIGHT = 0.012  # heights that differ by less are one, as a biased camera sees them [m]


def with_supports(
    objects: Mapping[str, SeenObject], heights: Mapping[str, float]
) -> dict[str, SeenObject]:
    """The objects of a scene, each on what it stands.

    Args:
        objects: by name, as if they stood on the table.
        heights: over the table at which bases are seen [m]; what has none stands on the table.
    """
    found = dict(objects)
    for name in sorted(heights, key=lambda name: heights[name]):
        seen, height = found[name], heights[name]
        box = next((other for other in found.values() if _is_inside(seen, height, other)), None)
        if box is not None:
            found[name] = put_on(seen, box)
            continue
        lower = [
            other
            for other in found.values()
            if other.model.inside is None
            and heights.get(other.name, 0.0) < height
            and _is_over(seen, other)
        ]
        nearest = min(lower, key=lambda other: abs(other.top_height - height), default=None)
        if nearest is None or height < _SAME_HEIGHT:
            continue
        if abs(nearest.top_height - height) < _SAME_HEIGHT:
            found[name] = put_on(seen, nearest)
    return found


def put_on(seen: SeenObject, lower: SeenObject | None) -> SeenObject:
    """An object on another one, or on the table if that is None, where it is seen from above."""
    z, on = (
        (0.0, None) if lower is None else (lower.pose.z + lower.model.standing_height, lower.name)
    )
    return replace(seen, pose=replace(seen.pose, z=z), on=on)


def _is_over(seen: SeenObject, other: SeenObject) -> bool:
    """Return True if the middle of an object is above another one."""
    outline = Polygon.convex(other.bulk()[0])
    return bool((outline.normals @ [seen.pose.x, seen.pose.y] < outline.offsets).all())


def _is_inside(seen: SeenObject, height: float, box: SeenObject) -> bool:
    """Return True if the base of an object, so high [m], is within the walls of an open box."""
    inside = box.model.inside
    if inside is None or box.name == seen.name or box.attitude is not None:
        return False
    floor = face_in_world(inner_floor(inside), box)
    return height < box.top_height and bool(
        (floor.normals @ seen.pose.p_WB[:2] < floor.offsets).all()
    )


def level_top(seen: SeenObject) -> Polygon | None:
    """The face on which something may stand, in the object's frame; None if there is none."""
    if seen.attitude is not None or seen.model.lid is not None or seen.model.inside is not None:
        return None
    return seen.model.top_face


def stack_with(there: SeenObject, objects: Mapping[str, SeenObject]) -> list[SeenObject]:
    """The whole stack of which an object is to be a member, each after what it stands on.

    Args:
        there: the object, in its place; where it is among `objects` does not count.
        objects: by name.
    """
    root = there
    while root.on is not None:
        root = objects[root.on]
    others = {name: seen for name, seen in objects.items() if name != there.name}
    return [*_members(root, {**others, there.name: there})]


def _members(root: SeenObject, objects: Mapping[str, SeenObject]) -> Iterator[SeenObject]:
    """An object, and after it all that it carries."""
    yield root
    for seen in objects.values():
        if seen.on == root.name:
            yield from _members(seen, objects)


def stacked_bodies(stack: list[SeenObject], placed: str, place_sd: float) -> list[StackedBody]:
    """A stack as the mechanics takes it.

    Args:
        stack: from `stack_with`; the tops of those that carry something are flat.
        placed: name of the one whose place is not known better than by a standard deviation.
        place_sd: that, along x and y of W [m].
    """
    places = {seen.name: k for k, seen in enumerate(stack)}
    return [
        _stacked_body(
            seen,
            None if seen.on is None else places[seen.on],
            place_sd if seen.name == placed else 0.0,
        )
        for seen in stack
    ]


def face_in_world(face: Polygon, seen: SeenObject) -> Polygon:
    """A face of an object, from its B to W."""
    return Polygon(face.vertices @ seen.pose.R_WB[:2, :2].T + seen.pose.p_WB[:2])


def _stacked_body(seen: SeenObject, below: int | None, place_sd: float) -> StackedBody:
    model, R = seen.model, seen.pose.R_WB[:2, :2]
    base = face_in_world(Polygon.convex(model.base.corners), seen)
    top = model.standing_face
    return StackedBody(
        model.mass,
        model.mass_sd,
        R @ np.array(model.com[:2]) + seen.pose.p_WB[:2],
        R @ np.diag(np.square(model.com_sd[:2])) @ R.T + place_sd**2 * np.eye(2),
        base,
        base if top is None else face_in_world(top, seen),
        below,
    )
