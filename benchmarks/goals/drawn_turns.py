"""Turns of a conversation: each is drawn by what truly stands where when it is said.

| turn | label |
|---|---|
| a command | feasible: it is drawn until `benchmarks.goals.sense` finds it sensible |
| "put it down" | feasible; what a hand holds is always put down next |
| "again" | feasible; drawn only where the last command would be sensible once more |
| "undo that" | feasible; drawn only where the place before is free and the face below is the same |
| one of `HOPELESS` | infeasible, by lengths, angles and forces far beyond what can be |

Labels know believed models and true poses, never a planner or a reach.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.goals.drawn_worlds import LIDDED, SETTINGS, Setting, hard_scene
from benchmarks.goals.judge import Places
from benchmarks.goals.sense import sensible
from benchmarks.goals.sentences import HARD, TRIES, Kind, fits, sentence_about
from grammar.frames import command as g
from nlcontrol import Registry
from nlcontrol.batches.drawn_scenes import Generator, pushable_models
from nlcontrol.errors import ControlError
from nlcontrol.session.conversation import Conversation
from planner.types.world_state import SeenObject, WorldState
from sim.truth.scene_file import Scene

TURNS = 10
"""Sentences of a conversation."""
UNDO, AGAIN, HOPELESS_SHARE = 0.12, 0.08, 0.15
"""Shares of turns that are remarks, where one fits, and of those that cannot be done."""
FIRST = 0.6
"""Share of the commands about the object that stands in the hard place."""
IT = 0.4
"""Share of the commands that say "it", where that is meant."""

HOPELESS = (
    "push {0} 3 m away",
    "push {0} 2 m to the left",
    "lift {0} by 2 m",
    "tilt {0} by 85 degrees without toppling it",
    "push {0} 10 cm away with at most 0.02 N",
    "push {0} 20 cm to the right within 0.2 s",
)
"""Commands that no object and no robot of these scenes can carry out."""

TurnKind = Literal[Kind, "put down", "undo", "again", "hopeless"]


class Job(NamedTuple):
    """Which conversation.

    Attributes:
        seed, number: of its world and its turns.
        tries: roll-outs in each round of the search by which a refusal is judged; 0 judges none.
    """

    seed: int
    number: int
    tries: int = 0

    @property
    def setting(self) -> Setting:
        """In what its world is hard; settings take turns."""
        return SETTINGS[self.number % len(SETTINGS)]

    @property
    def lidded(self) -> bool:
        """Whether it begins with something to be opened: every second wide world does."""
        return self.setting == "wide" and self.number // len(SETTINGS) % 2 == 1


@dataclass(frozen=True)
class Turn:
    """What is said next.

    Attributes:
        kind: of the turn.
        text: the words.
        target: object that it is about.
        feasible: its label.
    """

    kind: TurnKind
    text: str
    target: str
    feasible: bool


@dataclass(frozen=True)
class Past:
    """The turn before, for remarks.

    Attributes:
        turn: what was said.
        frames: what was understood, the objects resolved.
        before: how everything truly stood then.
        done: whether it was carried out.
    """

    turn: Turn
    frames: tuple[g.Frame, ...]
    before: Places
    done: bool


def draw_scene(job: Job) -> Scene:
    """The world of a conversation; its first object stands in the hard place."""
    registry = Registry.built_in()
    among = [registry.get(name) for name in LIDDED] if job.lidded else list(pushable_models())
    if job.setting == "fallen":
        among = [model for model in among if fits("rotate", model)]
    rng = np.random.default_rng((job.seed, job.number))
    return hard_scene(f"talk-{job.seed}-{job.number}", job.setting, rng, among)


def draw_turn(job: Job, index: int, talk: Conversation, now: Places, past: Past | None) -> Turn:
    """What is said next.

    Args:
        job: which conversation.
        index: of the turn, from 0.
        talk: the conversation so far.
        now: how everything truly stands.
        past: the turn before.
    """
    rng = np.random.default_rng((job.seed, job.number, index))
    robot = talk.controller
    if robot.held is not None:
        return Turn("put down", "put it down", robot.held.name, feasible=True)
    state = WorldState({name: place.seen(name) for name, place in now.items()}, robot.table)
    remark, roll = None, float(rng.random())
    if past is not None and past.done:
        remark = _remark(past, now, state, roll)
    if remark is not None:
        return remark
    names = list(now)
    if rng.random() >= HOPELESS_SHARE:
        for _ in range(len(names)):
            first = rng.random() < FIRST
            name = names[0] if first else names[int(rng.integers(len(names)))]
            drawn = _command(job, name, talk, state, rng)
            if drawn is not None:
                return drawn
    name = names[int(rng.integers(len(names)))]
    text = HOPELESS[int(rng.integers(len(HOPELESS)))].format(f"the {name}")
    return Turn("hopeless", text, name, feasible=False)


def _remark(past: Past, now: Places, state: WorldState, roll: float) -> Turn | None:
    name = past.turn.target
    if roll < UNDO and past.turn.kind in ("displace", "place", "rotate"):
        return Turn("undo", "undo that", name, True) if _may_return(past, now, state) else None
    if UNDO <= roll < UNDO + AGAIN and past.turn.kind in ("displace", "rotate"):
        here = state.objects[name].lies_on != "nothing flat"
        good = here and sensible(past.frames, state)
        return Turn("again", "again", name, feasible=True) if good else None
    return None


def _may_return(past: Past, now: Places, state: WorldState) -> bool:
    """Whether an object lies as before, and its place is free."""
    name = past.turn.target
    was, here = past.before[name].seen(name), state.objects[name]
    others_stay = all(
        math.dist(each.middle[:2], past.before[other].middle[:2]) < 0.01
        for other, each in now.items()
        if other != name
    )
    if not others_stay or was.lies_on != here.lies_on or here.lies_on == "nothing flat":
        return False
    place = g.Place(relation="at", reference=g.Point(x=was.pose.x, y=was.pose.y))
    frame = g.Frame(action="push", object=g.ObjectRef(text=name, noun=name, id=name), goal=place)
    return sensible([frame], state)


def _command(
    job: Job, name: str, talk: Conversation, state: WorldState, rng: Generator
) -> Turn | None:
    """A sensible sentence about an object; None if none is found."""
    target, robot = state.objects[name], talk.controller
    if target.lies_on == "nothing flat":
        return None
    kinds = [kind for kind in _kinds(job, target) if fits(kind, target.model)]
    kind = kinds[int(rng.integers(len(kinds)))]
    others = [other for other in state.objects if other != name]
    says_it = rng.random() < IT
    for _ in range(TRIES):
        text = sentence_about(target, kind, others, rng)
        if kind == "until" and not others:
            continue
        shortened = [text.replace(f"the {name}", "it", 1)] if says_it else []
        for said in (*shortened, text):
            try:
                frames = robot.resolve(robot.parse(said), talk.context).frames
            except ControlError:
                continue
            named = {frame.object.id if frame.object else None for frame in frames}
            if named == {name} and sensible(frames, state):
                return Turn(kind, said, name, feasible=True)
    return None


def _kinds(job: Job, target: SeenObject) -> Sequence[Kind]:
    upright = target.lies_on == "bottom"
    kinds: dict[Kind, None] = dict.fromkeys(HARD[job.setting])
    if upright and target.model.name in LIDDED:
        return ("displace", "lift", "open")
    kinds.pop("open", None)
    if not upright:
        for kind in ("lift", "carry", "tilt", "topple"):
            kinds.pop(kind, None)
    return tuple(kinds)
