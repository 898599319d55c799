"""One table of error codes, and the one exception in which they all reach the caller.

Every stage has an exception of its own (`grammar.ParseError`, `objectmodels.ModelError`,
`sim.SceneError`), since the lower packages do not know the front. Here they become a
`ControlError`, whose code decides the exit status of the command line and the HTTP status.
"""

from __future__ import annotations

import os
import signal
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from nlcontrol.interruption import EXIT_CODES
from nlcontrol.json_document import DocumentPart
from objectmodels.errors import NlcontrolError
from planner.types.cure import Cure

if TYPE_CHECKING:
    from grammar.frames.command import Span
    from planner.types.refusal import Refusal

OK, INTERNAL, USAGE, NOT_UNDERSTOOD, NO_PLAN, NOT_HELD, UNDECIDED = range(7)
"""Exit codes of the command line; a signal adds its own (`nlcontrol.interruption`)."""


class Status(NamedTuple):
    """Meaning of a code to the caller's shell and to the caller's HTTP client."""

    exit: int
    http: int


_SENTENCE = Status(NOT_UNDERSTOOD, 422)
_NO_PLAN = Status(NO_PLAN, 409)
_LACKS = Status(NO_PLAN, 501)
_CALLER = Status(USAGE, 400)

CODES: dict[str, Status] = {
    # Frames that others wrote.
    "bad_frame": _SENTENCE,
    # Names that do not lead to one object, and questions about nothing.
    "unknown_object": _SENTENCE,
    "ambiguous_object": _SENTENCE,
    "not_on_table": _SENTENCE,
    "no_antecedent": _SENTENCE,
    # Remarks that refer to what was said and done before.
    "nothing_before": _SENTENCE,
    "not_alone": _SENTENCE,
    # Refusals of the planner: its reasons are the codes.
    "impossible": _NO_PLAN,
    "out_of_reach": _NO_PLAN,
    "blocked": _NO_PLAN,
    "too_uncertain": _NO_PLAN,
    "out_of_time": _NO_PLAN,
    "too_small": _NO_PLAN,
    "time_limit": Status(NO_PLAN, 504),
    "not_explorable": _NO_PLAN,
    "unsupported": _LACKS,
    "uncheckable": _LACKS,
    # Tools of a language model.
    "bad_arguments": _CALLER,
    "unknown_tool": _CALLER,
    "motion_not_allowed": _CALLER,
    # The caller's files and options.
    "usage": _CALLER,
    "unknown_scene": _CALLER,
    "bad_scene": _CALLER,
    "bad_default": _CALLER,
    "cannot_write": _CALLER,
    "unknown_face": _CALLER,
    "bad_push": _CALLER,
    "bad_model_file": _CALLER,
    "not_yours": _CALLER,
    # Descriptions of objects for other simulators.
    "bad_description": _CALLER,
    "not_one_body": _CALLER,
    "unsupported_shape": _CALLER,
    # Tests of a plug-in's models.
    "unknown_plugin": _CALLER,
    "no_models": _CALLER,
    "wrong_frame": _CALLER,
    "not_finite": _CALLER,
    "out_of_bounds": _CALLER,
    "not_balanced": _CALLER,
    "not_calibrated": _CALLER,
    "too_slow": _CALLER,
    "not_picklable": _CALLER,
    "not_saved": _CALLER,
    # More of the caller's files and options.
    "bad_record": _CALLER,
    "bad_recipe": _CALLER,
    "not_repeatable": _CALLER,
    "missing_extra": Status(USAGE, 501),
    "no_pictures": Status(INTERNAL, 501),
    "scene_and_registry_differ": _CALLER,
    "worker_lost": Status(INTERNAL, 500),
    "bad_row": _CALLER,
    "versions_differ": Status(INTERNAL, 500),
    # The service: its sessions and its queues.
    "unknown_session": Status(USAGE, 404),
    "session_lost": Status(USAGE, 410),
    "too_many_sessions": Status(USAGE, 429),
    "queue_full": Status(USAGE, 429),
    "bad_executor": _CALLER,
    "no_file": Status(USAGE, 404),
    "aborted": Status(INTERNAL, 500),
    # The store of the service, and bundles of its runs.
    "store_in_use": Status(USAGE, 409),
    "bad_store": Status(USAGE, 503),
    "store_locked": Status(INTERNAL, 503),
    "store_full": Status(INTERNAL, 503),
    "store_not_writable": Status(INTERNAL, 503),
    "unreadable": Status(INTERNAL, 500),
    "unknown_run": Status(USAGE, 404),
    "run_under_way": Status(USAGE, 409),
    "bad_cursor": _CALLER,
    "key_reused": Status(USAGE, 409),
    "cut_off": Status(INTERNAL, 500),
    "bad_bundle": _CALLER,
    "run_differs": Status(NOT_HELD, 200),
    # A client's service: not there, or something else.
    "no_service": Status(INTERNAL, 503),
    "bad_answer": Status(INTERNAL, 502),
    # Sessions: plans to be approved, and what a session can do.
    "unknown_plan": Status(USAGE, 404),
    "used_plan": Status(NO_PLAN, 409),
    "expired_plan": Status(NO_PLAN, 410),
    "stale_plan": Status(NO_PLAN, 409),
    "other_sentence": Status(NO_PLAN, 409),
    "approval_required": Status(USAGE, 409),
    "busy": Status(NO_PLAN, 409),
    "no_robot": Status(USAGE, 409),
    "no_reset": Status(USAGE, 409),
    "bad_table": _CALLER,
    # Requests over HTTP that get no further than the door.
    "bad_request": _CALLER,
    "bad_json": _CALLER,
    "wrong_token": Status(USAGE, 401),
    "wrong_origin": Status(USAGE, 403),
    "unknown_path": Status(USAGE, 404),
    "wrong_method": Status(USAGE, 405),
    "slow_request": Status(USAGE, 408),
    "too_large": Status(USAGE, 413),
    "wrong_media_type": Status(USAGE, 415),
    "wrong_host": Status(USAGE, 421),
    "too_many_requests": Status(USAGE, 429),
    # The address of a server.
    "bad_token": _CALLER,
    "cannot_listen": _CALLER,
    # The machine and the installation.
    "cannot_import": Status(INTERNAL, 500),
    "system_error": Status(INTERNAL, 500),
    # During the execution, and after it.
    "interrupted": Status(EXIT_CODES[signal.SIGINT], 499),
    "executor_failed": Status(INTERNAL, 500),
    "simulation_broke": Status(INTERNAL, 500),
    "clause_not_held": Status(NOT_HELD, 200),
    "not_finished": Status(NOT_HELD, 200),
    "clause_unknown": Status(UNDECIDED, 200),
    "internal": Status(INTERNAL, 500),
}
"""Codes of the front. What the lower packages raise falls under the family it comes from."""

