"""A plan: actions whose predicted outcome satisfies a frame; and the other results of planning.

All of them are values. They are what `nlcontrol plan --json` prints, so their field names are part
of the public contract; every number is in SI units.
"""

from __future__ import annotations

from textwrap import shorten
from typing import Literal

from objectmodels.html_table import html_table
from planner.types.actions import Action, Aim, GraspAction, Limits, PushAction
from planner.types.frozen_value import Value
from planner.types.probability_text import probability_text
from planner.types.refusal import Refusal

PlanTask = Literal["push", "topple", "tilt", "lift", "place", "stand", "pour", "open", "close"]


class DefaultUsed(Value):
    """A value that the sentence did not give, and that the table of defaults supplied.

    Attributes:
        name: of the default.
        value: of it.
        unit: of the value.
        reason: why it was needed.
    """

    name: str
    value: float
    unit: str
    reason: str


class Plan(Value):
    """Actions, one after the other, whose predicted outcome satisfies the frame.

    Of several pushes only the first is carried out; then the robot looks, and plans anew towards
    the same aim until it is reached. What a hand does is carried out to its end.

    Attributes:
        status: says that it is a plan.
        object: name of what is moved.
        task: what the actions amount to.
        actions: one after the other.
        committed: how many of them are carried out before the robot looks again.
        limits: what stops every push, or what a hand keeps of the distance to other objects.
        speed: largest speed of a hand while it holds something [m/s]; None for pushes, which have
            their own.
        aim: where the object should stand at the end; None if it falls, stays where it is or up.
        probability: least probability that all ends as predicted.
        defaults: values that the sentence left open.
        considered: how many candidates were evaluated.
        satisfying: how many of them satisfied the frame.
        notes: plain sentences on how the plan was chosen.
    """

    status: Literal["planned"] = "planned"
    object: str
    task: PlanTask
    actions: tuple[Action, ...]
    committed: int
    limits: Limits = Limits()
    speed: float | None = None
    aim: Aim | None = None
    probability: float = 1.0
    defaults: tuple[DefaultUsed, ...] = ()
    considered: int = 0
    satisfying: int = 0
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        kinds = ", ".join(action.kind for action in self.actions[:6])
        more = ", …" if len(self.actions) > 6 else ""
        name = shorten(self.object, 40, placeholder="…")
        return (
            f"<Plan to {self.task} the {name}: {kinds}{more}; probability {self.probability:.3g}>"
        )

    def _repr_html_(self) -> str:
        header = ("step", "contact in B [mm]", "at most [N]", "travel [mm]", "sliding from [N]",
                  "toppling from [N]")  # fmt: skip
        rows = [_step_texts(action) for action in self.actions]
        caption = f"{self.task} the {self.object}, probability {probability_text(self.probability)}"
        return html_table(caption, header, rows)

    @property
    def push(self) -> PushAction:
        """First push: of several the only one that is carried out before the robot looks again."""
        return self.pushes[0]

    @property
    def pushes(self) -> tuple[PushAction, ...]:
        """Pushes, in their order; none if a hand does it."""
        return tuple(action for action in self.actions if action.kind == "push")

    @property
    def grasp(self) -> GraspAction | None:
        """Grasp that holds while the other actions are carried out; None if nothing is held."""
        first = self.actions[0]
        return first if first.kind == "grasp" else None

    @property
    def steps(self) -> tuple[Action, ...]:
        """Actions after the grasp; all of them if nothing is held."""
        return self.actions if self.grasp is None else self.actions[1:]


class Reached(Value):
    """Nothing is left to be done: the object is seen where it should be, or as it should be.

    Attributes:
        aim: where it should be; None if the goal is no place.
        off: distance from there [m].
        turned_off: angle from the wanted heading [rad]; 0 if none is wanted.
        lid: how far its lid is seen to be open, if that is the goal; see `SeenObject.lid`.
    """

    status: Literal["reached"] = "reached"
    aim: Aim | None = None
    off: float = 0.0
    turned_off: float = 0.0
    lid: float | None = None


def _step_texts(action: Action) -> tuple[str, ...]:
    """A row of the table of a plan; all that is no push has its kind alone."""
    if action.kind != "push":
        return (action.kind, "", "", "", "", "")
    found = action.prediction
    forces = ("never" if f is None else f"{f:.2f}" for f in (found.slide_force, found.topple_force))
    contact = ", ".join(f"{1e3 * x:z.0f}" for x in action.p_BC)
    step = f"push, {action.face}, {action.fingers} finger{'s'[: action.fingers - 1]}"
    return (step, contact, f"{action.force_limit:.2f}", f"{1e3 * action.stroke:.0f}", *forces)


PlanningResult = Plan | Reached | Refusal
