"""`serve`: the planning service over HTTP, until a signal ends it."""

from __future__ import annotations

import os
import webbrowser
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import click

from nlcontrol.cli.console.console_output import FILE
from nlcontrol.errors import error, known_errors_raised
from nlcontrol.interruption import SIGNALS

if TYPE_CHECKING:
    from nlcontrol.service.http.responses import HttpSettings
    from nlcontrol.service.service_settings import ServiceSettings

TOKEN_VARIABLE = "NLCONTROL_TOKEN"
"""Variable of the environment that may hold the token."""

_COUNT = click.IntRange(1, 1000)


@click.command("serve")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option(
    "--port",
    default=8000,
    show_default=True,
    type=click.IntRange(0, 65535),
    help="Port to listen on; 0: any free one.",
)
@click.option(
    "--scene",
    "scenes",
    multiple=True,
    help="Scene that clients may open; default: all built-in ones. May be repeated.",
)
@click.option("--workers", type=_COUNT, help="Simultaneous simulated runs; default: cores - 1.")
@click.option("--sessions", type=_COUNT, help="Most open sessions.")
@click.option("--planners", type=_COUNT, help="Most processes that plan without a session.")
@click.option("--queue", type=click.IntRange(0, 10_000), help="Most waiting runs.")
@click.option(
    "--time-limit",
    type=click.FloatRange(0.0, min_open=True),
    metavar="SECONDS",
    help="Stop a plan or an answer after this many seconds (wall clock); default: 60.",
)
@click.option(
    "--store",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder of the runs; default: one in your home folder.",
)
@click.option(
    "--keep",
    type=click.IntRange(1),
    metavar="MB",
    help="Space for finished runs; the oldest are deleted.",
)
@click.option(
    "--token-file",
    type=FILE,
    help=f"File holding the token that requests must carry; or set {TOKEN_VARIABLE}. Required "
    "unless --host is this machine's own.",
)
@click.option(
    "--name",
    "names",
    multiple=True,
    help="Another host name of the service, such as a proxy's. May be repeated.",
)
@click.option(
    "--executor", metavar="MODULE:CLASS", help="Robot to drive instead of the simulated one."
)
@click.option("--approve", is_flag=True, help="Require an approved plan for every motion.")
@click.option("--open", "opens", is_flag=True, help="Open the page in a browser.")
def command(
    host: str,
    port: int,
    scenes: tuple[str, ...],
    workers: int | None,
    sessions: int | None,
    planners: int | None,
    queue: int | None,
    time_limit: float | None,
    store: Path | None,
    keep: int | None,
    token_file: Path | None,
    names: tuple[str, ...],
    executor: str | None,
    approve: bool,
    opens: bool,
) -> int:
    """Serve plans, sessions and runs over HTTP.

    docs/service.md is the guide to it.
    """
    _require_packages()
    from pydantic import ValidationError

    from nlcontrol.service.http.responses import HttpSettings
    from nlcontrol.service.run_store import default_folder
    from nlcontrol.service.service_settings import ServiceSettings

    given = {
        "workers": workers,
        "sessions": sessions,
        "planners": planners,
        "queue": queue,
        "request_time": time_limit,
        "store": store or default_folder(),
        "keep_bytes": None if keep is None else keep * 10**6,
        "scenes": scenes or None,
        "executor": executor,
    }
    try:
        settings = ServiceSettings(**{key: v for key, v in given.items() if v is not None})
        http = HttpSettings(
            host=host, port=port, token=_token(token_file), hosts=names, approve=approve
        )
    except ValidationError as raised:
        first = raised.errors(include_url=False)[0]
        raise click.UsageError(f"{first['loc'][0]}: {first['msg']}") from None
    return _serve(settings, http, opens=opens)


def _serve(settings: ServiceSettings, http: HttpSettings, *, opens: bool) -> int:
    from nlcontrol.service.http.request_guard import BrowserLogin
    from nlcontrol.service.http.web_server import listening_socket, log_as_json, serve, url_of
    from nlcontrol.service.planning_service import PlanningService

    _require_token(http)
    with listening_socket(http.host, http.port) as listening, known_errors_raised():
        log_as_json()
        with PlanningService(settings) as service:
            url = url_of(listening, http.hosts)
            click.echo(f"nlcontrol serves at {url}")
            login = None if http.token is None else BrowserLogin(http.token)
            if login is not None:
                url = login.link(url)
                click.echo(f"log in to its page, once, at {url}")
            if opens:
                # A browser of the terminal does not return before it is left.
                Thread(target=webbrowser.open, args=(url,), daemon=True).start()
            serve(service, http, listening, login)
    return SIGNALS.exit_code


def _require_packages() -> None:
    """Refuses to serve without the packages of the extra.

    Raises:
        ControlError: `missing_extra`.
    """
    try:
        import fastapi  # noqa: F401
        import sse_starlette  # noqa: F401
        import uvicorn  # noqa: F401
    except ImportError as raised:
        raise error(
            "missing_extra",
            f"serving needs the package {raised.name}",
            suggestions=("install from the checkout: pip install '.[serve]'",),
        ) from raised


def _token(file: Path | None) -> str | None:
    """The token of a file, else of the environment; None if there is none.

    Raises:
        ControlError: the file cannot be read.
    """
    if file is None:
        return os.environ.get(TOKEN_VARIABLE) or None
    from objectmodels.files.yaml_documents import read_text

    with known_errors_raised():
        return read_text(file, "token_file").strip()


def _require_token(http: HttpSettings) -> None:
    """Refuses to listen to other machines without a token.

    Raises:
        ControlError: `bad_token`.
    """
    from nlcontrol.service.http.responses import LOOPBACK

    if http.token is None and http.host not in LOOPBACK:
        raise error(
            "bad_token",
            f"at {http.host} other machines can reach the service, and it has no token",
            suggestions=(
                "write at least 16 characters into a file, and give it with --token-file",
                "leave --host out: the service then listens to this machine alone",
            ),
        )
