"""The page that goes on with a service that outlives its kills."""

from __future__ import annotations

from tests.browser.open_page import OpenPage

STATE = "page.state.get"
PLANNED = f"{STATE}('offer')?.result.status === 'planned'"
RESTING = f"!{STATE}('asking') && {STATE}('connection') === 'open'"
PHASE = f"{STATE}('events').findLast(({{ event }}) => event.phase)?.event.phase"


def session_of(opened: OpenPage) -> str | None:
    found: str | None = opened.ask(f"{STATE}('session')?.session_id ?? null")
    return found


def plan(opened: OpenPage, text: str) -> None:
    opened.say(text)
    opened.wait(f"{STATE}('said') === {text!r} && {PLANNED}")
