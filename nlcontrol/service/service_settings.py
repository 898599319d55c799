"""Settings of the planning service."""

from __future__ import annotations

import os
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field


def _default_workers() -> int:
    return max(1, (os.cpu_count() or 1) - 1)


class ServiceSettings(BaseModel):
    """Settings of the planning service.

    Attributes:
        workers: most runs that simulate at once; by default one processor is left for plans.
        sessions: most open sessions, each in a process of its own.
        planners: most processes that plan without a session.
        queue: most waiting runs, and most calls that wait for a planner.
        store: folder of the runs; a temporary one if not given, where `serve` takes the user's own.
        keep_bytes: space for finished runs; the oldest are deleted first.
        scenes: names of the scenes that clients may open; all built-in ones if not given.
        executor: `module:Class` of the robot to drive instead of the simulated one.
        idle_time: time after which an idle session is closed [s].
        request_time: longest time for a plan or an answer [s].
        stop_time: longest time for a run to come to rest when its session is closed [s].
        sentence_length: longest sentence [characters].
        body_bytes: largest body of a request.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    workers: int = Field(default_factory=_default_workers, ge=1)
    sessions: int = Field(default=8, ge=1)
    planners: int = Field(default=4, ge=1)
    queue: int = Field(default=32, ge=0)
    store: Path | None = None
    keep_bytes: int = Field(default=2 * 1024**3, ge=0)
    scenes: tuple[str, ...] | None = None
    executor: str | None = Field(default=None, pattern=r"^[\w.]+:\w+$")
    idle_time: float = Field(default=1800.0, gt=0.0)
    request_time: float = Field(default=60.0, gt=0.0)
    stop_time: float = Field(default=20.0, gt=0.0)
    sentence_length: int = Field(default=2000, ge=1)
    body_bytes: int = Field(default=1024**2, ge=1)