FAMILIES: dict[str, Status] = {"sentence": _SENTENCE, "model": _CALLER, "scene": _CALLER}
"""Status of a code that is not in `CODES`, by the stage that raised it."""


class ErrorInfo(DocumentPart):
    """An error as data, the `error` of every JSON document.

    Attributes:
        code: stable name in snake case.
        message: one plain sentence.
        span: the words it is about, `[start, end)` in the sentence as given.
        spans: all places that it is about, if there are several, as in a contradiction.
        suggestions: what would be possible, or might have been meant.
        say: whole sentences that would do in place of the one that was said.
        numbers: the figures that decided, by name [SI].
        capability: what this robot lacks, if that is the matter.
        path: file and key that it is about, if any.
        family: the stage that raised it.
        cures: suggestions as data, where it is known what they ask for; not written into documents.
    """

    code: str
    message: str
    span: tuple[int, int] | None = None
    spans: tuple[tuple[int, int], ...] = ()
    suggestions: tuple[str, ...] = ()
    say: tuple[str, ...] = ()
    numbers: dict[str, float] = Field(default={})
    capability: str | None = None
    path: str | None = None
    family: str | None = None
    cures: SkipJsonSchema[tuple[Cure, ...]] = Field(default=(), exclude=True, repr=False)

    @property
    def status(self) -> Status:
        """Exit and HTTP status of this error."""
        if self.code in CODES:
            return CODES[self.code]
        return FAMILIES.get(self.family or "", CODES["internal"])


class ControlError(NlcontrolError):
    """Whatever went wrong, with a code and with what would have been right.

    Attributes:
        info: the error as data.
    """

    def __init__(self, info: ErrorInfo) -> None:
        super().__init__(info.message)
        self.info = info
        self.code, self.message, self.suggestions = info.code, info.message, info.suggestions

    def __reduce__(self) -> tuple[type[ControlError], tuple[ErrorInfo]]:
        """So that it comes home from another process."""
        return type(self), (self.info,)


