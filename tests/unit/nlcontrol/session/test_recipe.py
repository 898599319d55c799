"""A controller rebuilt from its recipe goes on as the one that it was taken from."""

from __future__ import annotations

from threading import Thread

import pytest

from nlcontrol.errors import ControlError
from nlcontrol.service.bundle import rebuild_controller
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.recipe import JournalEntry, Recipe
from objectmodels import Registry
from objectmodels.registry.model_registry import model_document, model_from_document
from sim.supervision import StopToken


def _again(controller: Controller) -> Controller:
    """Rebuilt from the recipe as JSON."""
    text = controller.recipe().model_dump_json()
    return rebuild_controller(Recipe.model_validate_json(text))


def test_models_are_what_their_documents_say() -> None:
    for model in Registry.built_in():
        assert model_from_document(model_document(model), "document") == model


@pytest.mark.parametrize("scene", ["kitchen", "counter"])
def test_a_fresh_controller(scene: str) -> None:
    controller = Controller(scene, seed=4)
    again = _again(controller)
    assert (again.models, again.defaults, again.seed) == (controller.models, controller.defaults, 4)
    assert again.look() == controller.look()


def test_sentences_and_looks_are_done_again() -> None:
    controller = Controller("kitchen", seed=1)
    _ = controller.executor.world  # type: ignore[attr-defined]
    controller.look()
    Conversation(controller).say("where is the mug?")
    first, second = Conversation(controller), Conversation(controller)
    first.say("push the mug 3 cm to the left", plan_only=True)
    second.say("where is the ice tea box?")
    first.say(list(controller.parse("push it 2 cm away").frames), plan_only=True)
    deeds = controller.recipe().deeds
    assert [deed.conversation for deed in deeds] == [0, 0, 1, 2, 1]
    assert deeds[0] == JournalEntry(begun=0.0)
    again = _again(controller)
    assert again.recipe() == controller.recipe()


@pytest.mark.slow
def test_the_next_sentence_has_the_same_trace() -> None:
    controller = Controller("kitchen", seed=2)
    conversation = Conversation(controller)
    conversation.say("push the mug 2 cm to the left")
    again = _again(controller)
    assert again.models == controller.models
    results = [Conversation(each).say("push the mug 2 cm away") for each in (controller, again)]
    assert results[0].trace is not None
    assert results[0] == results[1]


def test_what_was_done_otherwise_has_no_recipe() -> None:
    watched, believing, stopped = (Controller("kitchen") for _ in range(3))
    watched.watch("mug")
    Conversation(believing).say("where is the mug?")
    believing.models["mug"] = believing.models["mug"].model_copy(update={"mass": 0.2})
    stop = StopToken()
    Thread(target=stop.request).run()
    Conversation(stopped).say("push the mug 2 cm away", stop=stop)
    for controller in (watched, believing, stopped):
        with pytest.raises(ControlError) as raised:
            controller.recipe()
        assert raised.value.code == "not_repeatable"
        assert raised.value.info.suggestions


def test_beliefs_given_at_first_are_part_of_it() -> None:
    controller = Controller("kitchen")
    heavy = controller.models["mug"].model_copy(update={"mass": 0.2})
    controller.models["mug"] = heavy
    Conversation(controller).say("where is the mug?")
    assert _again(controller).models["mug"].mass == 0.2


def test_a_recipe_of_something_else_is_refused() -> None:
    recipe = Controller("kitchen").recipe()
    broken: tuple[dict[str, object], ...] = (
        {"scene": {}},
        {"defaults": {"no": 1}},
        {"registry": ({"format": "box/9"},)},
        {"deeds": (JournalEntry(begun=7.0),)},
        {"beliefs": {}},
    )
    for changes in broken:
        with pytest.raises(ControlError) as raised:
            rebuild_controller(recipe.model_copy(update=changes))
        assert raised.value.code == "bad_recipe"
