"""Times of starting, reading, planning, predicting, simulating and drawing.

    python -m benchmarks.times cold-start [--runs 9]
    python -m benchmarks.times warm-plans --task push --tables 6 --seed 59

Each subcommand is a function here. Processor time does
not depend on what else the machine does; where that is not told, what is measured stands beside a
peer in the same run.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from benchmarks.commands import run_command

# What is heavy is imported where it is used: a first plan is timed in a process that has not
# loaded it.
if TYPE_CHECKING:
    import numpy as np

    from objectmodels import ObjectModel
    from objectmodels.geometry.base_shapes import Array
    from sim.truth.scene_file import Scene

    Generator = np.random.Generator

PACKAGES = ("nlcontrol", "grammar", "planner", "objectmodels", "sim")


def timed(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """How long something takes [s]."""
    start = clock()
    work()
    return clock() - start


def _output(*command: str, given: str = "") -> str:
    """What a command of this Python prints."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    run = subprocess.run(
        [sys.executable, *command],
        input=given,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
        env=environment,
    )
    return run.stdout


def _child_time() -> float:
    """User and system time of all processes that were started here and have ended [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cold_start(runs: int = 9) -> None:
    """Cold start of `nlcontrol plan`, as a multiple of importing what any such program imports.

    Both commands run in fresh processes, in turn, so that a busy machine slows both alike; the
    medians of their processor times are compared. Byte code is written by a first run, as in any
    installation.
    """
    sentence = "push the ice tea box away without toppling it"
    commands = {
        "import numpy, lark, pydantic, click": ("-c", "import numpy, lark, pydantic, click"),
        "nlcontrol plan": ("-m", "nlcontrol", "plan", sentence, "--json"),
    }

    def spent() -> list[float]:
        return [timed(lambda c=c: _output(*c), _child_time) for c in commands.values()]  # type: ignore[misc]

    spent()  # once for the file cache and the byte code
    times = [spent() for _ in range(runs)]
    for name, column in zip(commands, zip(*times, strict=True), strict=True):
        print(f"{name:36} {statistics.median(column):.3f} s (median of {runs})")
    print(f"cold start: {statistics.median(b / a for a, b in times):.2f} times the imports")


def first_plan(runs: int = 9) -> None:
    """What the first plan of a process costs, part by part, beyond importing the modules.

    Each run is a fresh process. It imports all modules that the sentence ever loads, then times
    the parts in turn: controller and look, parsing, planning by `Controller.plan`, and what
    `Conversation.say(…, plan_only=True)` adds to them at its first call. They are processor time,
    the medians of the runs; they vary by half with what else the machine does, the imports most.
    """
    prelude = "import json, sys; from benchmarks.times import first_parts, first_modules;"
    modules = _output("-c", f"{prelude} json.dump(first_modules(), sys.stdout)")
    parts = f"{prelude} json.dump(first_parts(json.load(sys.stdin)), sys.stdout)"
    times = [json.loads(_output("-c", parts, given=modules)) for _ in range(runs)]
    for part in times[0]:
        print(f"{part:32s} {statistics.median(run[part] for run in times):6.1f} ms")


def first_modules() -> list[str]:
    """The names of the project's modules that a sentence loads."""
    first_parts(())
    return [name for name in sys.modules if name.partition(".")[0] in PACKAGES]


def first_parts(modules: Sequence[str]) -> dict[str, float]:
    """Processor times of the parts of the first sentence, after these modules [ms]."""
    sentence = "push the ice tea box 5 cm away"
    times: dict[str, float] = {}
    began = time.process_time()

    def lap(part: str) -> None:
        nonlocal began
        now = time.process_time()
        times[part], began = 1e3 * (now - began), now

    for name in modules:
        import_module(name)
    lap("imports")
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation

    controller = Controller("kitchen")
    controller.look()
    lap("controller and look")
    command = controller.command(sentence)
    lap("parse")
    frame = controller.resolve(command).frames[0]
    lap("resolve")
    controller.plan(frame)
    lap("plan")
    Conversation(controller).say(sentence, plan_only=True)
    lap("say, parsed and planned before")
    return times


MOVED, TURNED = 0.02, 10.0
"""Farthest that an object is moved in its scene, along x and y [m], and turned [degrees]."""

