"""Were refusals right? A search by brute force for what was refused, by the class of the refusal.

| refused as | confirmed if |
|---|---|
| `impossible` | no strokes do it in the world as it truly is, whoever pushes |
| `too_uncertain` | the best strokes for the object as it is believed succeed, over objects drawn from the belief, less often than was asked |
| `out_of_reach`, `blocked`, `out_of_time` | no strokes do it that some posture of hand and arm can make |

What does it in the true world only may be luck: where strokes of the last row exist, but succeed,
over objects drawn from the belief, less often than was asked of a plan, the verdict is `unlikely`.
The robot was right to refuse them, but not for the reason that it gave.

Strokes keep what every push of the robot keeps: they touch nothing else. The search is that of `benchmarks.goals.search`, postures are those of `benchmarks.goals.postures`.
It may miss what there is: a confirmed refusal is one for which nothing was found. What has fallen
over beside the object is left out of it, which gives it more room than there is.

What no strokes do (a whole hand's work, what lies or is brought to what lies, a step that comes
after others) is planned once more instead, with ten times the work: confirmed is what is refused
then, too. A plan that is found is carried out, and the refusal was wrong if the judge of true poses
finds it done; if not, it is `unlikely`.
"""  # noqa: E501

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import numpy as np

from benchmarks.goals.cases import Done, Watch, Watched
from benchmarks.goals.postures import reachable
from benchmarks.goals.search import Asked, Found, repeated, search, seen
from benchmarks.goals.sentences import Job, beliefs_of, said
from benchmarks.goals.tables import Columns, counters, grouped, table
from benchmarks.record import Kept, carried_out
from benchmarks.worlds.strokes import Array, Generator, heading_of, upright
from grammar.frames.command import Command
from nlcontrol.checks.frame_checks import require_checkable
from nlcontrol.errors import ControlError
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_execution import run_command
from objectmodels import ObjectModel
from planner.problem.planning_problem import is_handled
from planner.types.defaults import Defaults
from planner.types.plan import Plan
from planner.types.world_state import WorldState
from sim.simulated_executor import simulation
from sim.truth.object_truth import truth_as_believed
from sim.truth.scene_file import Pose, Scene

Verdict = Literal["confirmed", "unlikely", "unconfirmed", "not looked for"]

DRAWN = 20
"""Objects drawn from a belief."""
BEST = 3
"""Ways of doing it that are tried on all of them."""
POSTURED = 4
"""Ways of doing it for which postures are looked for."""

_MORE = 10  # times as long as the first may a second search work
_MOST = 1000  # the most that is counted of ways and looks
_NEAR = 0.45  # what is farther away from the object meets neither it nor the hand [m]
_LEAST = 0.05  # of what is believed; parameters are drawn no smaller


class Finding(NamedTuple):
    """What was found about a refusal.

    Attributes:
        verdict: on it.
        found: what was found, or not.
    """

    verdict: Verdict
    found: str


def judge_refusal(
    robot: Watched,
    target: str,
    reason: str,
    tries: int,
    rng: Generator,
    second: Callable[[], Finding],
) -> Finding:
    """Looks into the refusal that a robot gave last.

    Args:
        robot: in its world as it is now.
        target: name of the object that the sentence is about.
        reason: class of the refusal.
        tries: roll-outs in each round of the search.
        rng: to draw from.
        second: what a second search finds; for what no strokes do.
    """
    if not robot.watches:
        return Finding("not looked for", "nothing was planned")
    watch = robot.watches[-1]
    try:
        require_checkable(watch.frame)
    except ControlError as error:
        return Finding("not looked for", error.info.message)
    world = simulation(robot.executor).world
    fragile = frozenset(item.name for item in world.scene.objects if item.fragile)
    asked = Asked(watch.frame, target, robot.models, robot.table, fragile)
    poses = world.sample.poses
    nothing_done = all(each.trace is None for each in robot.watches)
    if nothing_done and not _is_made_by_strokes(watch, asked, poses):
        return second()
    if not upright(poses[asked.name]):
        return Finding("not looked for", f"the {asked.name} does not stand any more")
    now = _as_it_stands(world.scene, asked, poses)
    level = robot.defaults.probability
    if reason in ("out_of_reach", "blocked", "out_of_time"):
        return _unreachable(now, asked, level, tries, rng)
    if reason == "too_uncertain":
        believed = _with(now, asked.name, asked.model, np.zeros(7))
        found, rolled = search(believed, asked, tries, rng, enough=BEST)
        best, _ = likeliest(now, asked, found, rng)
        text = f"the best of {len(found)} ways found in {rolled} roll-outs succeeds in {best:.0%}"
        return Finding("confirmed" if best < level else "unconfirmed", text)
    found, rolled = search(now, asked, tries, rng)
    if found:
        return Finding("unconfirmed", f"{_told(found[0])} do it, found after {rolled} roll-outs")
    return Finding("confirmed", f"nothing in {rolled} roll-outs")


