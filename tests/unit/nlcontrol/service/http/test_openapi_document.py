"""The OpenAPI document: described, with operation ids, and unions that say which kind they are."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from nlcontrol.service.http.service_app import routes_app


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    return routes_app().openapi()


def operations(document: dict[str, Any]) -> list[dict[str, Any]]:
    return [operation for path in document["paths"].values() for operation in path.values()]


def test_every_field_and_every_operation_is_described(document: dict[str, Any]) -> None:
    bare = [
        f"{name}.{key}"
        for name, schema in document["components"]["schemas"].items()
        for key, field in schema.get("properties", {}).items()
        if not field.get("description")
    ]
    assert bare == []
    for operation in operations(document):
        assert operation["description"], operation["operationId"]
        for parameter in operation.get("parameters", ()):
            assert parameter["description"], (operation["operationId"], parameter["name"])


def test_operation_ids_are_unique_and_answers_are_typed(document: dict[str, Any]) -> None:
    names = [operation["operationId"] for operation in operations(document)]
    assert len(names) == len(set(names)) > 35
    for operation in operations(document):
        answers = operation["responses"]
        for family in ("4XX", "5XX"):
            assert "application/problem+json" in answers[family]["content"]
        assert any(status.startswith("2") for status in answers)
        assert "422" not in answers


@pytest.mark.parametrize(
    ("name", "field"), [("Plan", "actions"), ("Frame", "goal"), ("Frame", "constraints")]
)
def test_unions_are_discriminated(document: dict[str, Any], name: str, field: str) -> None:
    found = document["components"]["schemas"][name]["properties"][field]
    union = found.get("items", found)
    assert union["discriminator"]["propertyName"] == "kind"
    assert len(union["oneOf"]) > 5


def test_what_may_be_left_out_is_never_null(document: dict[str, Any]) -> None:
    """Null in a query or a header would be the word."""
    for operation in operations(document):
        for parameter in operation.get("parameters", ()):
            assert parameter["schema"]["type"] != "null"
            assert "anyOf" not in parameter["schema"]


def test_every_body_takes_nothing_unknown(document: dict[str, Any]) -> None:
    for operation in operations(document):
        for content in operation.get("requestBody", {}).get("content", {}).values():
            body, *_ = content["schema"].get("anyOf", [content["schema"]])  # or null
            name = body["$ref"].rpartition("/")[2]
            assert document["components"]["schemas"][name]["additionalProperties"] is False


def test_the_server_sends_both_schemas(http: httpx.Client, document: dict[str, Any]) -> None:
    assert http.get("/v1/openapi.json").json() == document
    assert http.get("/v1/schema").json()["$defs"].keys() >= {"Result", "Command"}


def test_a_property_called_default_stays(document: dict[str, Any], http: httpx.Client) -> None:
    """It is a name, where a default of an object is a keyword, which is left out."""
    row = document["components"]["schemas"]["Row"]
    said = {"text": "push the ice tea box away"}
    answer = http.post("/v1/parse", json=said).json()
    for each in answer["explanation"]:
        assert each.keys() <= row["properties"].keys()


def test_the_token_is_a_security_scheme(document: dict[str, Any]) -> None:
    schemes = document["components"]["securitySchemes"]
    assert schemes["token"]["scheme"] == "bearer"
    assert {} in document["security"]  # none is needed where there is no token


def test_a_key_that_is_misspelt_is_told_with_the_one_that_is_meant(http: httpx.Client) -> None:
    problem = http.post("/v1/parse", json={"txt": "push the mug away"}).json()
    assert problem["suggestions"] == ["did you mean 'text'?"]
