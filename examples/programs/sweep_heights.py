"""Predicts pushes all the way up an object: where does it topple?"""

from nlcontrol import Session

with Session("kitchen") as session:
    for height in range(20, 220, 20):
        push = session.predict("ice tea box", height=1e-3 * height)
        print(height, "mm:", push.outcome, push.onset, "N")