def _is_made_by_strokes(watch: Watch, asked: Asked, poses: Mapping[str, Array]) -> bool:
    """Whether strokes may do what was refused: it is the first step, and about what stands."""
    named = [name for name in poses if name == asked.name or asked.speaks_of(name)]
    stand = all(upright(poses[name]) for name in named)
    planned = any(isinstance(made, Plan) for made in watch.plans)
    return not planned and not is_handled(watch.frame) and stand


def second_search(robot: Watched, command: Command) -> Finding:
    """What a robot finds and does if it may work longer; its world is as it leaves it then.

    Args:
        robot: that does it.
        command: that was refused.
    """
    robot.defaults = patient(robot.defaults)
    robot.forget_steps()
    result = run_command(robot, command)
    many = f"{robot.defaults.most_work} units of work"
    if result.status != "done" and all(watch.trace is None for watch in robot.watches):
        return Finding("confirmed", f"no plan with up to {many} either")
    truly = robot.true_verdicts()
    if result.status == "done" and all(step.met is not False and not step.broken for step in truly):
        return Finding("unconfirmed", f"a plan, with up to {many}, which the true world carries")
    return Finding("unlikely", f"a plan, with up to {many}, which the true world does not carry")


def patient(defaults: Defaults) -> Defaults:
    """Defaults with which a search may work ten times as long."""
    return replace(
        defaults,
        most_work=_MORE * defaults.most_work,
        most_contacts_last=_MORE * defaults.most_contacts_last,
        most_looks=_MOST,
        most_looks_last=_MOST,
        most_grasps=_MOST,
    )


def _as_it_stands(scene: Scene, asked: Asked, poses: Mapping[str, Array]) -> Scene:
    """The scene as it is now, without what has fallen over or is too far away to matter."""
    here = poses[asked.name][4:6]
    objects = []
    for item in scene.objects:
        x, y = poses[item.name][4:6].tolist()
        pose = Pose(x_m=x, y_m=y, yaw_deg=math.degrees(heading_of(poses[item.name])))
        near = math.dist((x, y), here) < _NEAR or asked.speaks_of(item.name)
        if upright(poses[item.name]) and near:
            objects.append(item.model_copy(update={"pose": pose}))
    return scene.model_copy(update={"objects": tuple(objects)})


def likeliest(
    scene: Scene, asked: Asked, ways: Sequence[Found], rng: Generator, draws: int = DRAWN
) -> tuple[float, Found | None]:
    """In which share of the worlds the best of some ways succeeds, and which one that is.

    Args:
        scene: how everything stands.
        asked: what is asked.
        ways: strokes that do it in some world; 0 and None if there are none.
        rng: to draw from.
        draws: worlds, each with the object drawn from the belief.
    """
    spread = asked.model.covariance
    off = (rng.multivariate_normal(np.zeros(7), spread) for _ in range(draws))
    worlds = [_with(scene, asked.name, asked.model, each) for each in off]
    rated = [(float(np.mean([repeated(w, asked, way) for w in worlds])), way) for way in ways]
    return max(rated, key=lambda each: each[0], default=(0.0, None))


def _with(scene: Scene, name: str, model: ObjectModel, off: Array) -> Scene:
    """The scene with an object that differs by so much from what is believed."""
    mass, friction, finger = np.maximum(1.0 + off[:3] / model.means[:3], _LEAST).tolist()
    truth = truth_as_believed(model)
    changed = truth.model_copy(
        update={
            "mass_kg": truth.mass_kg * mass,
            "friction_table": truth.friction_table * friction,
            "friction_finger": truth.friction_finger * finger,
        }
    ).with_shift(off[4:])
    objects = tuple(
        item.model_copy(update={"truth": changed}) if item.name == name else item
        for item in scene.objects
    )
    return scene.model_copy(update={"objects": objects})


def _unreachable(scene: Scene, asked: Asked, level: float, tries: int, rng: Generator) -> Finding:
    found, rolled = search(scene, asked, tries, rng, enough=POSTURED)
    made = [each for each in found if _postured(scene, asked, each, rng)]
    if not made:
        text = f"{len(found)} ways in {rolled} roll-outs, none of which a hand can make"
        return Finding("confirmed", text)
    best, way = likeliest(scene, asked, made, rng)
    assert way is not None, "a hand can make some"
    text = f"{_told(way)} do it, and a hand can make them; they succeed in {best:.0%}"
    return Finding("unlikely" if best < level else "unconfirmed", text)


