"""Who may ask, by which name, from which page, and how much; over real connections."""

from __future__ import annotations

import asyncio
import json
import socket
from urllib.parse import urlsplit

import httpx
import pytest
from starlette.types import Receive, Scope, Send

from nlcontrol.errors import ErrorInfo
from nlcontrol.service.http.problem_documents import Problem
from nlcontrol.service.http.request_guard import SECURITY_HEADERS, RequestGuard
from nlcontrol.service.http.responses import HttpSettings
from tests.patience import PATIENCE
from tests.service_process import ServerProcess

JSON = {"Content-Type": "application/json"}
SAID = {"text": "push the ice tea box away"}
TOKEN = "0123456789abcdef"


def code(response: httpx.Response) -> tuple[int, str]:
    """Status and code of a problem, whose form is checked."""
    assert response.headers["content-type"] == "application/problem+json"
    problem = response.json()
    assert problem["status"] == response.status_code
    assert {"type", "title", "detail"} <= problem.keys()
    assert problem["suggestions"]
    return response.status_code, problem["code"]


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example:80", "", "[::2]"])
def test_a_foreign_host_name_is_refused(http: httpx.Client, host: str) -> None:
    assert code(http.get("/v1/health", headers={"Host": host})) == (421, "wrong_host")


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:9", "127.0.0.1:1", "[::1]:5"])
def test_names_of_this_machine_are_taken(http: httpx.Client, host: str) -> None:
    assert http.get("/v1/health", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("method", ["GET", "POST", "DELETE"])
@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "http://["]
)
def test_another_origin_is_refused(http: httpx.Client, method: str, origin: str) -> None:
    refused = http.request(method, "/v1/sessions", json=None, headers={"Origin": origin})
    assert code(refused) == (403, "wrong_origin")


def test_own_origin_is_taken_and_a_page_of_another_site_is_not(
    http: httpx.Client, server: ServerProcess
) -> None:
    own = {"Origin": server.url, "Sec-Fetch-Site": "same-origin"}
    assert http.post("/v1/parse", json=SAID, headers=own).status_code == 200
    for site in ("cross-site", "same-site"):
        refused = http.get("/v1/health", headers={"Sec-Fetch-Site": site})
        assert code(refused) == (403, "wrong_origin")


@pytest.mark.parametrize(
    ("content", "headers", "expected"),
    [
        (b"text=push", {"Content-Type": "text/plain"}, (415, "wrong_media_type")),
        (b"{}", {}, (415, "wrong_media_type")),
        (b"{}", {"Content-Type": "application/jsonp"}, (415, "wrong_media_type")),
        (b"{", JSON, (400, "bad_json")),
        (b'{"text": NaN}', JSON, (400, "bad_json")),
        (b'{"text": "\\ud800"}', JSON, (400, "bad_json")),
        (b'{"text": "\xff"}', JSON, (400, "bad_json")),
        (b"[" * 100_000, JSON, (400, "bad_json")),
        (b'{"text": "' + b"a" * 2**20 + b'"}', JSON, (413, "too_large")),
        (b"[" * 100 + b"]" * 100, JSON, (422, "bad_request")),
        (b"null", JSON, (400, "bad_json")),
        (b"{}", JSON, (422, "bad_request")),
        (b'{"text": "a", "frames": []}', JSON, (422, "bad_request")),
        (b'{"text": "a", "path": "b"}', JSON, (422, "bad_request")),
        (b'{"text": "a", "table": {"seed": 1e999}}', JSON, (422, "bad_request")),
        (b'{"text": "a", "table": {"scene": "/etc/passwd"}}', JSON, (400, "unknown_scene")),
        (b'{"text": "' + b"a" * 2001 + b'"}', JSON, (413, "too_large")),
    ],
    ids=lambda value: str(value)[:40],
)
def test_hostile_bodies(
    http: httpx.Client, content: bytes, headers: dict[str, str], expected: tuple[int, str]
) -> None:
    assert code(http.post("/v1/plan", content=content, headers=headers)) == expected


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("predict", {"object": "mug", "height": True}),
        ("predict", {"object": "mug", "height": "0.05"}),
        ("map", {"object": "mug", "spacing": True}),
        ("parse", {**SAID, "table": {"seed": False}}),
        ("parse", {**SAID, "table": {"defaults": {"tilt_deg": True}}}),
        ("parse", {**SAID, "table": {"objects": [{"name": "mug", "x": True, "y": 0.1}]}}),
        ("ask", {**SAID, "explain": 1}),
    ],
)
def test_what_is_no_number_is_not_taken_for_one(
    http: httpx.Client, path: str, body: dict[str, object]
) -> None:
    assert code(http.post(f"/v1/{path}", json=body)) == (422, "bad_request")


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/v1/sessions", "GET, HEAD, POST"),
        ("/v1/runs/a", "DELETE, GET, HEAD"),
        ("/v1/plan", "POST"),
        ("/docs", "GET, HEAD"),
    ],
)
def test_all_methods_of_a_path_are_told(http: httpx.Client, path: str, methods: str) -> None:
    assert http.put(path).headers["allow"] == methods


