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

A refusal of what is labelled feasible is judged by `refusal_judge`, if the job says so, and if
nothing was done before it. That judge looks, plans and even carries out, in a copy of the process:
the talk goes on as if it had not been judged.
"""

from __future__ import annotations

import traceback
from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from benchmarks.goals.cases import Watched
from benchmarks.goals.drawn_turns import TURNS, Job, Past, Turn, draw_scene, draw_turn
from benchmarks.goals.drawn_worlds import believed
from benchmarks.goals.judge import SLACK, STIRRED, Places, fallen, moved, true_places
from benchmarks.goals.refusal_judge import Finding, judge_refusal, second_search
from benchmarks.goals.refusal_judge import Verdict as RefusalVerdict
from benchmarks.goals.sentences import SIDES
from benchmarks.goals.tables import Columns, counters, grouped, share, table
from benchmarks.record import Kept
from grammar.frames import command as g
from nlcontrol.parallel_tasks import end_with_parent
from nlcontrol.session.conversation import Conversation
from planner.types.defaults import DEFAULTS as D

if TYPE_CHECKING:
    from nlcontrol.results.result import Result

Verdict = Literal["satisfied", "rightly refused", "refused", "failed", "false", "crashed"]
GOOD = ("satisfied", "rightly refused")
ACTED = Finding("not looked for", "something was done before it was refused")
"""Of a turn that was not refused at once, and so not rightly."""

_LOOKS = 10  # most that are waited until everything rests


@dataclass(frozen=True)
class Said(Turn):
    """What came of a turn.

    Attributes:
        verdict: on it.
        status, reason, message: as in a result.
        told: its notes.
        broken: kinds of the clauses that truly were broken.
        stranded: names of what was stranded by it.
        untold: those of them of which the answer says nothing.
        judged: verdict on its refusal, if that was judged.
        found: by what.
    """

    verdict: Verdict = "crashed"
    status: str = "crashed"
    reason: str = ""
    message: str = ""
    told: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()
    stranded: tuple[str, ...] = ()
    untold: tuple[str, ...] = ()
    judged: RefusalVerdict | None = None
    found: str = ""

    def with_finding(self, finding: Finding) -> Said:
        """The turn with what was found about its refusal."""
        came: Verdict = "rightly refused" if finding.verdict == "confirmed" else "refused"
        return replace(self, verdict=came, judged=finding.verdict, found=finding.found)


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
    said = Said(**vars(turn))
    try:
        result = conversation.say(turn.text)
    except Exception:  # one turn that breaks must not end a run of many
        text = traceback.format_exc(limit=-3)
        return replace(said, message=text), Past(turn, (), before, done=False)
    after = true_places(robot.executor)
    met, broken = _judged(turn, before, after, past, robot)
    stirred = bool(moved(before, after, STIRRED))
    came = verdict(turn, result, met and not broken, stirred)
    finding = None
    if job.tries > 0 and came == "refused" and turn.feasible:
        acted = stirred or any(watch.trace is not None for watch in robot.watches)
        finding = ACTED if acted else refusal_finding(job, index, turn.target, robot, result)
    asked = {frame.object.id for frame in result.frames if frame.object and _may_fall(frame)}
    fell = [name for name in fallen(before, after) if name not in asked]
    stranded = list(dict.fromkeys([*fell, *_out_of_reach(robot, before, after)]))
    said = replace(
        said,
        verdict=came,
        status=result.status,
        reason=result.error.code if result.error else "",
        message=result.error.message if result.error else "",
        told=result.notes,
        broken=broken,
        stranded=tuple(stranded),
        untold=tuple(name for name in stranded if not is_told(result, name)),
    )
    if finding is not None:
        said = said.with_finding(finding)
    done = result.status == "done"
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


def _judged(
    turn: Turn, before: Places, after: Places, past: Past | None, robot: Watched
) -> tuple[bool, tuple[str, ...]]:
    """Whether no goal of a turn was missed, and the clauses that were broken."""
    steps = robot.true_verdicts()
    broken = tuple(dict.fromkeys(kind for step in steps for kind in step.broken))
    now = after[turn.target]
    match turn.kind:
        case "undo":
            assert past is not None, "something is undone"
            was = past.before[turn.target]
            turned = 0.0 if now.is_round else now.turned_against(was)
            near = now.way_to(was) <= SLACK * 2.0 * D.turn_drift
            met = near and turned <= SLACK * 2.0 * D.turn_tolerance
        case "put down":
            low = now.lowest <= SLACK * D.lift_tolerance
            level = now.leans_against(before[turn.target]) <= SLACK * D.upright
            met = robot.held is None and low and level
        case _:
            met = all(step.met is not False for step in steps)
    return met, broken


def _may_fall(frame: g.Frame) -> bool:
    events = {clause.event for clause in frame.constraints if isinstance(clause, g.Until)}
    return isinstance(frame.goal, g.Topple | g.Upright) or "tips" in events


def _out_of_reach(robot: Watched, before: Places, after: Places) -> Iterator[str]:
    """Names of what was moved to where the robot can neither push nor lift it."""
    for name in moved(before, after) if robot.held is None else ():
        said = [f"push the {name} 5 cm {side}" for side in SIDES] + [f"lift the {name} by 5 cm"]
        answers = (Conversation(robot).say(text, plan_only=True).status for text in said)
        if not any(status in ("planned", "done") for status in answers):
            yield name


def refusal_finding(job: Job, index: int, target: str, robot: Watched, result: Result) -> Finding:
    """What is found about a refused turn, in the world as the talk has it then.

    Args:
        job: which conversation.
        index: of the turn.
        target: name of the object that it is about.
        robot: that has refused it, and has done nothing since.
        result: its answer.
    """
    reason = result.error.code if result.error else ""
    rng = np.random.default_rng((job.seed, job.number, index, job.tries))
    # Its objects are resolved, so that "it" is what it was.
    said = g.Command(
        text=result.text, frames=result.frames, paraphrase=result.paraphrase or result.text
    )
    second = partial(second_search, robot, said)
    try:
        found: Finding = result_in_copy(
            partial(judge_refusal, robot, target, reason, job.tries, rng, second)
        )
    except RuntimeError as raised:  # one refusal that cannot be judged must not end a run of many
        return Finding("not looked for", str(raised))
    return found


def result_in_copy(work: Callable[[], object]) -> Any:
    """Result of what is done in a copy of this process, and leaves no trace here.

    The copy is a fork: it begins with all that is in memory here, and gives back a result alone.

    Raises:
        RuntimeError: the copy has raised something, which the message names, or has ended.
    """
    context = get_context("fork")
    here, there = context.Pipe(duplex=False)
    copy = context.Process(target=_send_result, args=(work, there))
    copy.start()
    there.close()
    try:
        result, raised = here.recv()
    except EOFError:
        raise RuntimeError("the copy of the process has ended") from None
    finally:
        copy.join()
    if raised is not None:
        raise RuntimeError(raised)
    return result


def _send_result(work: Callable[[], object], there: Connection) -> None:
    end_with_parent()
    try:
        there.send((work(), None))
    except Exception as raised:  # whatever it is, it is told in the process that waits for it
        there.send((None, f"{type(raised).__name__}: {raised}"))


def jobs(options: Namespace) -> list[Job]:
    """The conversations of a seed that the options choose; `--confirm` judges their refusals."""
    tries = options.tries if options.confirm else 0
    return [Job(options.seed, options.first + k, tries) for k in range(options.cases)]


def report(talks: Sequence[Talk]) -> str:
    """Tables of verdicts by setting and kind, every turn that went amiss or was judged."""
    turns = [(each.job.setting, turn) for each in talks for turn in each.turns]
    every = [turn for _, turn in turns]
    settings: dict[str, list[Said]] = {}
    for setting, turn in turns:
        settings.setdefault(setting, []).append(turn)
    columns: Columns[Said] = counters(lambda turn: turn.verdict, get_args(Verdict))
    columns["good"] = lambda some: share(sum(turn.verdict in GOOD for turn in some), len(some))
    columns["stranded"] = lambda some: sum(len(turn.stranded) for turn in some)
    columns["untold"] = lambda some: sum(len(turn.untold) for turn in some)
    lines = [table(settings | grouped(every, lambda turn: turn.kind), columns)]
    judged = Counter(turn.judged for turn in every if turn.judged)
    if judged:
        told = ", ".join(f"{judged[verdict]} {verdict}" for verdict in get_args(RefusalVerdict))
        lines.append(f"refusals judged: {told}")
    return "\n".join([*lines, *_amiss(talks)])


def _amiss(talks: Sequence[Talk]) -> Iterator[str]:
    for each in talks:
        for index, turn in enumerate(each.turns):
            if turn.verdict in GOOD and not turn.stranded and not turn.judged:
                continue
            broken = f"; broken {', '.join(turn.broken)}" if turn.broken else ""
            left = f"; stranded {', '.join(turn.stranded)}" if turn.stranded else ""
            left += f", untold {', '.join(turn.untold)}" if turn.untold else ""
            yield (
                f"{each.job.seed}-{each.job.number}.{index} {turn.verdict} “{turn.text}”"
                f"{broken}{left}: {turn.reason} {turn.message} {'; '.join(turn.told)}".rstrip()
            )
            if turn.judged:
                yield f"  {turn.judged}: {turn.found}"


def line(talk: Talk) -> str:
    """What came of one conversation."""
    verdicts = Counter(turn.verdict for turn in talk.turns)
    told = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())
    return f"{talk.job.seed}-{talk.job.number}: {told}"
