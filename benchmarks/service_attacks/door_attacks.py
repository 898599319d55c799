"""Attacks on the door: hosts, origins, tokens, paths, bodies, methods, listeners, floods."""

from __future__ import annotations

import json
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx

from benchmarks.service_attacks.attacked_server import TOKEN
from benchmarks.service_attacks.attacker import SENTENCES, Attacker
from benchmarks.service_attacks.hostile_values import PATHS, bad_body, near, odd_text, odd_value
from benchmarks.service_attacks.plan_attacks import RUNS
from tests.patience import PATIENCE

FLOOD = 300
"""Requests of a flood, more than the service takes at once."""

LISTENERS = 80
"""Streams that are opened at once, more than the service keeps open."""

CALLS: Mapping[str, dict[str, Any]] = {
    "/v1/parse": {"text": "push the mug 3 cm away"},
    "/v1/plan": {"text": "push the mug 3 cm away"},
    "/v1/ask": {"text": "how heavy is the mug?"},
    "/v1/predict": {"object": "mug", "height": 0.03},
    "/v1/map": {"object": "mug", "spacing": 0.05},
    "/v1/affordances": {"object": "mug"},
    "/v1/sessions/{session_id}/parse": {"text": "push the mug 3 cm away"},
    "/v1/sessions/{session_id}/plans": {"text": "push the mug 3 cm away"},
    "/v1/sessions/{session_id}/ask": {"text": "how heavy is the mug?"},
    "/v1/sessions/{session_id}/predict": {"object": "mug", "height": 0.03},
    "/v1/sessions/{session_id}/say": {"text": "push the mug 3 cm away"},
    "/v1/sessions/{session_id}/runs": {"plan_id": "plan-0"},
    "/v1/sessions": {"scene": "kitchen"},
}
"""Calls that take a body, with one that makes sense."""

NAMED = (
    ("GET", "/v1/sessions/{session_id}"),
    ("DELETE", "/v1/sessions/{session_id}"),
    ("POST", "/v1/sessions/{session_id}/look"),
    ("POST", "/v1/sessions/{session_id}/stop"),
    ("POST", "/v1/sessions/{session_id}/reset"),
    ("GET", "/v1/sessions/{session_id}/live"),
    ("GET", "/v1/runs/{run_id}"),
    ("GET", "/v1/runs/{run_id}/events"),
    ("GET", "/v1/runs/{run_id}/trace"),
    ("GET", "/v1/runs/{run_id}/replay"),
    ("GET", "/v1/runs/{run_id}/bundle"),
    ("POST", "/v1/runs/{run_id}/stop"),
    ("POST", "/v1/runs/{run_id}/abort"),
    ("DELETE", "/v1/runs/{run_id}"),
    ("GET", "/v1/objects/{name}"),
)
"""Calls with a name in their path."""

NOT_THERE = (
    "unknown_session", "unknown_run", "unknown_object", "unknown_path", "wrong_method",
    "bad_request",
)  # fmt: skip


def try_wrong_host(a: Attacker) -> None:
    """A name that was made to point here (DNS rebinding), with a plan that is fresh."""
    plan_id = a.spare_plan()
    port = a.server.port
    hosts = (
        "evil.example", f"evil.example:{port}", "127.0.0.1.evil.example", "localhost.evil.example",
        "0.0.0.0", "169.254.169.254", f"127.0.0.1@evil.example:{port}", "[::ffff:7f00:1]", "",
        f"127.0.0.1:{port}, evil.example", "127.1",
    )  # fmt: skip
    a.send(
        "wrong Host, with a fresh plan",
        "POST",
        RUNS,
        json={"plan_id": plan_id},
        headers={"Host": a.rng.choice(hosts)},
        expected=("wrong_host",),
    )


def try_wrong_origin(a: Attacker) -> None:
    """A page of another origin, with a plan that is fresh."""
    plan_id = a.spare_plan()
    port = a.server.port
    headers = a.rng.choice(
        (
            {"Origin": "http://evil.example"},
            {"Origin": "null"},
            {"Origin": f"http://127.0.0.1:{port + 1}"},
            {"Origin": f"http://localhost:{port}"},
            {"Origin": f"http://127.0.0.1:{port}.evil.example"},
            {"Origin": ""},
            {"Origin": "http://["},
            {"Sec-Fetch-Site": "cross-site"},
            {"Sec-Fetch-Site": "same-site", "Origin": f"http://127.0.0.1:{port}"},
        )
    )
    a.send(
        "page of another origin, with a fresh plan",
        "POST",
        RUNS,
        json={"plan_id": plan_id},
        headers=headers,
        expected=("wrong_origin",),
    )


