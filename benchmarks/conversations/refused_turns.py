"""Was a turn rightly refused? Its refusal is judged at once, in the world as the talk has it then.

The judge is that of `benchmarks.goals.refusal_judge`. It works in a copy of the process, since it
looks, plans and even carries out: the talk goes on as if it had not been judged.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from benchmarks.conversations.copied_process import result_in_copy
from benchmarks.conversations.drawn_turns import Job
from benchmarks.goals.cases import Watched
from benchmarks.goals.refusal_judge import Finding, Refusal, judge_refusal, second_search
from grammar.frames.command import Command

if TYPE_CHECKING:
    from nlcontrol.results.result import Result


ACTED = Finding("not looked for", "something was done before it was refused")
"""Of a turn that was not refused at once, and so not rightly."""


def refusal_finding(job: Job, index: int, target: str, robot: Watched, result: Result) -> Finding:
    """What is found about a refused turn.

    Args:
        job: which conversation.
        index: of the turn.
        target: name of the object that it is about.
        robot: that has refused it, and has done nothing since.
        result: its answer.
    """
    refusal = Refusal(target, result.error.code if result.error else "", job.tries)
    rng = np.random.default_rng((job.seed, job.number, index, job.tries))
    # Its objects are resolved, so that "it" is what it was.
    command = Command(
        text=result.text, frames=result.frames, paraphrase=result.paraphrase or result.text
    )

    def judge() -> Finding:
        return judge_refusal(robot, refusal, rng, lambda: second_search(robot, command))

    try:
        return result_in_copy(judge)
    except RuntimeError as raised:  # one refusal that cannot be judged must not end a run of many
        return Finding("not looked for", str(raised))
