"""Fixed sentences in worlds that differ from seed to seed from what is believed.

| suite | world | belief |
|---|---|---|
| hands | a built-in scene, each thing shifted by up to 10 mm along x and y and turned by up to 10°; masses, frictions and forces of lids lie within 15 %; the carton is 20 to 80 % full | the registry |
| paper | the kitchen; masses, frictions and forces of lids lie within 30 %, centres of mass within some millimetres; a camera with a noise of 5 mm and 2° and a constant error of 2 mm | knows those bounds |
| ten | the kitchen; masses and frictions are off by up to 20 %: the corners of that range first | the registry |
| wrong_beliefs | the kitchen | of the ice tea box half of the true friction, 0.6 or 1.4 times its mass, as sure of them as of the right ones, relative to the value |

The robot is told one sentence as a user would tell it, and judged by the checks of its clauses,
which see the world as it truly is. A failure is *told* if the robot itself ended with it, and
*silent* if it thought that all was done. Each seed also has its own noise of sensors.
"""  # noqa: E501

from __future__ import annotations

import traceback
from argparse import Namespace
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.goals.drawn_worlds import VISION, believed, drawn_truth, harder
from benchmarks.goals.tables import Columns, counters, grouped, table
from benchmarks.record import Kept
from nlcontrol import Registry
from nlcontrol.batches.drawn_scenes import Generator
from nlcontrol.checks.verdicts import PLANNED_ENDS
from nlcontrol.learning.lessons import change_contents
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import ObjectModel
from sim.truth.object_truth import Truth, truth_as_believed
from sim.truth.scene_file import Pose, Scene, SceneObject, load_scene

Suite = Literal["hands", "paper", "ten", "wrong_beliefs"]

PUSH = "push the ice tea box away without toppling it"
HANDS = {
    "open": ("kitchen", "open the ice tea cup"),
    "pour": ("kitchen", "pour the contents of the ice tea into the mug"),
    "lift": ("kitchen", "lift the mug"),
    "place": ("kitchen", "pick up the mug and put it next to the ice tea cup"),
    "jar": ("pantry", "take the lid off the jar"),
    "bottle": ("pantry", "unscrew the cap of the fixed bottle"),
}
"""Where each sentence of a hand is said, and the sentence."""
SENTENCES: dict[Suite, dict[str, str]] = {
    "hands": {name: text for name, (_, text) in HANDS.items()},
    "paper": {"push": PUSH, "open": HANDS["open"][1], "pour": HANDS["pour"][1]},
    "ten": {"push": PUSH},
    "wrong_beliefs": {"push": PUSH},
}

SHIFT, TURN = 0.010, 10.0
"""Largest shift of an object along x and y [m], and largest turn [degrees], for `hands`."""
APART = 0.15
"""Largest relative difference of truth and belief there."""
FILLED = (0.20, 0.80)
"""Share of its capacity that is in the carton."""
SPREAD = 0.20
"""Largest relative difference of truth and belief for `ten`."""
OBJECT = "ice tea box"
FRICTION, MASSES = 0.5, (0.6, 1.4)
"""What `wrong_beliefs` believes of the object, as shares of the truth."""

_POURED = "ice tea"
_OUTCOMES = ("satisfied", "refused", "told", "silent", "crashed")


class Job(NamedTuple):
    """A sentence in the world of a seed."""

    suite: Suite
    sentence: str
    seed: int

    @property
    def text(self) -> str:
        """The words."""
        return SENTENCES[self.suite][self.sentence]


class Done(Kept[Job]):
    """What came of a sentence.

    Attributes:
        status: as in a result, or `crashed`.
        end: of the last try; empty if nothing was tried.
        reason, message: code and words of what stopped it.
        tries: how many plans were carried out.
        stuck: whether the robot says that it did less than was asked.
        notes: clauses that did not hold, with what was measured, and what pushes taught.
    """

    status: str
    end: str = ""
    reason: str = ""
    message: str = ""
    tries: int = 0
    stuck: bool = False
    notes: tuple[str, ...] = ()

    @property
    def outcome(self) -> str:
        """`satisfied`, `refused`, `told`, `silent` or `crashed`."""
        if self.status == "done":
            return "satisfied"
        if self.status != "failed":
            return "crashed" if self.status == "crashed" else "refused"
        return "told" if self.stuck or self.end not in PLANNED_ENDS else "silent"


def robot_of(job: Job) -> Controller:
    """The robot of a job, in its world."""
    match job.suite:
        case "paper":
            return Controller(world(job), registry=believed(wide=True), seed=job.seed)
        case "wrong_beliefs":
            registry = Registry.built_in().copy()
            registry.add(wrongly_believed(job.seed), over=(OBJECT,))
            return Controller(world(job), registry=registry, seed=job.seed)
    return Controller(world(job), seed=job.seed)


