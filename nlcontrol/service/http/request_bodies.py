"""Bodies of requests, and what stands in paths and headers; nothing unknown, nothing unbounded."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Header, Path, Query
from pydantic import Field

from nlcontrol.service.documents import SessionSpec
from nlcontrol.service.methods import RequestBody, SaidBody
from nlcontrol.session.executor import Motion

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
        plan_id: of an offer.
        text: that was shown to whoever approved the plan; it is refused (`other_sentence`) unless
            it is the text that was planned. Not compared if not given.
    """

    plan_id: str = Field(pattern=_NAME, examples=["plan_id-of-an-offer"])
    text: str | None = None
