"""Shows a plan, and carries it out once somebody has approved it."""

from nlcontrol import Session

with Session("kitchen", approval="plan") as session:
    offer = session.plan("push the mug 3 cm to the left")
    print(offer)
    for check in session.execute(offer).checks:
        print(check)
