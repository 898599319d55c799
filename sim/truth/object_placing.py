"""Objects put on the table of a scene, which really are as their models say.

Frames: W is the world, z up, table plane z = 0; B is an object's frame at the centre of its base.
"""

from __future__ import annotations

from contextlib import suppress

from objectmodels import ObjectModel
from objectmodels.errors import printable
from planner.problem.footprints import gap, room_to_edge
from sim.errors import SceneError
from sim.truth.scene_file import Pose, Scene, SceneObject
from sim.truth.truth_from_model import whole_truth

PLACES = ((0.45, 0.18), (0.45, -0.18), (0.4, 0.25), (0.4, -0.3), (0.5, 0.5))
"""Places within reach, from which a push away stays so, x and y in W [m]."""


def scene_with_object(scene: Scene, model: ObjectModel, pose: Pose) -> Scene:
    """The scene with one more object, which is as its model says.

    Raises:
        SceneError: `bad_scene` if its name is taken, or it would stand beyond the table's edge or
            in something else.
    """
    truth = whole_truth(model)
    item = SceneObject(name=model.name, model=model.name, pose=pose, truth=truth)
    covered = item.covered
    if room_to_edge(covered, scene.table.extent) < 0.0:
        extent = scene.table.extent
        bounds = f"x from {extent.x_min:g} to {extent.x_max:g}, y from {extent.y_min:g} to "
        hint = f"the table has {bounds}{extent.y_max:g} m"
        raise _no_place(model, "it would stand beyond the table's edge", hint)
    for other in scene.objects:
        if other.name.casefold() == model.name.casefold():
            hint = "say its name alone: it stands there already"
            raise _no_place(model, "there is an object of that name in the scene", hint)
        if (apart := gap(covered, other.covered)) <= 0.0:
            hint = f"put it {max(1.0, -1e2 * apart):.0f} cm or more away from there"
            raise _no_place(model, f"the {other.name} stands there", hint)
    return scene.model_copy(update={"objects": (*scene.objects, item)})


def free_place(scene: Scene, model: ObjectModel) -> Pose | None:
    """A place near the robot where there is room for an object; None if there is none."""
    for x, y in PLACES:
        place = Pose(x_m=x, y_m=y)
        with suppress(SceneError):
            scene_with_object(scene, model, place)
            return place
    return None


def _no_place(model: ObjectModel, why: str, hint: str) -> SceneError:
    return SceneError(
        "bad_scene", f"the {printable(model.name)} cannot be put there: {why}", (hint,)
    )
