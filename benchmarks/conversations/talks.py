"""One conversation: its turns said to a robot in its world, and judged by what truly came of them.

| verdict | |
|---|---|
| satisfied | done, every goal met and no clause broken by the judge of true poses |
| rightly refused | refused before anything moved: infeasible, or confirmed by a judge |
| refused | feasible by its label, and refused |
| failed | carried out, and said not to have come about |
| false | said to be done, and truly it is not |
| crashed | an exception |

*Stranded* is what fell without being asked to, or was moved to where neither a push nor a lift of
it is planned, even if others are moved aside. It is *told* if the answer names it as failed, or
says where it is.

A refusal of what is labelled feasible is judged by `refused_turns`, if the job says so, and if
nothing was done before it.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from pydantic import BaseModel, ConfigDict

from benchmarks.conversations.drawn_turns import TURNS, Job, Past, Turn, draw_scene, draw_turn
from benchmarks.conversations.refused_turns import ACTED, refusal_finding
from benchmarks.conversations.true_places import TruePlace, fallen, moved, true_places
from benchmarks.goals.cases import Watched
from benchmarks.goals.refusal_judge import Finding
from benchmarks.goals.refusal_judge import Verdict as RefusalVerdict
from benchmarks.goals.sentences import SIDES
from benchmarks.goals.true_judge import SLACK, STIRRED
from benchmarks.goals.worlds import believed
from benchmarks.record import Kept
from grammar.frames import command as g
from nlcontrol import Conversation
from planner.types.defaults import DEFAULTS as D

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

Verdict = Literal["satisfied", "rightly refused", "refused", "failed", "false", "crashed"]
Places = Mapping[str, TruePlace]

_LOOKS = 10  # most that are waited until everything rests


class Said(BaseModel):
    """What came of a turn.

    Attributes:
        kind, text, target, feasible: see `benchmarks.conversations.drawn_turns.Turn`.
        verdict: on it.
        status, reason, message: as in a result.
        told: its notes.
        broken: kinds of the clauses that truly were broken.
        stranded: names of what was stranded by it.
        untold: those of them of which the answer says nothing.
        seconds: it took, by the processor.
        judged: verdict on its refusal, if that was judged.
        found: by what.
    """

    model_config = ConfigDict(frozen=True)

    kind: str
    text: str
    target: str
    feasible: bool
    verdict: Verdict
    status: str = "crashed"
    reason: str = ""
    message: str = ""
    told: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()
    stranded: tuple[str, ...] = ()
    untold: tuple[str, ...] = ()
    seconds: float = 0.0
    judged: RefusalVerdict | None = None
    found: str = ""

    def with_finding(self, finding: Finding) -> Said:
        """The turn with what was found about its refusal."""
        right = finding.verdict == "confirmed"
        changes = {"verdict": "rightly refused" if right else "refused",
                   "judged": finding.verdict, "found": finding.found}  # fmt: skip
        return self.model_copy(update=changes)


class Talk(Kept[Job]):
    """What came of a conversation.

    Attributes:
        turns: one after the other; a crash ends it.
    """

    turns: tuple[Said, ...]


def talk(job: Job) -> Talk:
    """Holds a conversation."""
    robot = Watched(draw_scene(job), registry=believed(job.setting == "wide"), seed=job.seed)
    wait_for_rest(robot)
    conversation, past, turns = Conversation(robot), None, []
    for index in range(TURNS):
        said, past = _say(job, index, conversation, robot, past)
        turns.append(said)
        print(f"{job.seed}-{job.number}.{index} {said.verdict}: {said.text}", flush=True)
        if said.verdict == "crashed":
            break
    return Talk(job=job, turns=tuple(turns))


def wait_for_rest(robot: Watched) -> None:
    """Looks on until nothing moves any more: what is laid on a side may not stay there."""
    before = true_places(robot.executor)
    for _ in range(_LOOKS):
        robot.look()
        now = true_places(robot.executor)
        if not moved(before, now):
            return
        before = now


def _say(
    job: Job, index: int, conversation: Conversation, robot: Watched, past: Past | None
) -> tuple[Said, Past]:
    """What came of one more turn, and what the next one may be about."""
    before = true_places(robot.executor)
    turn = draw_turn(job, index, conversation, before, past)
    robot.forget_steps()
    start = time.process_time()
    said = Said(**vars(turn), verdict="crashed")
    try:
        result = conversation.say(turn.text)
    except Exception:  # one turn that breaks must not end a run of many
        text = traceback.format_exc(limit=-3)
        return said.model_copy(update={"message": text}), Past(turn, (), before, done=False)
    seconds = time.process_time() - start
    after = true_places(robot.executor)
    truth = _Truth(turn, before, after, past)
    met, broken = truth.judge(robot)
    stirred = bool(moved(before, after, STIRRED))
    came = verdict(turn, result, met and not broken, stirred)
    finding = None
    if job.tries > 0 and came == "refused" and turn.feasible:
        acted = stirred or any(watch.trace is not None for watch in robot.watches)
        finding = ACTED if acted else refusal_finding(job, index, turn.target, robot, result)
    stranded = [*truth.fallen(result.frames), *_out_of_reach(robot, before, after)]
    stranded = list(dict.fromkeys(stranded))
    error = result.error
    changes = {
        "verdict": came,
        "status": result.status,
        "reason": error.code if error else "",
        "message": error.message if error else "",
        "told": result.notes,
        "broken": broken,
        "stranded": tuple(stranded),
        "untold": tuple(name for name in stranded if not is_told(result, name)),
        "seconds": seconds,
    }
    said, done = said.model_copy(update=changes), result.status == "done"
    if finding is not None:
        said = said.with_finding(finding)
    return said, Past(turn, result.frames, before, done)


def verdict(turn: Turn, result: Result, good: bool, stirred: bool) -> Verdict:
    """The verdict on a turn.

    Args:
        turn: what was said.
        result: what the robot says.
        good: whether what was asked is truly so, and nothing was broken.
        stirred: whether anything was moved.
    """
    if result.status == "done":
        return "satisfied" if good else "false"
    if result.status == "failed":
        return "failed"
    return "refused" if turn.feasible or stirred else "rightly refused"


def is_told(result: Result, name: str) -> bool:
    """Whether an answer says of an object that something is wrong with it, or where it is."""
    wrong = result.error.message if result.error else ""
    return any(name in text for text in (wrong, *result.notes))


class _Truth:
    """What a turn truly brought about."""

    def __init__(self, turn: Turn, before: Places, after: Places, past: Past | None) -> None:
        self.turn, self.before, self.after, self.past = turn, before, after, past

    def judge(self, robot: Watched) -> tuple[bool, tuple[str, ...]]:
        """Whether no goal was missed, and the clauses that were broken."""
        steps = robot.true_verdicts()
        met = all(step.met is not False for step in steps)
        broken = tuple(dict.fromkeys(kind for step in steps for kind in step.broken))
        if self.turn.kind == "undo":
            met = self._is_back()
        if self.turn.kind == "put down":
            met = self._stands(robot)
        return met, broken

    def _is_back(self) -> bool:
        assert self.past is not None, "something is undone"
        name = self.turn.target
        was, now = self.past.before[name], self.after[name]
        turned = 0.0 if now.is_round else now.turned_against(was)
        near = now.way_to(was) <= SLACK * 2.0 * D.turn_drift
        return near and turned <= SLACK * 2.0 * D.turn_tolerance

    def _stands(self, robot: Watched) -> bool:
        now, was = self.after[self.turn.target], self.before[self.turn.target]
        low = float(now.corners[:, 2].min()) <= SLACK * D.lift_tolerance
        return robot.held is None and low and now.leans_against(was) <= SLACK * D.upright

    def fallen(self, frames: Sequence[g.Frame]) -> list[str]:
        """Names of what fell without being asked to."""
        asked = {
            frame.object.id for frame in frames if frame.object is not None and _may_fall(frame)
        }
        return [name for name in fallen(self.before, self.after) if name not in asked]


def _may_fall(frame: g.Frame) -> bool:
    events = {clause.event for clause in frame.constraints if isinstance(clause, g.Until)}
    return isinstance(frame.goal, g.Topple | g.Upright) or "tips" in events


def _out_of_reach(robot: Watched, before: Places, after: Places) -> list[str]:
    """Names of what was moved to where the robot can neither push nor lift it."""
    if robot.held is not None:
        return []
    return [name for name in moved(before, after) if not _is_reached(robot, name)]


def _is_reached(robot: Watched, name: str) -> bool:
    sentences = [f"push the {name} 5 cm {side}" for side in SIDES]
    said = (*sentences, f"lift the {name} by 5 cm")
    return any(robot.say(text, plan_only=True).status in ("planned", "done") for text in said)
