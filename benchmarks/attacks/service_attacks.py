"""Attacks on a real server whose robot counts its motions: on approval, and on the door.

Every answer is compared with the OpenAPI document by the server that tests start. An attack on the
door (host, origin, token, body, method) is tried with a plan that is fresh.
"""

from __future__ import annotations

import json
import random
import socket
import time
import uuid
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx

from benchmarks.attacks.hostility import (
    PATHS,
    SEQUENCES_OF_A_SESSION,
    Attack,
    Attacks,
    Tally,
    bad_body,
    near,
    odd_text,
    odd_value,
)
from nlcontrol.errors import CODES, FAMILIES
from tests.fakes.counted_executor import first_poses, motions_in, write_poses
from tests.patience import PATIENCE
from tests.service_process import serving_counted_robot

TOKEN = "an-unguessable-token-of-a-test"

SENTENCES = (
    "push the ice tea box 5 cm away",
    "push the mug 3 cm to the left",
    "push the ice tea box 4 cm to the right",
    "push the cereal box 3 cm away",
)

FLOOD = 300
"""Requests of a flood, more than the service takes at once."""

LISTENERS = 80
"""Streams that are opened at once, more than the service keeps open."""

SESSION = "/v1/sessions/{session_id}"
RUNS, SAY, LIVE = f"{SESSION}/runs", f"{SESSION}/say", f"{SESSION}/live"

PUSH, WEIGH = {"text": "push the mug 3 cm away"}, {"text": "how heavy is the mug?"}
TOUCH = {"object": "mug", "height": 0.03}

CALLS: Mapping[str, dict[str, Any]] = {
    "/v1/parse": PUSH,
    "/v1/plan": PUSH,
    "/v1/ask": WEIGH,
    "/v1/predict": TOUCH,
    "/v1/map": {"object": "mug", "spacing": 0.05},
    "/v1/affordances": {"object": "mug"},
    f"{SESSION}/parse": PUSH,
    f"{SESSION}/plans": PUSH,
    f"{SESSION}/ask": WEIGH,
    f"{SESSION}/predict": TOUCH,
    SAY: PUSH,
    RUNS: {"plan_id": "plan-0"},
    "/v1/sessions": {"scene": "kitchen"},
}
"""Calls that take a body, with one that makes sense."""

