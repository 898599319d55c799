"""A session whose robot is simulated: what was approved is what would have been done at once."""

from __future__ import annotations

import pytest

from nlcontrol import Session
from nlcontrol.errors import ControlError
from nlcontrol.service.bundle import rebuild_controller
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.recipe import Recipe

AWAY = "push the mug 2 cm away"


@pytest.mark.slow
def test_plan_and_execute_do_what_say_does() -> None:
    with Session("kitchen", seed=2) as session:
        offer = session.plan(AWAY)
        assert offer.plan_id is not None
        other = session.plan("push the ice tea box 2 cm to the left").plan_id
        run = session.start(plan_id=offer.plan_id)
        result = run.result()
        assert result == Conversation(Controller("kitchen", seed=2)).say(AWAY)
        # The table is not the one any more for which the other plan was made.
        with pytest.raises(ControlError) as raised:
            session.start(plan_id=other or "")
        assert raised.value.code == "stale_plan"
        assert raised.value.info.numbers["mug: moved"] == pytest.approx(0.02, abs=0.01)
        text = session.controller.recipe().model_dump_json()
        again = rebuild_controller(Recipe.model_validate_json(text))
        assert again.models == session.controller.models
        assert again.look() == session.controller.look()