def _postured(scene: Scene, asked: Asked, found: Found, rng: Generator) -> bool:
    """Whether hand and arm can make all strokes."""
    for stroke, before in zip(found.strokes, found.before, strict=True):
        there = {
            name: replace(seen(name, asked.models[name], pose), fragile=name in asked.fragile)
            for name, pose in before.items()
        }
        if not reachable(stroke, found.fingers, scene.robot, WorldState(there), rng):
            return False
    return True


def _told(found: Found) -> str:
    """Strokes in words."""
    ways = "; ".join(
        f"from ({1e3 * s.start[0]:.0f}, {1e3 * s.start[1]:.0f}, {1e3 * s.start[2]:.0f}) mm"
        f" to ({1e3 * s.end[0]:.0f}, {1e3 * s.end[1]:.0f}) mm"
        for s in found.strokes
    )
    return f"strokes of {found.fingers} fingertips {ways}"


class Doubt(NamedTuple):
    """A refusal to be looked into.

    Attributes:
        case: which case was refused.
        reason: its class.
        tries: roll-outs in each round of the search.
    """

    case: Job
    reason: str
    tries: int


class Confirmation(Kept[Doubt]):
    """What brute force found.

    Attributes:
        verdict: on the refusal.
        text: the sentence.
        refusal: what the robot said.
        found: what was found, or not.
    """

    verdict: Verdict
    text: str
    refusal: str
    found: str


def confirmed(
    results: Sequence[Done],
    most: int,
    *,
    executor: Executor | None,
    workers: int | None,
    record: Path | None,
    tries: int,
) -> str:
    """Looks into refusals, spread over the classes, and tells about them.

    Args:
        results: among which there are refusals.
        most: how many of them.
        executor: where; processes of this machine if not given.
        workers: how many.
        record: of the results; what is found is kept beside it.
        tries: roll-outs in each round of a search.
    """
    doubts = [Doubt(done.job, why, tries) for done, why in _sample(results, most)]
    beside = record and record.with_name(f"{record.stem}.confirmed{record.suffix}")
    found = carried_out(
        confirm,
        doubts,
        Confirmation,
        executor=executor,
        workers=workers,
        record=beside,
        told=lambda one: print(one.job.case, one.job.reason, one.verdict, file=sys.stderr),
    )
    refused = sum(bool(done.refused) for done in results)
    told = list(found.values())
    return f"{confirmations(told)}\n{wrong_share(told, refused, len(results))}"


def _sample(results: Sequence[Done], most: int) -> list[tuple[Done, str]]:
    """The first of each class, then the second of each, and so on."""
    met: Counter[str] = Counter()
    ranked = []
    for done in results:
        if done.refused:
            ranked.append((met[done.refused], done))
            met[done.refused] += 1
    ranked.sort(key=lambda each: each[0])
    return [(done, done.refused) for _, done in ranked[:most]]


def confirmations(found: Sequence[Confirmation]) -> str:
    """A line per class, and all about those that were not confirmed."""
    columns: Columns[Confirmation] = counters(lambda each: each.verdict, get_args(Verdict))
    columns["cases"] = lambda some: ", ".join(str(each.job.case) for each in some)
    lines = [table(grouped(found, lambda each: each.job.reason), columns)]
    lines += [
        f"{each.job.case} {each.verdict}: “{each.text}”: {each.refusal}\n  found: {each.found}"
        for each in found
        if each.verdict != "confirmed"
    ]
    return "\n".join(lines)


def wrong_share(found: Sequence[Confirmation], refused: int, cases: int) -> str:
    """Which share of all cases was wrongly refused, by those that were looked into.

    Args:
        found: about some refusals.
        refused: how many there were.
        cases: of which these were refused.
    """
    looked = sum(each.verdict != "not looked for" for each in found)
    wrong = sum(each.verdict == "unconfirmed" for each in found)
    share = wrong / max(looked, 1) * refused / max(cases, 1)
    return (
        f"wrongly refused: {wrong} of {looked} that were looked into, of {refused} refused of"
        f" {cases} cases: {share:.1%} of all cases"
    )


def confirm(doubt: Doubt) -> Confirmation:
    """Looks into one refusal."""
    scene, sentence = said(doubt.case)
    registry, seed = beliefs_of(doubt.case), doubt.case.seed
    robot, fresh = (Watched(scene, registry=registry, seed=seed) for _ in range(2))
    result = Conversation(robot).say(sentence.text, plan_only=not doubt.case.executed)
    finding = judge_refusal(
        robot,
        sentence.target,
        doubt.reason,
        doubt.tries,
        np.random.default_rng((seed, doubt.case.number, doubt.tries)),
        lambda: second_search(fresh, fresh.command(sentence.text)),
    )
    return Confirmation(
        job=doubt,
        verdict=finding.verdict,
        text=sentence.text,
        refusal=result.error.message if result.error else "",
        found=finding.found,
    )
