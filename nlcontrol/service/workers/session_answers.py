"""Answers of a planning session as JSON documents."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from nlcontrol.errors import NOT_UNDERSTOOD, ControlError
from nlcontrol.json_document import Document, document_text
from nlcontrol.reports.word_explanation import reading_explanation
from nlcontrol.results.result import Result, result_with
from nlcontrol.service.documents import Offer, StatedObject, Understanding
from nlcontrol.service.methods import QUESTIONS
from nlcontrol.session.corrected_sentences import error_with_corrections
from nlcontrol.session.frame_documents import text_of

if TYPE_CHECKING:
    from nlcontrol.service.session_protocol import PlanningSession
    from nlcontrol.session.frame_documents import Frames

ASKED = frozenset(question.name for question in QUESTIONS)
"""Methods that any caller may call: nothing moves."""

METHODS = ASKED | {"reset"}
"""Those of one's own session."""


def session_answer(
    session: PlanningSession, method: str, arguments: Mapping[str, Any], *, ends: bool = False
) -> bytes:
    """The answer of a session to one of `METHODS`, as JSON.

    Args:
        session: that is asked.
        method: of it.
        arguments: of the method, as JSON has them; with `explain` the result says which words
            became which parameters.
        ends: the session ends with this answer, so that a plan id would be good for nothing.

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
    if method == "parse":
        return _understanding(session, arguments["said"]).model_dump_json().encode()
    explains = arguments.get("explain", False)
    rest = {key: value for key, value in arguments.items() if key != "explain"}
    answer: BaseModel | None = getattr(session, method)(**rest)
    if answer is None:
        return b"{}"
    if isinstance(answer, Offer):
        offered = {"plan_id": None, "expires_in": None} if ends else {}
        answer = answer.model_copy(
            update={**offered, "result": _explained(answer.result) if explains else answer.result}
        )
    elif isinstance(answer, Result) and explains:
        answer = _explained(answer)
    if isinstance(answer, Document):
        return answer.model_dump_json().encode()
    return document_text(answer.model_dump(mode="json"), None).encode()


def _understanding(session: PlanningSession, said: str | Frames) -> Understanding:
    """The reading of a sentence; that it is not understood is one too.

    Raises:
        ControlError: anything else went wrong.
    """
    text = text_of(said)
    try:
        read = session.parse(said)
    except ControlError as raised:
        if raised.info.status.exit != NOT_UNDERSTOOD:
            raise
        info = error_with_corrections(raised.info, text, session.parse)
        return Understanding(ok=False, text=text, error=info)
    return Understanding(
        ok=True,
        text=read.text,
        frames=read.frames,
        paraphrase=read.paraphrase,
        asides=read.asides,
        left_out=read.left_out,
        explanation=reading_explanation(read),
    )


def _explained(result: Result) -> Result:
    """The result with the way of its words to parameters."""
    return result_with(result, explanation=result.explanation_rows())
