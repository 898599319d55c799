"""Says one sentence after another: the session remembers what "it" and "that" are."""

from nlcontrol import Session

with Session("kitchen", seed=1) as session:
    for text in ("push the ice tea box 5 cm away", "a bit more", "undo that"):
        print(session.say(text))
