"""Stops a push as soon as the fingers press with more than 2 N."""

from nlcontrol import Session

with Session("kitchen") as session:
    run = session.start("push the cereal box 10 cm away")
    for numbered in run.events():
        if sum((numbered.event.forces or {}).values()) > 2.0:
            run.stop()
    print(run.result().status)