def try_form_of_a_page(a: Attacker) -> None:
    """A body as a page may send it to anyone, without asking."""
    plan_id = a.spare_plan()
    kinds = ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "json")
    a.send(
        "body that is not said to be JSON, with a fresh plan",
        "POST",
        RUNS,
        content=json.dumps({"plan_id": plan_id}),
        headers={"Content-Type": a.rng.choice(kinds)},
        expected=("wrong_media_type",),
    )


def try_bad_token(a: Attacker) -> None:
    """A token that is none, with a plan that is fresh."""
    plan_id = a.spare_plan()
    guess = near(a.rng, TOKEN).strip()
    tokens = (
        "", "Bearer", "Bearer ", f"Basic {TOKEN}", TOKEN,
        f"Bearer {guess if guess != TOKEN else 'x'}",
        "Bearer " + "x" * 5000, f"Bearer {TOKEN}, Bearer x", "Bearer null", "Bearer \xe9",
        f"Bearer {TOKEN[:-1]}",
    )  # fmt: skip
    a.send(
        "bad token, with a fresh plan",
        "POST",
        RUNS,
        json={"plan_id": plan_id},
        headers={"Authorization": a.rng.choice(tokens).encode("latin-1").replace(b"\n", b"")},
        expected=("wrong_token",),
    )


def try_traversal(a: Attacker) -> None:
    """A way to a file in every place where a string may stand."""
    way = a.rng.choice(PATHS)
    if a.rng.random() < 0.5:
        method, template = a.rng.choice(NAMED)
        names = dict.fromkeys(("session_id", "run_id", "name"), way)
        if a.rng.random() < 0.5:
            path = template.partition("{")[0] + way
            a.send("way to a file in a path", "GET", None, path=path, expected=NOT_THERE)
        else:
            a.send("way to a file in a path", method, template, names=names, expected=NOT_THERE)
        return
    template, body = a.rng.choice([call for call in CALLS.items() if "say" not in call[0]])
    body = {**body, **{key: way for key in body if isinstance(body[key], str)}}
    if "table" in a.rng.choice(("table", "")) and "session" not in template:
        body["table"] = {"scene": way}
    a.send("way to a file in a body", "POST", template, json=body)
    query = {"session": way, "cursor": way, "limit": "1"}
    a.send("way to a file in a query", "GET", "/v1/runs", params=query)


def try_bad_body(a: Attacker) -> None:
    """A body that is no JSON, too deep, too large, or not of the form."""
    text = a.rng.choice(SENTENCES)
    a.send(
        "body that is broken, deep, huge or of another form",
        "POST",
        a.rng.choice([call for call in CALLS if call != "/v1/sessions"]),
        content=bad_body(a.rng, text),
        headers={"Content-Type": "application/json"},
        expected=("bad_json", "bad_request", "too_large", "closed"),
    )


def try_odd_text(a: Attacker) -> None:
    """A sentence with what keyboards do not have; it may be answered, and moves nothing."""
    a.send(
        "sentence with odd characters, to be read or planned",
        "POST",
        a.rng.choice(("/v1/parse", "/v1/plan", "/v1/sessions/{session_id}/plans")),
        json={"text": odd_text(a.rng)},
        expected=("ok", "too_large", "bad_json", "bad_request"),
    )


def try_odd_values(a: Attacker) -> None:
    """Values of any type where others belong, and frames of nonsense."""
    template, body = a.rng.choice([call for call in CALLS.items() if call[0] != "/v1/sessions"])
    if "text" in body and a.rng.random() < 0.5:
        body = {"frames": odd_value(a.rng)}
    else:
        body = {**body, a.rng.choice(list(body)): odd_value(a.rng)}
    if template.endswith(("/say", "/runs")):
        expected: tuple[str, ...] = (
            "bad_request", "approval_required", "unknown_plan", "too_large", "bad_frame",
            "bad_json",
        )  # fmt: skip
    else:
        expected = ()
    a.send(
        "values of other types, and frames of nonsense",
        "POST",
        template,
        json=body,
        expected=expected,
    )


def try_unknown_names(a: Attacker) -> None:
    """Sessions, runs and objects that there are not."""
    method, template = a.rng.choice(NAMED)
    guess = near(a.rng, a.session)
    if guess != a.session:
        names = dict.fromkeys(("session_id", "run_id", "name"), guess)
        a.send("session, run or object that there is not", method, template, names=names,
               expected=NOT_THERE)  # fmt: skip


def try_bad_numbers(a: Attacker) -> None:
    """Pages, cursors and numbers of events that make no sense."""
    odd = a.rng.choice(
        ("-1", "1e9", "NaN", "99999999999999999999", "", "0x10", "' OR 1=1", "\u0663")
    )
    place = a.rng.choice(("limit", "cursor", "session"))
    a.send("page that makes no sense", "GET", "/v1/runs", params={place: odd})


