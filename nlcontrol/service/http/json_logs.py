"""Logs of the service: one JSON object a line on standard error."""

from __future__ import annotations

import json
import logging
import sys
import time

_LONGEST = 2000  # of a text in the log [characters]


class JsonFormatter(logging.Formatter):
    """Formatter of records as JSON objects.

    What a record bears as `fields` becomes keys of its own.
    """

    def format(self, record: logging.LogRecord) -> str:
        """The record on one line."""
        written = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
            + f".{int(record.msecs):03d}Z",
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage()[:_LONGEST],
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            written["traceback"] = self.formatException(record.exc_info)[-_LONGEST:]
        return json.dumps(written, ensure_ascii=False)


def log_as_json(level: int = logging.INFO) -> None:
    """Sends what the service and its server log to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonFormatter())
    for name in ("nlcontrol", "uvicorn.error"):
        logger = logging.getLogger(name)
        logger.handlers = [handler]
        logger.setLevel(level)
        logger.propagate = False
