"""The JSON schema of what the commands answer."""

from __future__ import annotations

import json

from pydantic.json_schema import models_json_schema

from grammar.frames.command import Command
from nlcontrol.errors import ErrorInfo
from nlcontrol.learning.learning_reports import ExplorationReport, FitReport, Lesson
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from planner.types.default_settings import settings

_ANSWERS = (Result, Command, PushPrediction, FitReport, ExplorationReport)
_SCHEMA = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, object]:
    """JSON schema of the answers.

    `Command` is what `parse` answers, `Result` what `plan` and `say` (its `answer` is that to a
    question, its steps carry a `Lesson` for what each push taught), `PushPrediction` what `predict`
    does, `FitReport` what `fit` does, `ExplorationReport` what `explore` does. Numbers are in SI
    units, angles in radians, spans are `[start, end)` in code points of the sentence as given.
    `Defaults` is what a scene file's `defaults` and `--set` take, in the units that its names bear.
    """
    _, definitions = models_json_schema(
        [(model, "serialization") for model in (*_ANSWERS, Lesson, ErrorInfo)],
        title="nlcontrol",
        description=" ".join((schema.__doc__ or "").split()),
    )
    definitions["$defs"]["Defaults"] = _defaults()
    return {
        "$schema": _SCHEMA,
        **definitions,
        "anyOf": [{"$ref": f"#/$defs/{model.__name__}"} for model in _ANSWERS],
    }


def _defaults() -> dict[str, object]:
    """JSON schema of what words mean when a sentence says no more."""
    properties = {
        setting.name: {
            "type": "number",
            "minimum" if setting.zero else "exclusiveMinimum": 0,
            "maximum": setting.most,
            "default": setting.value,
            "description": setting.meaning,
        }
        for setting in settings()
    }
    return {"type": "object", "properties": properties, "additionalProperties": False}


def schema_json() -> str:
    """The schema as text."""
    return json.dumps(schema(), indent=2, ensure_ascii=False)
