"""The JSON schema of what the commands answer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue, models_json_schema
from pydantic_core.core_schema import DataclassSchema, ModelSchema

from grammar.frames.command import Command
from nlcontrol.batches.batch import BatchSummary
from nlcontrol.batches.rows import BatchRow, RowResult
from nlcontrol.errors import ErrorInfo
from nlcontrol.json_document import SCHEMA_VERSION, docstring_parts
from nlcontrol.learning.learning_reports import ExplorationReport, FitReport, Lesson
from nlcontrol.questions.drag_prediction import DragPrediction
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from planner.types.defaults import settings

_ANSWERS = (
    Result,
    Command,
    PushPrediction,
    DragPrediction,
    FitReport,
    ExplorationReport,
    RowResult,
    BatchSummary,
)


class DescribedSchema(GenerateJsonSchema):
    """Schema of models whose docstrings, or those of their bases, describe the fields."""

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        """Schema of one model."""
        names = {field.alias: name for name, field in schema["cls"].model_fields.items()}
        return _with_descriptions(super().model_schema(schema), schema["cls"], names)

    def dataclass_schema(self, schema: DataclassSchema) -> JsonSchemaValue:
        """Schema of one dataclass."""
        return _with_descriptions(super().dataclass_schema(schema), schema["cls"], {})


def _with_descriptions(
    made: JsonSchemaValue, cls: type, names: Mapping[str | None, str]
) -> JsonSchemaValue:
    """A schema with the descriptions of a class; `names` are those of the fields with aliases."""
    summary, said = "", {"kind": "says which kind of part it is"}
    for base in reversed(cls.__mro__):
        summary, described = docstring_parts(base.__dict__.get("__doc__") or "")
        said |= described
    for key, field in made.get("properties", {}).items():
        if told := said.get(names.get(key, key)):
            field["description"] = told
    return {**made, "description": summary} if summary else made


def schema() -> dict[str, Any]:
    """JSON schema of the answers.

    `Command` is what `parse` answers, `Result` what `plan` and `say` (its `answer` is that to a
    question, its steps carry a `Lesson` for what each push taught), `PushPrediction` what `predict`
    does (`DragPrediction` with `--press`), `FitReport` what `fit` does, `ExplorationReport` what
    `explore` does, `RowResult` a line of `batch` and `BatchSummary` its summary (`BatchRow` is a
    row that it takes), `Failure` what any of them does where it got no further. Each document bears
    `schema_version` and `ok`; a later minor version adds fields, a later major one renames or
    removes some. Numbers are in SI units, angles in radians, spans are `[start, end)` in code
    points of the sentence as given.
    `Defaults` is what a scene file's `defaults` and `--set` take, in the units that its names bear.
    """
    _, definitions = models_json_schema(
        [(model, "serialization") for model in (*_ANSWERS, BatchRow, Lesson, ErrorInfo)],
        title="nlcontrol",
        schema_generator=DescribedSchema,
        description=" ".join((schema.__doc__ or "").split()),
    )
    parts = definitions["$defs"]
    parts["Defaults"] = _defaults()
    error = {"text": {"type": "string"}, "error": {"$ref": "#/$defs/ErrorInfo"}}
    parts["Failure"] = {"type": "object", "properties": error, "required": ["error"]}
    answers = (*(model.__name__ for model in _ANSWERS), "Failure")
    for name in answers:
        # JSON schema of a document with what all of them bear.
        answer = parts[name]
        major = SCHEMA_VERSION.partition(".")[0]
        every = {
            "schema_version": {
                "type": "string",
                "pattern": rf"^{major}\.\d+$",
                "description": "of the form, major.minor",
            },
            "ok": {"type": "boolean", "description": "whether the command did what was asked"},
        }
        required = dict.fromkeys((*every, *answer.get("required", ())))
        parts[name] = {
            **answer,
            "properties": {**every, **answer["properties"], **every},
            "required": list(required),
            "additionalProperties": True,
        }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **definitions,
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in answers],
    }


def _defaults() -> dict[str, Any]:
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
