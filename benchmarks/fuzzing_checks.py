"""A check of schemathesis: no request that fits the document is refused for its form.

It stands in the place of `positive_data_acceptance`, for which any refusal of such a request is a
fault. Here many are in order: a request may name a scene, an object, a cursor or a default that is
not there, which no document can know.
"""

from __future__ import annotations

from typing import Any

import schemathesis

FORM = {"bad_request", "bad_json", "wrong_media_type"}
"""Codes of refusals for which the form of the request is the reason."""


@schemathesis.check
def form_acceptance(
    ctx: schemathesis.CheckContext, response: schemathesis.Response, case: schemathesis.Case[Any]
) -> None:
    """Raises an AssertionError where the document says otherwise than the service."""
    fits = case.meta is not None and case.meta.generation.mode.is_positive
    media_type = response.headers.get("content-type", [""])[0]
    if fits and media_type == "application/problem+json":
        problem = response.json()
        assert problem["code"] not in FORM, f"it fits the document, and is refused: {problem}"
