"""The login of a browser over real connections: a link that works once, a cookie, the same door."""

from __future__ import annotations

import re
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import httpx
import pytest

from nlcontrol.service.http.request_guard import BrowserLogin
from tests.patience import PATIENCE, wait_until
from tests.service_process import serving

TOKEN = "a token of some length"
get = partial(httpx.get, timeout=PATIENCE)
post = partial(httpx.post, timeout=PATIENCE)


@dataclass(frozen=True)
class Locked:
    """A server with a token, and the link that was opened in the browser."""

    url: str
    link: str


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Locked]:
    folder = tmp_path_factory.mktemp("browser")
    browser, opened = folder / "browser", folder / "opened"
    browser.write_text(f"#!/bin/sh\nprintf '%s' \"$1\" > {opened}.new\nmv {opened}.new {opened}\n")
    browser.chmod(browser.stat().st_mode | stat.S_IXUSR)
    environment = {"NLCONTROL_TOKEN": TOKEN, "BROWSER": f"{browser} %s"}
    with serving("--open", environment=environment) as server:
        assert server.process.stdout is not None
        printed = server.process.stdout.readline().split()[-1]
        wait_until(opened.exists, "the link in the browser")
        assert opened.read_text() == printed
        yield Locked(server.url, printed)


def log_in(url: str, secret: str, **headers: str) -> httpx.Response:
    return post(f"{url}/v1/login", json={"secret": secret}, headers=headers)


def cookie_of(answer: httpx.Response) -> str:
    assert answer.status_code == 204
    return answer.headers["set-cookie"].partition(";")[0]


def test_the_link_logs_in_once_and_the_token_always(locked: Locked) -> None:
    assert locked.link.startswith(f"{locked.url}/#login=")
    code = locked.link.partition("=")[2]
    given = log_in(locked.url, code)
    rules = given.headers["set-cookie"].split("; ")[1:]
    assert set(rules) == {"Path=/", "HttpOnly", "SameSite=Strict"}
    again = log_in(locked.url, code)
    assert (again.status_code, again.json()["code"]) == (401, "wrong_token")
    assert cookie_of(log_in(locked.url, TOKEN)) == cookie_of(given)
    assert TOKEN not in given.headers["set-cookie"]
    assert code not in given.headers["set-cookie"]


def test_the_cookie_opens_what_the_token_opens(locked: Locked) -> None:
    cookie = cookie_of(log_in(locked.url, TOKEN))
    health = f"{locked.url}/v1/health"
    assert get(health).status_code == 401
    assert get(health, headers={"Cookie": cookie}).status_code == 200
    assert get(health, headers={"Cookie": f"other=1; {cookie}"}).status_code == 200
    name, _, value = cookie.partition("=")
    for wrong in (name, f"{name}=", f"{name}={value[:-1]}", f"x{cookie}", f"{name}={TOKEN}"):
        assert get(health, headers={"Cookie": wrong}).status_code == 401


def test_pages_of_others_gain_nothing_by_the_cookie(locked: Locked) -> None:
    cookie = {"Cookie": cookie_of(log_in(locked.url, TOKEN))}
    for headers in ({"Origin": "http://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        refused = get(f"{locked.url}/v1/health", headers=cookie | headers)
        assert (refused.status_code, refused.json()["code"]) == (403, "wrong_origin")
        posted = post(f"{locked.url}/v1/sessions", json={}, headers=cookie | headers)
        assert posted.status_code == 403
        assert log_in(locked.url, TOKEN, **headers).status_code == 403
    renamed = get(f"{locked.url}/v1/health", headers=cookie | {"Host": "evil.example"})
    assert renamed.status_code == 421


@pytest.mark.parametrize("page", ["/", "/docs"])
def test_a_page_itself_needs_no_token_and_a_link_elsewhere_may_open_it(
    locked: Locked, page: str
) -> None:
    address = f"{locked.url}{page}"
    link = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    opened = get(address, headers=link | {"Sec-Fetch-Dest": "document"})
    assert opened.status_code == 200
    assert re.search("frame-ancestors 'none'", opened.headers["content-security-policy"])
    for headers in (
        link | {"Sec-Fetch-Dest": "iframe"},
        link | {"Sec-Fetch-Dest": "document", "Origin": "http://evil.example"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "script"},
    ):
        assert get(address, headers=headers).status_code == 403
    elsewhere = get(f"{locked.url}/v1/runs", headers=link | {"Sec-Fetch-Dest": "document"})
    assert elsewhere.status_code == 403


def test_a_cookie_that_came_over_tls_goes_no_other_way() -> None:
    login = BrowserLogin(TOKEN)
    assert login.cookie(is_secure=True).endswith("; Secure")
    assert "Secure" not in login.cookie(is_secure=False)
    assert login.knows(login.cookie(is_secure=True).partition(";")[0])


@pytest.mark.parametrize("secret", ["", "\ud800", "a" * 5000, TOKEN.upper()])
def test_guesses_are_refused(secret: str) -> None:
    assert not BrowserLogin(TOKEN).accepts(secret)


def test_two_services_of_one_machine_do_not_take_each_others_cookies() -> None:
    ours, other = BrowserLogin(TOKEN), BrowserLogin(TOKEN + "2")
    both = "; ".join(each.cookie(is_secure=False).partition(";")[0] for each in (ours, other))
    assert ours.knows(both)
    assert other.knows(both)
    assert not ours.knows(other.cookie(is_secure=False).partition(";")[0])
