"""Plans for a table that another camera sees, for another arm's controller."""

from nlcontrol import Session
from nlcontrol.types import StatedObject

table = [StatedObject(name="ice tea box", x=0.45, y=0.0), StatedObject(name="mug", x=0.6, y=0.25)]
with Session("kitchen", objects=table) as session:
    print(session.plan("push the ice tea box 10 cm away").result.guide)