def test_a_wrong_key_is_told_with_its_place(http: httpx.Client) -> None:
    objects = [{"name": "mug", "x": 0.5, "y": 0.0}, {"name": "jar", "x": "far", "y": 0.0}]
    refused = http.post("/v1/plan", json={**SAID, "table": {"objects": objects}})
    assert refused.json()["path"] == "table.objects[1].x"
    many = [{"name": f"mug {n}", "x": 0.5, "y": 0.0} for n in range(61)]
    refused = http.post("/v1/plan", json={**SAID, "table": {"objects": many}})
    assert (code(refused), refused.json()["path"]) == ((422, "bad_request"), "table.objects")
    refused = http.post("/v1/sessions/nobody/look", json={"objects": many})
    assert (code(refused), refused.json()["path"]) == ((422, "bad_request"), "objects")
    refused = http.post("/v1/plan", json={**SAID, "tabel": {}})
    assert refused.json()["path"] == "tabel"


@pytest.mark.parametrize(
    ("method", "path", "expected"),
    [
        ("GET", "/redoc", (404, "unknown_path")),
        ("GET", "/v1/sessions/", (404, "unknown_path")),
        ("GET", "/v1/plan", (405, "wrong_method")),
        ("OPTIONS", "/v1/plan", (405, "wrong_method")),
        ("GET", "/v1/sessions/nobody", (404, "unknown_session")),
        ("GET", "/v1/runs/nothing", (404, "unknown_run")),
        ("GET", "/v1/runs/..%2f..%2fetc", (404, "unknown_path")),
        ("GET", "/v1/runs/.._.._etc", (422, "bad_request")),
        ("GET", "/v1/runs/a%00b/trace", (422, "bad_request")),
        ("GET", "/v1/runs?cursor=x", (400, "bad_cursor")),
        ("GET", "/v1/runs?limit=0", (422, "bad_request")),
    ],
)
def test_paths(http: httpx.Client, method: str, path: str, expected: tuple[int, str]) -> None:
    assert code(http.request(method, path)) == expected


def test_every_answer_bears_the_security_headers(http: httpx.Client) -> None:
    answers = [http.get("/v1/health"), http.get("/v1/nothing"), http.head("/v1/health")]
    for answer in answers:
        assert {name: answer.headers.get(name) for name in SECURITY_HEADERS} == SECURITY_HEADERS
        assert "server" not in answer.headers
    assert answers[2].status_code == 200
    assert answers[2].content == b""


def test_chunks_count_towards_the_limit_too(http: httpx.Client) -> None:
    refused = http.post("/v1/plan", content=(b" " * 2**16 for _ in range(40)), headers=JSON)
    assert code(refused) == (413, "too_large")


def test_two_host_headers_and_a_handshake_of_a_socket_get_nowhere(server: ServerProcess) -> None:
    address = urlsplit(server.url)
    assert address.hostname is not None
    upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    upgrade += "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
    for extra, status in (("Host: localhost\r\n", b"400"), (upgrade, b"404")):
        with socket.create_connection(
            (address.hostname, address.port or 0), timeout=PATIENCE
        ) as line:
            line.sendall(f"GET /v1/live HTTP/1.1\r\nHost: localhost\r\n{extra}\r\n".encode())
            assert line.recv(100).startswith(b"HTTP/1.1 " + status)


