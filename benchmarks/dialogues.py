"""How many turns of whole dialogues are understood as they are meant.

    python -m benchmarks.dialogues judging
    python -m benchmarks.dialogues developing --sets eighth ninth --simulate

Dialogues stand in `tests/data/dialogues`, in sets, each turn with what is meant; the first lines of
`developing.yaml` say how. They take place in the scene `kitchen`, if they do not name another one.
Without `--simulate` everything is planned and nothing moves. Of the dialogues that judge only
counts are printed. A turn at which the program fails is not right.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from grammar.frames.command import Frame
from nlcontrol.results.result import Result
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation

DIALOGUES = Path(__file__).parents[1] / "tests" / "data" / "dialogues"


def _asked(result: Result) -> list[Frame]:
    """The frames of a command, without those that only make way for them."""
    return [f for f in result.frames if f.query is None and f not in result.aside]


def _in_words(value: Any) -> Any:
    """A field of a goal with objects by their names, and numbers to six digits."""
    if isinstance(value, dict):
        return value.get("id") or {key: _in_words(field) for key, field in value.items()}
    if isinstance(value, list | tuple):
        return [_in_words(field) for field in value]
    return round(value, 6) if isinstance(value, float) else value


def has_steps(result: Result, steps: list[list[Any]]) -> bool:
    """Check for the frames that are meant, one for each step, and for nothing else."""
    frames = _asked(result)
    return len(frames) == len(steps) and all(
        frame.action in ([action] if isinstance(action, str) else action)
        and frame.object is not None
        and frame.object.id == name
        and _in_words(goal).items() <= _in_words(frame.goal.model_dump()).items()
        and set(*kinds) <= {constraint.kind for constraint in frame.constraints}
        for frame, (action, name, goal, *kinds) in zip(frames, steps, strict=True)
    )


def is_told(result: Result, turn: dict[str, Any]) -> bool:
    """Check for an answer to the question that is meant, about what is meant."""
    if result.answer is None or any(step.execution for step in result.steps):
        return False
    told = " ".join((result.answer.text, *result.answer.lines))
    query = next((frame.query for frame in result.frames if frame.query), "done")
    return (
        query == turn["tells"]
        and all(name in told for name in turn.get("names", ()))
        and not any(words in told for words in turn.get("not", ()))
    )


def is_undone(result: Result, name: str) -> bool:
    """Check for a remark that takes back: where nothing has moved, for that it is read as one."""
    if any(frame.dialogue == "undo" for frame in result.frames):
        return True
    return result.status == "done" and {f.object and f.object.id for f in result.frames} == {name}


def is_right(result: Result, turn: dict[str, Any]) -> bool:
    """Check for a result that is what a turn means, any of it if it may mean several things."""
    if turn.get("refused") and result.status == "not_understood":
        return True
    if "tells" in turn:
        return is_told(result, turn)
    if "undoes" in turn and is_undone(result, turn["undoes"]):
        return True
    return any(has_steps(result, turn[key]) for key in ("steps", "or") if key in turn)


def acts_wrongly(result: Result, turn: dict[str, Any]) -> bool:
    """Check for something done, or planned to be done, with an object that was not meant."""
    acts = [f.object.id for f in _asked(result) if f.object and f.action]
    meant = {step[1] for key in ("steps", "or") for step in turn.get(key, ())}
    meant |= {turn["undoes"]} if "undoes" in turn else set()
    return result.status != "not_understood" and not set(acts) <= meant


class Count(NamedTuple):
    """Turns of a set of dialogues.

    Attributes:
        turns: all of them.
        right: those whose result is what they mean.
        wrong: those at which something is done with an object that was not meant.
        failed: those at which the program failed.
    """

    turns: int
    right: int
    wrong: int
    failed: int

    def __str__(self) -> str:
        return (
            f"{self.right} of {self.turns} turns right, {self.wrong} with an object that was not "
            f"meant, {self.failed} at which the program failed"
        )


def count_of(dialogues: list[Any], *, simulate: bool, show: bool) -> Count:
    """Says the turns of a set of dialogues and counts; with `show` prints those not right."""
    right = wrong = turns = failed = 0
    for dialogue in dialogues:
        scene, said = "kitchen", dialogue
        if isinstance(dialogue, dict):
            scene, said = dialogue["scene"], dialogue["turns"]
        conversation = Conversation(Controller(scene, seed=1))
        for turn in said:
            turns += 1
            try:
                result = conversation.say(turn["say"], plan_only=not simulate)
            except Exception:  # whatever it is, it is counted, and the rest is said
                failed += 1
                continue
            good = is_right(result, turn)
            right, wrong = right + good, wrong + acts_wrongly(result, turn)
            if show and not good:
                told = (
                    result.error.message if result.error else result.answer and result.answer.text
                )
                print(f"{turn['say']!r}: {result.status} {result.paraphrase!r} {told or ''}")
    return Count(turns, right, wrong, failed)


def main() -> None:
    options = argparse.ArgumentParser(description="How turns of dialogues are understood.")
    options.add_argument("dialogues", choices=("developing", "judging"))
    options.add_argument("--sets", nargs="*", help="names of sets; all if not given")
    options.add_argument("--simulate", action="store_true")
    options.add_argument("--show", action="store_true", help="print the turns that are not right")
    chosen = options.parse_args()
    text = (DIALOGUES / f"{chosen.dialogues}.yaml").read_text(encoding="utf-8")
    sets = yaml.safe_load(text)
    show = chosen.show and chosen.dialogues != "judging"
    counts = []
    for name in chosen.sets or sets:
        counts.append(count_of(sets[name], simulate=chosen.simulate, show=show))
        print(f"{name}: {counts[-1]}", flush=True)
    print(f"all: {Count(*map(sum, zip(*counts, strict=True)))}")


if __name__ == "__main__":
    main()