def world(job: Job) -> Scene:
    """The world of a job; it depends on its suite, its scene and its seed alone."""
    scene = load_scene(HANDS[job.sentence][0] if job.suite == "hands" else "kitchen")
    rng = np.random.default_rng(job.seed)
    registry = believed(wide=True) if job.suite == "paper" else Registry.built_in()
    objects = [(item, registry.get(item.model)) for item in scene.objects]
    changed: dict[str, object] = {}
    match job.suite:
        case "hands":
            drawn = [_shifted(item, model, rng) for item, model in objects]
        case "paper":
            drawn = [
                item.model_copy(update={"truth": _doubted(model, rng)}) for item, model in objects
            ]
            changed["vision"] = VISION
        case "ten":
            mass, friction = shares(job.seed)
            drawn = []
            for item, model in objects:
                off = {"mass_kg": mass * model.mass, "friction_table": friction * model.friction}
                truth = item.truth.model_copy(update=off)
                drawn.append(item.model_copy(update={"truth": truth}))
        case _:
            return scene
    return scene.model_copy(update=changed | {"objects": tuple(drawn)})


def _shifted(item: SceneObject, model: ObjectModel, rng: Generator) -> SceneObject:
    x, y, turn = rng.uniform(-1.0, 1.0, 3).tolist()
    pose = Pose(
        x_m=item.pose.x_m + SHIFT * x,
        y_m=item.pose.y_m + SHIFT * y,
        yaw_deg=item.pose.yaw_deg + TURN * turn,
    )
    return item.model_copy(update={"pose": pose, "truth": _handled(model, rng)})


def _handled(model: ObjectModel, rng: Generator) -> Truth:
    """How an object really is, with what is in it."""
    mass, friction, finger, contents, lid = (1.0 + APART * rng.uniform(-1.0, 1.0, 5)).tolist()
    filled = rng.uniform(*FILLED)
    container, vessel = model.container, model.vessel
    if container is None or vessel is None:
        model = model.model_copy(update={"mass": mass * model.mass})
    else:
        volume = contents * container.contents
        if model.name == _POURED:
            volume = filled * vessel.capacity
        shell = change_contents(model, -container.contents)
        model = change_contents(shell.model_copy(update={"mass": mass * shell.mass}), volume)
    return Truth.model_validate(
        dict(truth_as_believed(model))
        | {
            "friction_table": friction * model.friction,
            "friction_finger": finger * model.finger_friction,
            "container": model.container,
            "lid": None if model.lid is None else harder(model.lid, lid),
        }
    )


def _doubted(model: ObjectModel, rng: Generator) -> Truth:
    """How an object really is, within the bounds that the robot knows."""
    truth = drawn_truth(model, True, rng)
    if model.container is None or truth.container is not None:
        return truth
    contents = model.container.contents_l * truth.mass_kg / model.mass
    container = model.container.model_copy(update={"contents_l": contents})
    return truth.model_copy(update={"container": container})


def shares(seed: int) -> tuple[float, float]:
    """True mass and true friction for `ten`, as shares of the believed ones."""
    low, high = 1.0 - SPREAD, 1.0 + SPREAD
    corners = [(low, low), (low, high), (high, low), (high, high)]
    if seed < len(corners):
        return corners[seed]
    mass, friction = np.random.default_rng(seed).uniform(low, high, 2).tolist()
    return mass, friction


def wrongly_believed(seed: int) -> ObjectModel:
    """The ice tea box with its wrong beliefs."""
    model = Registry.built_in().get(OBJECT)
    truth = load_scene("kitchen").object(OBJECT).truth
    friction, mass = FRICTION * truth.friction_table, MASSES[seed % 2] * truth.mass_kg
    return model.model_copy(
        update={
            "friction": friction,
            "friction_sd": model.friction_sd * friction / model.friction,
            "mass": mass,
            "mass_sd": model.mass_sd * mass / model.mass,
        }
    )


def run(job: Job) -> Done:
    """Says a sentence in its world; what it stumbles over is a result too."""
    try:
        result = Conversation(robot_of(job)).say(job.text)
    except Exception:  # one case that breaks must not end the run
        return Done(job=job, status="crashed", message=traceback.format_exc(limit=-3))
    lessons = [lesson.text for step in result.steps for lesson in step.lessons]
    missed = [
        f"{check.quantity} {check.measured} {check.unit}, asked {check.relation} {check.expected}"
        for check in result.checks
        if not check.ok
    ]
    return Done(
        job=job,
        status=result.status,
        end=result.execution.end if result.execution else "",
        reason=result.error.code if result.error else "",
        message=result.error.message if result.error else "",
        tries=sum(len(step.plans) for step in result.steps),
        stuck=any(step.stuck is not None for step in result.steps),
        notes=(*missed, *lessons),
    )


def jobs(options: Namespace) -> list[Job]:
    """The sentences in the worlds that the options choose."""
    names = options.kinds or SENTENCES[options.suite]
    seeds = range(options.seed, options.seed + options.seeds)
    return [Job(options.suite, name, seed) for name in names for seed in seeds]


def report(results: Sequence[Done]) -> str:
    """What came of each sentence, and of each world in which it was not satisfied."""
    columns: Columns[Done] = counters(lambda done: done.outcome, _OUTCOMES)
    columns["tries a run"] = lambda some: f"{sum(done.tries for done in some) / len(some):.2f}"
    amiss = (line(done) for done in results if done.outcome != "satisfied")
    return "\n".join([table(grouped(results, lambda done: done.job.sentence), columns), *amiss])


def line(done: Done) -> str:
    """What came of one sentence."""
    details = "; ".join(filter(None, (done.end, done.reason, done.message, *done.notes)))
    return f"{done.job.sentence} {done.job.seed} {done.outcome}: {details}"
