"""Access of the routes to the service behind them, and the forms of their answers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from fastapi import Depends, Request
from starlette.responses import Response

from nlcontrol.errors import error
from nlcontrol.json_document import Document, document_text
from nlcontrol.service.documents import SessionInfo
from nlcontrol.service.planning_service import PlanningService

if TYPE_CHECKING:
    from pydantic import BaseModel

    from nlcontrol.service.methods import SaidBody
    from nlcontrol.service.service_settings import ServiceSettings


Answer = TypeVar("Answer")


def planning_service(request: Request) -> PlanningService:
    """The service behind a request."""
    service = request.app.state.service
    assert isinstance(service, PlanningService), "the application was made with it"
    return service


Service = Annotated[PlanningService, Depends(planning_service)]
"""Of a route: the service behind it."""


class SessionList(Document):
    """Sessions.

    Attributes:
        sessions: that are open.
    """

    sessions: tuple[SessionInfo, ...]


async def answer_of(future: Future[bytes]) -> Response:
    """The answer of a worker, which is JSON already."""
    return Response(await asyncio.wrap_future(future), media_type="application/json")


async def waited(
    service: PlanningService, asked: Callable[..., Answer], *arguments: Any, **options: Any
) -> Answer:
    """The answer to what waits for a process or a disk, in the waiting room of the service."""
    call = partial(asked, *arguments, **options)
    return await asyncio.get_running_loop().run_in_executor(service.waiting_room, call)


def document_response(document: BaseModel, status: int = 200) -> Response:
    """The answer that bears a document of this process."""
    text = document_text(document.model_dump(mode="json"), None)
    return Response(text.encode(), status_code=status, media_type="application/json")


def require_bounded_sentence(body: SaidBody, settings: ServiceSettings) -> None:
    """Refuses a sentence that is longer than the settings allow.

    Raises:
        ControlError: `too_large`.
    """
    if body.text is not None and len(body.text) > settings.sentence_length:
        raise error(
            "too_large",
            f"the sentence has more than {settings.sentence_length} characters",
            suggestions=("say less at once",),
            numbers={"sentence_length": float(settings.sentence_length)},
        )
