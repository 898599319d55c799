"""Says a sentence; if it is refused, says what would do instead, until there is a plan.

    python examples/follow_suggestions.py "push the ice tea box 3 m away"

A refusal has whole sentences in `error.say`. Each of them has a plan.
"""

from __future__ import annotations

import sys

from nlcontrol import Session

sentence = sys.argv[1] if len(sys.argv) > 1 else "push the ice tea box 3 m away"
with Session("kitchen") as session:
    while True:
        result = session.plan(sentence).result
        print(f"“{sentence}”: {result.status}")
        if result.error is None:
            break
        print(f"  {result.error.message}")
        if not result.error.say:
            break
        sentence = result.error.say[0]
if result.plan is not None:
    print(f"  {result.plan!r}")
