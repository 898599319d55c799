"""The OpenAPI document: that of FastAPI, in which docstrings describe every field."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute
from pydantic.json_schema import models_json_schema

from grammar.frames.command import Command
from nlcontrol.json_schema import DescribedSchema
from nlcontrol.service.http.problem_documents import Problem
from nlcontrol.service.methods import body_example
from objectmodels.files.yaml_documents import classes_in

if TYPE_CHECKING:
    from fastapi import APIRouter, FastAPI
    from pydantic import BaseModel

_SCHEMAS = "#/components/schemas/"
_OF_NAMES = frozenset({"properties", "patternProperties", "$defs", "dependentSchemas"})

_SECURITY: dict[str, dict[str, str]] = {
    "token": {
        "type": "http",
        "scheme": "bearer",
        "description": "The token of the service, where it has one.",
    },
    "login": {
        "type": "apiKey",
        "in": "cookie",
        "name": "nlcontrol",
        "description": "The cookie that a browser gets for the token; its name begins so.",
    },
}
"""Ways to bear the token; none is needed where the service has none."""

_PROBLEM = {"application/problem+json": {"schema": {"$ref": f"{_SCHEMAS}Problem"}}}

PROBLEMS: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "A mistake of the caller.",
        "content": _PROBLEM,
    },
    "5XX": {
        "description": "Its store takes nothing (503), or it has a defect.",
        "content": _PROBLEM,
    },
}
"""Answers that every route may give, besides its own."""


def openapi_document(app: FastAPI, routers: Iterable[APIRouter]) -> dict[str, Any]:
    """The OpenAPI document of an application, made once."""
    if app.openapi_schema is None:
        document = get_openapi(
            title=app.title,
            version=app.version,
            summary=app.summary,
            routes=app.routes,
            separate_input_output_schemas=False,
        )
        document["components"]["schemas"] |= _described_schemas(routers)
        document["components"]["securitySchemes"] = _SECURITY
        document["security"] = [{}, *({name: []} for name in _SECURITY)]
        _leave_out_null(document)
        # Gives each body an example, made from those of its fields, where its route has none.
        for route in _routes(routers):
            if route.body_field is not None and route.include_in_schema:
                (body,) = classes_in(route.body_field.field_info.annotation)
                for method in route.methods or ():
                    operation = document["paths"][route.path][method.lower()]
                    content = operation["requestBody"]["content"]["application/json"]
                    content.setdefault("example", body_example(body))
        app.openapi_schema = document
    return app.openapi_schema


def _leave_out_null(document: dict[str, Any]) -> None:
    """Takes null out of bodies and parameters that may be left out; clients leave them out."""
    for operation in (each for path in document["paths"].values() for each in path.values()):
        content = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
        schemas = [s for s in content.get("schema", {}).get("anyOf", ()) if s != {"type": "null"}]
        if len(schemas) == 1:
            content["schema"] = schemas[0]
        for parameter in operation.get("parameters", ()):
            kinds = parameter["schema"].pop("anyOf", ())
            parameter["schema"] |= next((kind for kind in kinds if kind != {"type": "null"}), {})


def _described_schemas(routers: Iterable[APIRouter]) -> dict[str, Any]:
    """Schema of every document that is asked for or answered, by its name."""
    models: set[type[BaseModel]] = {Problem, Command, *_models(routers)}
    _, definitions = models_json_schema(
        [(model, "validation") for model in sorted(models, key=lambda model: model.__name__)],
        schema_generator=DescribedSchema,
        ref_template=_SCHEMAS + "{model}",
    )
    schemas: dict[str, Any] = definitions["$defs"]
    for name, schema in schemas.items():
        _leave_out_object_defaults(schema)
        *_, room, title = name.split("__") if "__" in name else ("", schema["title"])
        schema["title"] = room.title() + title
    return schemas


def _leave_out_object_defaults(schema: Any) -> None:
    """Leaves out defaults that are objects, of which generators of clients can make nothing.

    A schema has keywords, and under some of them names that are anybody's: `default` may be one.
    """
    if isinstance(schema, list):
        for part in schema:
            _leave_out_object_defaults(part)
    elif isinstance(schema, dict):
        if isinstance(schema.get("default"), dict):
            del schema["default"]
        for keyword, part in schema.items():
            parts = part.values() if keyword in _OF_NAMES and isinstance(part, dict) else [part]
            for each in parts:
                _leave_out_object_defaults(each)


def _models(routers: Iterable[APIRouter]) -> Iterator[type[BaseModel]]:
    for route in _routes(routers):
        yield from classes_in(route.response_model)
        if route.body_field is not None:
            yield from classes_in(route.body_field.field_info.annotation)


def _routes(routers: Iterable[APIRouter]) -> Iterator[APIRoute]:
    for route in (route for router in routers for route in router.routes):
        if isinstance(route, APIRoute):
            yield route
