"""What a box that a mug stands beside is asked, and the checks of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from grammar.frames import command as g
from nlcontrol.checks import frame_checks as clause_checks
from nlcontrol.checks.verdicts import Check
from objectmodels import BoxModel, CylinderModel
from planner.types.world_state import TableState
from sim.traces.trace import Trace

TraceMaker = Callable[..., Trace]
BOX = g.ObjectRef(text="ice tea box", id="ice tea box")
MUG = g.ObjectRef(text="mug", id="mug")
TABLE = TableState(-0.2, 1.2, -0.8, 0.8)
ROUND = CylinderModel(name="mug", radius=0.04, height=0.1, mass=0.3, friction=0.4)
AWAY = g.Displace(direction="away", spans=((21, 25),))


def frame_of(goal: Any = AWAY, *constraints: Any, action: g.Action = "push") -> g.Frame:
    """A frame about the box."""
    return g.Frame(action=action, object=BOX, goal=goal, constraints=constraints)


def check(frame: g.Frame, trace: Trace, box: BoxModel) -> tuple[Check, ...]:
    """The checks of a box that a mug, 80 mm wide, stands 200 mm to the left of."""
    return clause_checks.check(frame, trace, {"ice tea box": box, "mug": ROUND}, TABLE)


def one(checks: tuple[Check, ...], quantity: str) -> Check:
    """The check whose quantity has these words in it."""
    (found,) = [c for c in checks if quantity in c.quantity]
    return found
