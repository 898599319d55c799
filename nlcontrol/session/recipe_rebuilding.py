"""From a recipe to a controller that goes on as the one that it was taken from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nlcontrol.errors import ControlError, error, known_errors_raised
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.proposals import Proposal
from nlcontrol.session.recipe import Recipe
from objectmodels import Registry
from objectmodels.errors import printable
from objectmodels.registry.model_registry import model_from_document
from planner.types.defaults import Defaults
from sim.simulated_executor import SimulatedExecutor, simulation

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from sim.supervision import Progress


def rebuild_controller(recipe: Recipe) -> Controller:
    """Builds a controller to which all has happened that its recipe says.

    Raises:
        ControlError: `bad_recipe`.
    """
    return repeat_recipe(recipe)[0]


def repeat_recipe(
    recipe: Recipe, *, exact: bool = True, progress: Progress | None = None
) -> tuple[Controller, Result | None]:
    """The same, and the result of the last deed; None if that was a look, or there is none.

    Args:
        recipe: of a controller.
        exact: whether every deed has to begin at its time.
        progress: told what happens during the simulation.

    Raises:
        ControlError: `bad_recipe`.
    """
    controller, result = _first_controller(recipe), None
    conversations: dict[int, Conversation] = {}
    proposals: dict[tuple[int, int | None], Proposal] = {}
    for deed in recipe.deeds:
        executor = simulation(controller.executor)
        # The world is built even where the time does not matter: that decides how a look is made.
        if deed.begun is not None and deed.begun != executor.world.time and exact:
            raise _bad_recipe(f"“{deed.said}” was said at another time")
        if deed.said is None:
            controller.look()
            result = None
            continue
        if deed.conversation not in conversations:
            conversations[deed.conversation] = Conversation(controller)
        conversation = conversations[deed.conversation]
        if deed.proposes is not None:
            proposal = conversation.plan(deed.said)
            proposals[deed.conversation, deed.proposes] = proposal
            result = proposal.result
        elif deed.executes is not None:
            approved = proposals.get((deed.conversation, deed.executes))
            if approved is None or (approved.intention is None and exact):
                raise _bad_recipe(f"“{deed.said}” was not planned before")
            result = approved.result  # which refuses it, where another version has planned
            if approved.intention is not None:
                result = conversation.execute(approved, progress=progress)
        else:
            result = conversation.say(deed.said, motion=deed.motion, progress=progress)
    return controller, result


def _first_controller(recipe: Recipe) -> Controller:
    """The controller before anything was done."""
    try:
        with known_errors_raised():
            kinds = Registry.default().kinds
            registry = Registry()
            for document in recipe.registry:
                registry.add(model_from_document(document, "recipe", kinds))
            if recipe.scene.get("models"):
                raise ValueError("its scene names files of this machine")
            controller = Controller(
                executor=SimulatedExecutor.from_document(recipe.scene, seed=recipe.seed),
                registry=registry,
                defaults=Defaults(**recipe.defaults),
            )
            controller.models = {
                name: model_from_document(document, "recipe", kinds)
                for name, document in recipe.beliefs.items()
            }
            names = {item.name for item in controller.cell.objects}
            if names != controller.models.keys():
                odd = ", ".join(sorted(names ^ controller.models.keys())[:5])
                raise ValueError(f"its beliefs are not of the scene's objects: {odd}")
    except (ValueError, TypeError, ControlError) as raised:
        raise _bad_recipe(str(raised)) from raised
    return controller


def _bad_recipe(message: str) -> ControlError:
    hint = "take one that `Controller.recipe` made with this version"
    told = printable(" ".join(message[:500].split()))  # a recipe may come from anybody
    return error("bad_recipe", f"it cannot be rebuilt: {told}", suggestions=(hint,))
