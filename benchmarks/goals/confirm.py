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
It may miss what there is: a confirmed refusal is one for which nothing was found.

What no strokes do (a whole hand's work, what lies, a step that comes after others) is planned once
more instead, with ten times the work: confirmed is what is refused then, too.
"""  # noqa: E501

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.goals.cases import Done, Watch, Watched
from benchmarks.goals.postures import reachable
from benchmarks.goals.search import Asked, Found, repeated, search, seen
from benchmarks.goals.sentences import beliefs_of, said
from benchmarks.goals.worlds import Job
from benchmarks.record import Kept, carried_out
from benchmarks.strokes import Array, heading_of, upright
from nlcontrol.batches.drawn_scenes import Generator
from nlcontrol.checks.frame_checks import require_checkable
from nlcontrol.errors import ControlError
from objectmodels import ObjectModel
from planner.problem.planning_problem import is_handled
from planner.types.defaults import DEFAULTS
from planner.types.world_state import WorldState
from sim.simulated_executor import simulation
from sim.truth.scene_file import Pose, Scene
from sim.truth.truth_from_model import truth_as_believed

Verdict = Literal["confirmed", "unlikely", "unconfirmed", "not looked for"]

DRAWN = 20
"""Objects drawn from a belief."""
BEST = 3
"""Ways of doing it that are tried on all of them."""
POSTURED = 4
"""Ways of doing it for which postures are looked for."""

PATIENT = replace(
    DEFAULTS,
    most_work=10 * DEFAULTS.most_work,
    most_contacts_last=10 * DEFAULTS.most_contacts_last,
    most_looks=1000,
    most_looks_last=1000,
    most_grasps=1000,
)
"""With which a second search may work ten times as long; a thousand is the most that is counted."""

_NEAR = 0.45  # what is farther away from the object meets neither it nor the hand [m]
_LEAST = 0.05  # of what is believed; parameters are drawn no smaller


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
        told=_tell,
    )
    refused = sum(done.refused is not None for done in results)
    told = list(found.values())
    return f"{table(told)}\n{wrong_share(told, refused, len(results))}"


def _tell(found: Confirmation) -> None:
    case = found.job.case
    print(f"{case.seed}-{case.number} {found.job.reason} {found.verdict}", file=sys.stderr)


def _sample(results: Sequence[Done], most: int) -> list[tuple[Done, str]]:
    """The first of each class, then the second of each, and so on."""
    refused = [(done, done.refused) for done in results if done.refused is not None]
    met: Counter[str] = Counter()
    ranks = []
    for _, reason in refused:
        ranks.append(met[reason])
        met[reason] += 1
    order = sorted(range(len(refused)), key=lambda k: (ranks[k], k))
    return [refused[k] for k in order[:most]]


def table(found: Sequence[Confirmation]) -> str:
    """A line per class, and all about those that were not confirmed."""
    lines = [
        f"{'refused as':14} {'confirmed':>10} {'unlikely':>9} {'not':>5} {'not looked for':>15}"
        "  numbers"
    ]
    for reason in dict.fromkeys(each.job.reason for each in found):
        some = [each for each in found if each.job.reason == reason]
        counts = Counter(each.verdict for each in some)
        numbers = ", ".join(str(each.job.case.number) for each in some)
        lines.append(
            f"{reason:14} {counts['confirmed']:>10} {counts['unlikely']:>9}"
            f" {counts['unconfirmed']:>5} {counts['not looked for']:>15}  {numbers}"
        )
    for each in found:
        if each.verdict != "confirmed":
            case = each.job.case
            lines.append(
                f"{case.seed}-{case.number} {each.verdict}: “{each.text}”: {each.refusal}"
                f"\n  found: {each.found}"
            )
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
    robot = Watched(scene, registry=beliefs_of(doubt.case), seed=doubt.case.seed)
    result = robot.say(sentence.text, plan_only=not doubt.case.executed)
    made = partial(
        Confirmation,
        job=doubt,
        text=sentence.text,
        refusal=result.error.message if result.error else "",
    )
    rng = np.random.default_rng((doubt.case.seed, doubt.case.number, doubt.tries))
    watch = robot.watches[-1]
    frame = watch.frame
    fragile = frozenset(item.name for item in scene.objects if item.fragile)
    asked = Asked(frame, sentence.target, robot.models, robot.table, fragile)
    world = simulation(robot.executor).world
    poses = world.sample.poses
    try:
        require_checkable(frame)
    except ControlError as error:
        return made(verdict="not looked for", found=error.info.message)
    nothing_done = all(each.trace is None for each in robot.watches)
    if nothing_done and not _is_made_by_strokes(watch, poses[asked.name]):
        verdict, found = _second_search(doubt)
        return made(verdict=verdict, found=found)
    if not upright(poses[asked.name]):
        return made(verdict="not looked for", found=f"the {asked.name} does not stand any more")
    now = _as_it_stands(world.scene, asked, poses)
    if doubt.reason == "too_uncertain":
        verdict, found = _uncertain(now, asked, robot.defaults.probability, doubt.tries, rng)
    elif doubt.reason in ("out_of_reach", "blocked", "out_of_time"):
        level = robot.defaults.probability
        verdict, found = _unreachable(now, asked, robot.models, level, doubt.tries, rng)
    else:
        verdict, found = _impossible(now, asked, doubt.tries, rng)
    return made(verdict=verdict, found=found)


def _is_made_by_strokes(watch: Watch, pose: Array) -> bool:
    """Whether strokes may do what was refused: it is the first step, and about what stands."""
    return watch.plan is None and not is_handled(watch.frame) and upright(pose)


def _second_search(doubt: Doubt) -> tuple[Verdict, str]:
    """What the robot finds if it may work longer."""
    scene, sentence = said(doubt.case)
    registry, seed = beliefs_of(doubt.case), doubt.case.seed
    robot = Watched(scene, registry=registry, seed=seed, defaults=PATIENT)
    planned = robot.say(sentence.text, plan_only=True).status == "planned"
    many = f"{PATIENT.most_work} units of work"
    if planned:
        return "unconfirmed", f"a plan, with up to {many}"
    return "confirmed", f"no plan with up to {many} either"


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


def _impossible(scene: Scene, asked: Asked, tries: int, rng: Generator) -> tuple[Verdict, str]:
    found, rolled = search(scene, asked, tries, rng)
    if found:
        return "unconfirmed", f"{_told(found[0])} do it, found after {rolled} roll-outs"
    return "confirmed", f"nothing in {rolled} roll-outs"


def _uncertain(
    scene: Scene, asked: Asked, level: float, tries: int, rng: Generator
) -> tuple[Verdict, str]:
    found, rolled = search(
        _with(scene, asked.name, asked.model, np.zeros(7)), asked, tries, rng, enough=BEST
    )
    best, _ = likeliest(scene, asked, found, rng)
    text = f"the best of {len(found)} ways found in {rolled} roll-outs succeeds in {best:.0%}"
    return ("confirmed" if best < level else "unconfirmed"), text


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
    worlds = [_with(scene, asked.name, asked.model, _drawn(asked.model, rng)) for _ in range(draws)]
    rated = [(float(np.mean([repeated(w, asked, way) for w in worlds])), way) for way in ways]
    return max(rated, key=lambda each: each[0], default=(0.0, None))


def _drawn(model: ObjectModel, rng: Generator) -> Array:
    """How parameters differ from what is believed, in the order of `UNCERTAIN`, shape (7,)."""
    return np.asarray(rng.multivariate_normal(np.zeros(7), model.covariance))


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


def _unreachable(
    scene: Scene,
    asked: Asked,
    models: dict[str, ObjectModel],
    level: float,
    tries: int,
    rng: Generator,
) -> tuple[Verdict, str]:
    found, rolled = search(scene, asked, tries, rng, enough=POSTURED)
    made = [each for each in found if _postured(scene, each, models, rng)]
    if not made:
        return (
            "confirmed",
            f"{len(found)} ways in {rolled} roll-outs, none of which a hand can make",
        )
    best, way = likeliest(scene, asked, made, rng)
    assert way is not None, "a hand can make some"
    text = f"{_told(way)} do it, and a hand can make them; they succeed in {best:.0%}"
    return ("unlikely" if best < level else "unconfirmed"), text


def _postured(scene: Scene, found: Found, models: dict[str, ObjectModel], rng: Generator) -> bool:
    """Whether hand and arm can make all strokes."""
    fragile = {item.name for item in scene.objects if item.fragile}
    return all(
        reachable(stroke, found.fingers, scene.robot, _seen(before, models, fragile), rng)
        for stroke, before in zip(found.strokes, found.before, strict=True)
    )


def _seen(
    poses: Mapping[str, Array], models: dict[str, ObjectModel], fragile: set[str]
) -> WorldState:
    """Everything where it truly stands."""
    return WorldState(
        {
            name: replace(seen(name, models[name], pose), fragile=name in fragile)
            for name, pose in poses.items()
        }
    )


def _told(found: Found) -> str:
    """Strokes in words."""
    ways = "; ".join(
        f"from ({1e3 * s.start[0]:.0f}, {1e3 * s.start[1]:.0f}, {1e3 * s.start[2]:.0f}) mm"
        f" to ({1e3 * s.end[0]:.0f}, {1e3 * s.end[1]:.0f}) mm"
        for s in found.strokes
    )
    return f"strokes of {found.fingers} fingertips {ways}"
