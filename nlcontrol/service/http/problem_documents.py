"""Problem documents: a caller's mistakes, and our defects, as RFC 9457 has them."""

from __future__ import annotations

from http import HTTPStatus
from textwrap import shorten
from typing import TYPE_CHECKING, Any

from fastapi.exceptions import RequestValidationError
from pydantic import Field
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import Match, Route

from nlcontrol.errors import ControlError, ErrorInfo
from nlcontrol.json_document import DocumentPart
from objectmodels.errors import printable, suggest
from objectmodels.files.yaml_documents import classes_in, short_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fastapi import APIRouter, FastAPI
    from starlette.requests import Request

MEDIA_TYPE = "application/problem+json"


class Fault(DocumentPart):
    """A place in a request that is not as it has to be.

    Attributes:
        path: path of the place, such as `table.seed`.
        message: the fault there.
    """

    path: str
    message: str


class Problem(DocumentPart):
    """A problem document (RFC 9457): why a request was not fulfilled.

    Attributes:
        type: URN of the kind of problem.
        title: the kind in words.
        status: status of HTTP.
        detail: the problem in one plain sentence.
        code: stable name of the kind, the `code` of all errors of nlcontrol.
        suggestions: possible alternatives, or what may have been meant.
        say: whole sentences that would do in place of the one that was said.
        path: place in the body, or file and key, that it is about.
        numbers: the figures that decided, by name [SI].
        span: the words that it is about, `[start, end)` in the sentence as given.
        spans: all places in the sentence that it is about, if there are several.
        capability: capability that this robot lacks, if that is the cause.
        family: the stage that raised it.
        faults: places in the request, if its form is wrong.
    """

    type: str = "about:blank"
    title: str
    status: int = Field(ge=400, le=599)
    detail: str
    code: str
    suggestions: tuple[str, ...] = ()
    say: tuple[str, ...] = ()
    path: str | None = None
    numbers: dict[str, float] = Field(default={})
    span: tuple[int, int] | None = None
    spans: tuple[tuple[int, int], ...] = ()
    capability: str | None = None
    family: str | None = None
    faults: tuple[Fault, ...] = ()


OF_REQUESTS: dict[int, tuple[str, str]] = {
    400: ("bad_request", "see GET /v1/openapi.json for what is taken here"),
    404: ("unknown_path", "GET /v1/openapi.json lists every path"),
    405: ("wrong_method", "the header Allow says which methods this path has"),
}
"""Code and suggestion of what the router itself refuses, by status."""


def problem_status(info: ErrorInfo) -> int:
    """HTTP status of an error of the service; 5xx for defects alone."""
    http = info.status.http
    # What is lacking or takes too long is no defect; proxies would send the request again.
    return 422 if http in (499, 501, 504) else http


def problem_of(info: ErrorInfo, *, status: int | None = None, **more: Any) -> Problem:
    """The problem document of an error."""
    return Problem(
        type=f"urn:nlcontrol:problem:{info.code}",
        title=info.code.replace("_", " ").capitalize(),
        status=problem_status(info) if status is None else status,
        detail=info.message,
        **info.model_dump(exclude={"message"}),
        **more,
    )


def problem_response(problem: Problem, headers: Mapping[str, str] | None = None) -> Response:
    """The answer that bears a problem document."""
    answered = dict(headers or {})
    if problem.status == HTTPStatus.TOO_MANY_REQUESTS:
        wait = max(1, round(problem.numbers.get("retry_after", 1.0)))
        answered.setdefault("Retry-After", str(wait))
    return Response(
        problem.model_dump_json(exclude_defaults=True).encode(),
        status_code=problem.status,
        headers=answered,
        media_type=MEDIA_TYPE,
    )


def defect() -> Problem:
    """The problem document of a defect, of which the log alone says more."""
    hint = "the log of the service says more; tell whoever runs it"
    message = "this is a defect of nlcontrol"
    return problem_of(ErrorInfo(code="internal", message=message, suggestions=(hint,)))


def answer_problems(app: FastAPI, routers: Sequence[APIRouter]) -> None:
    """Lets an application of some routers answer with problem documents, whatever it refuses."""

    async def answer_http_exception(request: Request, raised: Exception) -> Response:
        assert isinstance(raised, HTTPException), "it is registered for these"
        # Methods of all routes of a path; the framework names those of the first alone.
        found = {
            method
            for router in routers
            for route in router.routes
            if isinstance(route, Route) and route.matches(request.scope)[0] is not Match.NONE
            for method in route.methods or ()
        }
        allowed = sorted({*found, "HEAD"} if "GET" in found else found)
        code, hint = OF_REQUESTS.get(raised.status_code, OF_REQUESTS[400])
        info = ErrorInfo(code=code, message=str(raised.detail), suggestions=(hint,))
        headers = dict(raised.headers or {})
        if raised.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["Allow"] = ", ".join(allowed)
        return problem_response(problem_of(info, status=raised.status_code), headers)

    app.add_exception_handler(ControlError, _answer_error)
    app.add_exception_handler(RequestValidationError, _answer_faults)
    app.add_exception_handler(HTTPException, answer_http_exception)
    app.add_exception_handler(Exception, _answer_defect)


async def _answer_error(_: Request, raised: Exception) -> Response:
    assert isinstance(raised, ControlError), "it is registered for these"
    return problem_response(problem_of(raised.info))


async def _answer_defect(_: Request, raised: Exception) -> Response:
    return problem_response(defect())  # which is raised on, for the guard to log it


async def _answer_faults(request: Request, raised: Exception) -> Response:
    assert isinstance(raised, RequestValidationError), "it is registered for these"
    complaints = raised.errors()
    faults = _faults(complaints)
    info = ErrorInfo(
        code="bad_request",
        message=f"{faults[0].path}: {faults[0].message}",
        path=faults[0].path,
        suggestions=_meant(request, complaints[0]) or (OF_REQUESTS[400][1],),
    )
    return problem_response(problem_of(info, status=422, faults=faults))


def _meant(request: Request, complaint: Mapping[str, Any]) -> tuple[str, ...]:
    """Keys of the body that one which is not known may have meant, as suggestions."""
    body = getattr(request.scope.get("route"), "body_field", None)
    if complaint["type"] != "extra_forbidden" or body is None:
        return ()
    keys = {
        field.alias or name
        for model in classes_in(body.field_info.annotation)
        for name, field in model.model_fields.items()
    }
    return tuple(f"did you mean '{key}'?" for key in suggest(str(complaint["loc"][-1]), keys))


def _faults(complaints: Sequence[Mapping[str, Any]]) -> tuple[Fault, ...]:
    # Ten places of a body are complained about at once.
    return tuple(
        Fault(path=_place(complaint["loc"]), message=_message(complaint))
        for complaint in complaints[:10]
    )


def _place(loc: Sequence[str | int]) -> str:
    """Place as it is written, `table.objects[2].x`; of a query or a header its name."""
    keys = loc[1:] if len(loc) > 1 else loc
    place = ""
    for key in keys:
        place += f"[{key}]" if isinstance(key, int) else f".{shorten(printable(key), 80)}"
    return place.removeprefix(".")


def _message(complaint: Mapping[str, Any]) -> str:
    if complaint["type"] == "extra_forbidden":
        return "found a key that is not known here"
    if complaint["type"] == "missing":
        return "found nothing, expected this key"
    said = str(complaint["msg"]).removeprefix("Value error, ").removeprefix("Input should be ")
    return f"found {short_text(complaint['input'])}, expected {said}"
