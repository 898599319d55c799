"""Whether two versions answer alike: documents and digests of executions.

    python -m benchmarks.sameness before.jsonl
    python -m benchmarks.sameness after.jsonl --like before.jsonl

Writes what `parse`, `plan` and `say` print with `--json`, exit codes included, and ends with 1 if
an answer differs from the other file's, byte by byte. Sentences are drawn from the test set,
understood and refused ones; what is planned and done names an object of its scene, half of it in
the kitchen, the rest in each scene by turns. `python -m benchmarks.goals` keeps what is said and
what comes of it, with a digest of all traces, which `--goals` compares case by case:

    python -m benchmarks.goals --cases 200 --seed 0 --record goals_after.jsonl
    python -m benchmarks.sameness after.jsonl --goals goals_before.jsonl goals_after.jsonl
"""

from __future__ import annotations

import argparse
import json
import random
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from benchmarks.record import Kept, carried_out
from benchmarks.sentences import refused, understood
from nlcontrol.cli import run
from sim.truth.scene_file import load_scene

SCENES = ("kitchen", "breakfast", "counter", "pantry", "workbench")

COUNTS = {"parse": 2000, "plan": 200, "say": 30}
"""Sentences of each command."""


class Question(BaseModel):
    """A command with a sentence."""

    model_config = ConfigDict(frozen=True)

    command: Literal["parse", "plan", "say"]
    scene: str
    text: str


class Answer(Kept[Question]):
    """What the command line printed, and its exit code."""

    printed: str
    exit_code: int


def questions(seed: int) -> list[Question]:
    """As many as `COUNTS` has, but for what is drawn twice."""
    draw = random.Random(seed)
    texts = [*understood(), *refused()]
    asked = dict.fromkeys(
        Question(command="parse", scene=SCENES[0], text=text)
        for text in draw.sample(texts, min(COUNTS["parse"], len(texts)))
    )
    names = {scene: [item.name for item in load_scene(scene).objects] for scene in SCENES}
    for command in ("plan", "say"):
        for number in range(COUNTS[command]):
            scene = SCENES[number // 2 % len(SCENES)] if number % 2 else SCENES[0]
            fitting = [text for text in texts if any(name in text for name in names[scene])]
            asked[Question(command=command, scene=scene, text=draw.choice(fitting))] = None
    return list(asked)


def answer(question: Question) -> Answer:
    """Asks the command line, in this process."""
    scene = [] if question.command == "parse" else ["--scene", question.scene]
    asked = [question.command, "--json", *scene, "--", question.text]
    with redirect_stdout(StringIO()) as printed, redirect_stderr(StringIO()):
        exit_code = run(asked)
    return Answer(job=question, printed=printed.getvalue(), exit_code=exit_code)


def differing(before: Path, after: Path) -> list[str]:
    """Jobs of a record that another one lacks or answers otherwise."""
    first, second = (_by_job(path) for path in (before, after))
    return [key for key in sorted(first | second) if first.get(key) != second.get(key)]


def _by_job(path: Path) -> dict[str, Any]:
    """What was answered, by question; of a case of goals by its seed and number, times apart."""
    answers: dict[str, Any] = {}
    for line in map(json.loads, path.read_text("utf-8").splitlines()):
        job, answer = line.pop("job"), line
        if "digest" in line:
            job = job[:2]
            answer = {key: line[key] for key in ("text", "status", "message", "digest")}
        answers[json.dumps(job)] = answer
    return answers


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("record", type=Path)
    parser.add_argument("--like", type=Path, help="record of another version")
    parser.add_argument("--goals", type=Path, nargs=2, help="records of `benchmarks.goals`")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    carried_out(answer, questions(options.seed), Answer, record=options.record)
    compared = [(options.like, options.record)] if options.like else []
    compared += [tuple(options.goals)] if options.goals else []
    differences = [(b, key) for a, b in compared for key in differing(a, b)]
    for path, key in differences:
        print(f"{path.name}: {key}")
    print(f"{len(differences)} answers differ in {len(compared)} comparisons, seed {options.seed}")
    return int(bool(differences))


if __name__ == "__main__":
    sys.exit(main())