_BOXES = ("ice tea box", "cereal box", "coffee box")
_SIDES = ("away", "toward me", "to the left", "to the right")
_MANNERS = ("", "", " without toppling it", " slowly", " with one finger", " with at most 15 N")


class Task(NamedTuple):
    """Sentences of a task, its scenes, and how many are said at each table."""

    sentence: Callable[[Generator], str]
    scenes: tuple[str, ...]
    said: int


def _one(rng: Generator, choices: Sequence[str]) -> str:
    return choices[int(rng.integers(len(choices)))]


def _turn_sentence(rng: Generator) -> str:
    sense = _one(rng, ("clockwise", "counterclockwise"))
    return f"turn the {_one(rng, _BOXES)} {rng.integers(10, 40)} degrees {sense}"


TASKS: Mapping[str, Task] = {
    "push": Task(
        lambda rng: (
            f"push the {_one(rng, _BOXES)} {rng.integers(3, 16)} cm {_one(rng, _SIDES)}"
            f"{_one(rng, _MANNERS)}"
        ),
        ("kitchen", "workbench", "breakfast"),
        4,
    ),
    "turn": Task(
        _turn_sentence,
        ("kitchen", "workbench"),
        2,
    ),
    "topple": Task(
        lambda rng: f"topple the {_one(rng, _BOXES)} {_one(rng, _SIDES)}",
        ("kitchen", "workbench"),
        2,
    ),
    "lift": Task(
        lambda rng: f"lift the {_one(rng, ('mug', 'ice tea'))} by {rng.integers(3, 10)} cm",
        ("kitchen",),
        2,
    ),
    "place": Task(
        lambda rng: (
            f"put the {_one(rng, ('mug', 'ice tea'))} {_one(rng, ('next to', 'behind'))} "
            "the ice tea cup"
        ),
        ("kitchen",),
        2,
    ),
    "pour": Task(
        lambda rng: f"pour {5 * rng.integers(4, 21)} ml of the ice tea into the mug",
        ("kitchen",),
        4,
    ),
    "open": Task(lambda rng: f"open the {_one(rng, ('jar', 'ice tea cup'))}", ("pantry",), 2),
}


def moved_table(name: str, rng: Generator) -> Scene:
    """A built-in scene whose objects are moved by up to `MOVED` and turned by up to `TURNED`."""
    from sim import load_scene

    scene = load_scene(name)
    objects = []
    for item in scene.objects:
        x, y, turn = rng.uniform(-1.0, 1.0, 3) * (MOVED, MOVED, TURNED)
        pose = item.pose
        moved = {"x_m": pose.x_m + x, "y_m": pose.y_m + y, "yaw_deg": pose.yaw_deg + turn}
        objects.append(item.model_copy(update={"pose": pose.model_copy(update=moved)}))
    return scene.model_copy(update={"objects": tuple(objects)})


class PlanTime(NamedTuple):
    """How long a plan took.

    Attributes:
        status: of the result.
        first: whether nothing was planned at its table before.
        spent, wall: processor and wall time [s].
    """

    status: str
    first: bool
    spent: float
    wall: float


def warm_plans(
    tables: int = 20,
    seed: int = 0,
    task: Sequence[str] = tuple(TASKS),
) -> None:
    """How long plans take where others were made before, over varied tables and sentences.

    The process has planned the task before, at another table. Refusals are counted apart; so is
    the first plan at a table. Times are of `Conversation.say(…, plan_only=True)`, from the words to
    the result.
    """
    for name in task:
        _plan_times(TASKS[name], 1, seed + 1)  # the process warms up
        times = _plan_times(TASKS[name], tables, seed)
        made = [each for each in times if each.status == "planned"]
        print(f"{name}: median and 95th percentile")
        print(_plan_row("plans", made))
        print(_plan_row("of them the first at a table", [each for each in made if each.first]))
        refused = [each for each in times if each.status != "planned"]
        print(_plan_row("refusals", refused), flush=True)