NAMED = (
    ("GET", SESSION),
    ("DELETE", SESSION),
    ("POST", f"{SESSION}/look"),
    ("POST", f"{SESSION}/stop"),
    ("POST", f"{SESSION}/reset"),
    ("GET", LIVE),
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

NAMES = ("session_id", "run_id", "name")

REFUSED_FORM = ("too_large", "bad_request", "bad_json")

NOT_THERE = (
    "unknown_session",
    "unknown_run",
    "unknown_object",
    "unknown_path",
    "wrong_method",
    "bad_request",
)


class Attacker:
    """A caller with one session in which only approved plans may be carried out.

    Args:
        url: of the server that is attacked.
        folder: of its table.
        seed: of the attacks.

    Attributes:
        http: a connection that bears the token.
        tally: of the answers.
        session: id of the session that is open.
        old_plans: ids of plans of sessions that were closed.
        permits: ids of the plans that were approved in time, each for one run.
    """

    def __init__(self, url: str, folder: Path, seed: int) -> None:
        self.url, self.folder = url, folder
        self.port = int(url.rpartition(":")[2])
        self.http = self.client(keepalive_expiry=2.0)
        self.first_poses = first_poses()
        self.rng = random.Random(seed)
        self.tally = Tally()
        self.session = ""
        self.old_plans: list[str] = []
        self.permits: set[str] = set()
        self._attack = ATTACKS[0]
        self._runs: set[str] = set()
        self._due = 0  # motions that the permits of this sequence allow
        self._before = self.motions()
        self._spare: str | None = None

    def client(self, **limits: Any) -> httpx.Client:
        """Connections that bear the token."""
        return httpx.Client(
            base_url=self.url,
            headers={"Authorization": f"Bearer {TOKEN}"},
            timeout=PATIENCE,
            trust_env=False,
            limits=httpx.Limits(**limits),
        )

    def attack(self, sequences: int) -> None:
        """Tries sequences of attacks, in one session after the other."""
        for number in range(sequences):
            if number % SEQUENCES_OF_A_SESSION == 0:
                self.open_session()
            tried = ATTACKS.sequence(self.rng)
            for attack in tried:
                self.attempt(attack)
            self.settle(", ".join(attack.name for attack in tried))

    def attempt(self, attack: Attack[Attacker]) -> None:
        """Tries an attack."""
        self._attack = attack
        attack.attempt(self)

    # --- calls ---------------------------------------------------------------------------------

    def send(
        self,
        method: str,
        path: str,
        *,
        names: Mapping[str, str] | None = None,
        attack: str | None = None,
        expected: tuple[str, ...] | None = None,
        **request: Any,
    ) -> tuple[str, httpx.Response | None]:
        """The code and the answer of a request; the code is `closed` where no answer came.

        Args:
            method: of HTTP.
            path: in which names are put.
            names: to be put there; the open session's if not given.
            attack: what it is counted as, if not as the attack that is tried.
            expected: codes of the answer, if not those of that attack; `closed` where the line may
                be closed as well.
            request: body and headers.
        """
        attack = self._attack.name if attack is None else attack
        expected = self._attack.expected if expected is None else expected
        for name, value in {"session_id": self.session, **(names or {})}.items():
            path = path.replace(f"{{{name}}}", quote(value, safe=""))
        try:
            response = self.http.request(method, path, **request)
        except (httpx.InvalidURL, httpx.LocalProtocolError):
            return "ok", None  # such a request cannot even be written
        except httpx.TransportError as raised:
            self.tally.note(attack, "closed")
            if "closed" not in expected:
                self.tally.blame("no answer", attack, f"{method} {path[:120]}: {raised!r}")
            return "closed", None
        return self.judge(response, attack, expected), response

    def run(self, plan_id: str, **request: Any) -> tuple[str, httpx.Response | None]:
        """The code and the answer of a request to carry out a plan; see `send`."""
        return self.send("POST", RUNS, json={"plan_id": plan_id}, **request)

    def judge(self, response: httpx.Response, attack: str, expected: tuple[str, ...]) -> str:
        """The code of an answer, or `ok`; what is wrong with it is counted."""
        call = f"{response.request.method} {response.request.url.raw_path[:120]!r}"
        code = "ok"
        if response.request.method == "HEAD" and not response.is_success:
            code = {404: "unknown_path", 405: "wrong_method"}.get(response.status_code, "")
        elif not response.is_success:
            try:
                problem = response.json()
                code = str(problem["code"])
                known = code in CODES or problem.get("family") in FAMILIES
                known = bool(known and problem["detail"] and problem["suggestions"])
            except (ValueError, LookupError, TypeError):
                code, known = f"HTTP {response.status_code}", False
            if not known:
                self.tally.blame("undocumented", attack, f"{call}: {response.text[:200]}")
        if response.is_server_error:
            self.tally.blame("5xx", attack, f"{call}: {response.text[:300]}")
        self.tally.judge(attack, expected, code, call, response.text)
        return code

    def call(self, method: str, path: str, **request: Any) -> dict[str, Any]:
        """The answer to a request that is no attack; {} if it has none."""
        response = self.http.request(method, path, **request)
        if not response.is_success:
            raise RuntimeError(f"{method} {path}: {response.status_code} {response.text}")
        document: dict[str, Any] = response.json() if response.content else {}
        return document

    # --- what is in order ----------------------------------------------------------------------

    def motions(self) -> int:
        """Motions so far."""
        return motions_in(self.folder)

    def put_back(self) -> None:
        """Puts everything where it stood at the beginning, by hand."""
        write_poses(self.folder, self.first_poses)

    def open_session(self) -> None:
        """Opens a session, after closing the last one."""
        self.drop_spare_plan()
        if self.session:
            self.old_plans = [self.fresh_plan()]
            self.call("DELETE", f"/v1/sessions/{self.session}")
        self.session = self.call("POST", "/v1/sessions", json={"approval": "plan"})["session_id"]

    def fresh_plan(self) -> str:
        """Id of a plan of the open session, from where everything stood at the beginning."""
        self.put_back()
        text = self.rng.choice(SENTENCES)
        offer = self.call("POST", f"/v1/sessions/{self.session}/plans", json={"text": text})
        plan_id = offer["plan_id"]
        if plan_id is None:
            raise RuntimeError(f"'{text}' is not planned: {offer['result']['error']}")
        return str(plan_id)

    def spare_plan(self) -> str:
        """Id of a plan of the open session, made for an attack before and not used up by it."""
        self._spare = self._spare or self.fresh_plan()
        return self._spare

    def allow(self, plan_id: str) -> None:
        """Notes that a plan was approved, and moves something."""
        self.drop_spare_plan()
        self.permits.add(plan_id)
        self._due += 1

    def drop_spare_plan(self) -> None:
        """Notes that the spare plan is used up, or holds no more."""
        self._spare = None

    def execute(self, plan_id: str, key: str) -> str:
        """Id of the run that carries out a fresh plan, once it has ended."""
        self.allow(plan_id)
        path, headers = f"/v1/sessions/{self.session}/runs", {"Idempotency-Key": key}
        run = self.call("POST", path, json={"plan_id": plan_id}, headers=headers)
        self.wait()
        return str(run["run_id"])

    def wait(self) -> None:
        """Waits until nothing is carried out in the session."""
        deadline = time.monotonic() + PATIENCE
        while self.call("GET", f"/v1/sessions/{self.session}")["state"] == "running":
            if time.monotonic() > deadline:
                raise RuntimeError("a run does not end")
            time.sleep(0.005)

    def settle(self, sequence: str) -> None:
        """Compares what has moved, and what was carried out, with what was allowed.

        Args:
            sequence: what was done, in words.
        """
        self.wait()
        motions = self.motions()
        moved, self._before = motions - self._before, motions
        if moved > self._due:
            self.tally.blame("motion", sequence, f"{moved} motions, {self._due} allowed")
        page = self.call("GET", "/v1/runs", params={"session": self.session, "limit": 10})
        for run in page["runs"]:
            if run["run_id"] in self._runs:
                continue
            self._runs.add(run["run_id"])
            if run["kind"] != "execute" or run["plan_id"] not in self.permits:
                self.tally.blame("motion", sequence, f"run {run['run_id']} of {run['plan_id']}")
            self.permits.discard(run["plan_id"])
        self._due = 0
        if moved:
            self.put_back()


@contextmanager
def attacker_of_service(folder: Path, seed: int = 0) -> Iterator[Attacker]:
    """Context with an attacker of a server where each motion needs an approved plan.

    Args:
        folder: for the table.
        seed: of the attacks.
    """
    with serving_counted_robot(
        folder, "--approve", environment={"NLCONTROL_TOKEN": TOKEN}
    ) as server:
        attacker = Attacker(server.url, folder, seed)
        with attacker.http:
            yield attacker


ATTACKS = Attacks[Attacker]()
tried = ATTACKS.tried


# --- approval: to move something without a fresh plan -------------------------------------------


@tried(8, "plan id that is guessed", "unknown_plan", "bad_request")
def forged_plan(a: Attacker) -> None:
    """A plan id that is like a real one."""
    real = a.spare_plan()
    if (forged := near(a.rng, real)) != real:
        a.run(forged)


@tried(2, "plan that was carried out already", "used_plan", "unknown_plan")
def used_plan(a: Attacker) -> None:
    plan_id = a.fresh_plan()
    a.execute(plan_id, uuid.uuid4().hex)
    for _ in range(a.rng.randrange(1, 4)):
        a.run(
            plan_id, headers={"Idempotency-Key": uuid.uuid4().hex} if a.rng.random() < 0.5 else {}
        )


@tried(4, "plan of a table that was changed since", "stale_plan")
def stale_plan(a: Attacker) -> None:
    """A plan for a table on which a hand has moved something away from the robot since."""
    plan_id = a.fresh_plan()
    name, by = a.rng.choice(list(a.first_poses)), a.rng.uniform(0.01, 0.05)
    x, y, yaw = a.first_poses[name]
    write_poses(a.folder, {**a.first_poses, name: (x + by, y, yaw)})
    try:
        a.run(plan_id)
    finally:
        a.put_back()


@tried(4, "plan approved under another sentence", "other_sentence", *REFUSED_FORM)
def other_sentence(a: Attacker) -> None:
    text = a.rng.choice((*SENTENCES, odd_text(a.rng)))
    a.send("POST", RUNS, json={"plan_id": a.fresh_plan(), "text": f"{text} instead"})


@tried(4, "plan of another session", "unknown_plan", "bad_request")
def foreign_plan(a: Attacker) -> None:
    """A plan of another session, or this session's in another."""
    for plan_id in a.old_plans:
        a.run(plan_id)
    plan_id = a.spare_plan()
    if (session := near(a.rng, a.session)) != a.session:
        a.run(
            plan_id,
            names={"session_id": session},
            attack="session id that is guessed",
            expected=("unknown_session", "bad_request", "unknown_path", "wrong_method"),
        )


@tried(3, "plan that a stop has dropped", "expired_plan")
def dropped_plan(a: Attacker) -> None:
    plan_id = a.fresh_plan()
    a.call("POST", f"/v1/sessions/{a.session}/stop")
    a.drop_spare_plan()
    a.run(plan_id)


@tried(6, "sentence to be carried out, without approval", "approval_required", *REFUSED_FORM)
def to_say(a: Attacker) -> None:
    a.send("POST", SAY, json={"text": a.rng.choice((*SENTENCES, odd_text(a.rng)))})


@tried(3, "question that would move the robot", "bad_request", "approval_required")
def question_that_moves(a: Attacker) -> None:
    motion = a.rng.choice(("simulate", "robot"))
    a.send("POST", f"{SESSION}/ask", json={**WEIGH, "motion": motion})


@tried(1, "request that is sent again with its key", "ok")
def key_again(a: Attacker) -> None:
    """The same request with the same key, and another one with it."""
    plan_id, key = a.fresh_plan(), uuid.uuid4().hex
    run_id = a.execute(plan_id, key)
    code, response = a.run(plan_id, headers={"Idempotency-Key": key})
    if code == "ok" and response is not None and response.json()["run_id"] != run_id:
        a.tally.blame("motion", "request that is sent again with its key", "began another run")
    a.put_back()
    a.run(
        a.fresh_plan(),
        headers={"Idempotency-Key": key},
        attack="key of another request",
        expected=("key_reused",),
    )


@tried(1, "plan that is approved four times at once", "ok", "used_plan", "unknown_plan", "busy")
def two_at_once(a: Attacker) -> None:
    plan_id = a.fresh_plan()
    a.allow(plan_id)
    with ThreadPoolExecutor(4) as callers:
        codes = list(callers.map(lambda _: a.run(plan_id)[0], range(4)))
    if codes.count("ok") != 1:
        a.tally.blame("unexpected", "plan that is approved four times at once", "not one run")
    a.wait()


@tried(1, "caller who hangs up, and asks again", "ok")
def vanishing_caller(a: Attacker) -> None:
    """A caller who approves a plan, does not wait for the answer, and asks again."""
    plan_id = a.fresh_plan()
    a.allow(plan_id)
    headers = {"Idempotency-Key": uuid.uuid4().hex}
    path, body = f"/v1/sessions/{a.session}/runs", {"plan_id": plan_id}
    try:
        a.http.post(path, json=body, headers=headers, timeout=0.002)
    except httpx.TransportError:
        a.tally.note("caller who approves a plan and hangs up", "closed")
    a.run(plan_id, headers=headers)  # whether it had arrived or not, it is carried out once
    a.wait()


@tried(4, "another method on `runs` or `say`", "wrong_method", "bad_request")
def other_methods(a: Attacker) -> None:
    """A plan to be carried out by a method that changes nothing, or by another one."""
    plan_id = a.spare_plan()
    method = a.rng.choice(("GET", "HEAD", "PUT", "PATCH", "OPTIONS", "TRACE", "DELETE", "BREW"))
    a.send(
        method,
        a.rng.choice((RUNS, SAY)),
        params={"plan_id": plan_id, "text": SENTENCES[0]},
        headers={"X-HTTP-Method-Override": "POST", "X-Method-Override": "POST"},
    )


# --- the door -----------------------------------------------------------------------------------


@tried(4, "wrong Host, with a fresh plan", "wrong_host")
def wrong_host(a: Attacker) -> None:
    """A name that was made to point here (DNS rebinding)."""
    plan_id, port = a.spare_plan(), a.port
    hosts = (
        *("evil.example", f"evil.example:{port}", "127.0.0.1.evil.example"),
        *("localhost.evil.example", "0.0.0.0", "169.254.169.254"),
        *(f"127.0.0.1@evil.example:{port}", "[::ffff:7f00:1]", ""),
        *(f"127.0.0.1:{port}, evil.example", "127.1"),
    )
    a.run(plan_id, headers={"Host": a.rng.choice(hosts)})


@tried(4, "page of another origin, with a fresh plan", "wrong_origin")
def wrong_origin(a: Attacker) -> None:
    plan_id, here = a.spare_plan(), f"http://127.0.0.1:{a.port}"
    headers: tuple[dict[str, str], ...] = (
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": f"http://127.0.0.1:{a.port + 1}"},
        {"Origin": f"http://localhost:{a.port}"},
        {"Origin": f"{here}.evil.example"},
        {"Origin": ""},
        {"Origin": "http://["},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site", "Origin": here},
    )
    a.run(plan_id, headers=a.rng.choice(headers))


@tried(3, "body that is not said to be JSON, with a fresh plan", "wrong_media_type")
def form_of_a_page(a: Attacker) -> None:
    """A body as a page may send it to anyone, without asking."""
    content = json.dumps({"plan_id": a.spare_plan()})
    kinds = ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "json")
    a.send("POST", RUNS, content=content, headers={"Content-Type": a.rng.choice(kinds)})