def try_wrong_method(a: Attacker) -> None:
    """Methods and paths that do not belong."""
    method = a.rng.choice(("GET", "PUT", "PATCH", "TRACE", "CONNECT", "DELETE", "BREW"))
    paths = (
        "/v1/plan", "/v1/parse", "/", "/docs", "/redoc", "/v1", "/v2/plan", "/v1/../admin",
        "//v1/health", "/.git/config", "/v1/health/x",
    )  # fmt: skip
    path = a.rng.choice([path for path in paths if (method, path) != ("GET", "/")])  # the page
    a.send("methods and paths that do not belong", method, None, path=path,
           expected=("wrong_method", "unknown_path", "bad_request"))  # fmt: skip


def try_no_http(a: Attacker) -> None:
    """Bytes that are no request, half of one, or one with something smuggled in."""
    head = f"Host: 127.0.0.1:{a.server.port}\r\nAuthorization: Bearer {TOKEN}\r\n".encode()
    plan = json.dumps({"plan_id": a.spare_plan()}).encode()
    to = f"/v1/sessions/{a.session}/runs".encode()
    get = b"GET /v1/health HTTP/1.1\r\n"
    post = b"POST " + to + b" HTTP/1.1\r\n"
    kind = b"Content-Type: application/json\r\n"
    contents = (
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET / HTTP/9.9\r\n\r\n",
        get + b"\r\n",
        get + b"Host: a\r\n" + head + b"\r\n",
        post + head + kind + b"Content-Length: 500\r\n\r\n" + plan,
        post + head + kind + b"Content-Length: -1\r\n\r\n" + plan,
        post + head + kind + b"Content-Length: 5\r\nContent-Length: 50\r\n\r\n" + plan,
        post + head + kind + b"Transfer-Encoding: chunked\r\n\r\nZZ\r\n" + plan,
        post + head + kind + b"Transfer-Encoding: gzip\r\n\r\n" + plan,
        get + head + b"X: " + b"a" * 200_000 + b"\r\n\r\n",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n" + head + b"\r\n",
        get + head + b"Upgrade: websocket\r\nConnection: Upgrade\r\n\r\n",
        post + b"Host: evil.example\r\n" + kind + b"Content-Length: %d\r\n\r\n" % len(plan) + plan,
    )  # fmt: skip
    answer = a.server.raw_answer(a.rng.choice(contents), read=a.rng.random() < 0.8)
    status = answer.split(b" ")[1].decode() if answer.startswith(b"HTTP/1.1 ") else "closed"
    a.tally.note("bytes that are no whole request", status)
    if status.startswith("5"):
        a.tally.blame("5xx", "bytes that are no whole request", repr(answer[:200]))


def try_vanishing_listener(a: Attacker) -> None:
    """Listeners that open a stream and are gone."""
    path = f"/v1/sessions/{a.session}/live"
    for _ in range(a.rng.randrange(1, 6)):
        try:
            with a.server.http.stream("GET", path) as response:
                a.tally.note("listener who hangs up", "ok" if response.is_success else "refused")
        except httpx.TransportError:
            a.tally.note("listener who hangs up", "closed")


def try_flood(a: Attacker) -> None:
    """More requests at once than are taken."""
    with ThreadPoolExecutor(64) as callers:
        list(
            callers.map(
                lambda _: a.send(
                    "flood of requests", "POST", "/v1/plan", json={"text": SENTENCES[0]},
                    expected=("ok", "too_many_requests", "queue_full"),
                ),
                range(FLOOD),
            )
        )  # fmt: skip


def try_many_sessions(a: Attacker) -> None:
    """More sessions than the robot has."""
    a.send(
        "more sessions than there may be", "POST", "/v1/sessions", json={"scene": "kitchen"},
        expected=("too_many_sessions", "sessions_full", "queue_full", "busy"),
    )  # fmt: skip


def try_many_listeners(a: Attacker) -> None:
    """More streams at once than are kept open."""
    path = f"/v1/sessions/{a.session}/live"
    with httpx.Client(
        base_url=a.server.url,
        headers=a.server.http.headers,
        timeout=PATIENCE,
        limits=httpx.Limits(max_connections=None),
        trust_env=False,
    ) as http:
        streams = [
            http.send(http.build_request("GET", path), stream=True) for _ in range(LISTENERS)
        ]
        for stream in streams:
            if stream.is_success:
                a.tally.note("more listeners than there may be", "ok")
            else:
                stream.read()
                a.tally.judge(
                    "more listeners than there may be", stream, "/v1/sessions/{session_id}/live",
                    ("too_many_requests",),
                )  # fmt: skip
            stream.close()
