"""Answers of a planning session as JSON documents."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from nlcontrol.json_document import Document, document_text
from nlcontrol.service.documents import StatedObject

if TYPE_CHECKING:
    from nlcontrol.service.session_protocol import PlanningSession

QUESTIONS = frozenset({"parse", "ask", "predict", "map", "affordances", "plan", "look"})
"""Methods that any caller may call: nothing moves."""

METHODS = QUESTIONS | {"reset"}
"""Those of one's own session."""


def session_answer(session: PlanningSession, method: str, arguments: Mapping[str, Any]) -> bytes:
    """The answer of a session to one of `METHODS`, as JSON.

    Raises:
        ControlError: what the session raises.
    """
    if method not in METHODS:
        raise ValueError(f"{method} is no method of a session")
    if method == "ask":
        arguments = {**arguments, "motion": "never"}  # what moves waits for its turn, as a run
    stated = arguments.get("objects") if method == "look" else None
    if stated is not None:
        objects = tuple(StatedObject.model_validate(item) for item in stated)
        arguments = {**arguments, "objects": objects}
    answer: BaseModel | None = getattr(session, method)(**arguments)
    if answer is None:
        return b"{}"
    if isinstance(answer, Document):
        return answer.model_dump_json().encode()
    return document_text(answer.model_dump(mode="json"), None).encode()
