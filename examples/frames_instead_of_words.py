"""Asks for pushes by data in place of sentences, as a program or a form would.

Every action has a sentence too, so that a person may read what will be done.
"""

from __future__ import annotations

from nlcontrol import Session

with Session("kitchen") as session:
    for seen in session.look().objects:
        frame = {
            "action": "push",
            "object": {"text": seen.name, "id": seen.name},
            "goal": {"kind": "displace", "direction": "left", "distance": 0.04},
            "constraints": [{"kind": "no_topple"}],
        }
        result = session.plan([frame]).result
        told = f"{result.plan.probability:.3f}" if result.plan else "–"
        print(f"{told:>6}  {result.status:9} {result.paraphrase}")