@tried(4, "bad token, with a fresh plan", "wrong_token")
def bad_token(a: Attacker) -> None:
    plan_id, guess = a.spare_plan(), near(a.rng, TOKEN).strip()
    tokens = (
        *("", "Bearer", "Bearer ", f"Basic {TOKEN}", TOKEN),
        f"Bearer {guess if guess != TOKEN else 'x'}",
        *("Bearer " + "x" * 5000, f"Bearer {TOKEN}, Bearer x", "Bearer null", "Bearer \xe9"),
        f"Bearer {TOKEN[:-1]}",
    )
    token = a.rng.choice(tokens).encode("latin-1").replace(b"\n", b"")
    a.run(plan_id, headers={"Authorization": token})


@tried(12, "way to a file in a path", *NOT_THERE)
def traversal(a: Attacker) -> None:
    """A way to a file in every place where a string may stand."""
    way = a.rng.choice(PATHS)
    if a.rng.random() < 0.5:
        method, path = a.rng.choice(NAMED)
        if a.rng.random() < 0.5:
            method, path = "GET", path.partition("{")[0] + way
        a.send(method, path, names=dict.fromkeys(NAMES, way))
        return
    path, body = a.rng.choice([call for call in CALLS.items() if "say" not in call[0]])
    body = {**body, **{key: way for key in body if isinstance(body[key], str)}}
    if "table" in a.rng.choice(("table", "")) and "session" not in path:
        body["table"] = {"scene": way}
    a.send("POST", path, json=body, attack="way to a file in a body", expected=())
    query = {"session": way, "cursor": way, "limit": "1"}
    a.send("GET", "/v1/runs", params=query, attack="way to a file in a query", expected=())