def test_a_body_that_was_cut_off_is_not_carried_out(
    robot_http: httpx.Client, robot_server: ServerProcess, session: str
) -> None:
    said = {"text": "push the mug 3 cm to the left"}
    plan_id = robot_http.post(f"{session}/plans", json=said).json()["plan_id"]
    body = json.dumps({"plan_id": plan_id})
    address = urlsplit(robot_server.url)
    with socket.create_connection(
        (address.hostname or "", address.port or 0), timeout=PATIENCE
    ) as line:
        head = f"POST {session}/runs HTTP/1.1\r\nHost: localhost\r\n"
        head += "Content-Type: application/json\r\nContent-Length: 500\r\n\r\n"
        line.sendall((head + body).encode())
        line.shutdown(socket.SHUT_WR)
        assert line.recv(100) == b""
    opened = session.rpartition("/")[2]
    assert robot_http.get("/v1/runs", params={"session": opened}).json()["runs"] == []


def test_the_log_says_nothing_of_sentences(http: httpx.Client, server: ServerProcess) -> None:
    http.post("/v1/parse", json={"text": "push the secret away"}, headers={"Authorization": "xyz"})
    lines = [json.loads(line) for line in server.log.read_text().splitlines()]
    assert any(line.get("path") == "/v1/parse" and line["status"] == 200 for line in lines)
    assert "secret" not in server.log.read_text()
    assert "xyz" not in server.log.read_text()


def test_problems_bear_all_that_an_error_bears() -> None:
    told = {name for name, field in ErrorInfo.model_fields.items() if not field.exclude}
    assert told - Problem.model_fields.keys() == {"message"}


def answer_of_guard(headers: dict[str, bytes], **settings: object) -> httpx.Response:
    """Answer of a guard with nothing behind it."""

    async def answer(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    async def ask() -> httpx.Response:
        guard = RequestGuard(answer, HttpSettings.model_validate(settings), 1000)
        transport = httpx.ASGITransport(app=guard)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            return await client.get("/v1/health", headers=headers)  # type: ignore[arg-type]

    return asyncio.run(ask())


@pytest.mark.parametrize(
    ("bearer", "status"),
    [("", 401), ("Bearer", 401), (f"Bearer {TOKEN}x", 401), (f"Basic {TOKEN}", 401),
     ("Bearer é", 401), (f"Bearer {TOKEN}", 200), (f"bearer {TOKEN}", 200)],
)  # fmt: skip
def test_a_token_is_asked_for(bearer: str, status: int) -> None:
    answer = answer_of_guard({"Authorization": bearer.encode("latin-1")}, token=TOKEN)
    assert answer.status_code == status
    assert answer.headers.get("www-authenticate") == (None if status == 200 else "Bearer")


@pytest.mark.parametrize(("name", "status"), [(b"robot.example", 200), (b"other.example", 421)])
def test_a_name_of_a_proxy_is_taken_if_it_was_given(name: bytes, status: int) -> None:
    assert answer_of_guard({"Host": name}, hosts=("robot.example",)).status_code == status


def test_a_stated_table_is_stated_anew(http: httpx.Client) -> None:
    mug = {"name": "mug", "x": 0.5, "y": 0.1}
    opened = http.post("/v1/sessions", json={"objects": [mug]}).json()
    path = f"/v1/sessions/{opened['session_id']}"
    assert opened["has_robot"] is False
    seen = http.post(f"{path}/look", json={"objects": [{**mug, "x": 0.6}]}).json()
    again = http.post(f"{path}/look").json()
    for table in (seen, again):
        assert [(o["name"], o["x"]) for o in table["objects"]] == [("mug", 0.6)]
        assert table["source"] == "stated"
    offer = http.post(f"{path}/plans", json={"text": "push the mug 5 cm away"}).json()
    assert (offer["result"]["status"], offer["plan_id"]) == ("planned", None)
    assert code(http.post(f"{path}/say", json=SAID)) == (409, "no_robot")
    assert http.delete(path).status_code == 204
