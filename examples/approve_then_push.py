"""Shows a plan, does it once it is approved, and stops the robot if it presses too hard.

    python examples/approve_then_push.py          # asks
    python examples/approve_then_push.py --yes

`start` returns a run that goes on in a thread of its own; its events arrive as they happen.
"""

from __future__ import annotations

import sys

from nlcontrol import Session

MOST = 15.0  # N; above that somebody should have a look

with Session("kitchen", approval="plan") as session:
    offer = session.plan("push the ice tea box 10 cm away without toppling it")
    print(offer.result.report())
    if offer.plan_id is None or ("--yes" not in sys.argv and input("do it? [y/n] ") != "y"):
        sys.exit("nothing was moved")
    run = session.start(offer)
    for numbered in run.events():
        event = numbered.event
        if event.kind == "force":
            if sum((event.forces or {}).values()) > MOST:
                run.stop()
        else:
            print(f"{event.time:6.2f} s  {event.kind}: {event.text}")
    result = run.result()
    print(result.status)
    for check in result.checks:
        print("held" if check.ok else "missed", check.quantity, check.measured)
