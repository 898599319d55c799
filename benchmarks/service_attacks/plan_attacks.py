"""Attacks on approval: to move something without a fresh plan."""

from __future__ import annotations

import uuid
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx

from benchmarks.service_attacks.attacker import SENTENCES, Attacker
from benchmarks.service_attacks.hostile_values import near, odd_text

RUNS = "/v1/sessions/{session_id}/runs"
SAY = "/v1/sessions/{session_id}/say"

UNKNOWN = ("unknown_plan", "bad_request")


def try_forged_plan(a: Attacker) -> None:
    """A plan id that is guessed, or like a real one."""
    real = a.spare_plan()
    forged = near(a.rng, real)
    if forged != real:
        a.send("plan id that is guessed", "POST", RUNS, json={"plan_id": forged}, expected=UNKNOWN)


def try_used_plan(a: Attacker) -> None:
    """A plan that was carried out already."""
    plan_id = a.fresh_plan()
    a.execute(plan_id)
    for _ in range(a.rng.randrange(1, 4)):
        headers = {"Idempotency-Key": uuid.uuid4().hex} if a.rng.random() < 0.5 else {}
        a.send(
            "plan that was carried out already",
            "POST",
            RUNS,
            json={"plan_id": plan_id},
            headers=headers,
            expected=("used_plan", "unknown_plan"),
        )


def try_stale_plan(a: Attacker) -> None:
    """A plan for a table on which something was moved since."""
    plan_id = a.fresh_plan()
    a.server.move(a.rng.choice(list(a.server.first_poses)), a.rng.uniform(0.01, 0.05))
    try:
        a.send(
            "plan of a table that was changed since",
            "POST",
            RUNS,
            json={"plan_id": plan_id},
            expected=("stale_plan",),
        )
    finally:
        a.server.put_back()


def try_other_sentence(a: Attacker) -> None:
    """A fresh plan, approved under a sentence that was not planned."""
    text = a.rng.choice((*SENTENCES, odd_text(a.rng)))
    a.send(
        "plan approved under another sentence",
        "POST",
        RUNS,
        json={"plan_id": a.fresh_plan(), "text": f"{text} instead"},
        expected=("other_sentence", "too_large", "bad_request", "bad_json"),
    )


def try_foreign_plan(a: Attacker) -> None:
    """A plan of another session, or this session's in another."""
    for plan_id in a.old_plans:
        a.send("plan of another session", "POST", RUNS, json={"plan_id": plan_id}, expected=UNKNOWN)
    plan_id = a.spare_plan()
    session = near(a.rng, a.session)
    if session != a.session:
        a.send(
            "session id that is guessed",
            "POST",
            RUNS,
            names={"session_id": session},
            json={"plan_id": plan_id},
            expected=("unknown_session", "bad_request", "unknown_path", "wrong_method"),
        )


def try_dropped_plan(a: Attacker) -> None:
    """A plan that a stop has dropped."""
    plan_id = a.fresh_plan()
    a.call("POST", f"/v1/sessions/{a.session}/stop")
    a.drop_spare_plan()
    a.send(
        "plan that a stop has dropped",
        "POST",
        RUNS,
        json={"plan_id": plan_id},
        expected=("expired_plan",),
    )


def try_to_say(a: Attacker) -> None:
    """A sentence where plans have to be approved."""
    text = a.rng.choice((*SENTENCES, odd_text(a.rng)))
    a.send(
        "sentence to be carried out, without approval",
        "POST",
        SAY,
        json={"text": text},
        expected=("approval_required", "too_large", "bad_request", "bad_json"),
    )


def try_question_that_moves(a: Attacker) -> None:
    """A question that touches the object to know it better."""
    a.send(
        "question that would move the robot",
        "POST",
        "/v1/sessions/{session_id}/ask",
        json={"text": "how heavy is the mug?", "motion": a.rng.choice(("simulate", "robot"))},
        expected=("bad_request", "approval_required"),
    )


def try_key_again(a: Attacker) -> None:
    """The same request with the same key, and another one with it."""
    plan_id, key = a.fresh_plan(), uuid.uuid4().hex
    run_id = a.execute(plan_id, key)
    code, response = a.send(
        "request that is sent again with its key",
        "POST",
        RUNS,
        json={"plan_id": plan_id},
        headers={"Idempotency-Key": key},
        expected=("ok",),
    )
    if code == "ok" and response is not None and response.json()["run_id"] != run_id:
        a.tally.blame("motion", "request that is sent again with its key", "began another run")
    a.server.put_back()
    a.send(
        "key of another request",
        "POST",
        RUNS,
        json={"plan_id": a.fresh_plan()},
        headers={"Idempotency-Key": key},
        expected=("key_reused",),
    )


def try_two_at_once(a: Attacker) -> None:
    """A plan that is approved by several callers at once."""
    plan_id = a.fresh_plan()
    a.allow(plan_id)
    with ThreadPoolExecutor(4) as callers:
        codes = callers.map(
            lambda _: a.send(
                "plan that is approved four times at once",
                "POST",
                RUNS,
                json={"plan_id": plan_id},
                expected=("ok", "used_plan", "unknown_plan", "busy"),
            )[0],
            range(4),
        )
    if list(codes).count("ok") != 1:
        a.tally.blame("unexpected", "plan that is approved four times at once", "not one run")
    a.wait()


def try_to_vanish(a: Attacker) -> None:
    """A caller who approves a plan and does not wait for the answer."""
    plan_id = a.fresh_plan()
    a.allow(plan_id)
    request: dict[str, Any] = {
        "json": {"plan_id": plan_id},
        "headers": {"Idempotency-Key": uuid.uuid4().hex},
    }
    try:
        a.server.http.post(f"/v1/sessions/{a.session}/runs", timeout=0.002, **request)
    except httpx.TransportError:
        a.tally.note("caller who approves a plan and hangs up", "closed")
    # Whether it had arrived or not, it is carried out once.
    a.send("caller who hangs up, and asks again", "POST", RUNS, expected=("ok",), **request)
    a.wait()


def try_other_methods(a: Attacker) -> None:
    """A plan that is to be carried out by a method that changes nothing, or by another one."""
    plan_id = a.spare_plan()
    method = a.rng.choice(("GET", "HEAD", "PUT", "PATCH", "OPTIONS", "TRACE", "DELETE", "BREW"))
    headers = {"X-HTTP-Method-Override": "POST", "X-Method-Override": "POST"}
    a.send(
        "another method on `runs` or `say`",
        method,
        a.rng.choice((RUNS, SAY)),
        params={"plan_id": plan_id, "text": SENTENCES[0]},
        headers=headers,
        expected=("wrong_method", "bad_request"),
    )
