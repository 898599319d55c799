"""Inside a planner: each call gets a session of its own, at a table that may be open already."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING, Any

from nlcontrol.service.documents import SessionSpec, TableSpec
from nlcontrol.service.session import Session
from nlcontrol.service.workers.session_answers import ASKED, session_answer
from objectmodels import Registry

if TYPE_CHECKING:
    from nlcontrol.service.workers.worker_host import Tell
    from nlcontrol.session.executor import Executor

MOST_TABLES = 4
"""Tables that a planner keeps open."""

_FIRST_SENTENCES = (
    "push the coffee box 5 cm away without toppling it",
    "push the mug 3 cm to the left",
    "push the ice tea box 4 cm to the right with one finger",
    "pour 50 ml of the ice tea into the mug",
)
"""Two fingers, a rim, one finger and a grasp, at the built-in table *kitchen*."""


class PlannerHost:
    """Answers calls about tables; nothing is remembered from one to the next."""

    urgent: frozenset[str] = frozenset()

    def __init__(self, tell: Tell) -> None:
        self._lock = Lock()
        self._registry = (
            Registry.default()
        )  # to look for plug-ins takes longer than to read a sentence
        self._executors: OrderedDict[str, Executor] = OrderedDict()
        warm_up()

    def answer(self, method: str, arguments: Mapping[str, Any]) -> bytes:
        """The answer to a method of a session, for a `table` and within a `time_limit` [s]."""
        if method not in ASKED:
            raise ValueError(f"a planner does not answer {method}")
        rest = dict(arguments)
        table, time_limit = rest.pop("table"), rest.pop("time_limit")
        with self._lock:
            executor = self._executors.pop(table, None)
        spec = SessionSpec(**TableSpec.model_validate_json(table).model_dump())
        session = Session(spec, executor=executor, registry=self._registry, time_limit=time_limit)
        with self._lock:
            self._executors[table] = session.controller.executor
            while len(self._executors) > MOST_TABLES:
                self._executors.popitem(last=False)
        return session_answer(session, method, rest, ends=True)


@cache
def warm_up() -> None:
    """Loads and computes what the first plans would otherwise wait for; once in a process."""
    session = Session(SessionSpec())
    for sentence in _FIRST_SENTENCES:
        session.plan(sentence)
