"""The JSON schema of what the commands answer."""

from __future__ import annotations

import json

from pydantic.json_schema import models_json_schema

from grammar.frames import Command
from nlcontrol.errors import ErrorInfo
from nlcontrol.fitting import FitReport
from nlcontrol.predictions import PushPrediction
from nlcontrol.result import Result

_SCHEMA = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, object]:
    """JSON schema of the answers.

    `Command` is what `parse` answers, `Result` what `plan` and `say` (its `answer` is that to a
    question), `PushPrediction` what `predict` does, `FitReport` what `fit` does. Numbers are in SI
    units, angles in radians, spans are `[start, end)` in code points of the sentence as given.
    """
    _, definitions = models_json_schema(
        [
            (model, "serialization")
            for model in (Command, Result, PushPrediction, FitReport, ErrorInfo)
        ],
        title="nlcontrol",
        description=" ".join((schema.__doc__ or "").split()),
    )
    return {
        "$schema": _SCHEMA,
        **definitions,
        "anyOf": [
            {"$ref": f"#/$defs/{name}"}
            for name in ("Result", "Command", "PushPrediction", "FitReport")
        ],
    }


def schema_json() -> str:
    """The schema as text."""
    return json.dumps(schema(), indent=2, ensure_ascii=False)
