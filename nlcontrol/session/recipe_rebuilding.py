"""From a recipe to a controller that goes on as the one that it was taken from."""

from __future__ import annotations

from nlcontrol.errors import ControlError, error, known_errors_raised
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.recipe import Recipe
from objectmodels import Registry
from objectmodels.registry.model_files import model_from_document
from planner.types.defaults import Defaults
from sim.simulated_executor import SimulatedExecutor, simulation


def rebuild_controller(recipe: Recipe) -> Controller:
    """Builds a controller to which all has happened that its recipe says.

    Raises:
        ControlError: `bad_recipe`.
    """
    try:
        with known_errors_raised():
            kinds = Registry.default().kinds
            registry = Registry()
            for document in recipe.registry:
                registry.add(model_from_document(document, "recipe", kinds))
            controller = Controller(
                executor=SimulatedExecutor.from_document(recipe.scene, seed=recipe.seed),
                registry=registry,
                defaults=Defaults(**recipe.defaults),
            )
            controller.models = {
                name: model_from_document(document, "recipe", kinds)
                for name, document in recipe.beliefs.items()
            }
    except (ValueError, TypeError, ControlError) as raised:
        raise _bad_recipe(str(raised)) from raised
    conversations: dict[int, Conversation] = {}
    for deed in recipe.deeds:
        executor = simulation(controller.executor)
        if deed.begun is not None and deed.begun != executor.world.time:
            raise _bad_recipe(f"“{deed.said}” was said at another time")
        if deed.said is None:
            controller.look()
            continue
        if deed.conversation not in conversations:
            conversations[deed.conversation] = Conversation(controller)
        conversations[deed.conversation].say(deed.said, motion=deed.motion)
    return controller


def _bad_recipe(message: str) -> ControlError:
    hint = "take one that `Controller.recipe` made with this version"
    return error("bad_recipe", f"it cannot be rebuilt: {message}", suggestions=(hint,))
