"""Questions, answered from the object models and the planner; nothing is ever pushed for one.

What a push would do is said by the code behind `nlcontrol predict`, what can be done by the planner
and by the code behind `nlcontrol affordances`, where by the one behind `nlcontrol map`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice, permutations
from typing import TYPE_CHECKING

import numpy as np

from grammar.frames import command as g
from nlcontrol.checks.frame_checks import require_checkable
from nlcontrol.errors import ControlError, error
from nlcontrol.questions.answer import (
    DOES,
    Answer,
    Considered,
    affordance_lines,
    force_text,
)
from nlcontrol.questions.grasp_questions import (
    asks_for_hand,
    hand_answer,
    possible_answer,
    spill_answer,
)
from nlcontrol.questions.push_prediction import (
    SURE,
    PushPrediction,
    in_turn,
    particulars,
    threshold,
)
from nlcontrol.questions.push_questions import (
    EVENTS,
    figures,
    how_hard,
    most_favourable,
    push_asked_about,
    target_of,
    where_answer,
)
from nlcontrol.questions.scene_answers import (
    answer_about_scene,
    destination_answer,
    distance_answer,
    edge_answer,
    far_answer,
    property_answer,
    state_answer,
)
from nlcontrol.text_format import join_words, quantity
from planner import plan
from planner.affordances import TURNING_ARM, Affordance, affordances
from planner.problem.directions import HEADINGS, heading_of, phrase
from planner.problem.planning_problem import SearchBudget
from planner.types.plan import Plan, Reached
from planner.types.refusal import probability_text

if TYPE_CHECKING:
    from planner.types.defaults import Defaults
    from planner.types.robot import Robot
    from planner.types.world_state import WorldState


def answer(
    frame: g.Frame,
    state: WorldState,
    robot: Callable[[], Robot],
    defaults: Defaults,
    *,
    position_sd: float = 0.0,
) -> Answer:
    """The answer to a question.

    Args:
        frame: a frame with a query, its objects resolved to names in `state`.
        state: what the robot believes.
        robot: gives arm and hand, which few questions need.
        defaults: what a clause means when nothing more is said.
        position_sd: standard deviation of a seen position [m].

    Raises:
        ControlError: `nothing_before`; `unknown_object` if the question names none; a reason of
            the planner if what is asked about is no push of this robot.
    """
    match frame.query:
        case "predict" if frame.event == "ends_up":
            return destination_answer(frame, state, robot(), defaults)
        case "predict" if asks_for_hand(frame):
            return hand_answer(frame, state, robot(), defaults)
        case "predict" if frame.event == "spills":
            return spill_answer(frame, state, defaults)
        case "predict":
            return _predict(frame, state, defaults)
        case "possible":
            return _possible(frame, state, robot(), defaults)
        case "how_hard":
            return how_hard(frame, state, defaults)
        case "where":
            return where_answer(frame, state, defaults)
        case "value":
            return _value(frame, state, position_sd)
        case "capable" | "compare" | "seen":
            return answer_about_scene(frame, state, robot(), defaults)
        case "affordances":
            return _affordances(frame, state, robot(), defaults)
        case _:
            raise error(
                "nothing_before",
                "nothing was done yet, so there is nothing to explain",
                suggestions=("say first what is to be done",),
            )


def _value(frame: g.Frame, state: WorldState, position_sd: float) -> Answer:
    """What an object is like, how it stands, or how far from another one."""
    match frame.goal:
        case g.Displace(away_from=str()):
            return edge_answer(frame, state)
        case g.Place() | g.Upright() | g.SetDown() | g.Topple() | g.Open() | g.Close():
            return state_answer(frame, state)
        case g.Parameters(than=(_, *_)):
            return distance_answer(frame, state)
        case g.Parameters(which=("distance",)):
            return far_answer(frame, state)
    return property_answer(frame, state, position_sd)


def _predict(frame: g.Frame, state: WorldState, defaults: Defaults) -> Answer:
    """The outcome of a push and, if the question is about an event, whether it would come."""
    goal_event = EVENTS.get(frame.goal.kind, "moves")
    push = most_favourable(push_asked_about(frame, state, defaults), goal_event, defaults)
    found = push.push_prediction()
    model = push.target.model
    r, u = np.array(found.push.point) - np.array(model.com), found.push.direction
    turns = bool(abs(r[0] * u[1] - r[1] * u[0]) > TURNING_ARM * model.friction_radius)
    with_force = "" if push.force is None else f" with {force_text(push.force)}"
    start = f"Pushed{with_force} {push.where}"
    if frame.event is None:
        p, does = found.probability[found.outcome], DOES.get(found.outcome, "stays where it is")
        likely, yes = f"probability that it {does} {probability_text(p)}", None
    else:
        p = _probability(frame.event, found, turns)
        yes = p >= 0.5
        likely = f"probability that it {DOES[frame.event]} {probability_text(p)}"
        start = f"{_yes_or_no(p)}, {start[0].lower()}{start[1:]}"
    text = (
        f"{start}, the {push.target.name} would {_state(found, frame.event, turns)}: "
        f"{_reasons(found)} ({likely})."
    )
    return Answer(
        query="predict",
        text=text,
        lines=tuple(particulars(found)),
        numbers=figures(found),
        probability=p,
        yes=yes,
        push=push.push_in_answer,
    )


def _yes_or_no(p: float) -> str:
    if p >= 0.5:
        return "Yes" if p >= SURE else "Probably"
    return "No" if p <= 1.0 - SURE else "Probably not"


def _probability(event: g.Event, found: PushPrediction, turns: bool) -> float:
    p = found.probability
    return {
        "moves": p["slide"] + p["topple"],
        "slides": p["slide"],
        "tips": p["topple"],
        "tilts": p["topple"],
        "turns": p["slide"] if turns else 0.0,
        "stays_upright": 1.0 - p["topple"],
        "holds": 1.0 - p["slide"] - p["topple"],
    }[event]


def _state(found: PushPrediction, event: g.Event | None, turns: bool) -> str:
    """Outcome as a verb: "topple", "slide", "stay where it is"."""
    if found.outcome == "slide":
        if event == "turns":
            return "turn as it slides" if turns else "slide without turning much"
        return "slide"
    return {"none": "stay where it is", "topple": "topple"}[found.outcome]


def _reasons(found: PushPrediction) -> str:
    """Both thresholds, the lower one first; as believed, if that is not likeliest."""
    if found.onset is None:
        return "no force moves it there"
    first, other = in_turn(found)
    second = threshold(found, other, force_text, only=True)
    believed = "" if found.nominal == found.outcome else "just as it is believed, "
    return f"{believed}it {threshold(found, first, force_text)} and {second}"


def _possible(frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults) -> Answer:
    """The push that the planner finds for what is asked, or why it finds none."""
    command = frame.model_copy(update={"query": None, "event": None})
    made = plan(command, state, robot, defaults=defaults)
    if made.status == "planned":
        try:
            require_checkable(command)
        except ControlError as raised:
            return _denial(raised.info.code, raised.info.message, raised.info.suggestions, {})
        return plan_answer(made)
    if isinstance(made, Reached):
        return Answer(query="possible", text="Yes: it is there already.", numbers={}, yes=True)
    return _denial(made.reason, made.message, made.suggestions, made.numbers)


def plan_answer(made: Plan) -> Answer:
    """The answer that something can be done, how, and how surely."""
    return _push_answer(made) if made.pushes else possible_answer(made)


def _push_answer(made: Plan) -> Answer:
    push, predicted = made.push, made.push.prediction
    fingers = "two fingers" if push.fingers == 2 else "one finger"
    pushes = len(made.pushes)
    first = f"in {pushes} pushes, the first with " if pushes > 1 else ""
    does = {"turned": "turns", "tilted": "tilts"}.get(push.ends_on) or DOES[predicted.outcome]
    what = "of all of them" if pushes > 1 else f"that it {does}"
    return Answer(
        query="possible",
        text=f"Yes: {first}{fingers} on its {push.face} face, {quantity(push.p_BC[2], 'm')} above "
        f"the table, with at most {force_text(push.force_limit)} (probability {what} "
        f"{probability_text(made.probability)}).",
        numbers={
            "height": push.p_BC[2],
            "force": push.force_limit,
            "stroke": push.stroke,
            "onset": predicted.onset,
            "pushes": float(pushes),
        },
        probability=made.probability,
        yes=True,
        push=Considered(
            face=push.face,
            height=push.p_BC[2],
            heading=heading_of(np.array(push.direction_W)),
            force=push.force_limit,
        ),
    )


def _denial(
    reason: str, message: str, suggestions: tuple[str, ...], numbers: dict[str, float]
) -> Answer:
    return Answer(
        query="possible",
        text=f"No: {message}.",
        numbers=numbers,
        yes=False,
        reason=reason,
        suggestions=suggestions,
    )


_AROUND_IT = {"stand": "stand it up"}  # outcomes whose verb stands on both sides of the object


def _affordances(frame: g.Frame, state: WorldState, robot: Robot, defaults: Defaults) -> Answer:
    """Affordances of an object: a sentence, and the lines of `nlcontrol affordances`."""
    if frame.object is None:
        return abilities_answer(state, robot, defaults)
    target = target_of(frame, state)
    found = affordances(target, state, robot, defaults=defaults)
    can = [each for each in found if each.can]
    done = dict.fromkeys(each.outcome for each in can)
    lacking = dict.fromkeys(each.outcome for each in found if each.outcome not in done)
    text = (
        f"With the {target.name} I can {join_words([_ways(o, can) for o in done]) or 'do nothing'}"
    )
    if done and lacking:
        plain = join_words([each for each in lacking if each not in _AROUND_IT], "or")
        others = [_AROUND_IT[each] for each in lacking if each in _AROUND_IT]
        text += f"; I cannot {join_words([*([f'{plain} it'] if plain else []), *others], 'or')}"
    return Answer(
        query="affordances",
        text=f"{text}.",
        lines=tuple(affordance_lines(found)),
        numbers={"can": float(len(can)), "asked": float(len(found))},
    )


def _ways(outcome: str, can: list[Affordance]) -> str:
    """One thing that can be done, with its directions and its least force."""
    ways = [a for a in can if a.outcome == outcome]
    if not ways[0].direction:
        return _AROUND_IT.get(outcome, f"{outcome} it")
    least = min(a.least_force for a in ways if a.least_force is not None)
    directions = join_words([phrase(HEADINGS[a.direction]) for a in ways])
    return f"{outcome} it {directions} (from {force_text(least)} on)"


# What the robot can do: each ability is asked of the planner, with the things that stand there.
#
# An ability is there if a plan is made for it with any of them; the others are told as not found.


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
    names = join_words([f"the {name}" for name in state.objects]) or "nothing"
    text = f"I can {join_words(can) or 'do nothing with what stands here'}"
    text += (
        f"; with what stands here I found no way to {join_words(cannot, 'or')}" if cannot else ""
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