def _plan_times(task: Task, tables: int, seed: int) -> list[PlanTime]:
    import numpy as np

    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation

    times = []
    for number in range(tables):
        rng = np.random.default_rng((seed, number))
        scene = moved_table(task.scenes[number % len(task.scenes)], rng)
        controller = Controller(scene, seed=number)
        controller.look()
        for turn in range(task.said):
            text = task.sentence(rng)
            wall, spent = time.perf_counter(), time.process_time()
            status = Conversation(controller).say(text, plan_only=True).status
            spent, wall = time.process_time() - spent, time.perf_counter() - wall
            times.append(PlanTime(status, turn == 0, spent, wall))
    return times


def _plan_row(what: str, times: Sequence[PlanTime]) -> str:
    import numpy as np

    if not times:
        return f"  {what}: none"
    figures = []
    for name in ("spent", "wall"):
        middle, high = 1e3 * np.quantile([getattr(each, name) for each in times], [0.5, 0.95])
        figures.append(f"{name} {middle:.0f} and {high:.0f} ms")
    return f"  {what} ({len(times)}): {', '.join(figures)}"


def search_work(
    seed: int = 0, first: int = 0, cases: int = 60, most_work: int = 1_000_000, slow: float = 0.5
) -> None:
    """What plans in the worlds of `benchmarks.goals` cost: work, and time of a core.

    A quiet core does about four units of work (`most_work`) in a millisecond. Nothing is carried
    out. What takes `slow` seconds or more is listed.
    """
    from benchmarks.goals.drawn_worlds import believed
    from benchmarks.goals.sentences import Job, said
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation
    from planner import plan
    from planner.problem.planning_problem import SearchBudget

    total, whole = 0, 0.0
    for number in range(first, first + cases):
        work, spent, answers = 0, 0.0, []

        def planned(*args: Any, **settings: Any) -> Any:
            nonlocal work, spent
            budget, start = SearchBudget(most_work), time.process_time()
            made = plan(*args, **settings, budget=budget)
            work, spent = work + budget.done, spent + time.process_time() - start
            answers.append(getattr(made, "code", made.status))  # noqa: B023
            return made

        scene, sentence = said(Job(seed, number))
        controller = Controller(scene, registry=believed(), seed=seed, planner=planned)
        Conversation(controller).say(sentence.text, plan_only=True)
        total, whole = total + work, whole + spent
        if spent >= slow:
            text = f"{', '.join(answers)}: {sentence.text}"
            print(f"{seed}-{number}: {work} units, {spent:.1f} s ({text})", flush=True)
    print(f"{total} units in {whole:.1f} s: {1e3 * whole / max(total, 1):.2f} ms each")


def simulation(runs: int = 3) -> None:
    """Wall seconds per simulated second of a push with everything running.

    Everything: arm, hand and objects, camera, torque sensors, control at 100 Hz, recording. The
    peer is Drake alone: the same plant, holding still, without sensors and control, in the same
    run. Every object on the table costs, also one that is not touched: rows are for the kitchen's
    three boxes alone and for all that stands in it.
    """
    from sim import load_scene
    from sim.worlds.drake.drake_world import DrakeWorld

    def drake_alone(scene: Scene) -> float:
        simulator, seconds = DrakeWorld(scene).simulator, 10.0
        return timed(lambda: simulator.AdvanceTo(seconds, interruptible=False)) / seconds

    kitchen = load_scene("kitchen")
    print("| objects | Drake alone | everything | times as much |  (wall s per simulated s)")
    print("|---|---|---|---|")
    for count in (3, len(kitchen.objects)):
        scene = kitchen.model_copy(update={"objects": kitchen.objects[:count]})
        pairs = [(drake_alone(scene), _everything(scene)) for _ in range(runs)]
        alone, whole = (statistics.median(column) for column in zip(*pairs, strict=True))
        ratio = statistics.median(b / a for a, b in pairs)
        print(f"| {count} | {alone:.3f} | {whole:.3f} | {ratio:.2f} |")


def _everything(scene: Scene) -> float:
    """Wall seconds per simulated second of an execution, planning and start left out."""
    from nlcontrol.session.controller import Controller
    from planner.types.plan import Plan
    from sim.simulated_executor import simulation

    controller = Controller(scene)
    command = controller.parse("push the ice tea box away without toppling it")
    plan = controller.plan(controller.resolve(command).frames[0])
    assert isinstance(plan, Plan)
    world = simulation(controller.executor).world
    return timed(lambda: controller.execute(plan)) / world.time