def error(
    code: str,
    message: str,
    *,
    suggestions: tuple[str, ...],
    span: Span | None = None,
    numbers: dict[str, float] | None = None,
    capability: str | None = None,
) -> ControlError:
    """An error of the front itself; the code must stand in the table."""
    if code not in CODES:
        raise KeyError(code)
    return ControlError(
        ErrorInfo(
            code=code,
            message=message,
            span=span,
            suggestions=suggestions,
            numbers=numbers or {},
            capability=capability,
        )
    )


def whole_span(spans: Sequence[Span]) -> Span | None:
    """The place in a sentence from the first word of some spans to their last; None without any."""
    return (min(s for s, _ in spans), max(e for _, e in spans)) if spans else None


def known_error(raised: Exception) -> ControlError | None:
    """A stage's own exception as a `ControlError`; None if it is not one of theirs."""
    if isinstance(raised, ControlError):
        return raised
    # Late: a failing command must not load stages that it never reached.
    from grammar import ParseError
    from objectmodels import ModelError
    from planner.types.defaults import DefaultsError
    from sim.errors import SimError

    about: dict[str, Any]
    match raised:
        case DefaultsError():
            about = {}
        case ParseError(span=span, spans=spans, path=path):
            several = spans if len(spans) > 1 else ()
            about = {"family": "sentence", "span": span, "spans": several, "path": path}
        case ModelError(path=path):
            about = {"family": "model", "path": path}
        case SimError():
            about = {"family": "scene"}
        case _:
            return None
    common = {"message": raised.message, "suggestions": raised.suggestions}
    return ControlError(ErrorInfo(code=raised.code, **common, **about))


def exception_info(raised: Exception) -> ErrorInfo:
    """Any exception as data: a known error, or a defect with the place where it arose.

    NLCONTROL_DEBUG shows a defect's traceback on standard error.
    """
    # First, since knowing the others imports their packages.
    if isinstance(raised, ImportError):
        return _system_failure("cannot_import", raised, "`nlcontrol doctor` says what is missing")
    known = known_error(raised)
    if known is not None:
        return known.info
    if isinstance(raised, OSError):
        return _system_failure("system_error", raised, "see to that, and run it again")
    return _place_of_failure("internal", raised, "this is a defect of nlcontrol")


def _place_of_failure(code: str, raised: Exception, hint: str) -> ErrorInfo:
    """A failure that nobody has foreseen, with the place where it arose."""
    if os.environ.get("NLCONTROL_DEBUG"):
        traceback.print_exception(raised)
    place = traceback.extract_tb(raised.__traceback__)[-1]
    message = (
        f"{type(raised).__name__}: {raised} "
        f"(in {os.path.basename(place.filename)}, line {place.lineno})"
    )
    hint = f"{hint}; NLCONTROL_DEBUG=1 shows where it comes from"
    return ErrorInfo(code=code, message=message, suggestions=(hint,))


def _system_failure(code: str, raised: Exception, hint: str) -> ErrorInfo:
    """A failure of what is around nlcontrol, and no defect of it."""
    said = raised.strerror if isinstance(raised, OSError) and raised.strerror else str(raised)
    path = raised.filename if isinstance(raised, OSError) else None
    return ErrorInfo(
        code=code, message=said, path=None if path is None else str(path), suggestions=(hint,)
    )


@contextmanager
def known_errors_raised() -> Iterator[None]:
    """Turns the stages' own exceptions into `ControlError`; a defect passes as it is."""
    try:
        yield
    except Exception as raised:
        known = known_error(raised)
        if known is None or known is raised:
            raise
        raise known from raised


@contextmanager
def defects_raised() -> Iterator[None]:
    """Turns whatever goes wrong into a `ControlError`; what nobody has foreseen into `internal`."""
    try:
        yield
    except ControlError:
        raise
    except Exception as raised:
        raise ControlError(exception_info(raised)) from raised


@contextmanager
def executor_failures_raised() -> Iterator[None]:
    """Turns what an executor should not raise into `executor_failed`."""
    from sim.supervision import Stopped

    try:
        yield
    except Exception as raised:
        known = known_error(raised)
        if isinstance(raised, Stopped) or known is raised:
            raise
        if known is not None:
            raise known from raised
        hint = "the robot may stand anywhere: look at it, and open a new controller"
        raise ControlError(_place_of_failure("executor_failed", raised, hint)) from raised


def refusal_error(refusal: Refusal) -> ErrorInfo:
    """A refusal of the planner as the `error` of a result."""
    return ErrorInfo(
        code=refusal.reason,
        message=refusal.message,
        span=whole_span(refusal.spans),
        suggestions=refusal.suggestions,
        cures=refusal.cures,
        numbers=refusal.numbers,
        capability=refusal.capability,
    )
