"""Catches whatever nlcontrol raises, by one class."""

from nlcontrol import NlcontrolError, Registry, Session, load_scene, parse

for attempt in (
    lambda: parse("blorb the mug"),
    lambda: load_scene("kitchn"),
    lambda: Registry.default().get("mgu"),
    lambda: Session("kitchen", defaults={"push_distanc": 0.2}),
):
    try:
        attempt()
    except NlcontrolError as raised:
        print(raised.code, raised.message, raised.suggestions)
