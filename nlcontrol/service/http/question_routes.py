"""Routes of questions: without a session, about a table that is stated, and of a session."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from inspect import Parameter, Signature
from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from nlcontrol.service.http.request_bodies import SessionId
from nlcontrol.service.http.service_access import Service, answer_of, require_bounded_sentence
from nlcontrol.service.methods import (
    QUESTIONS,
    Question,
    RequestBody,
    SaidBody,
    TableBody,
    body_example,
)
from nlcontrol.service.planning_service import PlanningService

Endpoint = Callable[..., Awaitable[Response]]


def add_questions_alone(router: APIRouter) -> None:
    """Adds the questions that need no session."""
    for question in QUESTIONS:
        if question.alone is not None:
            router.add_api_route(
                f"/{question.name}",
                _endpoint(question, question.alone, _asked_alone(question), session=False),
                methods=["POST"],
                operation_id=question.name,
                response_model=question.answers,
                openapi_extra=_example(question, question.alone),
            )


def add_questions_of_session(router: APIRouter) -> None:
    """Adds the questions of a session."""
    for question in QUESTIONS:
        router.add_api_route(
            f"/{{session_id}}/{question.path}",
            _endpoint(question, question.asks, _asked_of_session(question), session=True),
            methods=["POST"],
            operation_id=f"session_{question.name}",
            response_model=question.answers,
            openapi_extra=_example(question, question.asks),
        )


def _example(question: Question, asks: type[RequestBody]) -> dict[str, Any]:
    """The example of a question's body, as a part of the OpenAPI document."""
    content = {"application/json": {"example": {**body_example(asks), **question.example}}}
    return {"requestBody": {"content": content}}


def _asked_alone(question: Question) -> Endpoint:
    async def asked(body: TableBody, service: PlanningService) -> Response:
        _require_bounded(body, service)
        return await answer_of(service.call_planner(question.name, body.table, **body.arguments))

    return asked


def _asked_of_session(question: Question) -> Endpoint:
    async def asked(
        session_id: str, service: PlanningService, body: RequestBody | None = None
    ) -> Response:
        _require_bounded(body, service)
        arguments = {} if body is None else body.arguments
        return await answer_of(service.call_session(session_id, question.name, **arguments))

    return asked


def _require_bounded(body: RequestBody | None, service: PlanningService) -> None:
    if isinstance(body, SaidBody):
        require_bounded_sentence(body, service.settings)


def _endpoint(
    question: Question, asks: type[RequestBody], asked: Endpoint, *, session: bool
) -> Endpoint:
    """The endpoint of a question, with the signature from which the framework reads its form."""
    empty = not any(field.is_required() for field in asks.model_fields.values()) and not issubclass(
        asks, SaidBody
    )
    kind, default = (asks | None, None) if empty else (asks, Parameter.empty)
    told: list[tuple[str, Any, Any]] = [("session_id", SessionId, Parameter.empty)] * session
    told += [("service", Service, Parameter.empty), ("body", kind, default)]
    asked.__signature__ = Signature(  # type: ignore[attr-defined]
        [
            Parameter(name, Parameter.KEYWORD_ONLY, default=value, annotation=annotation)
            for name, annotation, value in told
        ]
    )
    asked.__name__ = question.name
    asked.__doc__ = question.told if session else question.told_alone
    return asked
