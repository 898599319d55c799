"""Access of the routes to the service behind them, and the forms of their answers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from fastapi import Depends, Header, Path, Query, Request
from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import Response

from nlcontrol.errors import error
from nlcontrol.json_document import document_text
from nlcontrol.service.documents import SessionSpec
from nlcontrol.service.methods import RequestBody, SaidBody
from nlcontrol.service.planning_service import PlanningService
from nlcontrol.session.executor import Motion

if TYPE_CHECKING:
    from nlcontrol.service.service_settings import ServiceSettings


Answer = TypeVar("Answer")


def planning_service(request: Request) -> PlanningService:
    """The service behind a request."""
    service = request.app.state.service
    assert isinstance(service, PlanningService), "the application was made with it"
    return service


Service = Annotated[PlanningService, Depends(planning_service)]
"""Of a route: the service behind it."""


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


# Settings of the HTTP face of the planning service.


LOOPBACK = ("127.0.0.1", "localhost", "[::1]", "::1")
"""Names of this machine that no other machine can reach."""


class HttpSettings(BaseModel):
    """Settings of the HTTP interface.

    Attributes:
        host: address to listen on.
        port: port to listen on; 0: any free one.
        token: token that requests must carry; none if not given.
        hosts: further host names of the service, such as a proxy's.
        requests: most requests under way at once.
        listeners: most open streams of events and poses.
        heartbeat: longest silence of a stream [s].
        body_time: longest time for the body of a request [s].
        approve: require an approved plan for every motion, whatever a session asks for.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    host: str = "127.0.0.1"
    port: int = Field(default=8000, ge=0, le=65535)
    token: str | None = Field(default=None, min_length=16, max_length=1000, repr=False)
    hosts: tuple[str, ...] = ()
    requests: int = Field(default=128, ge=1)
    listeners: int = Field(default=64, ge=1)
    heartbeat: float = Field(default=15.0, gt=0.0)
    body_time: float = Field(default=10.0, gt=0.0)
    approve: bool = False


# Bodies of requests, and what stands in paths and headers; nothing unknown, nothing unbounded.


_NAME = r"^[A-Za-z0-9_-]{1,64}$"

SessionId = Annotated[str, Path(pattern=_NAME, description="Of a session.")]
RunId = Annotated[str, Path(pattern=_NAME, description="Of a run.")]
IdempotencyKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        pattern=r"^[\x21-\x7e]{1,200}$",
        description="Chosen by the caller: the same request with the same key begins nothing anew.",
    ),
]
AfterNumber = Annotated[
    int, Query(ge=0, le=2**53, description="Number of the last event that is known already.")
]
IdleTime = Annotated[
    float | None,
    Query(
        gt=0.0,
        le=60.0,
        description="Closes it only once nobody has used it for so long [s], and not if somebody"
        " takes it up again meanwhile, or a run is under way.",
    ),
]
ObjectPath = Annotated[
    str, Path(max_length=100, description="Name or synonym of an object model of the host.")
]


class SessionBody(SessionSpec, RequestBody):
    """A session to be opened."""


class LoginBody(RequestBody):
    """A login.

    Attributes:
        secret: the token of the service, or the code of the link that it has printed.
    """

    secret: str = Field(min_length=1, max_length=1000, examples=["the-token-of-the-service"])


class SayBody(SaidBody):
    """A sentence to be carried out, or frames in its place.

    Attributes:
        motion: `simulate` also lets a question move something, `never` nothing at all.
    """

    motion: Motion | None = None

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a session's method, as JSON has them."""
        return {**super().arguments, "motion": self.motion}


class PlanIdBody(RequestBody):
    """A plan to be executed.

    Attributes:
        plan_id: name of an offered plan.
        text: that was shown to whoever approved the plan; it is refused (`other_sentence`) unless
            it is the text that was planned. Not compared if not given.
    """

    plan_id: str = Field(pattern=_NAME, examples=["plan_id-of-an-offer"])
    text: str | None = None