@tried(10, "body that is broken, deep, huge or of another form", *REFUSED_FORM, "closed")
def broken_body(a: Attacker) -> None:
    text = a.rng.choice(SENTENCES)
    path = a.rng.choice([call for call in CALLS if call != "/v1/sessions"])
    content = bad_body(a.rng, text)
    a.send("POST", path, content=content, headers={"Content-Type": "application/json"})


@tried(8, "sentence with odd characters, to be read or planned", "ok", *REFUSED_FORM)
def odd_sentence(a: Attacker) -> None:
    """It may be answered, and moves nothing."""
    path = a.rng.choice(("/v1/parse", "/v1/plan", f"{SESSION}/plans"))
    a.send("POST", path, json={"text": odd_text(a.rng)})


@tried(10, "values of other types, and frames of nonsense")
def odd_values(a: Attacker) -> None:
    path, body = a.rng.choice([call for call in CALLS.items() if call[0] != "/v1/sessions"])
    if "text" in body and a.rng.random() < 0.5:
        body = {"frames": odd_value(a.rng)}
    else:
        body = {**body, a.rng.choice(list(body)): odd_value(a.rng)}
    refused = ("approval_required", "unknown_plan", "bad_frame", *REFUSED_FORM)
    a.send("POST", path, json=body, expected=refused if path in (SAY, RUNS) else ())


