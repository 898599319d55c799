"""Many sentences to one controller: memory, open files and time do not grow.

    python -m benchmarks.long_use [--sentences 200] [--seed 0]

The same ten sentences are said again and again in one conversation: pushes there and back, an undo,
questions, a refusal, one that is not understood. Memory is the resident set, read from /proc, after
a collection of garbage. It ends with 1 if memory grew by 50 MB or more after the first five
sentences, if files were left open, or if the last quarter took half as long again as the first.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
from typing import NamedTuple

from nlcontrol import Controller, Conversation

SENTENCES = (
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
WARM, MOST_GROWTH, MOST_SLOWER = 5, 50e6, 1.5


class State(NamedTuple):
    """Cost of a process after a sentence.

    Attributes:
        memory: resident [bytes].
        files: open ones.
        seconds: of processor time, for the sentence.
    """

    memory: int
    files: int
    seconds: float


def said(conversation: Conversation, text: str) -> State:
    """The state after one more sentence."""
    begun = time.process_time()
    result = conversation.say(text)
    seconds = time.process_time() - begun
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as file:
        memory = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    state = State(memory, len(os.listdir("/proc/self/fd")), seconds)
    print(
        f"{memory / 1e6:7.1f} MB {state.files:3d} files {seconds:6.2f} s  {result.status}: {text}",
        flush=True,
    )
    return state


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--sentences", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    conversation = Conversation(Controller("kitchen", seed=wanted.seed))
    states = [
        said(conversation, SENTENCES[k % len(SENTENCES)]) for k in range(max(wanted.sentences, 40))
    ]
    quarter = len(states) // 4 // len(SENTENCES) * len(SENTENCES)
    first, last = (
        sum(s.seconds for s in part) / quarter for part in (states[:quarter], states[-quarter:])
    )
    warm, end = states[WARM - 1], states[-1]
    print(f"memory: {warm.memory / 1e6:.1f} MB after {WARM}, {end.memory / 1e6:.1f} MB at the end")
    print(f"open files: {warm.files} after {WARM}, {end.files} at the end")
    print(f"time per sentence: first quarter {first:.2f} s, last {last:.2f} s of processor time")
    grown = end.memory - warm.memory >= MOST_GROWTH or end.files > warm.files
    return int(grown or last > MOST_SLOWER * first)


if __name__ == "__main__":
    sys.exit(main())
