"""The count of what was tried and how it was answered, and of what should not have been."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import Any

import httpx

from benchmarks.service_attacks.hostile_values import LEAKS
from nlcontrol.errors import CODES, FAMILIES

LISTED_FAULTS = 40


class Tally:
    """Attacks and answers.

    Args:
        openapi: document of the service, which says what it may answer.

    Attributes:
        answers: per attack, how often each answer came.
        faults: what should not have been, per kind.
        examples: the first of them in words.
    """

    def __init__(self, openapi: dict[str, Any]) -> None:
        self._paths: dict[str, Any] = openapi["paths"]
        self.answers: defaultdict[str, Counter[str]] = defaultdict(Counter)
        self.faults: Counter[str] = Counter()
        self.examples: list[str] = []

    def note(self, attack: str, answer: str) -> None:
        """Counts an answer."""
        self.answers[attack][answer] += 1

    def blame(self, kind: str, attack: str, what: str) -> None:
        """Counts what should not have been."""
        self.faults[kind] += 1
        if len(self.examples) < LISTED_FAULTS:
            self.examples.append(f"{kind}: {attack}: {what}")

    def judge(
        self, attack: str, response: httpx.Response, template: str | None, expected: Iterable[str]
    ) -> str:
        """Counts an answer and what is wrong with it.

        Args:
            attack: that it came to.
            response: the answer.
            template: path of the OpenAPI document; None where there is none.
            expected: codes with which it may refuse, `ok` if it may accept; any if there are none.

        Returns:
            The code of a refusal, or `ok`.
        """
        told = f"{response.request.method} {response.request.url.raw_path[:120]!r}"
        code = self._code(attack, response, told)
        self.note(attack, code)
        status = response.status_code
        if status >= 500:
            self.blame("5xx", attack, f"{told}: {status} {response.text[:300]}")
        if template is not None and not self._is_documented(response, template):
            self.blame("undocumented", attack, f"{told}: status {status}")
        if set(expected) and code not in expected:
            self.blame("unexpected", attack, f"{told}: {status} {code}: {response.text[:200]}")
        if any(leak in response.content for leak in LEAKS):
            self.blame("leak", attack, told)
        return code

    def _code(self, attack: str, response: httpx.Response, told: str) -> str:
        if response.is_success:
            return "ok"
        if response.request.method == "HEAD":
            return {404: "unknown_path", 405: "wrong_method"}.get(response.status_code, "")
        try:
            problem = response.json()
            code, family = problem["code"], problem.get("family")
            known = code in CODES or family in FAMILIES
            if not (known and problem["detail"] and problem["suggestions"]):
                self.blame("undocumented", attack, f"{told}: {problem}")
            if response.headers["content-type"] != "application/problem+json":
                self.blame("undocumented", attack, f"{told}: {response.headers['content-type']}")
        except (ValueError, LookupError, TypeError):
            self.blame(
                "undocumented", attack, f"{told}: {response.status_code} {response.text[:99]}"
            )
            return f"HTTP {response.status_code}"
        return str(code)

    def _is_documented(self, response: httpx.Response, template: str) -> bool:
        method = response.request.method.lower()
        operation = self._paths.get(template, {}).get("get" if method == "head" else method)
        if operation is None:
            return response.status_code in (404, 405)
        status = str(response.status_code)
        return any(known in operation["responses"] for known in (status, f"{status[0]}XX"))

    def table(self) -> str:
        """The table of what was tried, and how it was answered."""
        lines = ["| tried | times | answers |", "|---|---|---|"]
        for attack, answers in sorted(self.answers.items()):
            told = ", ".join(f"`{code}` {count}" for code, count in answers.most_common())
            lines.append(f"| {attack} | {answers.total()} | {told} |")
        return "\n".join(lines)