def predictions(pushes: int = 20_000, few: int = 500, repetitions: int = 5) -> None:
    """Predictions a second: both tiers beside a readable peer and engines, in the same run.

    Every tier takes random pushes of the same box; the peer, the seed's reference model, takes one
    push at a time, and fewer. The engines roll one push out after another (`benchmarks.engines`).
    """
    import numpy as np

    from benchmarks.engines.single_pushes import HAS_MUJOCO, WORLDS, silence_drake
    from benchmarks.worlds.pushes import World, random_push, roll_out
    from objectmodels import BoxModel, Registry
    from tests.unit.objectmodels.mechanics.seed_model import SeedModel

    silence_drake()
    box = Registry.built_in().get("ice tea box")
    points, forces = random_pushes(box, pushes)
    directions = forces / np.linalg.norm(forces, axis=1, keepdims=True)
    corners = {"support": "corners", "friction_radius": np.hypot(0.09, 0.09) / 2}
    on_corners = BoxModel(**(box.model_dump() | corners))
    reference, push, some = SeedModel.of(box), random_push(0, 0), 10 * few

    def by_reference() -> object:
        return [reference.outcome(p, f) for p, f in zip(points[:few], forces[:few], strict=True)]

    def exactly(model: ObjectModel, count: int) -> object:
        return model.thresholds(points[:count], directions[:count], exact=True)

    def rolled(world: Callable[[ObjectModel], World]) -> object:
        return roll_out(world(push.model), push)

    methods: dict[str, tuple[int, Callable[[], object]]] = {
        "seed's reference": (few, by_reference),
        "closed form": (pushes, lambda: box.predict(points, forces).code),
        "exact tier, four corners": (pushes, partial(exactly, on_corners, pushes)),
        "exact tier, even pressure": (some, partial(exactly, box, some)),
    }
    for engine in ("Drake", "MuJoCo") if HAS_MUJOCO else ("Drake",):
        methods[f"roll-out, {engine}"] = 1, partial(rolled, WORLDS[engine])
    print(f"{'method':28} {'pushes':>8} {'per second':>12} {'× reference':>12}")
    base = 0.0
    for name, (number, work) in methods.items():
        rate = number / min(timed(work) for _ in range(repetitions))
        base = base or rate
        print(f"{name:28} {number:8d} {rate:12,.4g} {rate / base:12,.4g}", flush=True)


def random_pushes(box: ObjectModel, n: int) -> tuple[Array, Array]:
    """Contact points and forces around the onset, shape (n, 3) each."""
    import numpy as np

    rng = np.random.default_rng(0)
    points = np.array(box.extents) * rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0], (n, 3))
    directions = rng.normal(size=(n, 3)) * [1.0, 1.0, 0.4]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return points, directions * rng.uniform(0.1, 0.9, (n, 1)) * box.weight


_COUNT_FRAMES = """(async (seconds) => {
  const { viewer, player } = replay;
  const scripts = [];
  const show = viewer.onframe;
  viewer.onframe = (now) => {
    scripts.push(viewer.scriptTime);
    const moves = show(now);
    if (!moves) player.play();
    return true;
  };
  const [first, began] = [viewer.frames, performance.now()];
  await new Promise((done) => setTimeout(done, 1e3 * seconds));
  viewer.onframe = show;
  scripts.sort((a, b) => a - b);
  return {
    rate: (1e3 * (viewer.frames - first)) / (performance.now() - began),
    script: scripts[scripts.length >> 1],
    most: scripts[Math.floor(0.95 * scripts.length)],
    worst: scripts[scripts.length - 1],
    level: viewer.quality.level,
  };
})"""
_PAINTED = """[
  performance.getEntriesByName("first-contentful-paint")[0].startTime,
  [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
    .filter(({ name }) => !name.includes("/v1/"))
    .reduce((sum, { transferSize }) => sum + transferSize, 0),
]"""


