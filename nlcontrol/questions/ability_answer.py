"""What the robot can do: each ability is asked of the planner, with the things that stand there.

An ability is there if a plan is made for it with any of them; the others are told as not found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice, permutations
from typing import TYPE_CHECKING

from grammar.frames import command as g
from nlcontrol.questions.answer import Answer
from nlcontrol.text_format import enumeration
from planner import plan
from planner.problem.planning_problem import SearchBudget
from planner.types.plan import Plan

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import WorldState


_Goal = Callable[[tuple[g.ObjectRef, ...]], g.Goal]
_ABILITIES: tuple[tuple[str, g.Action, int, _Goal], ...] = (
    ("push things", "push", 0, lambda _: g.Displace(direction="away")),
    ("turn them", "turn", 0, lambda _: g.Rotate(sense="ccw")),
    ("tilt them", "tilt", 0, lambda _: g.Tilt()),
    ("topple them", "topple", 0, lambda _: g.Topple()),
    ("lift them", "lift", 0, lambda _: g.Lift()),
    ("put them beside others", "place", 1, lambda o: g.Place(relation="next_to", reference=o)),
    ("put them on others", "place", 1, lambda o: g.Place(relation="on", reference=o)),
    ("put them into others", "place", 1, lambda o: g.Place(relation="in", reference=o)),
    ("pour from them", "pour", 1, lambda o: g.Pour(into=o[0])),
    ("open their lids", "open", 0, lambda _: g.Open()),
    ("close their lids", "close", 0, lambda _: g.Close()),
    ("hand them over", "hand_over", 0, lambda _: g.HandOver()),
)
"""Words of an ability, its action, how many other objects it takes, and its goal."""


def abilities_answer(state: WorldState, robot: Robot, defaults: Defaults) -> Answer:
    """What the robot finds a plan for with the things before it, and for what it finds none."""
    found = {
        words: _is_found(action, others, goal, state, robot, defaults)
        for words, action, others, goal in _ABILITIES
    }
    can = [words for words, is_planned in found.items() if is_planned]
    cannot = [words for words, is_planned in found.items() if not is_planned]
    names = enumeration([f"the {name}" for name in state.objects]) or "nothing"
    text = f"I can {enumeration(can) or 'do nothing with what stands here'}"
    text += (
        f"; with what stands here I found no way to {enumeration(cannot, 'or')}" if cannot else ""
    )
    return Answer(
        query="affordances",
        text=(
            f"{text}. I measure weight and friction by touch, and say beforehand what would "
            f"happen. Before me I have {names}."
        ),
        suggestions=("ask “what can you do with the box?” of a thing",),
        numbers={
            "objects": float(len(state.objects)),
            "can": float(len(can)),
            "asked": float(len(found)),
        },
    )


def _is_found(
    action: g.Action, others: int, goal: _Goal, state: WorldState, robot: Robot, defaults: Defaults
) -> bool:
    """Return True if there is a plan for an ability with any of the things."""
    # The work of all plans together: what can be done mostly shows soon.
    budget = SearchBudget(600)
    # At most 30 plans are asked for to find one ability.
    frames = islice(_frames(action, others, goal, state), 30)
    made = (plan(frame, state, robot, defaults=defaults, budget=budget) for frame in frames)
    return any(isinstance(each, Plan) for each in made)


def _frames(action: g.Action, others: int, goal: _Goal, state: WorldState) -> Iterator[g.Frame]:
    """Frames of an ability, about one thing after the other."""
    for name, *rest in permutations(state.objects, 1 + others):
        refs = tuple(g.ObjectRef(text=each, id=each) for each in rest)
        own = g.ObjectRef(text=name, id=name)
        yield g.Frame(action=action, object=own, goal=goal(refs))
