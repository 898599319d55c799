"""What "it" means while the hand holds something."""

import pytest

from nlcontrol.references.reference_search import Context
from nlcontrol.session.controller import Controller


@pytest.mark.parametrize(
    ("text", "held", "meant"),
    [
        ("put it down", "mug", "mug"),
        ("put it next to the cereal box", "mug", "mug"),
        ("put it next to the cereal box", None, "ice tea box"),
        ("pour it into the mug", "ice tea", "ice tea"),
        ("push it away", "mug", "ice tea box"),
    ],
)
def test_what_is_put_or_poured_is_what_the_hand_holds(
    text: str, held: str | None, meant: str
) -> None:
    controller = Controller("kitchen")
    said = Context(("ice tea box", "mug"), held)
    (frame,) = controller.resolve(controller.parse(text), said).frames
    assert frame.object is not None
    assert frame.object.id == meant