@tried(8, "session, run or object that there is not", *NOT_THERE)
def unknown_names(a: Attacker) -> None:
    method, path = a.rng.choice(NAMED)
    if (guess := near(a.rng, a.session)) != a.session:
        a.send(method, path, names=dict.fromkeys(NAMES, guess))


@tried(4, "page that makes no sense")
def bad_numbers(a: Attacker) -> None:
    """Pages, cursors and numbers of events that make no sense."""
    odd = ("-1", "1e9", "NaN", "99999999999999999999", "", "0x10", "' OR 1=1", "\u0663")
    value = a.rng.choice(odd)
    a.send("GET", "/v1/runs", params={a.rng.choice(("limit", "cursor", "session")): value})


@tried(*(4, "methods and paths that do not belong", "wrong_method", "unknown_path", "bad_request"))
def wrong_method(a: Attacker) -> None:
    method = a.rng.choice(("GET", "PUT", "PATCH", "TRACE", "CONNECT", "DELETE", "BREW"))
    paths = (
        *("/v1/plan", "/v1/parse", "/", "/docs", "/redoc", "/v1", "/v2/plan", "/v1/../admin"),
        *("//v1/health", "/.git/config", "/v1/health/x"),
    )
    # The page itself belongs.
    a.send(method, a.rng.choice([path for path in paths if (method, path) != ("GET", "/")]))


