"""Login of a browser: a cookie in the place of the token, as a page's streams bear no header.

The cookie is made from the token and does not tell it. A browser gets it for the token, or for a
code that is good once, and which stands in a link behind `#`: no request and no log bears that.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
import time

from starlette.requests import cookie_parser

LOGIN_PATH = "/v1/login"

LONGEST_PENALTY, FORGOTTEN = 5.0, 30.0
"""Time by which a wrong guess is answered late at most, and after which one is forgotten [s]."""


class BrowserLogin:
    """The login of browsers at a service that has a token.

    Args:
        token: of the service.
    """

    def __init__(self, token: str) -> None:
        self._token = token
        self._guesses, self._guessed_at = 0.0, time.monotonic()
        self._code: str | None = secrets.token_urlsafe(24)
        self._value = hmac.new(token.encode(), b"cookie of nlcontrol", hashlib.sha256).hexdigest()
        # Cookies do not know ports: each service on a machine has a name of its own.
        self._name = f"nlcontrol_{hashlib.sha256(self._value.encode()).hexdigest()[:12]}"

    def link(self, url: str) -> str:
        """The address that logs a browser in, once.

        Args:
            url: of the service.
        """
        return f"{url}/#login={self._code}"

    def accepts(self, secret: str) -> bool:
        """Takes a secret: true for the token, and once for the code of the link."""
        if self._code is not None and _are_same(secret, self._code):
            self._code = None
            return True
        return self.is_token(secret)

    def penalty(self) -> float:
        """Time by which a wrong guess is answered late [s]: the more of them of late, the later."""
        now = time.monotonic()
        self._guesses = max(0.0, self._guesses - (now - self._guessed_at) / FORGOTTEN) + 1.0
        self._guessed_at = now
        return float(min(LONGEST_PENALTY, 0.1 * 2.0 ** min(self._guesses - 1.0, 10.0)))

    def is_token(self, secret: str) -> bool:
        """True for the token."""
        return _are_same(secret, self._token)

    def cookie(self, *, is_secure: bool) -> str:
        """The header that gives a browser the cookie.

        Args:
            is_secure: the page came over TLS, so that the cookie may go no other way.
        """
        rules = "Path=/; HttpOnly; SameSite=Strict" + ("; Secure" if is_secure else "")
        return f"{self._name}={self._value}; {rules}"

    def knows(self, cookies: str) -> bool:
        """True if a header of cookies bears the right one."""
        return _are_same(cookie_parser(cookies).get(self._name, ""), self._value)


def _are_same(secret: str, ours: str) -> bool:
    return hmac.compare_digest(secret.encode("utf-8", "replace"), ours.encode())
