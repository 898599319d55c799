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
        workers: runs that may simulate at once; one processor is left for plans by default.
        sessions: that may be open at once, each a process.
        planners: processes that plan for those who have no session, at most.
        queue: runs that may wait for their turn, and as many calls for a planner.
        store: folder of the runs; a temporary one if not given, where `serve` takes the user's own.
        keep_bytes: of runs that are kept; the oldest go first.
        scenes: names of the host's scenes that may be asked for; all built-in ones if not given.
        executor: `module:Class` of the robot to be driven, instead of the simulated one.
        idle_time: after which a session of which nothing is asked is closed [s].
        request_time: after which a plan or an answer is given up [s].
        stop_time: which a run has to come to rest when its session is closed [s].
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
