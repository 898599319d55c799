"""Hidden truth: how the objects of one world really are, drawn from its seed.

Model: mass and friction coefficients are the scene's times 1 + σ z, the centre of mass is the
scene's plus σ z along each axis of B, with z normal and clipped at two. Contents are as much more
or less as the mass is. Six numbers are drawn for
each object, in the order of the file, whatever their σ.
"""

from __future__ import annotations

from sim.random_streams import RandomStream, clipped_normal, source
from sim.truth.scene_file import Hidden, Scene


def sample_world(scene: Scene, seed: int) -> Scene:
    """The scene as it is true in the world of a seed; the same if it hides nothing.

    Args:
        scene: as its file has it.
        seed: of the world.
    """
    hidden = scene.hidden
    if hidden == Hidden():
        return scene
    rng = source(seed, RandomStream.HIDDEN)
    objects = []
    for item in scene.objects:
        mass, friction, finger, *shift = clipped_normal(rng, 6).tolist()
        truth = item.truth.model_copy(
            update={
                "mass_kg": item.truth.mass_kg * (1.0 + hidden.mass * mass),
                "friction_table": item.truth.friction_table * (1.0 + hidden.friction * friction),
                "friction_finger": item.truth.friction_finger
                * (1.0 + hidden.finger_friction * finger),
            }
        )
        if truth.container is not None:
            litres = truth.container.contents_l * (1.0 + hidden.mass * mass)
            container = truth.container.model_copy(update={"contents_l": litres})
            truth = truth.model_copy(update={"container": container})
        shifted = truth.shifted([hidden.centre_of_mass_m * z for z in shift])
        objects.append(item.model_copy(update={"truth": shifted}))
    return scene.model_copy(update={"objects": tuple(objects), "hidden": Hidden()})
