"""Says what a refusal suggests, until there is a plan."""

from nlcontrol import Session

text = "push the ice tea box 3 m away"
with Session("kitchen") as session:
    while (offer := session.plan(text)).error is not None and offer.error.say:
        print(text, "→", offer.error.message, offer.error.numbers)
        text = offer.error.say[0]
    print(text, "→", offer.plan)
