"""The exact tier against two physics engines, Drake and MuJoCo, over random pushes.

Every push is rolled out in both engines: a slowly growing force at a point of an object that stands
alone on a plane (`benchmarks.pushes` says how its onset is found). The tables say how far the
engines' onsets are from the exact tier's, whether the class is the same where sliding and toppling
are further apart than `BAND`, and how many roll-outs and predictions a second takes.

    python -m benchmarks.engines [--pushes 500] [--seed 0] [--workers 2] [--verbose]

MuJoCo is optional; without it its rows are left out.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np

from benchmarks.predictions import random_pushes, rate
from benchmarks.pushes import Array, Push, Seen, World, random_push, roll_out
from nlcontrol.parallel_tasks import run_all
from objectmodels import PrismModel
from objectmodels.models.object_model import ObjectModel

BAND = 0.05
"""Where slide and topple are nearer to each other than this share of the onset, no class counts."""

WITHOUT_MUJOCO = "MuJoCo is left out: it is not installed; pip install '.[dev]' brings it."


@dataclass(frozen=True)
class Run:
    """A push, and what an engine made of it."""

    push: Push
    seen: Seen

    @property
    def error(self) -> float:
        """The engine's onset over the exact tier's, less one."""
        return self.seen.onset / self.push.onset - 1.0

    @property
    def decided(self) -> bool:
        """Whether the class counts."""
        return self.push.apart > BAND

    @property
    def right(self) -> bool:
        """Whether the engine saw the predicted class."""
        return self.seen.outcome == self.push.outcome


def worlds() -> dict[str, Callable[[ObjectModel], World]]:
    """The engines that are installed."""
    from benchmarks.drake_push import DrakeWorld

    engines: dict[str, Callable[[ObjectModel], World]] = {"Drake": DrakeWorld}
    try:
        from benchmarks.mujoco_push import MujocoWorld
    except ImportError:
        return engines
    return engines | {"MuJoCo": MujocoWorld}


def run(engine: str, seed: int, number: int) -> Run:
    """One push in one engine."""
    push = random_push(seed, number)
    return Run(push, roll_out(worlds()[engine](push.model), push))


def engine_runs(engine: str, pushes: int, seed: int, workers: int) -> list[Run]:
    """All pushes in one engine; progress goes to standard error."""
    push = partial(run, engine, seed)
    runs = run_all(push, range(pushes), workers=workers, initializer=_quiet)
    return list(_counted(runs, engine, pushes))


def _quiet() -> None:
    """Drake's log without its note that half spaces do not touch deformable bodies."""
    logging.getLogger("drake").setLevel(logging.ERROR)


def _counted(runs: Iterator[Run], engine: str, pushes: int) -> Iterator[Run]:
    start = perf_counter()
    for done, item in enumerate(runs, start=1):
        yield item
        if done % 50 == 0 or done == pushes:
            seconds = perf_counter() - start
            print(f"{engine}: {done} of {pushes} in {seconds:.0f} s", file=sys.stderr, flush=True)


def kinds(pushes: Sequence[Push]) -> str:
    """What the pushes are, in a line."""
    prisms = sum(isinstance(push.model, PrismModel) for push in pushes)
    counts = Counter(push.outcome for push in pushes)
    classes = ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())
    return f"{len(pushes)} pushes, {prisms} of them of prisms; by the exact tier: {classes}"


def agreement(runs: dict[str, list[Run]]) -> str:
    """How well the engines and the exact tier agree, as a table."""
    head = f"{'engine':8} {'pushes':>6} {'onset error: median':>20} {'95th':>8} {'worst':>8}"
    lines = [f"{head} {'class right':>20} {'in the band':>12}"]
    for engine, items in runs.items():
        errors = np.array([item.error for item in items])
        median, high = np.percentile(np.abs(errors), [50, 95], method="higher")
        worst = errors[np.argmax(np.abs(errors))]
        decided = [item for item in items if item.decided]
        right = sum(item.right for item in decided)
        share = f"{right} of {len(decided)} {right / max(len(decided), 1):7.2%}"
        lines.append(
            f"{engine:8} {len(items):6d} {median:20.3%} {high:8.3%} {worst:+8.3%} "
            f"{share:>20} {len(items) - len(decided):12d}"
        )
    return "\n".join(lines)


def worst(items: Sequence[Run], seed: int, count: int = 5) -> str:
    """The runs that agree least, wrong classes first, with all that it takes to repeat them."""
    ordered = sorted(items, key=lambda item: (item.decided and not item.right, abs(item.error)))
    return "\n".join(_details(item, seed) for item in reversed(ordered[-count:]))


def _details(item: Run, seed: int) -> str:
    push, seen = item.push, item.seen
    given = push.model.model_dump(include={"size", "corners", "height", "mass", "friction", "com"})
    return (
        f"random_push({seed}, {push.number}): {type(push.model).__name__} {given}\n"
        f"  point {push.point.tolist()}, direction {push.direction.tolist()}\n"
        f"  exact: {push.outcome} at {push.onset:.6g} N, slide and topple {push.apart:.2%} apart\n"
        f"  seen: {seen.outcome} at {seen.onset:.6g} N ({item.error:+.3%}), noticed at "
        f"{seen.noticed:.6g} N, slip {seen.slip:.2e} m/s, lift {seen.lift:.2e} m/s"
    )


def speeds(seed: int, predictions: int = 20_000, repetitions: int = 3) -> str:
    """Roll-outs and predictions per second for one object in this process, as a table."""
    push = random_push(seed, 0)
    model = push.model
    points, forces = random_pushes(model, predictions, seed=seed)
    rollouts = {
        engine: rate(partial(_rolled, world, push), 1, repetitions)
        for engine, world in worlds().items()
    }
    rates = {f"{engine}, roll-outs": value for engine, value in rollouts.items()}
    for name, exact in (("closed form", False), ("exact tier", True)):
        work = partial(_predicted, model, points, forces, exact)
        rates[f"{name}, predictions"] = rate(work, predictions, repetitions)
    lines = [f"{'':26} {'per second':>12}" + "".join(f" {'× ' + e:>12}" for e in rollouts)]
    for name, value in rates.items():
        ratios = "".join(f" {value / base:12,.4g}" for base in rollouts.values())
        lines.append(f"{name:26} {value:12,.4g}{ratios}")
    return "\n".join(lines)


def _rolled(world: Callable[[ObjectModel], World], push: Push) -> Seen:
    return roll_out(world(push.model), push)


def _predicted(model: ObjectModel, points: Array, forces: Array, exact: bool) -> object:
    return model.predict(points, forces, exact=exact).code


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--pushes", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--verbose", action="store_true", help="list the worst five of each engine")
    options = parser.parse_args()
    _quiet()
    engines = worlds()
    runs = {
        engine: engine_runs(engine, options.pushes, options.seed, options.workers)
        for engine in engines
    }
    print(kinds([item.push for item in runs["Drake"]]))
    print(agreement(runs))
    print()
    print(speeds(options.seed))
    if "MuJoCo" not in engines:
        print(f"\n{WITHOUT_MUJOCO}")
    if options.verbose:
        for engine, items in runs.items():
            print(f"\nWorst in {engine}:\n{worst(items, options.seed)}")


if __name__ == "__main__":
    main()
