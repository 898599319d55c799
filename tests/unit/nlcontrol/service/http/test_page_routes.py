"""The pages' files as the server sends them: a fixed table, a strict policy, nothing sent twice."""

from __future__ import annotations

import gzip
import re

import httpx
import pytest

from nlcontrol.service.http.page_routes import page_files
from nlcontrol.session.events import KINDS

MOST_BYTES = 1_500_000  # of the whole page, compressed


def test_the_page_and_all_that_it_imports_are_there(http: httpx.Client) -> None:
    todo, seen = ["/"], set[str]()
    while todo:
        address = todo.pop()
        answer = http.get(address)
        assert answer.status_code == 200, address
        seen.add(address)
        if address.startswith(("/docs/library/", "/v1/")):  # which the browser's test watches
            continue
        found = re.findall(r"(?:from|import|href=|src=)\s*\"([^\":]+)\"", answer.text)
        todo += {str(answer.url.join(other).path) for other in found} - seen - set(todo)
    assert len(seen) > 15
    assert "/docs/library/swagger-ui-bundle.js" in seen
    assert seen <= {*page_files(), "/v1/openapi.json"}


@pytest.mark.parametrize("address", ["/", "/docs"])
def test_the_policy_lets_nothing_from_elsewhere_in(http: httpx.Client, address: str) -> None:
    headers = http.get(address).headers
    policy = dict(rule.split(" ", 1) for rule in headers["content-security-policy"].split("; "))
    assert policy["default-src"] == policy["frame-ancestors"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["content-type"] == "text/html; charset=utf-8"
    assert headers["x-content-type-options"] == "nosniff"
    page = page_files()[address].content.decode()
    assert not re.search(r"<style|<script(?![^>]*src=)|\bon\w+=|style=", page)


def test_what_the_browser_has_is_not_sent_again(http: httpx.Client) -> None:
    first = http.get("/page/page.js")
    again = http.get("/page/page.js", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert http.get("/page/page.js", headers={"If-None-Match": 'W/"0"'}).status_code == 200


def test_compressed_is_the_same_and_light() -> None:
    for file in page_files().values():
        assert gzip.decompress(file.packed) == file.content
    assert sum(len(file.packed) for file in page_files().values()) < MOST_BYTES


@pytest.mark.parametrize(
    "address",
    ["/page/", "/page/index.html", "/page/..%2f..%2fsession.py", "/page//etc/passwd",
     "/viewer/replay.js", "/viewer/vendor/vendor.json", "/viewer/%2e%2e/html_replay.py",
     "/page/../documents.py", "/page/docs/docs.html", "/docs/",
     "/docs/library/redoc.standalone.js"],
)  # fmt: skip
def test_no_other_file_is_sent(http: httpx.Client, address: str) -> None:
    answer = http.get(address)
    assert (answer.status_code, answer.json()["code"]) == (404, "unknown_path")


def test_nothing_can_be_posted_there(http: httpx.Client) -> None:
    answer = http.post("/", json={})
    assert (answer.status_code, answer.json()["code"]) == (405, "wrong_method")


def test_the_page_hears_of_every_kind_of_event() -> None:
    script = page_files()["/page/service_api.js"].content.decode()
    listed = re.search(r"EVENT_KINDS = \[(.*?)\]", script, re.DOTALL)
    assert listed is not None
    assert re.findall(r'"(\w+)"', listed[1]) == list(KINDS)
