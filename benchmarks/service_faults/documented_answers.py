"""Answers of the service beside its OpenAPI document: status, content type, form of the body."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import httpx
import jsonschema_rs

PROBLEM = "application/problem+json"


class DocumentedAnswers:
    """The document of a service, which says what it may answer.

    Args:
        document: as the service sends it.

    Attributes:
        operations: method, path and description of each, by its id.
    """

    def __init__(self, document: dict[str, Any]) -> None:
        self._components = document["components"]
        self.operations: dict[str, tuple[str, str, dict[str, Any]]] = {
            operation["operationId"]: (method.upper(), path, operation)
            for path, methods in document["paths"].items()
            for method, operation in methods.items()
        }
        self._validator = cache(self._made_validator)

    def fault(self, operation: str, response: httpx.Response) -> str | None:
        """Why an answer is not as the document has it; None if it is.

        The body of a stream is not looked at; it may not have been read.
        """
        status, answers = response.status_code, self.operations[operation][2]["responses"]
        known = next(
            (each for each in (str(status), f"{status // 100}XX") if each in answers), None
        )
        if known is None:
            return f"status {status} is not documented: {response.text[:200]}"
        contents = answers[known].get("content", {})
        kind = response.headers.get("content-type", "").partition(";")[0]
        if not contents:
            return f"{status} has a body" if response.content else None
        if kind not in contents:
            return f"{status} comes as {kind or 'nothing'}: {response.text[:200]}"
        if kind not in ("application/json", PROBLEM):
            return None
        try:
            body = response.json()
        except json.JSONDecodeError:
            return f"{status} is no JSON: {response.text[:200]}"
        first = next(iter(self._validator(operation, known, kind).iter_errors(body)), None)
        return None if first is None else f"{status} {first.instance_path}: {first.message[:200]}"

    def _made_validator(
        self, operation: str, status: str, kind: str
    ) -> jsonschema_rs.Draft202012Validator:
        content = self.operations[operation][2]["responses"][status]["content"][kind]
        return jsonschema_rs.Draft202012Validator(
            {**content["schema"], "components": self._components}
        )