@tried(4, "bytes that are no whole request")
def no_http(a: Attacker) -> None:
    """Bytes that are no request, half of one, or one with something smuggled in."""
    head = f"Host: 127.0.0.1:{a.port}\r\nAuthorization: Bearer {TOKEN}\r\n".encode()
    plan = json.dumps({"plan_id": a.spare_plan()}).encode()
    get = b"GET /v1/health HTTP/1.1\r\n"
    post = f"POST /v1/sessions/{a.session}/runs HTTP/1.1\r\n".encode()
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
    )
    answer = _raw_answer(a.port, a.rng.choice(contents), read=a.rng.random() < 0.8)
    status = answer.split(b" ")[1].decode() if answer.startswith(b"HTTP/1.1 ") else "closed"
    a.tally.note("bytes that are no whole request", status)
    if status.startswith("5"):
        a.tally.blame("5xx", "bytes that are no whole request", repr(answer[:200]))


def _raw_answer(port: int, content: bytes, *, read: bool) -> bytes:
    """The answer to bytes that need not be HTTP; b"" if there is none or nobody reads it."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as line:
        try:
            line.sendall(content)
            if not read:
                return b""
            line.shutdown(socket.SHUT_WR)
            return b"".join(iter(partial(line.recv, 65536), b""))
        except OSError:
            return b""


@tried(2, "listener who hangs up")
def vanishing_listener(a: Attacker) -> None:
    """Listeners that open a stream and are gone."""
    for _ in range(a.rng.randrange(1, 6)):
        try:
            with a.http.stream("GET", f"/v1/sessions/{a.session}/live") as response:
                a.tally.note("listener who hangs up", "ok" if response.is_success else "refused")
        except httpx.TransportError:
            a.tally.note("listener who hangs up", "closed")


@tried(
    *(1, "more sessions than there may be"),
    *("too_many_sessions", "sessions_full", "queue_full", "busy"),
)
def many_sessions(a: Attacker) -> None:
    """More sessions than the robot has."""
    a.send("POST", "/v1/sessions", json={"scene": "kitchen"})


@tried(0.05, "flood of requests", "ok", "too_many_requests", "queue_full")
def flood(a: Attacker) -> None:
    """More requests at once than are taken."""
    with ThreadPoolExecutor(64) as callers:
        plan = partial(a.send, "POST", "/v1/plan", json={"text": SENTENCES[0]})
        list(callers.map(lambda _: plan(), range(FLOOD)))


@tried(0.05, "more listeners than there may be", "too_many_requests")
def many_listeners(a: Attacker) -> None:
    """More streams at once than are kept open."""
    with a.client(max_connections=None) as http:
        request = http.build_request("GET", f"/v1/sessions/{a.session}/live")
        streams = [http.send(request, stream=True) for _ in range(LISTENERS)]
        for stream in streams:
            if stream.is_success:
                a.tally.note("more listeners than there may be", "ok")
            else:
                stream.read()
                a.judge(stream, "more listeners than there may be", ("too_many_requests",))
            stream.close()
