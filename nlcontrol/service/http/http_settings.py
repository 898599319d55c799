"""Settings of the HTTP face of the planning service."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

LOOPBACK = ("127.0.0.1", "localhost", "[::1]", "::1")
"""Names of this machine that no other machine can reach."""


class HttpSettings(BaseModel):
    """Settings of the HTTP face.

    Attributes:
        host: address on which it listens.
        port: on which it listens; 0 takes a free one.
        token: that every request has to bear; none is needed if not given.
        hosts: further names by which requests may call the service, such as a proxy's.
        requests: that may be under way at once.
        listeners: streams of events and poses that may be open at once.
        heartbeat: longest silence of a stream [s].
        body_time: in which the body of a request has to arrive [s].
        approve: every motion needs an approved plan, whatever a session asks for.
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