def viewer(seconds: float = 4.0) -> None:
    """Frames per second of a replay while it plays, drawn in software, and the weight of the page.

    Runs Chromium without a display at 1280 × 800 with the kitchen and a push made by hand; prints
    frames per second, counted three times, the time of our script in a frame, and how coarsely the
    page chose to draw. Then opens the page of a service: when something is painted first, and how
    much was sent for it.
    """
    from playwright.sync_api import sync_playwright

    from sim import load_scene
    from sim.views.viewer_recording import save_replay
    from tests.browser.open_page import FLAGS, NAMES, OpenPage
    from tests.fakes.pushed_trace import pushed_trace
    from tests.service_process import serving

    browser_path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if browser_path is None:
        sys.exit(f"no browser: none of {', '.join(NAMES)} is installed")
    scene, size = load_scene("kitchen"), {"width": 1280, "height": 800}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder) / "run.html"
        save_replay(pushed_trace(scene, "ice tea box"), scene, path)
        print(f"size {path.stat().st_size / 1e3:.0f} kB")
        browser = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
        page = browser.new_page(viewport=size)  # type: ignore[arg-type]
        began = time.monotonic()
        page.goto(path.as_uri())
        while not page.evaluate("document.documentElement.dataset.ready"):
            time.sleep(0.02)
        print(f"ready after {time.monotonic() - began:.2f} s")
        for _ in range(3):
            found = page.evaluate(_COUNT_FRAMES, seconds)
            print(
                f"{found['rate']:5.1f} frames/s, script {found['script']:.1f} ms "
                f"(95 % below {found['most']:.1f} ms, all below {found['worst']:.1f} ms), "
                f"quality level {found['level']}"
            )
        page.close()
        with serving() as server:
            opened = OpenPage.opened(browser, server.url, viewport=size)
            painted, sent = opened.ask(_PAINTED)
            print(f"page of the service: first painted after {painted:.0f} ms")
            print(f"{sent / 1e3:.0f} kB sent for it")
            opened.wait("page.view.viewer?.frames > 0")
            print(f"table drawn after {opened.ask('performance.now()'):.0f} ms")
        browser.close()


_LONG_TALK = (
    "push the mug 3 cm to the left",
    "how heavy is the ice tea box?",
    "push the mug 3 cm to the right",
    "where is the cereal box?",
    "push the ice tea box 4 cm away",
    "undo that",
    "turn the ice tea box 15 degrees to the left",
    "turn it 15 degrees to the right",
    "push the mug 3 m away",
    "colourless green ideas sleep furiously",
)
_WARM, _MOST_GROWTH, _MOST_SLOWER = 5, 50e6, 1.5


def long_use(sentences: int = 200, seed: int = 0) -> int:
    """Many sentences to one controller: memory, open files and time do not grow.

    The same ten sentences are said again and again in one conversation: pushes there and back, an
    undo, questions, a refusal, one that is not understood. Memory is the resident set, read from
    /proc, after a collection of garbage. It ends with 1 if memory grew by 50 MB or more after the
    first five sentences, if files were left open, or if the last quarter took half as long again
    as the first.
    """
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation

    conversation = Conversation(Controller("kitchen", seed=seed))
    memories, files, times = [], [], []
    for k in range(max(sentences, 40)):
        text = _LONG_TALK[k % len(_LONG_TALK)]
        begun = time.process_time()
        status = conversation.say(text).status
        times.append(time.process_time() - begun)
        gc.collect()
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
        memories.append(pages * os.sysconf("SC_PAGE_SIZE"))
        files.append(len(os.listdir("/proc/self/fd")))
        figures = f"{memories[-1] / 1e6:7.1f} MB {files[-1]:3d} files {times[-1]:6.2f} s"
        print(f"{figures}  {status}: {text}", flush=True)
    quarter = len(times) // 4 // len(_LONG_TALK) * len(_LONG_TALK)
    first, last = sum(times[:quarter]) / quarter, sum(times[-quarter:]) / quarter
    warm = _WARM - 1
    print(
        f"memory: {memories[warm] / 1e6:.1f} MB after {_WARM}, "
        f"{memories[-1] / 1e6:.1f} MB at the end"
    )
    print(f"open files: {files[warm]} after {_WARM}, {files[-1]} at the end")
    print(f"time per sentence: first quarter {first:.2f} s, last {last:.2f} s of processor time")
    grown = memories[-1] - memories[warm] >= _MOST_GROWTH or files[-1] > files[warm]
    return int(grown or last > _MOST_SLOWER * first)


if __name__ == "__main__":
    sys.exit(
        run_command(
            cold_start,
            first_plan,
            warm_plans,
            search_work,
            simulation,
            predictions,
            viewer,
            long_use,
        )
    )
